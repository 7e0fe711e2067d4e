//! What the rays of a row gather in all volumes of a scene.

use super::clip::Segment;
use super::march::Marcher;
use super::ray::Rays;
use super::spans::Spans;
use super::{Gathered, place_in_step, reference};
use belvedere_core::DVec2;
use belvedere_scene::VolumeLayer;

/// Most rays that are followed together.
const BATCH: usize = 256;

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

/// What a ray of a column gathers in a layer.
pub(super) struct Found {
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
    /// What the rays of a row gather at a place within their pixels: by column, the farthest volume first; and the number of samples.
    ///
    /// * `wants`: the depth to which the ray of a column is followed; `None`: it is not.
    pub(super) fn row(&self, (y, within): (usize, DVec2), wants: impl Fn(usize) -> Option<f64>) -> (Vec<Found>, u64) {
        let mut found: Vec<Found> = Vec::new();
        let mut samples = 0;
        for volume in &self.volumes {
            let mut take = |column: usize, gathered: Gathered| {
                samples += u64::from(gathered.samples);
                if gathered.alpha > 0.0 {
                    found.push(Found { column, layer: volume.index, gathered });
                }
            };
            match self.way {
                Way::Fast => {
                    let mut batch = Batch::default();
                    let wants = |x| wants(x).filter(|_| volume.spans.hold([x, y]));
                    let voxels = volume.marcher.volume();
                    self.rays.row((y, within), self.width, voxels, wants, |x, segments: &[Segment]| {
                        if !segments.is_empty() {
                            batch.add(x, place_in_step(DVec2::new(x as f64, y as f64) + within), segments);
                            if batch.columns.len() == BATCH {
                                batch.gather(&volume.marcher, &mut take);
                            }
                        }
                    });
                    batch.gather(&volume.marcher, &mut take);
                }
                Way::Exact => {
                    for x in 0..self.width {
                        let Some(end) = wants(x) else { continue };
                        let pixel = DVec2::new(x as f64, y as f64) + within;
                        let range = [self.rays.near(), end.min(self.rays.deepest())];
                        take(x, reference::gather(self.rays.view(), volume.layer, pixel, range));
                    }
                }
            }
        }
        found.sort_by(|a, b| a.column.cmp(&b.column).then(b.gathered.enters.total_cmp(&a.gathered.enters)));
        (found, samples)
    }
}

/// Rays of a row that are followed together.
#[derive(Default)]
struct Batch {
    columns: Vec<usize>,
    /// Segments of all rays, and for each ray the number of those before its end.
    segments: Vec<Segment>,
    ends: Vec<usize>,
    /// For each ray the place of its samples within their steps.
    within: Vec<f64>,
}

impl Batch {
    fn add(&mut self, column: usize, within: f64, segments: &[Segment]) {
        self.columns.push(column);
        self.within.push(within);
        self.segments.extend_from_slice(segments);
        self.ends.push(self.segments.len());
    }

    /// Hands over what the rays gather, and forgets them.
    fn gather(&mut self, marcher: &Marcher<'_>, take: &mut impl FnMut(usize, Gathered)) {
        let found = marcher.gather(&self.segments, &self.ends, &self.within);
        self.columns.drain(..).zip(found).for_each(|(x, gathered)| take(x, gathered));
        self.segments.clear();
        self.ends.clear();
        self.within.clear();
    }
}
