//! Passes over a view with the projection in single precision and bounds on the image of heights.

use crate::geometry::lod::DecimatedHeights;
use crate::geometry::project::{Batch, Projector};
use crate::raster::cells::NODES;
use crate::screen::{Row, Screen, ScreenVertex, Snap};
use belvedere_core::{Aabb, DMat3, DVec2, DVec3, View};
use belvedere_scene::Heightfield;
use belvedere_sight::Carried;
use belvedere_sight::pass::{self, Extent, Points, Way, displaced};

/// A pass prepared for a frame.
#[derive(Debug)]
pub(crate) struct Pass<'a> {
    pub(crate) plain: pass::Pass<'a>,
    projector: Option<Projector<'a>>,
    height: HeightPx,
}

/// The passes that draw rigid bodies, where the stages up to the spline bend have carried them.
pub(crate) struct BodyPasses<'a> {
    pub(crate) carried: &'a Carried,
    pub(crate) passes: Vec<Pass<'a>>,
}

impl<'a> BodyPasses<'a> {
    pub(crate) fn new(carried: &'a Carried) -> Self {
        Self { carried, passes: Pass::all(carried.after()) }
    }
}

/// Columns of the ground: `count` of them from `first` on, `step` apart.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Columns {
    first: usize,
    step: usize,
    count: usize,
    /// Coordinate relative to the eye, in single precision.
    x: [f32; NODES],
}

impl Columns {
    /// Heights of the columns in a row of the ground.
    #[inline(always)]
    pub(crate) fn heights(&self, hf: &Heightfield, sparse: &DecimatedHeights, row: usize, out: &mut [f32; NODES]) {
        let (from, step) = sparse.row(hf, [self.first, row], self.step);
        match (step, from.first_chunk::<NODES>()) {
            (1, Some(whole)) if self.count == NODES => *out = *whole,
            _ => out.iter_mut().zip(from.iter().step_by(step)).take(self.count).for_each(|(o, h)| *o = *h),
        }
    }
}

impl<'a> Pass<'a> {
    /// The passes of a view, see [`pass::Pass::all`].
    pub(crate) fn all(view: &'a View) -> Vec<Self> {
        pass::Pass::all(view).into_iter().map(Self::new).collect()
    }

    /// The pass for several records, see [`pass::Pass::between`].
    pub(crate) fn between(view: &'a View, records: [usize; 2]) -> Self {
        Self::new(pass::Pass::between(view, records))
    }

    fn new(plain: pass::Pass<'a>) -> Self {
        let (view, way) = (plain.view(), plain.way());
        Self { plain, projector: Projector::new(view, way), height: HeightPx::new(view, way) }
    }

    /// The passes without what this renderer adds.
    pub(crate) fn plain<'p>(passes: &'p [Self]) -> Vec<&'p pass::Pass<'a>> {
        passes.iter().map(|pass| &pass.plain).collect()
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
        screen: &Screen,
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
        self.plain.displace_row(&mut points) && screen.snap_row(&points, out)
    }

    /// Images of positions in single precision; `false` if the pass has none.
    pub(crate) fn batch(&self, places: impl ExactSizeIterator<Item = DVec3>, batch: &mut Batch) -> bool {
        self.projector.as_ref().is_some_and(|projector| projector.batch(places, batch))
    }

    /// Image of one node, the same as in any row; `None` if it has none, or must be clipped.
    pub(crate) fn ground_node(
        &self,
        screen: &Screen,
        hf: &Heightfield,
        [col, row]: [usize; 2],
    ) -> Option<ScreenVertex> {
        let ([mut x], [mut y], [mut q]) = ([0], [0], [0.0]);
        let mut out =
            Row { x: std::slice::from_mut(&mut x), y: std::slice::from_mut(&mut y), q: std::slice::from_mut(&mut q) };
        let height = [hf.heights()[row * hf.cols() + col]];
        let whole = self.ground_row(screen, hf, &self.columns(hf, col, 1, 1), row, &height, &mut out);
        whole.then_some(ScreenVertex { x, y, q })
    }

    /// Extent of the part of a box that the image shows, for a view without curved rays: no point of it is nearer to the eye than the
    /// displaced box, nor farther from the axis than the corners of the image. The box itself may reach behind the eye.
    ///
    /// * `extent`: of the whole box, see [`pass::InView::Maybe`].
    pub(crate) fn shown_extent(&self, screen: &Screen, bounds: &Aabb, extent: Option<Extent>) -> Option<Extent> {
        let view = self.plain.view();
        if screen.ortho || view.curved_rays().is_some() {
            return extent;
        }
        let Some(displaced) = displaced(view.stages(), bounds) else { return extent };
        let eye = view.pinhole().eye;
        let distance = eye.clamp(displaced.min, displaced.max).distance(eye);
        let depth = distance * screen.scale / screen.scale.hypot(screen.center.length());
        match extent {
            Some(extent) => Some(Extent { depth: extent.depth.max(depth), ..extent }),
            None => (depth > 0.0).then_some(Extent { depth, image: [-screen.center, screen.center] }),
        }
    }

    /// Bound on the pixels that a unit of height inside the box spans on the image; infinite where unknown.
    /// * `extent`: of the box, see [`pass::InView::Maybe`].
    pub(crate) fn px_per_height(&self, screen: &Screen, bounds: &Aabb, extent: Option<Extent>) -> f64 {
        let Some(Extent { depth, image }) = extent else { return f64::INFINITY };
        let turning = self.plain.view().stages().iter().filter(|s| s.turns_heights());
        let stretch = turning.enumerate().map(|(i, stage)| {
            // The first stage that turns heights stretches the upright direction by the length of its image; later stages stretch by at most
            // the norm of their Jacobian.
            let upright = i == 0;
            let length = |j: DMat3| {
                if upright {
                    j.z_axis.length()
                } else {
                    [j.x_axis, j.y_axis, j.z_axis].map(DVec3::length_squared).iter().sum::<f64>().sqrt()
                }
            };
            let points = bounds.corners().into_iter().chain([bounds.center()]);
            points.map(|p| stage.jacobian(p).map_or(f64::INFINITY, length)).fold(0.0, f64::max)
        });
        // Parts beyond the image are not drawn.
        let image = image.map(|at| at.clamp(-screen.center.abs(), screen.center.abs()));
        let height_px = self.height.most(screen, image) * stretch.product::<f64>();
        if screen.ortho { height_px } else { height_px / depth }
    }
}

/// Pixels that a unit of height moves an image at depth 1.
///
/// Earth and terrain move points straight up or down. A turn shears a height by `before Z + (phi_a a_z + phi_b b_z) shift` with
/// phi_a in 0..=1 and phi_b in -1..=0; the image of that is convex in the sum and in the pixel, so ends and corners decide. After
/// a spline a height points anywhere.
#[derive(Debug)]
enum HeightPx {
    /// Extreme images of a unit height: its part across the axis in pixels, and its part along the axis.
    Ways(Vec<(DVec2, f64)>),
    /// Any direction, with this length.
    Any(f64),
}

impl HeightPx {
    fn new(view: &View, way: Way) -> Self {
        let ph = view.pinhole();
        let project = |d: DVec3| {
            let depth = if ph.is_orthographic() { 0.0 } else { d.dot(ph.forward) };
            (DVec2::new(d.dot(ph.right), d.dot(ph.down)) * ph.scale_px(), depth)
        };
        let norm = |m: &DMat3| m.to_cols_array().iter().map(|v| v * v).sum::<f64>().sqrt();
        let splined = view.stages().iter().any(|s| s.turns_heights());
        let rays = view.curved_rays();
        let (record, map) = match way {
            Way::Records([first, _]) => (first, None),
            Way::Segment(number) => (number as usize / 2, rays.and_then(|rays| rays.straight_map(number))),
        };
        let turn = rays.and_then(|rays| rays.turns().get(record)).filter(|_| map.is_none());
        match (turn, map, splined) {
            (None, None, false) => Self::Ways(vec![project(DVec3::Z)]),
            (None, None, true) => Self::Any(1.0),
            (None, Some(map), false) => Self::Ways(vec![project(map.linear * DVec3::Z)]),
            (None, Some(map), true) => Self::Any(norm(&map.linear)),
            (Some(turn), _, false) => {
                let (a, b) = (turn.a.gradient.z, -turn.b.gradient.z);
                let sums = [a.min(0.0) + b.min(0.0), a.max(0.0) + b.max(0.0)];
                Self::Ways(sums.map(|t| project(turn.before * DVec3::Z + t * turn.shift)).to_vec())
            }
            (Some(turn), _, true) => {
                let slopes = turn.a.gradient.length() + turn.b.gradient.length();
                Self::Any(norm(&turn.before) + turn.shift.length() * slopes)
            }
        }
    }

    /// Largest number of pixels per unit of height in a part of the image, given by its least and largest position from the centre, pixels.
    fn most(&self, screen: &Screen, [min, max]: [DVec2; 2]) -> f64 {
        let corners = [min, max, DVec2::new(min.x, max.y), DVec2::new(max.x, min.y)];
        match self {
            Self::Ways(ways) => {
                let off = |c: DVec2| ways.iter().map(move |(across, depth)| (*across - c * *depth).length());
                corners.into_iter().flat_map(off).fold(0.0, f64::max)
            }
            Self::Any(length) if screen.ortho => length * screen.scale,
            Self::Any(length) => {
                let off = |c: DVec2| (screen.scale * screen.scale + c.length_squared()).sqrt();
                length * corners.into_iter().map(off).fold(0.0, f64::max)
            }
        }
    }
}

#[cfg(test)]
mod tests;
