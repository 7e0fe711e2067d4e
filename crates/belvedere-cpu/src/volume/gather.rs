//! What the rays of some rows gather in all volumes of a scene.

use super::clip::Segment;
use super::march::Marcher;
use super::ray::Rays;
use super::spans::Spans;
use super::{Gathered, reference};
use belvedere_core::DVec2;
use belvedere_scene::VolumeLayer;
use belvedere_sight::volume::place_in_step;

/// Most rays that are followed together, and segments of rays beyond which no more are added.
const BATCH: usize = 1024;
const SEGMENTS: usize = 4096;

/// Algorithm that follows rays.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Way {
    /// Groups of samples, with empty-space skipping.
    Fast,
    /// One sample at a time in 64 bits.
    Exact,
}

/// A volume layer and its number.
pub(super) struct Drawn<'a> {
    pub(super) index: usize,
    pub(super) layer: &'a VolumeLayer,
    pub(super) marcher: Marcher<'a>,
    pub(super) spans: Spans,
}

/// Rays of a row of the picture, at one place within their pixels, 0..=1.
#[derive(Debug, Clone, Copy)]
pub(super) struct Row {
    pub(super) y: usize,
    pub(super) within: DVec2,
}

/// What a ray gathers in a layer.
pub(super) struct Found {
    /// Which of the rows, and the column.
    pub(super) row: usize,
    pub(super) column: usize,
    pub(super) layer: usize,
    pub(super) gathered: Gathered,
}

/// The volumes of a scene and the rays through them.
pub(super) struct Drawing<'a> {
    pub(super) rays: Rays<'a>,
    pub(super) volumes: Vec<Drawn<'a>>,
    pub(super) way: Way,
    pub(super) width: usize,
}

impl Drawing<'_> {
    /// The longest edge of a voxel, of those that [`belvedere_scene::Volume::voxel_edge`] tells, scene units.
    pub(super) fn voxel(&self) -> f64 {
        self.volumes.iter().map(|volume| volume.marcher.volume().voxel_edge()).fold(0.0, f64::max)
    }

    /// What the rays of rows gather: by row and column, the farthest volume first; and the number of samples.
    ///
    /// * `wants`: the depth to which the ray of a row and column is followed; `None`: it is not.
    pub(super) fn gather(&self, rows: &[Row], wants: impl Fn(usize, usize) -> Option<f64>) -> (Vec<Found>, u64) {
        let mut found: Vec<Found> = Vec::new();
        let mut samples = 0;
        for volume in &self.volumes {
            let mut take = |[row, column]: [usize; 2], gathered: Gathered| {
                samples += u64::from(gathered.samples);
                if gathered.alpha > 0.0 {
                    found.push(Found { row, column, layer: volume.index, gathered });
                }
            };
            match self.way {
                Way::Fast => self.side_by_side(volume, rows, &wants, &mut take),
                Way::Exact => {
                    for (row, Row { y, within }) in rows.iter().enumerate() {
                        for x in 0..self.width {
                            let Some(end) = wants(row, x) else { continue };
                            let pixel = DVec2::new(x as f64, *y as f64) + *within;
                            let range = [self.rays.near(), end.min(self.rays.deepest())];
                            take([row, x], reference::gather(self.rays.view(), volume.layer, pixel, range));
                        }
                    }
                }
            }
        }
        let order = |f: &Found| [f.row, f.column];
        found.sort_by(|a, b| order(a).cmp(&order(b)).then(b.gathered.enters.total_cmp(&a.gathered.enters)));
        (found, samples)
    }

    /// Follows the rays through one volume.
    fn side_by_side(
        &self,
        volume: &Drawn<'_>,
        rows: &[Row],
        wants: &impl Fn(usize, usize) -> Option<f64>,
        take: &mut impl FnMut([usize; 2], Gathered),
    ) {
        let mut batch = Batch::default();
        let voxels = volume.marcher.volume();
        for (row, Row { y, within }) in rows.iter().enumerate() {
            let wants = |x| if volume.spans.hold([x, *y]) { wants(row, x) } else { None };
            self.rays.row((*y, *within), self.width, voxels, wants, |x, segments: &[Segment]| {
                if !segments.is_empty() {
                    batch.add([row, x], place_in_step(DVec2::new(x as f64, *y as f64) + *within), segments);
                    if batch.rays.len() == BATCH || batch.segments.len() >= SEGMENTS {
                        batch.gather(&volume.marcher, take);
                    }
                }
            });
        }
        batch.gather(&volume.marcher, take);
    }
}

/// Rays that are followed together.
#[derive(Default)]
struct Batch {
    /// Row and column of each.
    rays: Vec<[usize; 2]>,
    /// Segments of all rays, and for each ray the number of those before its end.
    segments: Vec<Segment>,
    ends: Vec<usize>,
    /// For each ray the place of its samples within their steps.
    within: Vec<f64>,
}

impl Batch {
    fn add(&mut self, ray: [usize; 2], within: f64, segments: &[Segment]) {
        self.rays.push(ray);
        self.within.push(within);
        self.segments.extend_from_slice(segments);
        self.ends.push(self.segments.len());
    }

    /// Hands over what the rays gather, and forgets them.
    fn gather(&mut self, marcher: &Marcher<'_>, take: &mut impl FnMut([usize; 2], Gathered)) {
        let found = marcher.gather(&self.segments, &self.ends, &self.within);
        self.rays.drain(..).zip(found).for_each(|(ray, gathered)| take(ray, gathered));
        self.segments.clear();
        self.ends.clear();
        self.within.clear();
    }
}
