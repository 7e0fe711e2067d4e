//! Steps common to all renderers: checks of the options, and marks over the surfaces.

use crate::buffers::Buffers;
use crate::color::{self, Packed};
use crate::marks::Marks;
use crate::raster::band::BAND;
use crate::screen::Screen;
use crate::shade::ground_bytes;
use crate::stylise::{self, Relief};
use belvedere_scene::{Frame, LayerKind, RenderError, RenderJob};
use rayon::prelude::*;

/// Checks the options and runs `render` on the given number of threads.
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
        // No thread can be started: the caller's threads are used.
        Err(_) => render(job),
    }
}

/// Buffers of a picture; every pixel is sky.
pub(crate) fn buffers(job: &RenderJob<'_>) -> Buffers {
    let stylised = stylise::is_on(job);
    let buffers = Buffers::reuse(job, true, Vec::new(), Frame::default());
    // Where only centres are known, edges between faces are found from world points.
    let n = buffers.out.len();
    let world = (job.options.aux.world || stylised).then(|| vec![[f64::NAN; 3]; n]);
    Buffers { world, ..buffers }
}

/// Buffers in the memory of older ones; all pixels must be written.
pub(crate) fn buffers_in(job: &RenderJob<'_>, color: Vec<Packed>, old: Frame) -> Buffers {
    Buffers::reuse(job, Marks::are_in(job) || stylise::is_on(job), color, old)
}

/// Draws stylisation, lines and points over the surfaces, and encodes the colours.
/// * `relief`: depths and faces of all samples, if they are known.
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

/// Draws lines and points over the surfaces, and encodes the colours.
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

/// Bytes of the image of a node of the ground; four times that of a vertex, for subdivided cells.
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
    // Where planes cross, ground beside the picture may be drawn by several records.
    let passes = job.view.records().min(2) as u64;
    let drawn = |nodes: u64| {
        // With level of detail the picture bounds the number of nodes: a few per pixel, more near the eye.
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
