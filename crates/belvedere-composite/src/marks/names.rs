//! Names of lines, placed along them.

use crate::marks::baseline::{Letters, baselines};
use crate::marks::request::{Baseline, LabelRequest};
use crate::marks::visibility::{Run, Station};
use crate::marks::{MarkBuilder, Style, darker, path, ways, width_or_none};
use belvedere_core::DVec2;
use belvedere_scene::{Color, Hidden, LineLayer, NameAnchor, NamePlace, NameSide};
use rayon::prelude::*;
use std::collections::{HashMap, HashSet};

/// Margin between a name and the rim of the picture, pixels.
const RIM: f64 = 4.0;
/// A name needs a stretch of line of at least this share of its own width.
const LEAST_SHARE: f64 = 0.6;
/// Of a scene unit, in which points of lines are told.
const THOUSANDTHS: f64 = 1000.0;

/// A drawn stretch of line.
#[derive(Clone, Debug, PartialEq)]
struct Stretch {
    /// Index of the line in its layer, of a way in pieces that of the first.
    feature: u32,
    /// Length, pixels.
    length: f64,
    /// Its course, about a pixel apart.
    points: Vec<DVec2>,
    /// Lengths on the image and along the line from the beginning of the line to each point, pixels and scene units.
    arcs: Vec<[f64; 2]>,
}

impl MarkBuilder<'_> {
    /// Each name of a layer once, along the longest stretch of the ways that bear it, whose pieces are joined, or beside its middle where it winds; in a film
    /// along the stretch where it stood before, while there is room.
    ///
    /// * `id`: 1 + index of the layer.
    pub(super) fn line_names(&self, layer: &LineLayer, id: u32) -> Vec<LabelRequest> {
        let Some(size_px) = layer.label_px else { return Vec::new() };
        let half_px = 0.5 * width_or_none(layer.width_px, self.density);
        let style = Style { half_px, casing_px: None, hidden: layer.hidden, lift_m: layer.lift_m };
        let names: HashSet<&str> = layer.features.iter().map(|f| f.name.trim()).collect();
        let wide = |name: &str| self.fonts.text_size(size_px, name).width;
        let wanted: HashMap<&str, Wanted> = names
            .into_iter()
            .filter(|name| !name.is_empty())
            .map(|name| (name, Wanted { width: wide(name), held: self.choice.held_line(id, name) }))
            .collect();
        let found = ways::of(&layer.features).into_par_iter().filter_map(|way| {
            let f = &layer.features[way.first];
            let (name, wanted) = wanted.get_key_value(f.name.trim())?;
            let own = f.style.unwrap_or_default();
            let line = path::drape(self.scene, &way.points, layer.lift_m, self.coarse());
            let stretch = self.best(&line, style, (way.first as u32, wanted))?;
            let (color, half_px) = (own.color.unwrap_or(layer.color), half_px * own.scale.max(0.0));
            Some(Named { name, wanted, color, half_px, stretch })
        });
        let mut best: HashMap<&str, Named<'_>> = HashMap::new();
        for next in found.collect::<Vec<_>>() {
            if best.get(next.name).is_none_or(|best| next.wanted.prefers(&next.stretch, &best.stretch)) {
                best.insert(next.name, next);
            }
        }
        let mut names: Vec<Named<'_>> = best.into_values().filter(|n| n.wanted.has_room(&n.stretch)).collect();
        // Names of lines with longer visible stretches are placed first.
        names.sort_by(|a, b| b.stretch.length.total_cmp(&a.stretch.length).then(a.name.cmp(b.name)));
        names.into_iter().map(|named| self.line_name(named, size_px)).collect()
    }

    fn line_name(&self, named: Named<'_>, size_px: f64) -> LabelRequest {
        let Named { name, wanted, color, half_px, stretch } = named;
        let side = self.casing_of(half_px);
        let letters = Letters { width: wanted.width, size_px, gap: side + self.density };
        let held = wanted.on(&stretch);
        let middle = held.map_or(0.5, |(share, _)| share);
        let anchor = if held.is_some() { wanted.anchor() } else { Some(stretch.anchor(middle)) };
        let runs = held.and_then(|(share, side)| match side {
            NameSide::Along { upper } => Some((share, upper)),
            _ => None,
        });
        let along = baselines(&stretch.points, letters, runs).into_iter().map(|along| Baseline {
            // What is held stays held, though the end of the stretch may push it along.
            anchor: if along.held { anchor } else { Some(stretch.anchor(along.middle)) },
            points: along.points,
            upper: along.upper,
        });
        LabelRequest {
            marker: [side; 2],
            along: along.collect(),
            anchor,
            ..LabelRequest::new(name, stretch.at(middle), size_px, darker(color))
        }
        .clear_of(stretch.points, side)
    }

    /// The stretch that a name holds, or else the longest.
    fn best(&self, line: &[path::LinePoint], style: Style, (feature, wanted): (u32, &Wanted)) -> Option<Stretch> {
        let size = 2.0 * self.screen.center;
        // Where hidden parts are drawn like visible ones, the whole line may bear the name.
        let drawn = |run: Run| match style.hidden {
            Hidden::Show => vec![run.stations],
            _ => run.parts().into_iter().filter(|(visible, _)| *visible).map(|(_, part)| part).collect(),
        };
        let parts = self.runs(line, style).into_iter().flat_map(|(_, run)| drawn(run));
        let stretches = parts.flat_map(|part| within(&part, size, (feature, RIM * self.density)));
        // Of equally long ones the last.
        stretches.reduce(|best, next| match wanted.prefers(&best, &next) {
            true => best,
            false => next,
        })
    }
}

/// A name and the stretch that bears it, of a line with this colour and half width.
struct Named<'a> {
    name: &'a str,
    wanted: &'a Wanted,
    color: Color,
    half_px: f64,
    stretch: Stretch,
}

/// What is known of a name before its stretch is found.
struct Wanted {
    /// Of the text, pixels.
    width: f64,
    /// Where it stood in the frame before.
    held: Option<NamePlace>,
}

impl Wanted {
    fn anchor(&self) -> Option<NameAnchor> {
        self.held?.anchor
    }

    fn has_room(&self, stretch: &Stretch) -> bool {
        stretch.length >= LEAST_SHARE * self.width
    }

    /// Where on a stretch the name stood, as a share of its length, and on which side.
    fn on(&self, stretch: &Stretch) -> Option<(f64, NameSide)> {
        let held = self.held?;
        Some((stretch.share_of(self.anchor()?)?, held.side))
    }

    fn prefers(&self, a: &Stretch, b: &Stretch) -> bool {
        let [first, second] = [a, b].map(|s| self.on(s).is_some() && self.has_room(s));
        if first == second { a.length > b.length } else { first }
    }
}

impl Stretch {
    /// The place between two points at a share of the length: number of the second, and share of the way from the first.
    fn between(&self, share: f64) -> (usize, f64) {
        let last = self.arcs.len() - 1;
        let arc = (1.0 - share) * self.arcs[0][0] + share * self.arcs[last][0];
        let after = self.arcs.partition_point(|a| a[0] < arc).clamp(1.min(last), last);
        let [a, b] = [after.saturating_sub(1), after].map(|i| self.arcs[i][0]);
        (after, ((arc - a) / (b - a).max(1e-9)).clamp(0.0, 1.0))
    }

    /// The pixel at a share of the length.
    fn at(&self, share: f64) -> DVec2 {
        let (after, t) = self.between(share);
        self.points[after.saturating_sub(1)].lerp(self.points[after], t)
    }

    /// The point of the line at a share of the length.
    fn anchor(&self, share: f64) -> NameAnchor {
        let (after, t) = self.between(share);
        let [a, b] = [after.saturating_sub(1), after].map(|i| self.arcs[i][1]);
        NameAnchor { feature: self.feature, along: ((a + t * (b - a)) * THOUSANDTHS).round() as i64 }
    }

    /// The share of the length at a point of the line; `None` where the stretch does not contain it.
    fn share_of(&self, anchor: NameAnchor) -> Option<f64> {
        let along = anchor.along as f64 / THOUSANDTHS;
        let is_between = |pair: &[[f64; 2]]| (pair[0][1] <= along) != (pair[1][1] <= along);
        let pair = self.arcs.windows(2).find(|pair| self.feature == anchor.feature && is_between(pair))?;
        let t = (along - pair[0][1]) / (pair[1][1] - pair[0][1]);
        let arc = pair[0][0] + t * (pair[1][0] - pair[0][0]);
        Some((arc - self.arcs[0][0]) / self.length.max(1e-9))
    }
}

/// Stretches of a line within the picture.
/// * `feature`: index of the line in its layer; `rim`: margin of the picture, pixels.
fn within(part: &[Station], size: DVec2, (feature, rim): (u32, f64)) -> Vec<Stretch> {
    let inside = |s: &Station| s.pixel.cmpge(DVec2::splat(rim)).all() && s.pixel.cmple(size - rim).all();
    let stretch = |stations: &[Station]| {
        let (first, last) = (stations.first()?, stations.last()?);
        let points = stations.iter().map(|s| s.pixel).collect();
        let arcs = stations.iter().map(|s| [s.arc_px, s.on_line.along]).collect();
        Some(Stretch { feature, length: last.arc_px - first.arc_px, points, arcs })
    };
    part.split(|s| !inside(s)).filter_map(stretch).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::marks::path::LinePoint;
    use belvedere_core::DVec3;

    /// A level line of 230 pixels at row 50, 3 scene units to a pixel.
    fn line() -> Vec<Station> {
        let station = |i: i32| Station {
            pixel: DVec2::new(f64::from(i), 50.0),
            arc_px: f64::from(i) + 30.0,
            on_line: LinePoint { p: DVec3::ZERO, along: 3.0 * (f64::from(i) + 30.0), on_ground: true },
        };
        (-30..200).map(station).collect()
    }

    #[test]
    fn the_middle_of_a_stretch_is_that_of_its_part_within_the_picture() {
        let found = within(&line(), DVec2::new(100.0, 80.0), (7, RIM));
        let points: Vec<DVec2> = (4..=96).map(|x| DVec2::new(f64::from(x), 50.0)).collect();
        assert_eq!((found.len(), found[0].length, &found[0].points), (1, 92.0, &points));
        assert_eq!(found[0].at(0.5), DVec2::new(50.0, 50.0));
        assert!(within(&line(), DVec2::new(100.0, 40.0), (7, RIM)).is_empty());
    }

    #[test]
    fn a_point_of_a_line_is_found_again_where_the_stretch_contains_it() {
        let stretch = within(&line(), DVec2::new(100.0, 80.0), (7, RIM)).swap_remove(0);
        let anchor = stretch.anchor(0.25);
        assert_eq!(anchor, NameAnchor { feature: 7, along: 171_000 });
        assert!((stretch.share_of(anchor).unwrap() - 0.25).abs() < 1e-9);
        let wider = within(&line(), DVec2::new(150.0, 80.0), (7, RIM)).swap_remove(0);
        assert_eq!(wider.at(wider.share_of(anchor).unwrap()), stretch.at(0.25));
        assert_eq!(stretch.share_of(NameAnchor { feature: 6, ..anchor }), None);
        assert_eq!(stretch.share_of(NameAnchor { along: 600_000, ..anchor }), None);
        // A name keeps to the stretch where it stood, though another is longer.
        let held = Some(NamePlace { side: NameSide::Along { upper: true }, anchor: Some(anchor) });
        let other = Stretch { feature: 3, length: 500.0, ..wider.clone() };
        let wanted = |held, width| Wanted { width, held };
        assert!(wanted(held, 80.0).prefers(&stretch, &other) && wanted(None, 80.0).prefers(&other, &stretch));
        assert!(wanted(held, 400.0).prefers(&other, &stretch), "there is no room any more");
    }
}
