//! What renderers have in common: checked options, and what is drawn over the surfaces.

use crate::buffers::Buffers;
use crate::color::{self, Packed};
use crate::marks::Marks;
use crate::raster::band::BAND;
use crate::screen::Screen;
use crate::shade::ground_bytes;
use crate::stylise::{self, Relief};
use belvedere_scene::{Frame, LayerKind, RenderError, RenderJob};
use rayon::prelude::*;

/// Runs `render` with checked options on the threads asked for.
pub(crate) fn checked(
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

/// Buffers of a picture; every pixel is sky.
pub(crate) fn buffers(job: &RenderJob<'_>) -> Buffers {
    let stylised = stylise::is_on(job);
    let buffers = Buffers::reuse(job, true, Vec::new(), Frame::default());
    // Where only centres are known, edges between faces are found by their places.
    let n = buffers.out.len();
    let world = (job.options.aux.world || stylised).then(|| vec![[f64::NAN; 3]; n]);
    Buffers { world, ..buffers }
}

/// Buffers in the memory of older ones; every pixel is yet to be written.
pub(crate) fn buffers_in(job: &RenderJob<'_>, color: Vec<Packed>, old: Frame) -> Buffers {
    Buffers::reuse(job, Marks::are_in(job) || stylise::is_on(job), color, old)
}

/// Stylisation, lines and points over the surfaces, and the stored colours.
/// * `relief`: of the samples, if known.
pub(crate) fn finish(
    job: &RenderJob<'_>,
    marks: &Marks,
    screen: &Screen,
    relief: Option<Relief>,
    buffers: &mut Buffers,
) {
    if stylise::is_on(job) {
        stylise::apply(job, screen.width as usize, relief, buffers);
    }
    draw_marks(marks, screen, buffers);
}

/// Lines and points over the surfaces, and the stored colours.
pub(crate) fn draw_marks(marks: &Marks, screen: &Screen, buffers: &mut Buffers) {
    let chunk = BAND * screen.width as usize;
    let Buffers { depth, color, id, out, .. } = buffers;
    let encoding = color::encoding();
    out.par_chunks_mut(chunk).zip(color.par_chunks_mut(chunk)).zip(id.par_chunks_mut(chunk)).enumerate().for_each(
        |(i, ((out, color), id))| {
            marks.draw((i * BAND) as i32, screen, depth, color, id);
            for (o, c) in out.iter_mut().zip(color.iter()) {
                *o = c.encode(encoding);
            }
        },
    );
    marks.write_names(out, screen.width as usize);
}

/// Image of a node of the ground; four times that where cells are subdivided.
const NODE_BYTES: u64 = 4 * 12;

/// Bytes that a picture takes: the frame, the bands in work, the projected vertices and the lit ground.
fn check_memory(job: &RenderJob<'_>) -> Result<(), RenderError> {
    let [width, height] = job.view.pinhole().image;
    let samples = job.options.samples;
    let pixels = u64::from(width) * u64::from(height);
    let per_pixel = 3
        + 4
        + 4
        + 6
        + if job.options.aux.world { 24 } else { 0 }
        + if stylise::is_on(job) { 64 + Relief::bytes(u64::from(samples)) } else { 0 };
    let threads = if job.options.threads == 0 { rayon::current_num_threads() } else { job.options.threads } as u64;
    let bands = threads * (BAND as u64) * u64::from(width) * (u64::from(samples) + 1) * 8;
    // What lies beside the picture, where planes cross, may be drawn by several records.
    let passes = job.view.records().min(2) as u64;
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
            LayerKind::Terrain(t) => {
                let nodes = (t.heightfield.cols() * t.heightfield.rows()) as u64;
                drawn(nodes) + ground_bytes(job, &t.heightfield)
            }
            LayerKind::Boxes(b) => b.boxes.len() as u64 * 12 * 64,
            // A triangle on the image and, for the tracer, its share of a tree.
            kind => kind.triangles().map_or(0, |m| m.mesh.triangles().len() as u64 * 160),
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
