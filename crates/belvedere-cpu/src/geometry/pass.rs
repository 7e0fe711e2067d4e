//! One drawing of the scene, or of part of it: a record of a curved-ray chain, several records that displace as one map, or a segment
//! of the rays where records leave something out.

use crate::geometry::displace::Displacer;
use crate::geometry::lod::DecimatedHeights;
use crate::geometry::project::{Batch, Projector};
use crate::geometry::way::Way;
use crate::points::Points;
use crate::raster::cells::NODES;
use crate::screen::{Row, Screen, ScreenVertex, Snap};
use belvedere_core::{Aabb, CurvedRays, DMat3, DVec2, DVec3, EdgeError, EdgePoint, Edges, Stage, View};
use belvedere_scene::Heightfield;
use belvedere_sight::Carried;

/// A view prepared for a frame.
#[derive(Debug)]
pub(crate) struct Pass<'a> {
    view: &'a View,
    way: Way,
    /// Numbers of the first and the last record or segment, among all passes of the view.
    pub(crate) numbers: [usize; 2],
    /// Whether geometry that does not belong to the record or segment is clipped.
    cut: bool,
    displacer: Displacer<'a>,
    /// `None` unless edges are bent by a single turn alone.
    edges: Option<Edges<'a>>,
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

/// Whether the image shows a box.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum InView {
    /// The box is not visible in this pass.
    No,
    /// The box may be visible, with its extent; `None` where part of it may be beside or behind the eye.
    Maybe(Option<Extent>),
}

/// Extent of a box on the image and in depth.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Extent {
    /// Least depth, positive.
    depth: f64,
    /// Least and largest position on the image, pixels from its centre.
    image: [DVec2; 2],
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
    /// The passes of a view: one for each record, then one for each segment of curved rays. The records draw every image of every point
    /// once, except what they leave out ([`CurvedRays::leaves_out`]), which the segments draw.
    pub(crate) fn all(view: &'a View) -> Vec<Self> {
        let records = view.records();
        let segments = view.curved_rays().filter(|rays| rays.turn_count() > 0).map_or(0, CurvedRays::segments);
        let of_records =
            (0..records).map(|record| Self::new(view, Way::Records([record; 2]), [record; 2], records > 1));
        let of_segments = (0..segments).map(|k| Self::new(view, Way::Segment(k), [records + k as usize; 2], true));
        of_records.chain(of_segments).collect()
    }

    /// The pass for records from the first to the last that displace as one map, see [`CurvedRays::is_continuous`].
    pub(crate) fn between(view: &'a View, records: [usize; 2]) -> Self {
        Self::new(view, Way::Records(records), records, false)
    }

    fn new(view: &'a View, way: Way, numbers: [usize; 2], cut: bool) -> Self {
        let edges = match way {
            Way::Records([first, last]) if first == last => view.edges(first),
            Way::Segment(number) if number % 2 == 1 => view.edges(number as usize / 2),
            _ => None,
        };
        Self {
            view,
            way,
            numbers,
            cut,
            displacer: Displacer::new(view, way),
            edges,
            projector: Projector::new(view, way),
            height: HeightPx::new(view, way),
        }
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
        self.displacer.row(&mut points) && screen.snap_row(&points, out)
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

    /// Signed distances that must be positive for the point to belong to this pass.
    pub(crate) fn margins(&self, p: DVec3) -> [f64; 2] {
        match self.way {
            _ if !self.cut => [f64::INFINITY; 2],
            Way::Records([record, _]) => self.view.record_margins(record, p),
            Way::Segment(number) => self.view.segment_margins(number, p),
        }
    }

    /// Whether the records may leave out part of a box that this segment then has to draw.
    pub(crate) fn is_left_out(&self, bounds: &Aabb) -> bool {
        let (Way::Segment(number), Some(rays)) = (self.way, self.view.curved_rays()) else { return false };
        displaced(self.view.earlier_stages(), bounds).is_none_or(|b| rays.leaves_out(number, &b))
    }

    /// Whether part of a box may be clipped from a segment.
    pub(crate) fn cuts(&self, bounds: &Aabb) -> bool {
        let (Way::Segment(number), Some(rays)) = (self.way, self.view.curved_rays()) else { return false };
        let planes = rays.segment_planes(number);
        displaced(self.view.earlier_stages(), bounds)
            .is_none_or(|b| b.corners().iter().any(|&p| planes.iter().flatten().any(|plane| !(plane.at(p) > 0.0))))
    }

    /// Whether edges stay straight wherever they are.
    pub(crate) fn keeps_edges(&self) -> bool {
        let straight_part = matches!(self.way, Way::Segment(number) if number % 2 == 0);
        self.is_straight() || (straight_part && self.view.stages().len() == 1)
    }

    /// Whether all edges inside a box may be drawn straight within the tolerance; `false` also where the error is unknown.
    pub(crate) fn is_straight_in(&self, bounds: &Aabb, tolerance_px: f64) -> bool {
        self.keeps_edges() || self.edges.as_ref().is_some_and(|edges| edges.box_error_px(bounds) <= tolerance_px)
    }

    /// Input of [`Pass::edge_error_between`]; `None` where it cannot be precomputed.
    pub(crate) fn edge_point(&self, p: DVec3) -> Option<EdgePoint> {
        self.edges.as_ref()?.point(p)
    }

    /// [`EdgeError::px`] of [`Pass::edge_error`] from precomputed ends; `None` where it must be computed from their positions.
    pub(crate) fn edge_error_between(&self, a: Option<&EdgePoint>, b: Option<&EdgePoint>) -> Option<f64> {
        Some(self.edges.as_ref()?.error_px(a?, b?))
    }

    /// See [`View::edge_error`].
    pub(crate) fn edge_error(&self, a: DVec3, b: DVec3) -> EdgeError {
        edge_error(self.view, self.way, a, b)
    }

    /// Whether an edge may have an image between its ends where neither end has one.
    pub(crate) fn crosses(&self, a: DVec3, b: DVec3) -> bool {
        self.has_border() && !is_missed(self.view.stages(), &Aabb::of([a, b]))
    }

    /// See [`belvedere_core::map::StageMap::has_border`].
    pub(crate) fn has_border(&self) -> bool {
        self.view.stages().iter().any(|s| s.has_border())
    }

    /// Whether the pass may show the box, judged by its displaced bounds.
    pub(crate) fn in_view(&self, screen: &Screen, bounds: &Aabb) -> InView {
        if is_missed(self.view.stages(), bounds) {
            return InView::No;
        }
        let Some(rays) = self.view.curved_rays() else {
            return displaced(self.view.stages(), bounds)
                .map_or(InView::Maybe(None), |b| image_of(screen, &b.corners()));
        };
        let Some(before) = displaced(self.view.earlier_stages(), bounds) else { return InView::Maybe(None) };
        let eye = self.view.pinhole().eye;
        let record = match self.way {
            _ if rays.turn_count() == 0 => return image_of(screen, &before.corners()),
            Way::Records([record, _]) => record,
            Way::Segment(number) => match rays.straight_map(number) {
                Some(map) => {
                    let image = before.corners().map(|p| eye + map.linear * (p - map.viewpoint));
                    return image_of(screen, &image);
                }
                None => number as usize / 2,
            },
        };
        let Some(hull) = rays.displaced_hull_in(record, &before) else { return InView::Maybe(None) };
        let hull = hull.map(|v| eye + v);
        if self.view.records() == 1 { image_of(screen, &Aabb::of(hull).corners()) } else { image_of(screen, &hull) }
    }

    /// Extent of the part of a box that the image shows, for a view without curved rays: no point of it is nearer to the eye than the
    /// displaced box, nor farther from the axis than the corners of the image. The box itself may reach behind the eye.
    ///
    /// * `extent`: of the whole box, see [`InView::Maybe`].
    pub(crate) fn shown_extent(&self, screen: &Screen, bounds: &Aabb, extent: Option<Extent>) -> Option<Extent> {
        if screen.ortho || self.view.curved_rays().is_some() {
            return extent;
        }
        let Some(displaced) = displaced(self.view.stages(), bounds) else { return extent };
        let eye = self.view.pinhole().eye;
        let distance = eye.clamp(displaced.min, displaced.max).distance(eye);
        let depth = distance * screen.scale / screen.scale.hypot(screen.center.length());
        match extent {
            Some(extent) => Some(Extent { depth: extent.depth.max(depth), ..extent }),
            None => (depth > 0.0).then_some(Extent { depth, image: [-screen.center, screen.center] }),
        }
    }

    /// Bound on the pixels that a unit of height inside the box spans on the image; infinite where unknown.
    /// * `extent`: of the box, see [`InView::Maybe`].
    pub(crate) fn px_per_height(&self, screen: &Screen, bounds: &Aabb, extent: Option<Extent>) -> f64 {
        let Some(Extent { depth, image }) = extent else { return f64::INFINITY };
        let turning = self.view.stages().iter().filter(|s| s.turns_heights());
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

    pub(crate) fn is_straight(&self) -> bool {
        self.displacer.is_straight()
    }
}

/// See [`View::edge_error`].
pub(crate) fn edge_error(view: &View, way: Way, a: DVec3, b: DVec3) -> EdgeError {
    match way {
        Way::Records([first, last]) if first == last => view.edge_error_in(first, a, b),
        Way::Records([first, last]) => view.edge_error_between(first..=last, a, b),
        Way::Segment(number) => view.edge_error_along(number, a, b),
    }
}

/// Whether the image may show the hull of displaced points.
fn image_of(screen: &Screen, hull: &[DVec3]) -> InView {
    let (mut code, mut depth) = (u8::MAX, f64::INFINITY);
    let mut image = [DVec2::INFINITY, DVec2::NEG_INFINITY];
    for &p in hull {
        let v = screen.view_from(p);
        code &= screen.outcode(v, 2.0);
        depth = depth.min(v.z);
        let at = screen.pixel(v) - screen.center;
        image = [image[0].min(at), image[1].max(at)];
    }
    if code != 0 { InView::No } else { InView::Maybe((depth > 0.0).then_some(Extent { depth, image })) }
}

/// Whether the stages give no point of a box an image.
fn is_missed(stages: &[Stage], bounds: &Aabb) -> bool {
    let mut with_border = stages.iter().enumerate().filter(|(_, stage)| stage.has_border());
    with_border.any(|(at, stage)| displaced(&stages[..at], bounds).is_some_and(|b| stage.misses(&b)))
}

pub(crate) fn displaced(stages: &[Stage], bounds: &Aabb) -> Option<Aabb> {
    stages.iter().try_fold(*bounds, |b, stage| stage.displaced_bounds(&b))
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
mod tests {
    use super::*;
    use belvedere_core::map::curved_rays::{Model, Pencil, Sharpness, TurnSpec};
    use belvedere_core::map::earth::EarthCurvature;
    use belvedere_core::{Pinhole, Projection};

    fn views() -> Vec<View> {
        let (eye, target) = (DVec3::new(300.0, -9000.0, 2600.0), DVec3::new(0.0, 0.0, -900.0));
        let camera = |screen| Pinhole::look_at(eye, target, DVec3::Z, screen, [640, 360], 1.0, None).unwrap();
        let wide = camera(Projection::Perspective { fov_y: 0.9 });
        let turn = TurnSpec {
            viewpoint: eye + DVec3::Z * 1200.0,
            t0: DVec3::new(0.0, -1500.0, 0.0),
            t1: DVec3::ZERO,
            t2: DVec3::new(0.0, 1500.0, 0.0),
            pencil: Pencil::Parallel { normal: -DVec3::Y },
            m: Sharpness::Bend,
        };
        let rays = CurvedRays::new(&wide, Model::Modified, &[turn]).unwrap();
        let earth = Stage::EarthCurvature(EarthCurvature { eye, radius: 6.37e6, refraction: 0.13 });
        let flat = View::straight(camera(Projection::Orthographic { height: 6000.0 }));
        let stages = [vec![], vec![earth.clone()], vec![earth, Stage::CurvedRays(rays)]];
        stages.into_iter().map(|s| View::new(wide.clone(), s).unwrap()).chain([flat]).collect()
    }

    #[test]
    fn nor_in_what_the_image_shows_of_boxes_that_reach_behind_the_eye() {
        let mut around = 0;
        for view in views().iter().filter(|view| view.curved_rays().is_none() && !view.pinhole().is_orthographic()) {
            let (screen, pass) = (Screen::new(view.pinhole()), &Pass::all(view)[0]);
            let (eye, size) = (view.pinhole().eye, 2.0 * screen.center);
            for k in 0..40 {
                let turn = |seed: f64| (f64::from(k) * seed).fract();
                let min = eye + DVec3::new(-4e3 * turn(0.618), -4e3 * turn(0.755), -200.0 - 1500.0 * turn(0.57));
                let bounds = Aabb { min, max: min + DVec3::new(5e3, 5e3, 150.0) };
                let InView::Maybe(extent) = pass.in_view(&screen, &bounds) else { continue };
                let shown = pass.shown_extent(&screen, &bounds, extent);
                assert!(shown.is_some(), "{bounds:?}");
                let most = pass.px_per_height(&screen, &bounds, shown);
                assert!(most.is_finite() && most <= pass.px_per_height(&screen, &bounds, extent));
                around += usize::from(extent.is_none());
                for i in 0..1600 {
                    let low = min + DVec3::new(125.0 * f64::from(i % 40), 125.0 * f64::from(i / 40), 0.0);
                    let image =
                        |p: DVec3| view.displace_in(0, p).ok().and_then(|d| view.pinhole().project(d.point).ok());
                    let (Some((a, _)), Some((b, _))) = (image(low), image(low + DVec3::Z * 0.5)) else { continue };
                    if [a, b].iter().all(|p| p.cmpge(DVec2::ZERO).all() && p.cmple(size).all()) {
                        assert!(a.distance(b) / 0.5 <= most * (1.0 + 1e-9), "{low}: {} > {most}", a.distance(b) / 0.5);
                    }
                }
            }
        }
        assert!(around > 20, "{around} boxes reach behind the eye");
    }

    #[test]
    fn no_height_changes_the_image_by_more_than_is_said_nor_is_much_more_said() {
        for (k, view) in views().iter().enumerate() {
            let screen = Screen::new(view.pinhole());
            let pass = &Pass::all(view)[0];
            let (mut boxes, mut loose) = (0, 0.0f64);
            for (i, j) in (-8..8).flat_map(|i| (-6..24).map(move |j| (i, j))) {
                let min = DVec3::new(500.0 * f64::from(i), 500.0 * f64::from(j), -200.0);
                let bounds = Aabb { min, max: min + DVec3::new(400.0, 400.0, 300.0) };
                let InView::Maybe(extent @ Some(_)) = pass.in_view(&screen, &bounds) else { continue };
                let most = pass.px_per_height(&screen, &bounds, extent);
                let mut worst = 0.0f64;
                let image = |p: DVec3| view.displace_in(0, p).ok().and_then(|d| view.pinhole().project(d.point).ok());
                for n in 0..64 {
                    let at = |k: i32| f64::from(n >> (2 * k) & 3) / 3.0;
                    let low = min + DVec3::new(400.0 * at(0), 400.0 * at(1), 270.0 * at(2));
                    let (Some((a, _)), Some((b, _))) = (image(low), image(low + DVec3::Z * 30.0)) else { continue };
                    if [a, b].iter().all(|p| p.cmpge(DVec2::ZERO).all() && p.cmple(2.0 * screen.center).all()) {
                        worst = worst.max(a.distance(b) / 30.0);
                    }
                }
                assert!(worst <= most * (1.0 + 1e-9), "view {k}, box {i} {j}: {worst} > {most}");
                boxes += usize::from(worst > 0.0);
                // Far away, where the depths of all points of a box are about equal.
                if worst > 0.0 && j >= 10 {
                    loose = loose.max(most / worst);
                }
            }
            assert!(boxes > 60 && loose < 1.02, "view {k}: {boxes} boxes, {loose} times too much");
        }
    }
}
