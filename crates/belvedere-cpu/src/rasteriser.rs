//! The rasteriser: draws a frame from blocks of surfaces to marks.

use crate::cache::{GroundCache, lock};
use crate::frame::{checked, needed};
use crate::geometry::blocks::Blocks;
use crate::geometry::drawn_solids::DrawnSolids;
use crate::geometry::lod::Tree;
use crate::geometry::pass::{BodyPasses, Pass};
use crate::marks;
use crate::over_ground;
use crate::raster::band::{BAND, Band, sample_offsets};
use crate::resolve::relief::resolve_relief;
use crate::resolve::{Colors, Rows, resolve};
use crate::rows;
use crate::screen::Screen;
use crate::see_through::{self, Composer, SeeThrough};
use crate::shade::pixel_center::PixelCenters;
use crate::shade::{LightCache, Shader};
use crate::volume::{self, Way};
use belvedere_composite::branches;
use belvedere_composite::buffers::Buffers;
use belvedere_composite::color::Packed;
use belvedere_composite::depths::Depths;
use belvedere_composite::finish::{buffers_in, finish_veiled};
use belvedere_composite::layers;
use belvedere_composite::marks::Marks;
use belvedere_composite::sections::{Exposure, Sections};
use belvedere_composite::stylise::Relief;
use belvedere_composite::veil::{Veil, Veiled};
use belvedere_scene::Instant;
use belvedere_scene::{Frame, FrameStats, PictureRows, RenderError, RenderJob, Renderer};
use belvedere_sight::{Carried, Solids};
use rayon::prelude::*;
use std::ops::Range;
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
    pub(crate) detail: GroundCache<(), Arc<Tree>>,
    pub(crate) light: LightCache,
    /// Buffers for reuse; only their capacity is kept.
    pub(crate) scratch: Mutex<Vec<Scratch>>,
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

    fn whole_only(&self, job: &RenderJob<'_>) -> Option<&'static str> {
        rows::whole_only(job)
    }

    fn bytes_for(&self, job: &RenderJob<'_>, rows: Option<usize>) -> u64 {
        needed(job, (0, rows))
    }

    fn in_rows(
        &self,
        job: &RenderJob<'_>,
        work: &mut dyn FnMut(&dyn PictureRows) -> Result<(), RenderError>,
    ) -> Result<(), RenderError> {
        self.with_scratch(|scratch| rows::draw(self, job, scratch, work))
    }
}

/// Buffers of a frame, kept for the next one.
#[derive(Debug, Default)]
pub(crate) struct Scratch {
    pub(crate) blocks: Blocks,
    pub(crate) color: Vec<Packed>,
    pub(crate) bands: Mutex<Vec<Band>>,
}

/// Largest number of frames whose buffers are kept.
const SPARE_FRAMES: usize = 2;

impl CpuRenderer {
    fn draw(&self, job: &RenderJob<'_>, frame: Frame) -> Result<Frame, RenderError> {
        self.with_scratch(|scratch| self.draw_with(job, frame, scratch))
    }

    fn with_scratch<T>(&self, work: impl FnOnce(&mut Scratch) -> T) -> T {
        let mut scratch = lock(&self.scratch).pop().unwrap_or_default();
        let result = work(&mut scratch);
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
        let see_through = SeeThrough::of(job.scene);
        let surfaces = Surfaces {
            job,
            screen: &screen,
            blocks,
            shader: &shader,
            centers: centers.as_ref(),
            sections: sections.as_ref(),
            layers: &see_through,
            spare: bands,
        };
        let mut relief = Relief::room(job, sample_offsets(job.options.samples).len().max(2) - 1);
        let mut veil = (!see_through.is_empty()).then(|| Veil::clear(buffers.out.len()));
        let whole = screen.width as usize * screen.height as usize;
        let bands_of_relief = relief.as_mut().map(|relief| (relief, 0..whole));
        surfaces.draw(0, &mut buffers, (bands_of_relief, veil.as_mut()))?;
        over_ground::paint(job, (&shader, &screen), 0, &mut buffers);
        let samples = volume::compose(job, Way::Fast, &mut buffers)?;
        if buffers.open {
            let marks = marks::place(job, &passes, &screen, (Depths::Whole(&buffers.depth), Solids::Opaque));
            let front = veil.as_ref().filter(|_| Marks::are_in(job)).map(|veil| {
                marks::place(job, &passes, &screen, (Depths::Whole(&veil.nearest(&buffers.depth)), Solids::Drawn))
            });
            let front = front.unwrap_or_default();
            job.progress.tick("lines", 0.0)?;
            let veiled = veil.as_ref().map(|veil| Veiled { veil, first: 0, front: &front });
            finish_veiled(job, (&marks, veiled), &screen, relief, &mut buffers);
            job.progress.tick("lines", 1.0)?;
        }
        let stats = stats(blocks, samples, start);
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

/// Counts of a picture.
pub(crate) fn stats(blocks: &Blocks, samples: u64, start: Instant) -> FrameStats {
    let counts = blocks.counts();
    FrameStats {
        triangles_in: blocks.triangles_in,
        triangles_drawn: counts.drawn,
        edges_split: counts.split,
        vertices_missed: counts.missed,
        samples,
        layer_bytes: 0,
        milliseconds: start.elapsed().as_secs_f64() * 1e3,
    }
}

/// Inputs for rasterising the bands of a frame.
#[derive(Clone, Copy)]
pub(crate) struct Surfaces<'a> {
    pub(crate) job: &'a RenderJob<'a>,
    pub(crate) screen: &'a Screen,
    pub(crate) blocks: &'a Blocks,
    pub(crate) shader: &'a Shader<'a>,
    pub(crate) centers: Option<&'a PixelCenters<'a>>,
    pub(crate) sections: Option<&'a Sections<'a>>,
    /// Layers that need bands of their own.
    pub(crate) layers: &'a [SeeThrough],
    /// Bands for reuse.
    pub(crate) spare: &'a Mutex<Vec<Band>>,
}

/// A relief and its pixels that are drawn.
pub(crate) type ReliefPart<'r> = (&'r mut Relief, Range<usize>);

impl Surfaces<'_> {
    /// Draws the bands of some rows of the picture, or of all.
    /// * `first`: number of the first row, a multiple of [`BAND`]; `buffers`: of these rows.
    pub(crate) fn draw(
        &self,
        first: usize,
        buffers: &mut Buffers,
        (relief, veil): (Option<ReliefPart<'_>>, Option<&mut Veil>),
    ) -> Result<(), RenderError> {
        let Self { job, screen, shader, centers, layers, spare, .. } = *self;
        let chunk = BAND * screen.width as usize;
        let rows = buffers.depth.len() / screen.width.max(1) as usize;
        let bands = rows.div_ceil(BAND);
        let all = (screen.height as usize).div_ceil(BAND);
        let done = AtomicUsize::new(first / BAND);
        let offsets = sample_offsets(job.options.samples);
        let mut worlds: Vec<Option<&mut [[f64; 3]]>> = match &mut buffers.world {
            Some(w) => w.chunks_mut(chunk).map(Some).collect(),
            None => (0..bands).map(|_| None).collect(),
        };
        let mut relief = match relief {
            Some((relief, pixels)) => relief.bands_of(pixels, chunk),
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
                let y0 = (first + i * BAND) as i32;
                let y = [y0, (y0 + BAND as i32).min(screen.height)];
                let (band, exposed) = self.filled(y, &offsets, None);
                if let Some(relief) = relief {
                    resolve_relief(&band, shader, relief);
                }
                resolve(&band, shader, screen, &mut Rows { color, depth, id, world: world.as_deref_mut(), centers });
                if let Some(veil) = veil {
                    let bands = self.see_through(&band, y, (&offsets, exposed));
                    let composer = Composer { layers, behind: &band, bands: &bands, shader, screen };
                    composer.compose(veil);
                    lock(spare).extend(bands);
                }
                lock(spare).push(band);
                let done = done.fetch_add(1, Ordering::Relaxed) + 1;
                Ok(job.progress.tick("draw", done as f64 / all as f64)?)
            })
    }

    fn cleared(&self, [y0, y1]: [i32; 2], offsets: &[[i32; 2]]) -> Band {
        let mut band = lock(self.spare).pop().unwrap_or_default();
        band.clear(y0, y1, self.screen.width, offsets);
        band
    }

    fn exposure(&self, offsets: &[[i32; 2]]) -> Exposure {
        Exposure::new(self.job.options.exposures as usize, offsets.len())
    }

    /// The samples of what hides in some rows, and whether they have several exposures.
    /// * `only`: columns that are wanted, if not all.
    pub(crate) fn filled(&self, y: [i32; 2], offsets: &[[i32; 2]], only: Option<[i32; 2]>) -> (Band, bool) {
        let opaque = DrawnSolids { scene: self.job.scene, solids: Solids::Opaque };
        let mut band = self.cleared(y, offsets);
        band.only = only;
        self.blocks.draw(&mut band, opaque);
        let Some(sections) = self.sections.filter(|_| self.blocks.are_thin_in(&band)) else { return (band, false) };
        let exposure = self.exposure(offsets);
        band.expose(exposure.offsets(offsets));
        self.blocks.draw_thin(&mut band, self.screen.ortho, (sections, &exposure), opaque);
        (band, true)
    }

    /// The samples of the layers that something shines through in the rows of a band.
    pub(crate) fn see_through(&self, behind: &Band, y: [i32; 2], (offsets, exposed): (&[[i32; 2]], bool)) -> Vec<Band> {
        let mut bands: Vec<Band> = self.layers.iter().map(|_| self.cleared(y, offsets)).collect();
        let exposure = self.exposure(offsets);
        let thin = self.sections.filter(|_| exposed).map(|sections| (sections, &exposure, &behind.offsets[..]));
        see_through::draw((self.job.scene, self.layers), self.blocks, &mut bands, (self.screen.ortho, thin));
        bands
    }
}
