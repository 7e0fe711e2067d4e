//! One drawing of the scene: a record of a curved-ray chain, or the only one there is.

use crate::displace::{Displacer, Points};
use crate::grid::NODES;
use crate::lens::{Lens, ScreenVertex};
use crate::project::{Projector, Row};
use belvedere_core::{Aabb, DVec2, DVec3, SpaceMap, Stage, View};
use belvedere_scene::Heightfield;

/// A view prepared for a frame.
#[derive(Debug)]
pub(crate) struct Pass<'a> {
    view: &'a View,
    record: usize,
    displacer: Displacer<'a>,
    projector: Option<Projector<'a>>,
    height_px: f64,
}

/// What the image shows of a box.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum Look {
    /// Nothing, or nothing of this pass.
    Out,
    /// Perhaps some of it, at least this deep; `None` where part of it may be beside the eye.
    Seen(Option<f64>),
}

/// Columns of the ground: `count` of them from `first` on, `step` apart.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Columns {
    first: usize,
    step: usize,
    count: usize,
    /// Relative to the eye, where single precision does.
    x: [f32; NODES],
}

impl Columns {
    /// Their heights in a row of the ground.
    #[inline(always)]
    pub(crate) fn heights(&self, hf: &Heightfield, row: usize, out: &mut [f32; NODES]) {
        let from = &hf.heights()[row * hf.cols() + self.first..];
        match (self.step, from.first_chunk::<NODES>()) {
            (1, Some(whole)) if self.count == NODES => *out = *whole,
            _ => out.iter_mut().zip(from.iter().step_by(self.step)).take(self.count).for_each(|(o, h)| *o = *h),
        }
    }
}

impl<'a> Pass<'a> {
    /// The passes that together draw every image of every point once.
    pub(crate) fn all(view: &'a View) -> Vec<Self> {
        let pass = |record| Self {
            view,
            record,
            displacer: Displacer::new(view, record),
            projector: Projector::new(view, record),
            height_px: height_px(view, record),
        };
        (0..view.records()).map(pass).collect()
    }

    /// Displaced position; `None` where the point has no image.
    pub(crate) fn displace(&self, p: DVec3) -> Option<DVec3> {
        if self.is_straight() { Some(p) } else { self.displacer.point(p) }
    }

    /// Columns for [`Pass::ground_row`].
    pub(crate) fn columns(&self, hf: &Heightfield, first: usize, step: usize, count: usize) -> Columns {
        let mut out = Columns { first, step, count: count.min(NODES), x: [0.0; NODES] };
        if let Some(projector) = &self.projector {
            for (i, x) in out.x[..out.count].iter_mut().enumerate() {
                *x = projector.relative(hf.node_xy(first + i * step, 0))[0];
            }
        }
        out
    }

    /// Images of a row of nodes without holes; `false` if one of them has none, or must be clipped.
    /// * `heights`: see [`Columns::heights`].
    pub(crate) fn ground_row(
        &self,
        lens: &Lens,
        hf: &Heightfield,
        columns: &Columns,
        row: usize,
        heights: &[f32],
        out: &mut Row<'_>,
    ) -> bool {
        let Columns { first, step, count: n, .. } = *columns;
        if let Some(projector) = &self.projector {
            let y = projector.relative(hf.node_xy(first, row))[1];
            return projector.row(&columns.x[..n], y, heights, out);
        }
        let [mut x, mut y, mut z] = [[0.0f64; NODES]; 3];
        for i in 0..n {
            let xy = hf.node_xy(first + i * step, row);
            (x[i], y[i], z[i]) = (xy.x, xy.y, f64::from(heights[i]));
        }
        let mut points = Points { x: &mut x[..n], y: &mut y[..n], z: &mut z[..n] };
        self.displacer.row(&mut points) && lens.snap_row(&points, out)
    }

    /// Image of one node, the same as in any row; `None` if it has none, or must be clipped.
    pub(crate) fn ground_node(&self, lens: &Lens, hf: &Heightfield, [col, row]: [usize; 2]) -> Option<ScreenVertex> {
        let ([mut x], [mut y], [mut q]) = ([0], [0], [0.0]);
        let mut out =
            Row { x: std::slice::from_mut(&mut x), y: std::slice::from_mut(&mut y), q: std::slice::from_mut(&mut q) };
        let height = [hf.heights()[row * hf.cols() + col]];
        let whole = self.ground_row(lens, hf, &self.columns(hf, col, 1, 1), row, &height, &mut out);
        whole.then_some(ScreenVertex { x, y, q })
    }

    /// Signed distances that must be positive for the point to belong to this pass.
    pub(crate) fn margins(&self, p: DVec3) -> [f64; 2] {
        if self.is_only() { [f64::INFINITY; 2] } else { self.view.record_margins(self.record, p) }
    }

    /// Whether every point of the box belongs to this pass.
    pub(crate) fn holds(&self, bounds: &Aabb) -> bool {
        self.is_only() || self.record_margins(bounds).is_some_and(|m| m.iter().flatten().all(|m| *m > 0.0))
    }

    /// Margins at the corners of the box before the curved rays; they are affine there.
    fn record_margins(&self, bounds: &Aabb) -> Option<[[f64; 2]; 8]> {
        let (Stage::CurvedRays(rays), earlier) = self.view.stages().split_last()? else { return None };
        let before = displaced(earlier, bounds)?;
        Some(before.corners().map(|c| rays.record_margins(self.record, c)))
    }

    /// See [`View::edge_error_px`].
    pub(crate) fn edge_error_px(&self, a: DVec3, b: DVec3) -> f64 {
        self.view.edge_error_px_in(self.record, a, b)
    }

    /// Where the box lies, judged by its displaced bounds.
    pub(crate) fn look(&self, lens: &Lens, bounds: &Aabb) -> Look {
        if self.is_only() {
            let Some(b) = displaced(self.view.stages(), bounds) else { return Look::Seen(None) };
            let (mut code, mut depth) = (u8::MAX, f64::INFINITY);
            for corner in b.corners() {
                let v = lens.view_from(corner);
                code &= lens.outcode(v, 2.0);
                depth = depth.min(v.z);
            }
            return if code != 0 { Look::Out } else { Look::Seen((depth > 0.0).then_some(depth)) };
        }
        if self.record_margins(bounds).is_some_and(|all| (0..2).any(|side| all.iter().all(|m| m[side] <= 0.0))) {
            return Look::Out;
        }
        let Some(b) = self.view.image_box(bounds) else { return Look::Seen(None) };
        let size = 2.0 * lens.center;
        let out = b.max.x < -2.0 || b.max.y < -2.0 || b.min.x > size.x + 2.0 || b.min.y > size.y + 2.0;
        if out { Look::Out } else { Look::Seen(Some(b.depth_min)) }
    }

    /// Bound in pixels on what a unit of height inside the box can change on the image; infinite where unknown.
    /// * `depth_min`: of the box, see [`Look::Seen`].
    pub(crate) fn px_per_height(&self, lens: &Lens, bounds: &Aabb, depth_min: Option<f64>) -> f64 {
        let Some(depth) = depth_min.filter(|d| *d > 0.0) else { return f64::INFINITY };
        let stretch = |bend: &belvedere_core::map::spline::SplineBend| {
            let places = bounds.corners().into_iter().chain([bounds.center()]);
            places.map(|p| bend.jacobian(p).map_or(f64::INFINITY, |j| j.z_axis.length())).fold(0.0, f64::max)
        };
        let spline = self.view.stages().iter().find_map(|s| if let Stage::SplineBend(b) = s { Some(b) } else { None });
        let height_px = self.height_px * spline.map_or(1.0, stretch);
        if lens.ortho { height_px } else { height_px / depth }
    }

    pub(crate) fn is_only(&self) -> bool {
        self.view.records() == 1
    }

    pub(crate) fn is_straight(&self) -> bool {
        self.displacer.is_straight()
    }
}

fn displaced(stages: &[Stage], bounds: &Aabb) -> Option<Aabb> {
    stages.iter().try_fold(*bounds, |b, stage| stage.displaced_bounds(&b))
}

/// Pixels that a unit of height moves an image at depth 1 at most, anywhere on the image.
///
/// Earth and terrain move points straight up or down. A turn shears a height by `before Z + (phi_a a_z + phi_b b_z) shift` with
/// phi_a in 0..=1 and phi_b in -1..=0; the image of that is convex in the sum and in the pixel, so ends and corners decide. After
/// a spline a height points anywhere.
fn height_px(view: &View, record: usize) -> f64 {
    let ph = view.pinhole();
    let (scale, half) = (ph.scale_px(), ph.center_px().abs());
    let corners = [DVec2::new(-half.x, -half.y), DVec2::new(half.x, -half.y), DVec2::new(-half.x, half.y), half];
    let ball = if ph.is_orthographic() { scale } else { (scale * scale + half.length_squared()).sqrt() };
    let across = |d: DVec3| {
        let lateral = DVec2::new(d.dot(ph.right), d.dot(ph.down)) * scale;
        let depth = if ph.is_orthographic() { 0.0 } else { d.dot(ph.forward) };
        corners.iter().map(|c| (lateral - *c * depth).length()).fold(0.0, f64::max)
    };
    let splined = view.stages().iter().any(|s| matches!(s, Stage::SplineBend(_)));
    let turn = view.curved_rays().and_then(|rays| rays.turns().get(record));
    match (turn, splined) {
        (None, false) => across(DVec3::Z),
        (None, true) => ball,
        (Some(turn), false) => {
            let (a, b) = (turn.a.gradient.z, -turn.b.gradient.z);
            let sums = [a.min(0.0) + b.min(0.0), a.max(0.0) + b.max(0.0)];
            sums.map(|t| across(turn.before * DVec3::Z + t * turn.shift)).into_iter().fold(0.0, f64::max)
        }
        (Some(turn), true) => {
            let before = turn.before.to_cols_array().iter().map(|v| v * v).sum::<f64>().sqrt();
            let slopes = turn.a.gradient.length() + turn.b.gradient.length();
            ball * (before + turn.shift.length() * slopes)
        }
    }
}
