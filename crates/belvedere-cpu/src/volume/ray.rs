//! The rays of the pixels of a view as segments inside the box of a volume.

use super::clip::{Clip, Segment};
use super::sheaf::{Sheaf, TILE};
use belvedere_core::{DVec2, DVec3, View};
use belvedere_scene::Volume;
use belvedere_sight::trace::Split;

/// Relative difference below which two depths belong to one image of a point.
const SAME_DEPTH: f64 = 0.02;

/// Rays of a tile above which it pays to interpolate them.
const MANY: usize = 6;

/// Generates the segments of the rays of a view.
pub(super) struct Rays<'a> {
    view: &'a View,
    split: Split<'a>,
    /// Whether rays consist of straight and curved pieces in closed form.
    pieces: bool,
    /// Range of depths in which surfaces can be seen.
    range: [f64; 2],
    /// Whether rays between computed ones are interpolated.
    interpolates: bool,
}

impl<'a> Rays<'a> {
    /// * `range`: nearest depth, and a depth beyond which no surface is seen.
    pub(super) fn new(view: &'a View, range: [f64; 2]) -> Self {
        let pieces = view.stages().iter().all(|s| s.bends_rays());
        Self { view, split: Split::new(view), pieces, range, interpolates: pieces }
    }

    /// Computes every ray on its own.
    #[cfg(test)]
    pub(super) fn forget_neighbours(&mut self) {
        self.interpolates = false;
    }

    /// Nearest depth.
    pub(super) fn near(&self) -> f64 {
        self.range[0]
    }

    /// A depth beyond which no surface is seen.
    pub(super) fn deepest(&self) -> f64 {
        self.range[1]
    }

    pub(super) fn view(&self) -> &View {
        self.view
    }

    /// Depth at which the ray of a pixel sees a point that lies on it at about `depth`: segments of rays without pieces tell it roughly.
    pub(super) fn depth_of(&self, place: DVec3, depth: f64) -> f64 {
        if self.pieces {
            return depth;
        }
        match self.view.project(place) {
            Ok(image) if (image.depth - depth).abs() <= SAME_DEPTH * depth => image.depth,
            // Another part of the rays sees it first.
            _ => depth,
        }
    }

    /// Calls `each` with the segments of those pixels of a row that `wants` selects.
    ///
    /// * `within`: place of the rays within their pixels, 0..=1. `wants`: the depth to which the ray of a column is followed; `None`: it is not.
    pub(super) fn row(
        &self,
        (y, within): (usize, DVec2),
        width: usize,
        volume: &Volume,
        wants: impl Fn(usize) -> Option<f64>,
        mut each: impl FnMut(usize, &[Segment]),
    ) {
        let first = DVec2::new(0.0, y as f64) + within;
        let row = if self.pieces { None } else { self.split.row(first.y, self.range) };
        let mut sheaf = Sheaf::new(self.view, volume, self.range, first);
        let mut segments = Vec::new();
        for (x, far, is_one_of_many) in wanted(width, wants) {
            let pixel = first + DVec2::new(x as f64, 0.0);
            segments.clear();
            let mut clip = Clip::new(volume, &mut segments);
            if self.pieces {
                let range = [self.range[0], far];
                if !(self.interpolates && is_one_of_many && sheaf.ray(x, range, &mut clip)) {
                    clip.pieces(self.view, pixel, range);
                }
            } else {
                let curve = self.split.curve(pixel, row.as_ref());
                clip.chords(&self.split, &curve, [self.range[0], far.min(self.range[1])]);
            }
            each(x, &segments);
        }
    }
}

/// Columns of the rays to follow, the depths to which they are followed, and whether there are many in their tile.
fn wanted(width: usize, wants: impl Fn(usize) -> Option<f64>) -> impl Iterator<Item = (usize, f64, bool)> {
    (0..width).step_by(TILE).flat_map(move |first| {
        let columns = first..(first + TILE).min(width);
        let depths: Vec<Option<f64>> = columns.clone().map(&wants).collect();
        let is_many = depths.iter().flatten().count() >= MANY;
        columns.zip(depths).filter_map(move |(x, far)| Some((x, far?, is_many)))
    })
}
