//! Composites volumes over the surfaces of a picture.

use super::Gathered;
use super::gather::{Drawing, Drawn, Found, Way};
use super::march::Marcher;
use super::ray::Rays;
use super::smooth::{self, Behind};
use crate::trace::deepest;
use belvedere_composite::buffers::Buffers;
use belvedere_composite::color::Packed;
use belvedere_core::DVec2;
use belvedere_scene::{LayerKind, RenderError, RenderJob};
use rayon::prelude::*;
use std::sync::atomic::{AtomicU64, AtomicUsize, Ordering};

/// Rows that a thread draws at a time.
const ROWS: usize = 4;

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
