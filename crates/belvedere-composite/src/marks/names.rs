//! Names of lines, placed along them.

use crate::marks::baseline::{Letters, baselines};
use crate::marks::request::LabelRequest;
use crate::marks::visibility::{Run, Station};
use crate::marks::{MarkBuilder, Style, darker, path, width_or_none};
use belvedere_core::DVec2;
use belvedere_scene::{Color, Hidden, LineLayer};
use rayon::prelude::*;
use std::collections::HashMap;

/// Margin between a name and the rim of the picture, pixels.
const RIM: f64 = 4.0;
/// A name needs a stretch of line of at least this share of its own width.
const LEAST_SHARE: f64 = 0.6;

/// A drawn stretch of line.
#[derive(Clone, Debug, PartialEq)]
struct Stretch {
    /// Length, pixels.
    length: f64,
    middle: DVec2,
    /// Its course, about a pixel apart.
    points: Vec<DVec2>,
}

impl MarkBuilder<'_> {
    /// Each name of a layer once, along the longest stretch of the lines that bear it, or beside its middle where it winds.
    pub(super) fn line_names(&self, layer: &LineLayer) -> Vec<LabelRequest> {
        let Some(size_px) = layer.label_px else { return Vec::new() };
        let half_px = 0.5 * width_or_none(layer.width_px, self.density);
        let style = Style { half_px, casing_px: None, hidden: layer.hidden, lift_m: layer.lift_m };
        let stretches: Vec<(&str, (Color, f64), Option<Stretch>)> = layer
            .features
            .par_iter()
            .filter(|f| !f.name.trim().is_empty())
            .map(|f| {
                let own = f.style.unwrap_or_default();
                let look = (own.color.unwrap_or(layer.color), half_px * own.scale.max(0.0));
                let line = path::drape(self.scene, &f.points, layer.lift_m, self.coarse());
                (f.name.trim(), look, self.longest(&line, style))
            })
            .collect();
        let mut best: HashMap<&str, ((Color, f64), Stretch)> = HashMap::new();
        for (name, look, stretch) in stretches {
            let Some(stretch) = stretch else { continue };
            match best.get_mut(name) {
                Some(longest) if stretch.length > longest.1.length => *longest = (look, stretch),
                Some(_) => {}
                None => {
                    best.insert(name, (look, stretch));
                }
            }
        }
        let mut names: Vec<(&str, f64, (Color, f64), Stretch)> = best
            .into_iter()
            .map(|(name, (look, stretch))| (name, self.fonts.text_size(size_px, name).width, look, stretch))
            .filter(|(_, width, _, stretch)| stretch.length >= LEAST_SHARE * width)
            .collect();
        // Names of lines with longer visible stretches are placed first.
        names.sort_by(|a, b| b.3.length.total_cmp(&a.3.length).then(a.0.cmp(b.0)));
        let request = |(name, width, (color, half), stretch): (&str, f64, (Color, f64), Stretch)| {
            let side = self.casing_of(half);
            let letters = Letters { width, size_px, gap: side + self.density };
            LabelRequest {
                marker: [side; 2],
                along: baselines(&stretch.points, letters),
                line: (stretch.points, side),
                ..LabelRequest::new(name, stretch.middle, size_px, darker(color))
            }
        };
        names.into_iter().map(request).collect()
    }

    fn longest(&self, line: &[path::LinePoint], style: Style) -> Option<Stretch> {
        let size = 2.0 * self.screen.center;
        // Where hidden parts are drawn like visible ones, the whole line may bear the name.
        let drawn = |run: Run| match style.hidden {
            Hidden::Show => vec![run.stations],
            _ => run.parts().into_iter().filter(|(visible, _)| *visible).map(|(_, part)| part).collect(),
        };
        let parts = self.runs(line, style).into_iter().flat_map(|(_, run)| drawn(run));
        parts.flat_map(|part| within(&part, size, RIM * self.density)).max_by(|a, b| a.length.total_cmp(&b.length))
    }
}

/// Stretches of a line within the picture.
fn within(part: &[Station], size: DVec2, rim: f64) -> Vec<Stretch> {
    let inside = |s: &Station| s.pixel.cmpge(DVec2::splat(rim)).all() && s.pixel.cmple(size - rim).all();
    let stretch = |stations: &[Station]| {
        let (first, last) = (stations.first()?, stations.last()?);
        let half = 0.5 * (first.arc_px + last.arc_px);
        let after = stations.partition_point(|s| s.arc_px < half).min(stations.len() - 1);
        let [a, b] = [after.saturating_sub(1), after].map(|i| &stations[i]);
        let share = (half - a.arc_px) / (b.arc_px - a.arc_px).max(1e-9);
        let middle = a.pixel.lerp(b.pixel, share.clamp(0.0, 1.0));
        let points = stations.iter().map(|s| s.pixel).collect();
        Some(Stretch { length: last.arc_px - first.arc_px, middle, points })
    };
    part.split(|s| !inside(s)).filter_map(stretch).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::marks::path::LinePoint;
    use belvedere_core::DVec3;

    #[test]
    fn the_middle_of_a_stretch_is_that_of_its_part_within_the_picture() {
        let station = |i: i32| Station {
            pixel: DVec2::new(f64::from(i), 50.0),
            arc_px: f64::from(i) + 30.0,
            on_line: LinePoint { p: DVec3::ZERO, along: 0.0, on_ground: true },
        };
        let line: Vec<Station> = (-30..200).map(station).collect();
        let found = within(&line, DVec2::new(100.0, 80.0), RIM);
        let points: Vec<DVec2> = (4..=96).map(|x| DVec2::new(f64::from(x), 50.0)).collect();
        assert_eq!(found, [Stretch { length: 92.0, middle: DVec2::new(50.0, 50.0), points }]);
        assert!(within(&line, DVec2::new(100.0, 40.0), RIM).is_empty());
    }
}
