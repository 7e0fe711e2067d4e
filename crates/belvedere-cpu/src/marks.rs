//! Marks over surfaces that were drawn by passes: lines of sight go through the exact tracer.

use crate::geometry::pass::{InView, Pass};
use belvedere_composite::depths::{DepthTiles, Depths};
use belvedere_composite::drawn::{self, Drawn, Sight};
use belvedere_composite::marks::{Marks, NameMemory, Patience, Shapes};
use belvedere_core::{Aabb, DVec2, DVec3, EdgeError};
use belvedere_scene::{LayerKind, RenderJob};
use belvedere_sight::Solids;
use belvedere_sight::screen::{COARSE_PX, Screen};
use belvedere_sight::sections::{Exposure, Sections};
use belvedere_sight::trace::Tracer;
use std::sync::OnceLock;

/// Terrain with more nodes is not prepared for lines of sight in every frame.
const MAX_NODES: usize = 64 << 20;

/// The marks of a job.
/// * `depth`: surfaces at the pixel centres; `solids`: those that hide lines and points.
pub(crate) fn place(
    job: &RenderJob<'_>,
    passes: &[Pass<'_>],
    screen: &Screen,
    (depth, solids): (Depths<'_>, Solids),
) -> Marks {
    let passes: Vec<&dyn drawn::Pass> = passes.iter().map(|pass| pass as &dyn drawn::Pass).collect();
    let sight = TracedSight { job, solids, tracer: OnceLock::new() };
    let tolerance_px = job.options.tolerance_px.max(0.01);
    Marks::new(job, &Drawn { passes: &passes, screen, tolerance_px, depth, sight: &sight })
}

/// Where [`place`] reads depths.
pub(crate) fn wanted_depths(job: &RenderJob<'_>, passes: &[Pass<'_>], screen: &Screen) -> DepthTiles {
    let passes: Vec<&dyn drawn::Pass> = passes.iter().map(|pass| pass as &dyn drawn::Pass).collect();
    let sight = TracedSight { job, solids: Solids::Opaque, tracer: OnceLock::new() };
    let tolerance_px = job.options.tolerance_px.max(0.01);
    let drawn = Drawn { passes: &passes, screen, tolerance_px, depth: Depths::Whole(&[]), sight: &sight };
    Marks::wanted_depths(job, &drawn)
}

/// Largest error of bent lines as shapes, pixels.
const SHAPE_TOLERANCE_PX: f64 = 0.05;

/// The marks of a picture as shapes, for files of vectors: what the renderers draw over its surfaces, judged by the same lines of sight.
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
    over(job, (depth, job.options.tolerance_px.max(0.01)), |drawn| Marks::next_names(job, drawn, before))
}

fn over<T>(job: &RenderJob<'_>, (depth, tolerance_px): (&[f32], f64), work: impl FnOnce(&Drawn<'_>) -> T) -> T {
    let passes = Pass::all(job.view);
    let passes: Vec<&dyn drawn::Pass> = passes.iter().map(|pass| pass as &dyn drawn::Pass).collect();
    let screen = Screen::new(job.view.pinhole());
    let sight = TracedSight { job, solids: Solids::Opaque, tracer: OnceLock::new() };
    work(&Drawn { passes: &passes, screen: &screen, tolerance_px, depth: Depths::Whole(depth), sight: &sight })
}

/// The same as [`place`] for surfaces that were not drawn by passes.
pub(crate) fn place_alone(job: &RenderJob<'_>, screen: &Screen, depth: &[f32]) -> Marks {
    place(job, &Pass::all(job.view), screen, (Depths::Whole(depth), Solids::Opaque))
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
    let nodes = |kind: &LayerKind| match kind {
        LayerKind::Terrain(t) => t.heightfield.cols() * t.heightfield.rows(),
        _ => 0,
    };
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

impl drawn::Pass for Pass<'_> {
    fn displace(&self, p: DVec3) -> Option<DVec3> {
        Pass::displace(self, p)
    }

    fn margins(&self, p: DVec3) -> [f64; 2] {
        Pass::margins(self, p)
    }

    fn edge_error(&self, a: DVec3, b: DVec3) -> EdgeError {
        Pass::edge_error(self, a, b)
    }

    fn is_straight(&self) -> bool {
        Pass::is_straight(self)
    }

    fn fills_in(&self, screen: &Screen, bounds: &Aabb) -> bool {
        self.is_left_out(bounds) && self.in_view(screen, bounds) != InView::No
    }
}
