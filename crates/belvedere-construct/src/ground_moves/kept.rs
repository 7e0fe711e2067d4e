//! What lies on the ground and keeps its form when an author moves it.

use belvedere_core::map::ground_moves::MoveNet;
use belvedere_core::{DVec2, DVec3, polygon};
use belvedere_scene::{AreaSurface, Heightfield, LayerKind, LineClass, Scene, Sea};

/// An area of water is a lake if four fifths of its heights lie within this range, metres, as for the terrain solver.
const LEVEL_M: f64 = 30.0;
/// Fewest and most places of an area that are looked at, along each direction.
const LOOKS: [f64; 2] = [12.0, 400.0];

/// A line on the ground.
#[derive(Debug, Clone, PartialEq)]
pub struct KeptLine {
    /// Its name, or that of its layer.
    pub name: String,
    /// Its points, scene coordinates, at the height of the ground.
    pub points: Vec<DVec3>,
}

/// What lies on the ground and keeps its form.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Kept {
    /// Lakes stay level: rings of each, scene x, y.
    pub lakes: Vec<Vec<Vec<DVec2>>>,
    /// Land and sea beside these places stay at their height: nodes of the sea, scene x, y.
    pub sea: Vec<DVec2>,
    /// Rivers rise nowhere downstream by more than they do.
    pub rivers: Vec<KeptLine>,
    /// Routes keep their length.
    pub routes: Vec<KeptLine>,
}

impl Kept {
    /// Lakes are areas of water that lie level; the sea is that of the ground; rivers are lines of that class and those of the layers
    /// `rivers`; routes are lines that must be seen.
    ///
    /// * `heights`: whether anything goes up or down: only then lakes, sea and rivers are needed.
    pub fn of(scene: &Scene, rivers: &[String], heights: bool) -> Self {
        let mut kept = Self::default();
        let ground = scene.terrain();
        if let (Some(ground), true) = (ground, heights) {
            kept.sea = sea(ground);
        }
        for layer in &scene.layers {
            match &layer.kind {
                LayerKind::Area(areas) if areas.surface == AreaSurface::Water && heights => {
                    let rings = areas.features.iter().map(|f| &f.rings);
                    kept.lakes.extend(rings.filter(|rings| ground.is_none_or(|g| is_level(rings, g))).cloned());
                }
                LayerKind::Line(lines) => {
                    let is_named = rivers.contains(&layer.id);
                    for feature in lines.features.iter().filter(|f| f.points.len() > 1) {
                        let class = feature.style.as_ref().and_then(|style| style.class);
                        let is_river = is_named || matches!(class, Some(LineClass::River | LineClass::Stream));
                        let name = if feature.name.is_empty() { &layer.id } else { &feature.name };
                        let line = || KeptLine { name: name.clone(), points: feature.points.clone() };
                        if is_river && heights {
                            kept.rivers.push(line().downstream());
                        } else if layer.must_see && !is_river {
                            kept.routes.push(line());
                        }
                    }
                }
                _ => {}
            }
        }
        kept
    }
}

fn sea(ground: &Heightfield) -> Vec<DVec2> {
    let Some((_, is_sea)) = Sea::nodes(ground) else { return Vec::new() };
    let nodes = is_sea.iter().enumerate().filter(|(_, sea)| **sea);
    nodes.map(|(i, _)| ground.node_xy(i % ground.cols(), i / ground.cols())).collect()
}

fn is_level(rings: &[Vec<DVec2>], ground: &Heightfield) -> bool {
    let inside = places_inside(rings, f64::MAX);
    let mut heights: Vec<f64> = inside.into_iter().filter_map(|p| ground.height_at(p)).collect();
    heights.sort_by(f64::total_cmp);
    let at = |share: f64| heights[((heights.len() - 1) as f64 * share).round() as usize];
    !heights.is_empty() && at(0.9) - at(0.1) <= LEVEL_M
}

/// Places inside rings, about `step` apart or closer, and the corners of the rings.
pub(super) fn places_inside(rings: &[Vec<DVec2>], step: f64) -> Vec<DVec2> {
    let points = || rings.iter().flatten().copied();
    let (min, max) = points().fold((DVec2::INFINITY, DVec2::NEG_INFINITY), |(a, b), p| (a.min(p), b.max(p)));
    if !(min.is_finite() && max.is_finite()) {
        return Vec::new();
    }
    let [across, up] = (max - min).to_array().map(|side| (side / step).ceil().clamp(LOOKS[0], LOOKS[1]));
    let step = (max - min) / DVec2::new(across, up);
    let row = |j: usize| (0..=across as usize).map(move |i| min + step * DVec2::new(i as f64, j as f64));
    let grid = (0..=up as usize).flat_map(row);
    grid.filter(|p| polygon::is_inside(rings, *p)).chain(points()).collect()
}

impl KeptLine {
    /// The line from its higher end to its lower one.
    fn downstream(mut self) -> Self {
        if let (Some(first), Some(last)) = (self.points.first(), self.points.last())
            && first.z < last.z
        {
            self.points.reverse();
        }
        self
    }

    /// Most that the line rises on moved ground between two of its points, more than it did.
    pub(super) fn rise_under(&self, net: &MoveNet) -> f64 {
        let heights = self.points.iter().map(|p| (p.z, p.z + net.at(p.truncate()).z));
        let (mut lowest, mut most) = ([f64::INFINITY; 2], [0.0f64; 2]);
        for (before, after) in heights {
            for (k, z) in [before, after].into_iter().enumerate() {
                lowest[k] = lowest[k].min(z);
                most[k] = most[k].max(z - lowest[k]);
            }
        }
        (most[1] - most[0]).max(0.0)
    }
}
