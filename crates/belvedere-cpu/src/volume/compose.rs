//! Composites volumes over the surfaces of a picture.

use super::clip::Segment;
use super::march::Marcher;
use super::ray::Rays;
use super::smooth::{self, Behind};
use super::spans::Spans;
use super::{Gathered, place_in_step, reference};
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

/// What a ray of a column gathers in a layer.
pub(super) struct Found {
    pub(super) column: usize,
    layer: usize,
    pub(super) gathered: Gathered,
}

/// The volumes of a scene and the rays through them.
pub(super) struct Drawing<'a> {
    rays: Rays<'a>,
    volumes: Vec<Drawn<'a>>,
    way: Way,
    width: usize,
}

/// Composites the volumes of a scene over its surfaces, at the pixel centres, and at their edges at more places of the pixel. Volumes that
/// overlap are composited as wholes, the one that a ray enters first in front. Returns the number of samples taken.
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
    let drawing = Drawing { rays, volumes, way, width };
    let behind = Behind::of(job, buffers, far);
    let (samples, done) = (AtomicU64::new(0), AtomicUsize::new(0));
    let chunk = ROWS * width;
    let Buffers { color, depth, id, world, .. } = &mut *buffers;
    let mut worlds: Vec<Option<&mut [[f64; 3]]>> = match world {
        Some(w) => w.chunks_mut(chunk).map(Some).collect(),
        None => (0..height.div_ceil(ROWS)).map(|_| None).collect(),
    };
    let parts = color.par_chunks_mut(chunk).zip(depth.par_chunks_mut(chunk)).zip(id.par_chunks_mut(chunk));
    parts.zip(worlds.par_iter_mut()).enumerate().try_for_each(|(i, (((color, depth), id), world))| {
        let mut rows = Rows { width, color, depth, id, world: world.as_deref_mut() };
        for y in 0..rows.depth.len() / width {
            let taken = rows.draw(&drawing, far, [y, i * ROWS + y]);
            samples.fetch_add(taken, Ordering::Relaxed);
        }
        let done = (done.fetch_add(1, Ordering::Relaxed) + 1) * ROWS;
        job.progress.tick("volumes", (done as f64 / height as f64).min(1.0))
    })?;
    let smoothed = match behind {
        Some(behind) => smooth::edges(job, &drawing, &behind, &mut buffers.color)?,
        None => 0,
    };
    Ok(samples.into_inner() + smoothed)
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
    fn draw(&mut self, drawing: &Drawing<'_>, far: f64, [y, image_y]: [usize; 2]) -> u64 {
        let row = y * self.width..(y + 1) * self.width;
        // Ends of the rays: depths of the surfaces before any volume is drawn.
        let ends: Vec<f64> = self.depth[row].iter().map(|d| f64::from(*d).min(far)).collect();
        let (found, samples) = drawing.row((image_y, DVec2::splat(0.5)), |x| Some(ends[x]));
        for Found { column, layer, gathered } in found {
            let half = gathered.half.map(|(depth, place)| (drawing.rays.depth_of(place, depth), place));
            self.lay(y * self.width + column, layer, &Gathered { half, ..gathered });
        }
        samples
    }

    fn lay(&mut self, i: usize, layer: usize, gathered: &Gathered) {
        self.color[i] = Packed::new(gathered.over(self.color[i].rgb()));
        if let Some((depth, place)) = gathered.half {
            self.depth[i] = depth as f32;
            self.id[i] = layer as u32 + 1;
            if let Some(world) = &mut self.world {
                world[i] = place.to_array();
            }
        }
    }
}
