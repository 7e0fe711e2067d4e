//! Composites volumes over the surfaces of a picture.
//!
//! One ray goes through the centre of each pixel. Where neighbouring pixels differ, at silhouettes and edges inside a volume, three more go
//! through the pixel and the mean of the four counts; depth, id and place stay those of its centre.

use super::march::Marcher;
use super::ray::{Rays, Segment};
use super::spans::Spans;
use super::{Gathered, reference};
use crate::trace::deepest;
use belvedere_composite::buffers::Buffers;
use belvedere_composite::color::Packed;
use belvedere_core::DVec2;
use belvedere_scene::{LayerKind, RenderError, RenderJob, VolumeLayer};
use glam::Vec3A;
use rayon::prelude::*;
use std::sync::atomic::{AtomicU64, AtomicUsize, Ordering};

/// Rows that a thread draws at a time.
const ROWS: usize = 4;

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

/// More rays through a pixel at an edge: where in the pixel, 0..1 along both sides.
const MORE: [DVec2; 3] = [DVec2::new(0.5, 0.13), DVec2::new(0.18, 0.69), DVec2::new(0.82, 0.69)];
/// Difference between neighbouring pixels, in 255ths of square roots of light and of the absorbed share, from which on there is an edge.
const EDGE: u8 = 28;

/// Composites the volumes of a scene over its surfaces. Volumes that overlap are composited as wholes, the one that a ray enters first in
/// front. Returns the number of samples taken.
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
    let drawing = Drawing { rays, volumes, way, width };
    // What lies behind the volumes.
    let (back, ends) = (buffers.color.clone(), buffers.depth.clone());
    let end = |i: usize| f64::from(ends[i]).min(far);
    let mut seen = vec![[0u8; 4]; width * height];
    let Buffers { color, depth, id, world, .. } = buffers;
    let mut worlds: Vec<Option<&mut [[f64; 3]]>> = match world {
        Some(w) => w.chunks_mut(chunk).map(Some).collect(),
        None => (0..height.div_ceil(ROWS)).map(|_| None).collect(),
    };
    let parts = color.par_chunks_mut(chunk).zip(depth.par_chunks_mut(chunk)).zip(id.par_chunks_mut(chunk));
    let parts = parts.zip(worlds.par_iter_mut()).zip(seen.par_chunks_mut(chunk));
    parts.enumerate().try_for_each(|(i, ((((color, depth), id), world), seen))| {
        let mut rows = Rows { width, color, depth, id, world: world.as_deref_mut(), seen };
        for y in 0..rows.depth.len() / width {
            let image_y = i * ROWS + y;
            let (lists, taken) = drawing.row(image_y, DVec2::splat(0.5), &|x| Some(end(image_y * width + x)));
            rows.lay_row(&drawing.rays, y, lists);
            samples.fetch_add(taken, Ordering::Relaxed);
        }
        let done = (done.fetch_add(1, Ordering::Relaxed) + 1) * ROWS;
        job.progress.tick("volumes", (done as f64 / height as f64).min(1.0))
    })?;
    color.par_chunks_mut(width).enumerate().try_for_each(|(y, color)| {
        let edges: Vec<bool> = (0..width).map(|x| is_edge(&seen, width, [x, y])).collect();
        if edges.iter().any(|e| *e) {
            let wanted = |x: usize| edges[x].then(|| end(y * width + x));
            samples.fetch_add(drawing.smooth(y, &wanted, &back[y * width..], color), Ordering::Relaxed);
        }
        job.progress.tick("volumes", 1.0)
    })?;
    Ok(samples.into_inner())
}

/// Whether a pixel differs from one beside, above or below it.
fn is_edge(seen: &[[u8; 4]], width: usize, [x, y]: [usize; 2]) -> bool {
    let i = y * width + x;
    let here = seen[i];
    let differs =
        |other: Option<&[u8; 4]>| other.is_some_and(|o| o.iter().zip(here).any(|(a, b)| a.abs_diff(b) >= EDGE));
    let beside = [(x > 0).then(|| i - 1), (x + 1 < width).then_some(i + 1), i.checked_sub(width), Some(i + width)];
    beside.into_iter().flatten().any(|k| differs(seen.get(k)))
}

/// Light that the rays of a row gather: for each pixel the volumes that show something, by layer.
type Lists = Vec<Vec<(usize, Gathered)>>;

/// The volumes of a picture, and its rays.
struct Drawing<'a> {
    rays: Rays<'a>,
    volumes: Vec<Drawn<'a>>,
    way: Way,
    width: usize,
}

impl Drawing<'_> {
    /// What rays of a row see, farthest volume first, and the number of samples taken.
    ///
    /// * `within`: where in their pixels the rays go; `wanted`: the depth at which the ray of a column ends, `None`: it has none.
    fn row(&self, y: usize, within: DVec2, wanted: &dyn Fn(usize) -> Option<f64>) -> (Lists, u64) {
        let mut found: Lists = vec![Vec::new(); self.width];
        let mut samples = 0;
        for volume in &self.volumes {
            let mut take = |x: usize, gathered: Gathered| {
                samples += u64::from(gathered.samples);
                if gathered.alpha > 0.0 {
                    found[x].push((volume.index, gathered));
                }
            };
            match self.way {
                Way::Fast => self.rays.row(
                    y,
                    within,
                    self.width,
                    volume.marcher.volume(),
                    |x| wanted(x).filter(|_| volume.spans.hold([x, y])),
                    |x, segments: &[Segment]| {
                        take(x, volume.marcher.gather(segments));
                    },
                ),
                Way::Exact => {
                    for (x, end) in (0..self.width).filter_map(|x| Some((x, wanted(x)?))) {
                        let pixel = DVec2::new(x as f64, y as f64) + within;
                        let range = [self.rays.near(), end.min(self.rays.deepest())];
                        take(x, reference::gather(self.rays.view(), volume.layer, pixel, range));
                    }
                }
            }
        }
        for list in &mut found {
            list.sort_by(|a, b| b.1.enters.total_cmp(&a.1.enters));
        }
        (found, samples)
    }

    /// Gives the pixels of a row that are wanted the mean of several rays. Returns the number of samples taken.
    ///
    /// * `back`: colours behind the volumes; `color`: those of the row, with one ray for each pixel.
    fn smooth(&self, y: usize, wanted: &dyn Fn(usize) -> Option<f64>, back: &[Packed], color: &mut [Packed]) -> u64 {
        let mut sums: Vec<Vec3A> = color.iter().map(|c| c.rgb()).collect();
        let mut samples = 0;
        for within in MORE {
            let (lists, taken) = self.row(y, within, wanted);
            samples += taken;
            for ((sum, list), back) in sums.iter_mut().zip(lists).zip(back) {
                *sum += list.iter().fold(back.rgb(), |behind, (_, g)| g.color + behind * (1.0 - g.alpha));
            }
        }
        let share = 1.0 / (1 + MORE.len()) as f32;
        for (x, (color, sum)) in color.iter_mut().zip(sums).enumerate() {
            if wanted(x).is_some() {
                *color = Packed::new(sum * share);
            }
        }
        samples
    }
}

/// Some rows of the picture.
struct Rows<'b> {
    width: usize,
    color: &'b mut [Packed],
    depth: &'b mut [f32],
    id: &'b mut [u32],
    world: Option<&'b mut [[f64; 3]]>,
    /// Square roots of the light that the volumes send, and the share that they absorb.
    seen: &'b mut [[u8; 4]],
}

impl Rows<'_> {
    /// Lays what the rays of row `y` of these gather over it.
    fn lay_row(&mut self, rays: &Rays<'_>, y: usize, lists: Lists) {
        for (x, list) in lists.into_iter().enumerate() {
            let i = y * self.width + x;
            let (mut light, mut let_through) = (Vec3A::ZERO, 1.0);
            for (layer, gathered) in list {
                light = gathered.color + light * (1.0 - gathered.alpha);
                let_through *= 1.0 - gathered.alpha;
                let half = gathered.half.map(|(depth, place)| (rays.depth_of(place, depth), place));
                self.lay(i, layer, &Gathered { half, ..gathered });
            }
            let [r, g, b] = light.to_array().map(|v| (255.0 * v.max(0.0).sqrt()) as u8);
            self.seen[i] = [r, g, b, (255.0 * (1.0 - let_through)) as u8];
        }
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
