//! Marks over drawn surfaces, judged by lines of sight through the exact tracer.

use crate::depths::{DepthTiles, Depths};
use crate::drawn::{Drawn, Sight};
use crate::marks::{Marks, NameMemory, Patience, Shapes};
use belvedere_core::DVec2;
use belvedere_scene::{LayerKind, RenderJob};
use belvedere_sight::Solids;
use belvedere_sight::pass::Pass;
use belvedere_sight::screen::{COARSE_PX, Screen};
use belvedere_sight::sections::{Exposure, Sections};
use belvedere_sight::trace::Tracer;
use std::sync::OnceLock;

/// Terrain with more nodes is not prepared for lines of sight in every frame.
const MAX_NODES: usize = 64 << 20;
/// Largest error of bent lines as shapes, pixels.
const SHAPE_TOLERANCE_PX: f64 = 0.05;

/// The marks of a job.
///
/// * `passes`: all of the view; `depth`: surfaces at the pixel centres; `solids`: those that hide lines and points.
pub fn place(
    job: &RenderJob<'_>,
    passes: &[&Pass<'_>],
    screen: &Screen,
    (depth, solids): (Depths<'_>, Solids),
) -> Marks {
    let sight = TracedSight { job, solids, tracer: OnceLock::new() };
    Marks::new(job, &Drawn { passes, screen, tolerance_px: tolerance_px(job), depth, sight: &sight })
}

/// The same as [`place`] for a renderer without passes of its own.
pub fn place_alone(job: &RenderJob<'_>, screen: &Screen, depth: &[f32]) -> Marks {
    let passes = Pass::all(job.view);
    place(job, &passes.iter().collect::<Vec<_>>(), screen, (Depths::Whole(depth), Solids::Opaque))
}

/// Where [`place`] reads depths.
pub fn wanted_depths(job: &RenderJob<'_>, passes: &[&Pass<'_>], screen: &Screen) -> DepthTiles {
    let sight = TracedSight { job, solids: Solids::Opaque, tracer: OnceLock::new() };
    let depth = Depths::Whole(&[]);
    Marks::wanted_depths(job, &Drawn { passes, screen, tolerance_px: tolerance_px(job), depth, sight: &sight })
}

/// The marks of a picture as shapes, for files of vectors: what is drawn over its surfaces, judged by the same lines of sight.
///
/// * `job`: the job by which the surfaces were drawn, with its marks.
/// * `depth`: depths of the surfaces at the pixel centres, row by row, see [`belvedere_scene::Frame::depth`].
pub fn mark_shapes(job: &RenderJob<'_>, depth: &[f32]) -> Shapes {
    let tolerance_px = job.options.tolerance_px.clamp(0.01, SHAPE_TOLERANCE_PX);
    over(job, (depth, tolerance_px), |drawn| Marks::shapes(job, drawn))
}

/// The names of a frame of a film over its drawn surfaces, see [`Marks::next_names`].
///
/// * `job`: as of [`mark_shapes`]; `depth`: depths of the surfaces at the pixel centres, row by row.
pub fn next_names(job: &RenderJob<'_>, depth: &[f32], before: (&NameMemory, Patience)) -> NameMemory {
    over(job, (depth, tolerance_px(job)), |drawn| Marks::next_names(job, drawn, before))
}

fn over<T>(job: &RenderJob<'_>, (depth, tolerance_px): (&[f32], f64), work: impl FnOnce(&Drawn<'_>) -> T) -> T {
    let passes = Pass::all(job.view);
    let passes: Vec<&Pass<'_>> = passes.iter().collect();
    let screen = Screen::new(job.view.pinhole());
    let sight = TracedSight { job, solids: Solids::Opaque, tracer: OnceLock::new() };
    work(&Drawn { passes: &passes, screen: &screen, tolerance_px, depth: Depths::Whole(depth), sight: &sight })
}

fn tolerance_px(job: &RenderJob<'_>) -> f64 {
    job.options.tolerance_px.max(0.01)
}

/// Lines of sight through the exact tracer, which is prepared on first use.
struct TracedSight<'j> {
    job: &'j RenderJob<'j>,
    solids: Solids,
    tracer: OnceLock<Option<Tracer<'j>>>,
}

impl TracedSight<'_> {
    fn tracer(&self) -> Option<&Tracer<'_>> {
        self.tracer.get_or_init(|| prepared(self.job, self.solids)).as_ref()
    }
}

fn prepared<'a>(job: &RenderJob<'a>, solids: Solids) -> Option<Tracer<'a>> {
    let nodes = |kind: &LayerKind| kind.terrain().map_or(0, |t| t.heightfield.cols() * t.heightfield.rows());
    // The lines of a coarse picture are hidden by its depths alone.
    let nodes: usize = job.scene.layers.iter().map(|l| nodes(&l.kind)).sum();
    (nodes <= MAX_NODES && job.options.tolerance_px < COARSE_PX)
        .then(|| Tracer::exposed((job.scene, solids), job.view, Sections::new(job), Exposure::even()))
}

impl Sight for TracedSight<'_> {
    fn first_depth(&self, pixel: DVec2) -> Option<f64> {
        Some(self.tracer()?.first_hit(pixel).map_or(f64::INFINITY, |hit| hit.depth))
    }
}
