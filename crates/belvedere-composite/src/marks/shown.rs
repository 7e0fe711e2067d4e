//! Parts of lines, outlines and points that styling sections show.

use crate::marks::MarkBuilder;
use crate::marks::path::LinePoint;
use belvedere_core::DVec3;
use belvedere_scene::{LineFeature, LineLayer, PointLayer};
use belvedere_sight::sections::Shown;
use std::borrow::Cow;

impl MarkBuilder<'_> {
    /// Whether a layer is drawn everywhere, nowhere, or partly, and a test whether it is drawn at a point.
    pub(super) fn shows(&self, layer: usize) -> (Shown, impl Fn(DVec3) -> bool + '_) {
        let shown = self.sections.map_or(Shown::Everything, |s| s.of_layer(layer));
        (shown, move |p: DVec3| self.sections.is_none_or(|s| s.prevails(layer, p)))
    }

    /// The lines of a layer where they are shown.
    pub(super) fn shown_lines<'l>(&self, index: usize, layer: &'l LineLayer) -> Cow<'l, LineLayer> {
        let (shown, is_shown) = self.shows(index);
        if shown == Shown::Everything {
            return Cow::Borrowed(layer);
        }
        let stretches = |f: &LineFeature| -> Vec<LineFeature> {
            let runs = f.points.chunk_by(|a, b| is_shown(*a) == is_shown(*b));
            let runs = runs.filter(|run| run.len() > 1 && is_shown(run[0]));
            runs.map(|run| LineFeature { style: f.style, name: f.name.clone(), points: run.to_vec() }).collect()
        };
        let features = layer.features.iter().flat_map(stretches).collect();
        Cow::Owned(LineLayer { features, ..layer.clone() })
    }

    /// The points of a layer that are shown.
    pub(super) fn shown_points<'l>(&self, index: usize, layer: &'l PointLayer) -> Cow<'l, PointLayer> {
        let (shown, is_shown) = self.shows(index);
        if shown == Shown::Everything {
            return Cow::Borrowed(layer);
        }
        let features = layer.features.iter().filter(|f| is_shown(f.position)).cloned().collect();
        Cow::Owned(PointLayer { features, ..layer.clone() })
    }

    /// Paths of a layer, cut where they are not shown.
    pub(super) fn shown_paths(&self, index: usize, paths: Vec<Vec<LinePoint>>) -> Vec<Vec<LinePoint>> {
        let (shown, is_shown) = self.shows(index);
        if shown == Shown::Everything {
            return paths;
        }
        let runs = paths.iter().flat_map(|path| path.chunk_by(|a, b| is_shown(a.p) == is_shown(b.p)));
        runs.filter(|run| run.len() > 1 && is_shown(run[0].p)).map(<[LinePoint]>::to_vec).collect()
    }
}
