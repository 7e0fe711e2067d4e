//! Composites volumes over the surfaces of a picture.

use super::clip::Segment;
use super::march::Marcher;
use super::ray::Rays;
use super::spans::Spans;
use super::{Gathered, reference};
use crate::trace::deepest;
use belvedere_composite::buffers::Buffers;
use belvedere_composite::color::Packed;
use belvedere_core::DVec2;
use belvedere_scene::{LayerKind, RenderError, RenderJob, VolumeLayer};
use rayon::prelude::*;
use std::sync::atomic::{AtomicU64, AtomicUsize, Ordering};

/// Rows that a thread draws at a time.
const ROWS: usize = 4;
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
struct Drawn<'a> {
    index: usize,
    layer: &'a VolumeLayer,
    marcher: Marcher<'a>,
    spans: Spans,
}

/// Composites the volumes of a scene over its surfaces, at the pixel centres. Volumes that overlap are composited as wholes, the
/// one that a ray enters first in front. Returns the number of samples taken.
pub(crate) fn compose(job: &RenderJob<'_>, way: Way, buffers: &mut Buffers) -> Result<u64, RenderError> {
    let volumes: Vec<Drawn<'_>> = job
        .scene
        .layers
        .iter()
        .enumerate()
        .filter_map(|(index, l)| match &l.kind {
            LayerKind::Volume(layer) => Some((index, layer, Marcher::new(layer))),
            _ => None,
        })
        .filter(|(_, _, marcher)| !marcher.is_clear())
        .map(|(index, layer, marcher)| Drawn { index, layer, spans: marcher.spans(job.view), marcher })
        .collect();
    if volumes.is_empty() {
        return Ok(0);
    }
    let width = job.view.pinhole().image[0] as usize;
    let height = job.view.pinhole().image[1] as usize;
    let far = job.view.pinhole().far.unwrap_or(f64::INFINITY);
    let rays = Rays::new(job.view, [job.view.pinhole().near, deepest(job.scene, job.view)]);
    let (samples, done) = (AtomicU64::new(0), AtomicUsize::new(0));
    let chunk = ROWS * width;
    let Buffers { color, depth, id, world, .. } = buffers;
    let mut worlds: Vec<Option<&mut [[f64; 3]]>> = match world {
        Some(w) => w.chunks_mut(chunk).map(Some).collect(),
        None => (0..height.div_ceil(ROWS)).map(|_| None).collect(),
    };
    let parts = color.par_chunks_mut(chunk).zip(depth.par_chunks_mut(chunk)).zip(id.par_chunks_mut(chunk));
    parts.zip(worlds.par_iter_mut()).enumerate().try_for_each(|(i, (((color, depth), id), world))| {
        let mut rows = Rows { width, color, depth, id, world: world.as_deref_mut() };
        for y in 0..rows.depth.len() / width {
            let taken = rows.draw(&rays, &volumes, way, far, [y, i * ROWS + y]);
            samples.fetch_add(taken, Ordering::Relaxed);
        }
        let done = (done.fetch_add(1, Ordering::Relaxed) + 1) * ROWS;
        job.progress.tick("volumes", (done as f64 / height as f64).min(1.0))
    })?;
    Ok(samples.into_inner())
}

/// Rays of a row that are followed together.
#[derive(Default)]
struct Batch {
    columns: Vec<usize>,
    /// Segments of all rays, and for each ray the number of those before its end.
    segments: Vec<Segment>,
    ends: Vec<usize>,
}

impl Batch {
    fn add(&mut self, column: usize, segments: &[Segment]) {
        self.columns.push(column);
        self.segments.extend_from_slice(segments);
        self.ends.push(self.segments.len());
    }

    /// Hands over what the rays gather, and forgets them.
    fn gather(&mut self, marcher: &Marcher<'_>, take: &mut impl FnMut(usize, Gathered)) {
        let found = marcher.gather(&self.segments, &self.ends);
        self.columns.drain(..).zip(found).for_each(|(x, gathered)| take(x, gathered));
        self.segments.clear();
        self.ends.clear();
    }
}

/// Some rows of the picture.
struct Rows<'b> {
    width: usize,
    color: &'b mut [Packed],
    depth: &'b mut [f32],
    id: &'b mut [u32],
    world: Option<&'b mut [[f64; 3]]>,
}

impl Rows<'_> {
    /// Draws row `y` of these, row `image_y` of the picture.
    fn draw(&mut self, rays: &Rays<'_>, volumes: &[Drawn<'_>], way: Way, far: f64, [y, image_y]: [usize; 2]) -> u64 {
        let row = y * self.width..(y + 1) * self.width;
        // Ends of the rays: depths of the surfaces before any volume is drawn.
        let ends: Vec<f64> = self.depth[row.clone()].iter().map(|d| f64::from(*d).min(far)).collect();
        let mut found: Vec<(usize, usize, Gathered)> = Vec::new();
        let mut samples = 0;
        for volume in volumes {
            let mut take = |x: usize, gathered: Gathered| {
                samples += u64::from(gathered.samples);
                if gathered.alpha > 0.0 {
                    found.push((x, volume.index, gathered));
                }
            };
            match way {
                Way::Fast => {
                    let mut batch = Batch::default();
                    let wants = |x| volume.spans.hold([x, image_y]).then_some(ends[x]);
                    rays.row(image_y, self.width, volume.marcher.volume(), wants, |x, segments: &[Segment]| {
                        if !segments.is_empty() {
                            batch.add(x, segments);
                            if batch.columns.len() == BATCH {
                                batch.gather(&volume.marcher, &mut take);
                            }
                        }
                    });
                    batch.gather(&volume.marcher, &mut take);
                }
                Way::Exact => {
                    for (x, end) in ends.iter().enumerate() {
                        let pixel = DVec2::new(x as f64 + 0.5, image_y as f64 + 0.5);
                        let range = [rays.near(), end.min(rays.deepest())];
                        take(x, reference::gather(rays.view(), volume.layer, pixel, range));
                    }
                }
            }
        }
        // By column, the farthest volume first.
        found.sort_by(|a, b| a.0.cmp(&b.0).then(b.2.enters.total_cmp(&a.2.enters)));
        for (x, layer, gathered) in found {
            let half = gathered.half.map(|(depth, place)| (rays.depth_of(place, depth), place));
            self.lay(y * self.width + x, layer, &Gathered { half, ..gathered });
        }
        samples
    }

    fn lay(&mut self, i: usize, layer: usize, gathered: &Gathered) {
        self.color[i] = Packed::new(gathered.color + self.color[i].rgb() * (1.0 - gathered.alpha));
        if let Some((depth, place)) = gathered.half {
            self.depth[i] = depth as f32;
            self.id[i] = layer as u32 + 1;
            if let Some(world) = &mut self.world {
                world[i] = place.to_array();
            }
        }
    }
}
