//! Checks before a picture is drawn: options, threads, memory.

use crate::raster::band::BAND;
use crate::see_through::SeeThrough;
use crate::shade::ground_bytes;
use belvedere_composite::stylise::{self, Relief};
use belvedere_composite::veil::Veil;
use belvedere_scene::{Frame, LayerKind, RenderError, RenderJob};

/// Checks the options and runs `render` on the given number of threads.
/// * `more_per_pixel`: bytes of a pixel that the renderer takes beside those of [`check_memory`].
pub(crate) fn checked(
    job: &RenderJob<'_>,
    more_per_pixel: u64,
    render: impl Fn(&RenderJob<'_>) -> Result<Frame, RenderError> + Sync,
) -> Result<Frame, RenderError> {
    let options = job.options;
    if ![1, 4, 16].contains(&options.samples) {
        return Err(RenderError::Samples { samples: options.samples });
    }
    check_memory(job, more_per_pixel)?;
    if options.threads == 0 {
        return render(job);
    }
    match rayon::ThreadPoolBuilder::new().num_threads(options.threads).build() {
        Ok(pool) => pool.install(|| render(job)),
        // No thread can be started: the caller's threads are used.
        Err(_) => render(job),
    }
}

/// Bytes of the image of a node of the ground; four times that of a vertex, for subdivided cells.
const NODE_BYTES: u64 = 4 * 12;

/// Bytes that a picture takes: the frame, the bands in work, the projected vertices and the lit ground.
fn check_memory(job: &RenderJob<'_>, more_per_pixel: u64) -> Result<(), RenderError> {
    let [width, height] = job.view.pinhole().image;
    let samples = job.options.samples;
    let pixels = u64::from(width) * u64::from(height);
    let per_pixel = more_per_pixel
        + 3
        + 4
        + 4
        + 6
        + if job.options.aux.world || job.scene.paints_over_ground() { 24 } else { 0 }
        + if job.scene.paints_over_ground() { 5 } else { 0 }
        + if job.scene.has_see_through() { Veil::BYTES } else { 0 }
        + if stylise::is_on(job) { 64 + Relief::bytes(u64::from(samples)) } else { 0 };
    let threads = if job.options.threads == 0 { rayon::current_num_threads() } else { job.options.threads } as u64;
    let layers = 1 + SeeThrough::of(job.scene).len() as u64;
    let bands = layers * threads * (BAND as u64) * u64::from(width) * (u64::from(samples) + 1) * 8;
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
