//! The rasteriser: draws a frame from blocks of surfaces to marks.

use crate::cache::{GroundCache, lock};
use crate::frame::{checked, needed};
use crate::geometry::lod::Tree;
use crate::geometry::pass::{BodyPasses, Pass};
use crate::level_rows;
use crate::over_ground;
use crate::raster::band::sample_offsets;
use crate::rows;
use crate::screen::Screen;
use crate::see_through::SeeThrough;
use crate::shade::pixel_center::PixelCenters;
use crate::shade::{LightCache, Shader};
use crate::surfaces::{Scratch, Surfaces, stats};
use crate::volume::{self, Way};
use belvedere_composite::branches;
use belvedere_composite::depths::Depths;
use belvedere_composite::finish::{buffers_in, finish_veiled};
use belvedere_composite::layers;
use belvedere_composite::marks::Marks;
use belvedere_composite::stylise::Relief;
use belvedere_composite::traced_marks;
use belvedere_composite::veil::{Veil, Veiled};
use belvedere_scene::{Frame, FrameStats, Instant, PictureRows, RenderError, RenderJob, Renderer};
use belvedere_sight::sections::Sections;
use belvedere_sight::{Carried, Solids};
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
                layers::draw(job, |job| self.draw(job, std::mem::take(&mut *lock(&old))), traced_marks::place_alone)
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
        self.with_scratch(|scratch| level_rows::draw((&self.detail, &self.light), job, scratch, work))
    }
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
        over_ground::paint(job, (&shader, &screen), (0, [None, None]), &mut buffers);
        let samples = volume::compose(job, Way::Fast, &mut buffers)?;
        let mut of_marks = FrameStats::default();
        if buffers.open {
            let plain = Pass::plain(&passes);
            let marks = traced_marks::place(job, &plain, &screen, (Depths::Whole(&buffers.depth), Solids::Opaque));
            let front = veil.as_ref().filter(|_| Marks::are_in(job)).map(|veil| {
                let nearest = veil.nearest(&buffers.depth);
                traced_marks::place(job, &plain, &screen, (Depths::Whole(&nearest), Solids::Drawn))
            });
            let front = front.unwrap_or_default();
            job.progress.tick("lines", 0.0)?;
            let veiled = veil.as_ref().map(|veil| Veiled { veil, first: 0, front: &front });
            finish_veiled(job, (&marks, veiled), &screen, relief, &mut buffers);
            job.progress.tick("lines", 1.0)?;
            of_marks = marks.counted(of_marks);
        }
        let stats = stats(blocks, samples, start).and(&of_marks);
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
