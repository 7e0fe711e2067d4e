//! Checks before a picture is drawn: options, threads, memory.

use crate::raster::band::BAND;
use crate::see_through::SeeThrough;
use crate::shade::{ground_bytes, key_light};
use belvedere_composite::depths::DepthTiles;
use belvedere_composite::layers::Levels;
use belvedere_composite::marks::Marks;
use belvedere_composite::stylise::{self, Relief};
use belvedere_composite::unsharp::DepthGrid;
use belvedere_composite::veil::Veil;
use belvedere_scene::{Frame, LayerKind, RenderError, RenderJob};
use belvedere_sight::LightBuffer;

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
    check_memory(job, (more_per_pixel, None))?;
    match threads_of(job) {
        Some(pool) => pool.install(|| render(job)),
        None => render(job),
    }
}

/// Threads of the job's own, if it wants a number of them; where none can be started the caller's are used.
pub(crate) fn threads_of(job: &RenderJob<'_>) -> Option<rayon::ThreadPool> {
    let threads = job.options.threads;
    (threads > 0).then(|| rayon::ThreadPoolBuilder::new().num_threads(threads).build().ok()).flatten()
}

/// Bytes of the image of a node of the ground; four times that of a vertex, for subdivided cells.
const NODE_BYTES: u64 = 4 * 12;

/// Fails where a picture takes more memory than it may.
/// * `more_per_pixel`, `rows`: see [`needed`].
pub(crate) fn check_memory(job: &RenderJob<'_>, of: (u64, Option<usize>)) -> Result<(), RenderError> {
    let [width, height] = job.view.pinhole().image;
    let (needed, limit) = (needed(job, of), job.options.max_bytes);
    if needed <= limit {
        return Ok(());
    }
    let needed_mib = needed.div_ceil(1 << 20);
    Err(RenderError::TooLarge { width, height, samples: job.options.samples, needed_mib, limit_mib: limit >> 20 })
}

/// Bytes that a picture takes: the frame, the bands in work, the projected vertices and the lit ground.
/// * `more_per_pixel`: bytes of a pixel beside those; `rows`: rows that are drawn at a time, all if there is no number.
pub(crate) fn needed(job: &RenderJob<'_>, (more_per_pixel, rows): (u64, Option<usize>)) -> u64 {
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
        // For volumes whose edges are smooth: colour and depth of what lies behind, light and share absorbed.
        + if samples > 1 && job.scene.layers.iter().any(|l| l.kind.volume().is_some()) { 14 } else { 0 }
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
    let shadow = if job.light.shadows { LightBuffer::BYTES } else { 0 };
    let key_light = if job.light.shadows { key_light::most_bytes() } else { 0 };
    let nodes: u64 = job
        .scene
        .layers
        .iter()
        .map(|l| match &l.kind {
            LayerKind::Terrain(t) => {
                let nodes = (t.heightfield.cols() * t.heightfield.rows()) as u64;
                drawn(nodes) + ground_bytes(job, &t.heightfield)
            }
            LayerKind::Boxes(b) => b.boxes.len() as u64 * (12 * 64 + shadow),
            LayerKind::Molecule(m) => m.surface.mesh.triangles().len() as u64 * (160 + shadow) + key_light,
            // A triangle on the image and, for the tracer, its share of a tree.
            kind => kind.triangles().map_or(0, |m| m.mesh.triangles().len() as u64 * (160 + shadow)),
        })
        .sum();
    let Some(rows) = rows else { return pixels * per_pixel + bands + nodes };
    let grid = if job.options.stylisation.unsharp > 0.0 { DepthGrid::bytes(pixels) } else { 0 };
    let tiles = if Marks::are_in(job) { pixels / 64 * DepthTiles::BYTES_PER_TILE } else { 0 };
    // Representations that are drawn one by one are prepared together, and their rows are mixed by world points.
    let (levels, mixed) = Levels::of(job).map_or((1, 0), |levels| (levels.count() as u64, 2 * (3 + 4 + 4 + 24)));
    let (row, of_level) = (u64::from(width) * rows as u64, bands + nodes + grid + tiles);
    (row * (per_pixel + mixed) + of_level) * levels
}
