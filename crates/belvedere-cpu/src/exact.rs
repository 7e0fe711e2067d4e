//! The exact renderer: every sample follows its own curved ray to the first surface.
//!
//! It shares with the rasteriser the colours ([`crate::shade`]) and the lines and points drawn over the surfaces
//! ([`belvedere_composite`]), and nothing that decides what is seen where: the reference that other renderers are judged by.

use crate::frame::checked;
use crate::geometry::blocks::Blocks;
use crate::over_ground;
use crate::raster::band::{BAND, sample_offsets};
use crate::screen::{SUB, Screen};
use crate::see_through::SeeThrough;
use crate::shade::{LightCache, Shader};
use crate::traced_veil::TracedVeil;
use crate::volume::{self, Way};
use belvedere_composite::branches;
use belvedere_composite::buffers::Buffers;
use belvedere_composite::color::{Packed, Rgb};
use belvedere_composite::depths::Depths;
use belvedere_composite::finish::{buffers, finish_veiled};
use belvedere_composite::layers;
use belvedere_composite::marks::Marks;
use belvedere_composite::traced_marks;
use belvedere_composite::veil::Veiled;
use belvedere_core::DVec2;
use belvedere_scene::{Frame, FrameStats, Instant, LayerKind, RenderError, RenderJob, Renderer};
use belvedere_sight::Solids;
use belvedere_sight::pass::Pass;
use belvedere_sight::sections::{Exposure, Sections};
use belvedere_sight::trace::{RayHit, RowRays, Tracer, same_surface};
use rayon::prelude::*;
use std::cell::OnceCell;
use std::sync::atomic::{AtomicUsize, Ordering};

/// Rows that a thread traces at a time.
const ROWS: usize = 4;

/// Draws scenes by following curved rays: slow, without subdivision, as exact as the colours allow.
///
/// [`belvedere_scene::RenderOptions::tolerance_px`] concerns the lines alone. Depth, id and world position are those of the pixel
/// centres. Coverage samples are traced where a pixel's neighbours are on another surface; elsewhere the pixel has the colour of its
/// centre.
///
/// ```
/// use belvedere_core::{DVec3, Pinhole, Projection, View};
/// use belvedere_cpu::ExactRenderer;
/// use belvedere_scene::{Light, Progress, RenderJob, RenderOptions, Renderer, Scene};
///
/// let lens = Projection::Perspective { fov_y: 0.8 };
/// let pinhole = Pinhole::look_at(DVec3::ZERO, DVec3::Y, DVec3::Z, lens, [64, 48], 1.0, None)?;
/// let (scene, view) = (Scene::default(), View::straight(pinhole));
/// let (light, options, progress) = (Light::default(), RenderOptions::default(), Progress::silent());
/// let job = RenderJob { scene: &scene, view: &view, light: &light, options: &options, progress: &progress };
/// let frame = ExactRenderer.render(&job)?;
/// assert!(frame.id.iter().all(|&id| id == 0), "nothing but sky");
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Clone, Copy, Default)]
pub struct ExactRenderer;

impl Renderer for ExactRenderer {
    fn name(&self) -> &'static str {
        "exact"
    }

    fn render(&self, job: &RenderJob<'_>) -> Result<Frame, RenderError> {
        // First hits on every layer that is seen through.
        let hits = (SeeThrough::of(job.scene).len() * size_of::<Option<RayHit>>()) as u64;
        checked(job, hits, |job| branches::draw(job, |job| layers::draw(job, render, traced_marks::place_alone)))
    }
}

fn render(job: &RenderJob<'_>) -> Result<Frame, RenderError> {
    let start = Instant::now();
    job.progress.tick("prepare", 0.0)?;
    let screen = Screen::new(job.view.pinhole());
    let (sections, own) = (Sections::new(job), sample_offsets(job.options.samples));
    let exposure = Exposure::new(if sections.is_some() { job.options.exposures as usize } else { 1 }, own.len());
    let offsets = exposure.offsets(&own);
    let tracer = Tracer::exposed((job.scene, Solids::Opaque), job.view, sections, exposure.clone());
    let (blocks, light) = (Blocks::default(), LightCache::default());
    let shader = Shader::new(job, &screen, &blocks, &light);
    job.progress.tick("prepare", 1.0)?;
    let mut buffers = buffers(job);
    let picture = Picture { job, screen: &screen, tracer: &tracer, shader: &shader, offsets };
    let seen = picture.trace()?;
    picture.color(&seen, &mut buffers)?;
    let veil = match TracedVeil::new(job, (&shader, &tracer), &picture.offsets, &exposure) {
        Some(layers) => Some(layers.trace(&seen)?),
        None => None,
    };
    over_ground::paint(job, (&shader, &screen), (0, [None, None]), &mut buffers);
    let samples = volume::compose(job, Way::Exact, &mut buffers)?;
    let marks = traced_marks::place_alone(job, &screen, &buffers.depth);
    job.progress.tick("lines", 0.0)?;
    let front = veil.as_ref().filter(|_| Marks::are_in(job)).map(|veil| {
        let (passes, nearest) = (Pass::all(job.view), veil.nearest(&buffers.depth));
        traced_marks::place(job, &passes.iter().collect::<Vec<_>>(), &screen, (Depths::Whole(&nearest), Solids::Drawn))
    });
    let front = front.unwrap_or_default();
    let veiled = veil.as_ref().map(|veil| Veiled { veil, first: 0, front: &front });
    finish_veiled(job, (&marks, veiled), &screen, None, &mut buffers);
    job.progress.tick("lines", 1.0)?;
    let triangles_in = job.scene.layers.iter().map(|l| match &l.kind {
        LayerKind::Terrain(t) => 2 * ((t.heightfield.cols() - 1) * (t.heightfield.rows() - 1)) as u64,
        LayerKind::Boxes(b) => 12 * b.boxes.len() as u64,
        kind => kind.triangles().map_or(0, |m| m.mesh.triangles().len() as u64),
    });
    let stats = FrameStats {
        triangles_in: triangles_in.sum(),
        samples,
        milliseconds: start.elapsed().as_secs_f64() * 1e3,
        ..FrameStats::default()
    };
    let stats = marks.counted(stats);
    let (width, height) = (screen.width as usize, screen.height as usize);
    Ok(Frame { width, height, color: buffers.out, depth: buffers.depth, id: buffers.id, world: buffers.world, stats })
}

/// Colour, depth, id and world point.
type Pixel = (Packed, f32, u32, [f64; 3]);

struct Picture<'a> {
    job: &'a RenderJob<'a>,
    screen: &'a Screen,
    tracer: &'a Tracer<'a>,
    shader: &'a Shader<'a>,
    /// Samples of a pixel, the centre first.
    offsets: Vec<[i32; 2]>,
}

impl Picture<'_> {
    /// First hits at the pixel centres.
    fn trace(&self) -> Result<Vec<Option<RayHit>>, RenderError> {
        let (width, height) = (self.screen.width as usize, self.screen.height as usize);
        let mut seen = vec![None; width * height];
        let done = AtomicUsize::new(0);
        seen.par_chunks_mut(ROWS * width).enumerate().try_for_each(|(i, rows)| {
            for (k, row) in rows.chunks_mut(width).enumerate() {
                RowRays::new(self.tracer, (i * ROWS + k) as f64 + 0.5, 0).first_hits(row);
            }
            let done = (done.fetch_add(1, Ordering::Relaxed) + 1) * ROWS;
            self.job.progress.tick("trace", (done as f64 / height as f64).min(1.0))
        })?;
        Ok(seen)
    }

    fn color(&self, seen: &[Option<RayHit>], buffers: &mut Buffers) -> Result<(), RenderError> {
        let width = self.screen.width as usize;
        let offsets = &self.offsets;
        let bands = (self.screen.height as usize).div_ceil(BAND);
        let done = AtomicUsize::new(0);
        let shaded: Vec<Pixel> = (0..bands)
            .into_par_iter()
            .map(|band| {
                let rows = band * BAND..((band + 1) * BAND).min(seen.len() / width);
                let row = rows.flat_map(|y| self.row(seen, y, offsets)).collect::<Vec<_>>();
                let done = done.fetch_add(1, Ordering::Relaxed) + 1;
                self.job.progress.tick("draw", done as f64 / bands as f64)?;
                Ok(row)
            })
            .collect::<Result<Vec<_>, RenderError>>()?
            .concat();
        for (i, (color, depth, id, world)) in shaded.into_iter().enumerate() {
            (buffers.color[i], buffers.depth[i], buffers.id[i]) = (color, depth, id);
            if let Some(out) = &mut buffers.world {
                out[i] = world;
            }
        }
        Ok(())
    }

    fn row(&self, seen: &[Option<RayHit>], y: usize, offsets: &[[i32; 2]]) -> Vec<Pixel> {
        let width = self.screen.width as usize;
        // Each sample of a pixel has an image row of its own, shared by the whole row of pixels; only edges trace them.
        let place = |oy: i32| y as f64 + f64::from(oy) / f64::from(SUB);
        let rows: Vec<OnceCell<RowRays<'_, '_>>> = offsets.iter().map(|_| OnceCell::new()).collect();
        let trace =
            |s: usize, x: f64| rows[s].get_or_init(|| RowRays::new(self.tracer, place(offsets[s][1]), s)).first_hit(x);
        (y * width..(y + 1) * width).map(|i| self.pixel(seen, i, offsets, &trace)).collect()
    }

    /// * `trace`: first hit of the ray of sample `s` at image column `x`, pixels.
    fn pixel(
        &self,
        seen: &[Option<RayHit>],
        i: usize,
        offsets: &[[i32; 2]],
        trace: &dyn Fn(usize, f64) -> Option<RayHit>,
    ) -> Pixel {
        let width = self.screen.width as usize;
        let corner = DVec2::new((i % width) as f64, (i / width) as f64);
        let centre = self.shader.shade_hit(self.job.view, seen[i].as_ref(), corner + 0.5);
        let mut color = centre.color;
        if offsets.len() > 1 && self.is_edge(seen, i) {
            let sum: Rgb = (1..offsets.len())
                .map(|s| {
                    let at = corner + DVec2::from_array(offsets[s].map(f64::from)) / f64::from(SUB);
                    self.shader.shade_hit(self.job.view, trace(s, at.x).as_ref(), at).color
                })
                .fold(Rgb::ZERO, |a, b| a + b);
            color = sum / (offsets.len() - 1) as f32;
        }
        let depth = seen[i].map_or(f32::INFINITY, |s| s.depth as f32);
        (Packed::new(color), depth, centre.id, centre.world.to_array())
    }

    /// Whether a neighbour of the pixel lies on another surface.
    fn is_edge(&self, seen: &[Option<RayHit>], i: usize) -> bool {
        let (width, height) = (self.screen.width as usize, self.screen.height as usize);
        let (x, y) = (i % width, i / width);
        (y.saturating_sub(1)..(y + 2).min(height))
            .any(|v| (x.saturating_sub(1)..(x + 2).min(width)).any(|u| !same_surface(seen[i], seen[v * width + u])))
    }
}
