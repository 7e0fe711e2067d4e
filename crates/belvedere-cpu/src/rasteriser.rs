//! The rasteriser: draws a frame from blocks of surfaces to marks.

use crate::cache::{GroundCache, lock};
use crate::frame::checked;
use crate::geometry::blocks::Blocks;
use crate::geometry::drawn_solids::DrawnSolids;
use crate::geometry::lod::Tree;
use crate::geometry::pass::{BodyPasses, Pass};
use crate::marks;
use crate::over_ground;
use crate::raster::band::{BAND, Band, sample_offsets};
use crate::resolve::relief::resolve_relief;
use crate::resolve::{Colors, Rows, resolve};
use crate::screen::Screen;
use crate::see_through::{self, Composer, SeeThrough};
use crate::shade::pixel_center::PixelCenters;
use crate::shade::{LightCache, Shader};
use crate::volume::{self, Way};
use belvedere_composite::branches;
use belvedere_composite::buffers::Buffers;
use belvedere_composite::color::Packed;
use belvedere_composite::finish::{buffers_in, finish_veiled};
use belvedere_composite::layers;
use belvedere_composite::marks::Marks;
use belvedere_composite::sections::{Exposure, Sections};
use belvedere_composite::stylise::Relief;
use belvedere_composite::veil::{Veil, Veiled};
use belvedere_scene::Instant;
use belvedere_scene::{Frame, FrameStats, RenderError, RenderJob, Renderer};
use belvedere_sight::{Carried, Solids};
use rayon::prelude::*;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::{Arc, Mutex};

/// Draws scenes on the processor.
///
/// It caches data of the ground (light, averages, levels of detail) and the memory of its last frames: keep one
/// renderer for all frames of a film. Pictures do not depend on earlier ones.
///
/// ```
/// use belvedere_core::{DVec3, Pinhole, Projection, View};
/// use belvedere_cpu::CpuRenderer;
/// use belvedere_scene::{Light, Progress, RenderJob, RenderOptions, Renderer, Scene};
///
/// let lens = Projection::Perspective { fov_y: 0.8 };
/// let pinhole = Pinhole::look_at(DVec3::ZERO, DVec3::Y, DVec3::Z, lens, [64, 48], 1.0, None)?;
/// let (scene, view) = (Scene::default(), View::straight(pinhole));
/// let (light, options, progress) = (Light::default(), RenderOptions::default(), Progress::silent());
/// let job = RenderJob { scene: &scene, view: &view, light: &light, options: &options, progress: &progress };
/// let frame = CpuRenderer::default().render(&job)?;
/// assert!(frame.id.iter().all(|&id| id == 0), "nothing but sky");
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Default)]
pub struct CpuRenderer {
    detail: GroundCache<(), Arc<Tree>>,
    light: LightCache,
    /// Buffers for reuse; only their capacity is kept.
    scratch: Mutex<Vec<Scratch>>,
}

impl Renderer for CpuRenderer {
    fn name(&self) -> &'static str {
        "cpu"
    }

    fn render(&self, job: &RenderJob<'_>) -> Result<Frame, RenderError> {
        let mut frame = Frame::default();
        self.render_into(job, &mut frame)?;
        Ok(frame)
    }

    fn render_into(&self, job: &RenderJob<'_>, frame: &mut Frame) -> Result<(), RenderError> {
        let old = Mutex::new(std::mem::take(frame));
        *frame = checked(job, 0, |job| {
            branches::draw(job, |job| {
                layers::draw(job, |job| self.draw(job, std::mem::take(&mut *lock(&old))), marks::place_alone)
            })
        })?;
        Ok(())
    }
}

/// Buffers of a frame, kept for the next one.
#[derive(Debug, Default)]
struct Scratch {
    blocks: Blocks,
    color: Vec<Packed>,
    bands: Mutex<Vec<Band>>,
}

/// Largest number of frames whose buffers are kept.
const SPARE_FRAMES: usize = 2;

impl CpuRenderer {
    fn draw(&self, job: &RenderJob<'_>, frame: Frame) -> Result<Frame, RenderError> {
        let mut scratch = lock(&self.scratch).pop().unwrap_or_default();
        let result = self.draw_with(job, frame, &mut scratch);
        let mut spare = lock(&self.scratch);
        if spare.len() < SPARE_FRAMES {
            spare.push(scratch);
        }
        result
    }

    fn draw_with(&self, job: &RenderJob<'_>, frame: Frame, scratch: &mut Scratch) -> Result<Frame, RenderError> {
        let start = Instant::now();
        job.progress.tick("project", 0.0)?;
        let screen = Screen::new(job.view.pinhole());
        let passes = Pass::all(job.view);
        let carried = Carried::new(job.scene, job.view);
        let bodies = carried.as_ref().map(BodyPasses::new);
        let Scratch { blocks, color, bands } = scratch;
        let sections = Sections::new(job);
        blocks.build(job, (&passes, bodies.as_ref()), &screen, sections.as_ref(), &self.detail);
        job.progress.tick("project", 1.0)?;
        let shader = Shader::new(job, &screen, blocks, &self.light);
        let mut buffers = buffers_in(job, std::mem::take(color), frame);
        let centers = job.options.aux.exact.then(|| PixelCenters::new(job.scene, &passes, bodies.as_ref(), &screen));
        let surfaces = Surfaces { job, screen: &screen, blocks, shader: &shader, centers: centers.as_ref() };
        let mut relief = Relief::room(job, sample_offsets(job.options.samples).len().max(2) - 1);
        let see_through = SeeThrough::of(job.scene);
        let mut veil = (!see_through.is_empty()).then(|| Veil::clear(buffers.out.len()));
        let spare = Spare { bands, layers: &see_through };
        surfaces.draw(sections.as_ref(), spare, &mut buffers, (relief.as_mut(), veil.as_mut()))?;
        over_ground::paint(job, (&shader, &screen), &mut buffers);
        let samples = volume::compose(job, Way::Fast, &mut buffers)?;
        if buffers.open {
            let marks = marks::place(job, &passes, &screen, (&buffers.depth, Solids::Opaque));
            let front = veil
                .as_ref()
                .filter(|_| Marks::are_in(job))
                .map(|veil| marks::place(job, &passes, &screen, (&veil.nearest(&buffers.depth), Solids::Drawn)));
            let front = front.unwrap_or_default();
            job.progress.tick("lines", 0.0)?;
            let veiled = veil.as_ref().map(|veil| Veiled { veil, front: &front });
            finish_veiled(job, (&marks, veiled), &screen, relief, &mut buffers);
            job.progress.tick("lines", 1.0)?;
        }
        let counts = blocks.counts();
        let stats = FrameStats {
            triangles_in: blocks.triangles_in,
            triangles_drawn: counts.drawn,
            edges_split: counts.split,
            vertices_missed: counts.missed,
            samples,
            layer_bytes: 0,
            milliseconds: start.elapsed().as_secs_f64() * 1e3,
        };
        *color = buffers.color;
        let (width, height) = (screen.width as usize, screen.height as usize);
        Ok(Frame {
            width,
            height,
            color: buffers.out,
            depth: buffers.depth,
            id: buffers.id,
            world: buffers.world,
            stats,
        })
    }
}

/// Bands for reuse, and the layers that need bands of their own.
#[derive(Clone, Copy)]
struct Spare<'a> {
    bands: &'a Mutex<Vec<Band>>,
    layers: &'a [SeeThrough],
}

/// Inputs for rasterising the bands of a frame.
struct Surfaces<'a> {
    job: &'a RenderJob<'a>,
    screen: &'a Screen,
    blocks: &'a Blocks,
    shader: &'a Shader<'a>,
    centers: Option<&'a PixelCenters<'a>>,
}

impl Surfaces<'_> {
    fn draw(
        &self,
        sections: Option<&Sections<'_>>,
        spare: Spare<'_>,
        buffers: &mut Buffers,
        (relief, veil): (Option<&mut Relief>, Option<&mut Veil>),
    ) -> Result<(), RenderError> {
        let Self { job, screen, blocks, shader, centers } = *self;
        let Spare { bands: spare, layers } = spare;
        let opaque = DrawnSolids { scene: job.scene, solids: Solids::Opaque };
        let chunk = BAND * screen.width as usize;
        let bands = (screen.height as usize).div_ceil(BAND);
        let done = AtomicUsize::new(0);
        let offsets = sample_offsets(job.options.samples);
        let exposure = Exposure::new(job.options.exposures as usize, offsets.len());
        let mut worlds: Vec<Option<&mut [[f64; 3]]>> = match &mut buffers.world {
            Some(w) => w.chunks_mut(chunk).map(Some).collect(),
            None => (0..bands).map(|_| None).collect(),
        };
        let mut relief = match relief {
            Some(relief) => relief.bands(chunk),
            None => (0..bands).map(|_| None).collect(),
        };
        let mut veil = match veil {
            Some(veil) => veil.bands(chunk),
            None => (0..bands).map(|_| None).collect(),
        };
        let mut colors: Vec<Colors<'_>> = if buffers.open {
            buffers.color.chunks_mut(chunk).map(Colors::Open).collect()
        } else {
            buffers.out.chunks_mut(chunk).map(Colors::Stored).collect()
        };
        let depth = buffers.depth.par_chunks_mut(chunk);
        let id = buffers.id.par_chunks_mut(chunk);
        colors
            .par_iter_mut()
            .zip(depth)
            .zip(id)
            .zip(worlds.par_iter_mut())
            .zip(relief.par_iter_mut().zip(veil.par_iter_mut()))
            .enumerate()
            .try_for_each(|(i, ((((color, depth), id), world), (relief, veil)))| {
                let y0 = (i * BAND) as i32;
                let cleared = || {
                    let mut band = lock(spare).pop().unwrap_or_default();
                    band.clear(y0, (y0 + BAND as i32).min(screen.height), screen.width, &offsets);
                    band
                };
                let mut band = cleared();
                blocks.draw(&mut band, opaque);
                let mut thin = None;
                if let Some(sections) = sections.filter(|_| blocks.are_thin_in(&band)) {
                    band.expose(exposure.offsets(&offsets));
                    blocks.draw_thin(&mut band, screen.ortho, (sections, &exposure), opaque);
                    thin = Some((sections, &exposure));
                }
                if let Some(relief) = relief {
                    resolve_relief(&band, shader, relief);
                }
                resolve(&band, shader, screen, &mut Rows { color, depth, id, world: world.as_deref_mut(), centers });
                if let Some(veil) = veil {
                    let mut bands: Vec<Band> = layers.iter().map(|_| cleared()).collect();
                    let offsets = band.offsets.clone();
                    let thin = thin.map(|(sections, exposure)| (sections, exposure, &offsets[..]));
                    see_through::draw((job.scene, layers), blocks, &mut bands, (screen.ortho, thin));
                    let composer = Composer { layers, behind: &band, bands: &bands, shader, screen };
                    composer.compose(veil);
                    lock(spare).extend(bands);
                }
                lock(spare).push(band);
                let done = done.fetch_add(1, Ordering::Relaxed) + 1;
                Ok(job.progress.tick("draw", done as f64 / bands as f64)?)
            })
    }
}
