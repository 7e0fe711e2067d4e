//! The renderer without a GPU: a threaded, deterministic rasteriser for bent views.
//!
//! Every vertex is displaced and projected once per frame; surfaces are cut into blocks that are culled by their
//! displaced bounds; cell edges that the bend would visibly curve are split. Bands of image rows are then drawn and
//! coloured independently, so the picture is the same, byte for byte, for any number of threads.

mod band;
mod blocks;
mod box_blocks;
mod cache;
pub mod canvas;
mod cells;
mod choose;
mod displace;
mod exact;
mod grid;
mod lens;
mod lod;
mod marks;
mod mesh_blocks;
mod pass;
mod polish;
mod project;
mod raster;
mod refine;
mod resolve;
mod shade;
mod spline_table;
mod vector;

pub use exact::{ExactRenderer, Seen, Tracer};
pub use project::GroundImage;

use band::{Band, sample_offsets};
use belvedere_scene::{Frame, FrameStats, RenderError, RenderJob, Renderer};
use blocks::Blocks;
use cache::{GroundCache, lock};
use lens::Lens;
use lod::Tree;
use marks::Marks;
use pass::Pass;
use polish::Polish;
use rayon::prelude::*;
use resolve::{Colors, Rows, resolve};
use shade::color::Packed;
use shade::{LightCache, Shader};
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::{Arc, Mutex};
use std::time::Instant;

/// Rows of a band.
const BAND: usize = 16;

/// Draws scenes on the processor.
///
/// It remembers what it computed for a ground (light, averages, levels of detail) and the memory of its last frames: keep one
/// renderer for all frames of a film. Pictures do not depend on what it drew before.
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
    /// Buffers that no frame uses now; nothing in them but capacity survives.
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
        *frame = prepared(job, |job| self.draw(job, std::mem::take(&mut *lock(&old))))?;
        Ok(())
    }
}

/// Memory of frames, kept for the next one.
#[derive(Debug, Default)]
struct Scratch {
    blocks: Blocks,
    color: Vec<Packed>,
    bands: Mutex<Vec<Band>>,
}

/// Frames drawn at the same time whose memory is kept.
const SPARE_FRAMES: usize = 2;

/// Runs `render` with checked options on the threads asked for.
fn prepared(
    job: &RenderJob<'_>,
    render: impl Fn(&RenderJob<'_>) -> Result<Frame, RenderError> + Sync,
) -> Result<Frame, RenderError> {
    let options = job.options;
    if ![1, 4, 16].contains(&options.samples) {
        return Err(RenderError::Samples { samples: options.samples });
    }
    check_memory(job)?;
    if options.threads == 0 {
        return render(job);
    }
    match rayon::ThreadPoolBuilder::new().num_threads(options.threads).build() {
        Ok(pool) => pool.install(|| render(job)),
        // No threads to be had: the caller's serve as well.
        Err(_) => render(job),
    }
}

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
        let lens = Lens::new(job.view.pinhole());
        let passes = Pass::all(job.view);
        let Scratch { blocks, color, bands } = scratch;
        blocks.build(job.scene, &passes, &lens, job.options, &self.detail);
        job.progress.tick("project", 1.0)?;
        let shader = Shader::new(job, &lens, blocks, &self.light);
        let mut buffers = Buffers::reuse(job, std::mem::take(color), frame);
        let polish = job.options.aux.exact.then(|| Polish::new(job.scene, &passes, &lens));
        draw_surfaces(job, &lens, blocks, (&shader, polish.as_ref()), bands, &mut buffers)?;
        if buffers.open {
            let tolerance_px = if job.options.tolerance_px > 0.01 { job.options.tolerance_px } else { 0.01 };
            let marks = Marks::new(job, &passes, &lens, tolerance_px, &buffers.depth);
            job.progress.tick("lines", 0.0)?;
            finish(&marks, &lens, &mut buffers);
            job.progress.tick("lines", 1.0)?;
        }
        let counts = blocks.counts();
        let stats = FrameStats {
            triangles_in: blocks.triangles_in,
            triangles_drawn: counts.drawn,
            edges_split: counts.split,
            vertices_missed: counts.missed,
            milliseconds: start.elapsed().as_secs_f64() * 1e3,
        };
        *color = buffers.color;
        let (width, height) = (lens.width as usize, lens.height as usize);
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

struct Buffers {
    /// Whether lines or points may be drawn over the surfaces.
    open: bool,
    /// Colours of the surfaces while they are open, else empty.
    color: Vec<Packed>,
    depth: Vec<f32>,
    id: Vec<u32>,
    world: Option<Vec<[f64; 3]>>,
    /// The stored colours.
    out: Vec<[u8; 3]>,
}

impl Buffers {
    fn new(job: &RenderJob<'_>) -> Self {
        let open = Self::reuse(job, Vec::new(), Frame::default());
        let color = vec![Packed::default(); open.out.len()];
        Self { open: true, color, ..open }
    }

    /// Buffers of the size of the picture in the memory of older ones; every pixel is yet to be written.
    fn reuse(job: &RenderJob<'_>, mut color: Vec<Packed>, old: Frame) -> Self {
        let n = job.view.pinhole().image.map(|s| s as usize).iter().product();
        let Frame { color: mut out, mut depth, mut id, .. } = old;
        let open = Marks::are_in(job);
        if open {
            color.resize(n, Packed::default());
        }
        out.resize(n, [0; 3]);
        depth.resize(n, f32::INFINITY);
        id.resize(n, 0);
        let world = job.options.aux.world.then(|| vec![[f64::NAN; 3]; n]);
        Self { open, color, depth, id, world, out }
    }
}

fn draw_surfaces(
    job: &RenderJob<'_>,
    lens: &Lens,
    blocks: &Blocks,
    (shader, polish): (&Shader<'_>, Option<&Polish<'_>>),
    spare: &Mutex<Vec<Band>>,
    buffers: &mut Buffers,
) -> Result<(), RenderError> {
    let chunk = BAND * lens.width as usize;
    let bands = (lens.height as usize).div_ceil(BAND);
    let done = AtomicUsize::new(0);
    let offsets = sample_offsets(job.options.samples);
    let mut worlds: Vec<Option<&mut [[f64; 3]]>> = match &mut buffers.world {
        Some(w) => w.chunks_mut(chunk).map(Some).collect(),
        None => (0..bands).map(|_| None).collect(),
    };
    let mut colors: Vec<Colors<'_>> = if buffers.open {
        buffers.color.chunks_mut(chunk).map(Colors::Open).collect()
    } else {
        buffers.out.chunks_mut(chunk).map(Colors::Stored).collect()
    };
    let depth = buffers.depth.par_chunks_mut(chunk);
    let id = buffers.id.par_chunks_mut(chunk);
    colors.par_iter_mut().zip(depth).zip(id).zip(worlds.par_iter_mut()).enumerate().try_for_each(
        |(i, (((color, depth), id), world))| {
            let y0 = (i * BAND) as i32;
            let mut band = lock(spare).pop().unwrap_or_default();
            band.clear(y0, (y0 + BAND as i32).min(lens.height), lens.width, &offsets);
            blocks.draw(&mut band);
            resolve(&band, shader, lens, &mut Rows { color, depth, id, world: world.as_deref_mut(), polish });
            lock(spare).push(band);
            let done = done.fetch_add(1, Ordering::Relaxed) + 1;
            Ok(job.progress.tick("draw", done as f64 / bands as f64)?)
        },
    )
}

/// Lines and points over the surfaces, and the stored colours.
fn finish(marks: &Marks, lens: &Lens, buffers: &mut Buffers) {
    let chunk = BAND * lens.width as usize;
    let Buffers { depth, color, id, out, .. } = buffers;
    let encoding = shade::color::encoding();
    out.par_chunks_mut(chunk).zip(color.par_chunks_mut(chunk)).zip(id.par_chunks_mut(chunk)).enumerate().for_each(
        |(i, ((out, color), id))| {
            marks.draw((i * BAND) as i32, lens, depth, color, id);
            for (o, c) in out.iter_mut().zip(color.iter()) {
                *o = c.encode(encoding);
            }
        },
    );
    marks.write_names(out, lens.width as usize);
}

/// Image of a node of the ground; four times that where cells are subdivided.
const NODE_BYTES: u64 = 4 * 12;

/// Bytes that a picture takes: the frame, the bands in work, the projected vertices and the lit ground.
fn check_memory(job: &RenderJob<'_>) -> Result<(), RenderError> {
    let [width, height] = job.view.pinhole().image;
    let samples = job.options.samples;
    let pixels = u64::from(width) * u64::from(height);
    let per_pixel = 3 + 4 + 4 + 6 + if job.options.aux.world { 24 } else { 0 };
    let threads = if job.options.threads == 0 { rayon::current_num_threads() } else { job.options.threads } as u64;
    let bands = threads * (BAND as u64) * u64::from(width) * (u64::from(samples) + 1) * 8;
    let passes = job.view.records() as u64;
    let drawn = |nodes: u64| {
        // With less detail far away the picture bounds the nodes: a few per pixel, near the eye more.
        let nodes = if job.options.lod_px > 0.0 { nodes.min(8 * pixels + (1 << 20)) } else { nodes };
        nodes * NODE_BYTES * passes
    };
    let nodes: u64 = job
        .scene
        .layers
        .iter()
        .map(|l| match &l.kind {
            belvedere_scene::LayerKind::Terrain(t) => {
                let nodes = (t.heightfield.cols() * t.heightfield.rows()) as u64;
                drawn(nodes) + shade::ground_bytes(job, &t.heightfield)
            }
            belvedere_scene::LayerKind::Boxes(b) => b.boxes.len() as u64 * 12 * 64,
            // A triangle on the image and, for the tracer, its share of a tree.
            belvedere_scene::LayerKind::Mesh(m) => m.mesh.triangles().len() as u64 * 160,
            _ => 0,
        })
        .sum();
    let needed = pixels * per_pixel + bands + nodes;
    if needed > job.options.max_bytes {
        let mib = |b: u64| b.div_ceil(1 << 20);
        return Err(RenderError::TooLarge {
            width,
            height,
            samples,
            needed_mib: mib(needed),
            limit_mib: job.options.max_bytes >> 20,
        });
    }
    Ok(())
}
