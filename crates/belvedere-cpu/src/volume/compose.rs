//! Composites volumes over the surfaces of a picture.

use super::Gathered;
use super::edges::Cover;
use super::gather::{Drawing, Drawn, Found, Row, Way};
use super::march::Marcher;
use super::ray::Rays;
use super::smooth::{self, Behind};
use belvedere_composite::buffers::Buffers;
use belvedere_composite::color::Packed;
use belvedere_core::DVec2;
use belvedere_scene::{RenderError, RenderJob};
use belvedere_sight::trace::deepest;
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
        .filter_map(|(index, l)| l.kind.volume().map(|layer| (index, layer, Marcher::new(layer))))
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
    let mut behind = Behind::of(job, buffers, far);
    let (samples, done) = (AtomicU64::new(0), AtomicUsize::new(0));
    let chunk = ROWS * width;
    let Buffers { color, depth, id, world, .. } = &mut *buffers;
    let mut worlds = parts(world.as_deref_mut(), chunk, height);
    let mut covers = parts(behind.as_mut().map(|behind| &mut behind.cover[..]), chunk, height);
    let parts = color.par_chunks_mut(chunk).zip(depth.par_chunks_mut(chunk)).zip(id.par_chunks_mut(chunk));
    let parts = parts.zip(worlds.par_iter_mut()).zip(covers.par_iter_mut());
    parts.enumerate().try_for_each(|(i, ((((color, depth), id), world), cover))| {
        let (world, cover) = (world.as_deref_mut(), cover.as_deref_mut());
        let mut rows = Rows { width, color, depth, id, world, cover };
        samples.fetch_add(rows.draw(&drawing, far, i * ROWS), Ordering::Relaxed);
        let done = (done.fetch_add(1, Ordering::Relaxed) + 1) * ROWS;
        job.progress.tick("volumes", (done as f64 / height as f64).min(1.0))
    })?;
    let smoothed = match behind {
        Some(behind) => smooth::draw(job, &drawing, &behind, buffers)?,
        None => 0,
    };
    Ok(samples.into_inner() + smoothed)
}

/// Chunks of something that there may be for every pixel, for each [`ROWS`] rows.
fn parts<T>(all: Option<&mut [T]>, chunk: usize, height: usize) -> Vec<Option<&mut [T]>> {
    match all {
        Some(all) => all.chunks_mut(chunk).map(Some).collect(),
        None => (0..height.div_ceil(ROWS)).map(|_| None).collect(),
    }
}

/// Some rows of the picture.
struct Rows<'b> {
    width: usize,
    color: &'b mut [Packed],
    depth: &'b mut [f32],
    id: &'b mut [u32],
    world: Option<&'b mut [[f64; 3]]>,
    cover: Option<&'b mut [Cover]>,
}

impl Rows<'_> {
    /// Draws the rows, the first of which is row `first` of the picture. Returns the number of samples taken.
    fn draw(&mut self, drawing: &Drawing<'_>, far: f64, first: usize) -> u64 {
        // Ends of the rays: depths of the surfaces before any volume is drawn.
        let ends: Vec<f64> = self.depth.iter().map(|d| f64::from(*d).min(far)).collect();
        let rows: Vec<Row> =
            (0..ends.len() / self.width).map(|y| Row { y: first + y, within: DVec2::splat(0.5) }).collect();
        let (found, samples) = drawing.gather(&rows, |row, x| Some(ends[row * self.width + x]));
        for ray in found.chunk_by(|a, b| (a.row, a.column) == (b.row, b.column)) {
            let i = ray[0].row * self.width + ray[0].column;
            if let Some(cover) = &mut self.cover {
                cover[i] = Cover::of(ray.iter().map(|found| &found.gathered));
            }
            for Found { layer, gathered, .. } in ray {
                let half = gathered.half.map(|(depth, place)| (drawing.rays.depth_of(place, depth), place));
                self.lay(i, *layer, &Gathered { half, ..*gathered });
            }
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
