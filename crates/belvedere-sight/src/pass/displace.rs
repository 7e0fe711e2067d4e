//! The stages of a view prepared for a frame, so that millions of points pass quickly.
//!
//! Everything that is drawn goes through here, points in rows and single ones alike, by the same arithmetic in the same
//! order: two pieces of a surface that share a point place it alike to the last bit.

use crate::Fast;
use crate::pass::points::{Points, each};
use crate::pass::spline_table::SplineTable;
use crate::pass::way::Way;
use belvedere_core::map::curved_rays::{StraightMap, Turn};
use belvedere_core::{CurvedRays, DVec3, Stage, View};

/// All stages of a view for one pass over the scene.
#[derive(Debug)]
pub(super) struct Displacer<'a> {
    steps: Vec<Step<'a>>,
}

#[derive(Debug)]
enum Step<'a> {
    /// A stage without a faster form.
    Stage(&'a Stage),
    Spline(SplineTable<'a>),
    /// A record of curved rays with conic arcs; the first one leaves points before the turn alone.
    Conic {
        turn: &'a Turn,
        m: f64,
        eye: DVec3,
        first: bool,
    },
    /// A straight part of curved rays.
    Straight {
        map: StraightMap,
        eye: DVec3,
    },
    /// A record of curved rays of another model.
    Record {
        rays: &'a CurvedRays,
        record: usize,
    },
    /// Records that displace as one map, each point by its own: one step per record, from the given one on.
    Chain {
        rays: &'a CurvedRays,
        first: usize,
        steps: Vec<Step<'a>>,
    },
}

impl<'a> Step<'a> {
    fn record(rays: &'a CurvedRays, record: usize) -> Self {
        match rays.turns().get(record).map(|turn| (turn, turn.m)) {
            Some((turn, Some(m))) => Self::Conic { turn, m, eye: rays.root().eye, first: record == 0 },
            _ => Self::Record { rays, record },
        }
    }

    fn row(&self, p: &mut Points<'_>) -> bool {
        match self {
            Step::Stage(stage) => each(p, |p| stage.apply(p).ok()),
            Step::Spline(table) => table.row(p),
            Step::Conic { turn, m, eye, first } => conic(turn, *m, *eye, *first, p),
            Step::Straight { map, eye } => each(p, |p| Some(*eye + map.linear * (p - map.viewpoint))),
            Step::Record { rays, record } => each(p, |p| rays.displace_in(*record, p).ok().map(|d| d.point)),
            Step::Chain { rays, first, steps } => {
                let of = |p: &Points<'_>, i: usize| {
                    rays.record_of(*first..=first + steps.len() - 1, DVec3::new(p.x[i], p.y[i], p.z[i])) - first
                };
                let (mut from, mut whole) = (0, true);
                while from < p.x.len() {
                    let record = of(p, from);
                    let to = (from + 1..p.x.len()).find(|&i| of(p, i) != record).unwrap_or(p.x.len());
                    let part = from..to;
                    let (x, y, z) = (&mut p.x[part.clone()], &mut p.y[part.clone()], &mut p.z[part]);
                    whole &= steps[record].row(&mut Points { x, y, z });
                    from = to;
                }
                whole
            }
        }
    }
}

impl<'a> Displacer<'a> {
    pub(super) fn new(view: &'a View, way: Way) -> Self {
        let step = |stage: &'a Stage| match Fast::of(stage) {
            Fast::Spline(bend) => Step::Spline(SplineTable::new(bend)),
            Fast::Rays(rays) => match way {
                Way::Records([first, last]) if first == last => Step::record(rays, first),
                Way::Records([first, last]) => {
                    let steps = (first..=last).map(|record| Step::record(rays, record)).collect();
                    Step::Chain { rays, first, steps }
                }
                Way::Segment(number) => match rays.straight_map(number) {
                    Some(map) => Step::Straight { map, eye: rays.root().eye },
                    None => Step::record(rays, number as usize / 2),
                },
            },
            Fast::Earth(_) | Fast::Ground(_) | Fast::None => Step::Stage(stage),
        };
        Self { steps: view.stages().iter().map(step).collect() }
    }

    /// Whether nothing is displaced.
    pub(super) fn is_straight(&self) -> bool {
        self.steps.is_empty()
    }

    /// Displaced position; `None` where the point has no image.
    pub(super) fn point(&self, p: DVec3) -> Option<DVec3> {
        let (mut x, mut y, mut z) = ([p.x], [p.y], [p.z]);
        let known = self.row(&mut Points { x: &mut x, y: &mut y, z: &mut z });
        let p = DVec3::new(x[0], y[0], z[0]);
        (known && p.is_finite()).then_some(p)
    }

    /// Displaces points of slices of equal length; `false` if one of them has no image (the rest is then unspecified).
    /// A point that overflows comes out as not finite.
    pub(super) fn row(&self, p: &mut Points<'_>) -> bool {
        self.steps.iter().all(|step| step.row(p))
    }
}

/// `X' = eye + before (X - C') + phi(a, b) shift`, the first record `X' = X + phi shift`; phi is `max(0, a - b)` outside the wedge.
/// Without branches, so that several points are computed at once, unless all of them lie on one side.
fn conic(turn: &Turn, m: f64, eye: DVec3, first: bool, points: &mut Points<'_>) -> bool {
    let n = points.x.len();
    let (xs, ys, zs) = (&mut points.x[..n], &mut points.y[..n], &mut points.z[..n]);
    let [mut before, mut after] = [true; 2];
    for i in 0..n {
        let p = DVec3::new(xs[i], ys[i], zs[i]);
        let (a, b) = (turn.a.at(p), turn.b.at(p));
        before &= (a <= 0.0) & (a <= b);
        after &= (b <= 0.0) & (a > b);
    }
    if before && first {
        return true;
    }
    if before || after {
        for i in 0..n {
            let p = DVec3::new(xs[i], ys[i], zs[i]);
            let phi = if after { turn.h.at(p) } else { 0.0 };
            let base = if first { p } else { eye + turn.before * (p - turn.viewpoint_before) };
            let q = base + phi * turn.shift;
            (xs[i], ys[i], zs[i]) = (q.x, q.y, q.z);
        }
        return true;
    }
    for i in 0..n {
        let p = DVec3::new(xs[i], ys[i], zs[i]);
        let (a, b) = (turn.a.at(p), turn.b.at(p));
        let wedge = wedge_phi(m, a, b);
        let outside = if a > b { turn.h.at(p) } else { 0.0 };
        let phi = if (a > 0.0) & (b > 0.0) { wedge } else { outside };
        let base = if first { p } else { eye + turn.before * (p - turn.viewpoint_before) };
        let q = base + phi * turn.shift;
        (xs[i], ys[i], zs[i]) = (q.x, q.y, q.z);
    }
    true
}

/// phi of the modified model between the planes: `a = phi + m q`, `b = psi + m q`, `q = sqrt(phi psi)`; sums of positive
/// terms, scaled by `a + b`, so that nothing cancels near the planes. Anything outside.
#[inline]
fn wedge_phi(m: f64, a: f64, b: f64) -> f64 {
    let c = a + b;
    let (a, b) = (a / c, b / c);
    let ab = a * b;
    let difference = m * (a - b);
    let q = 2.0 * ab / (m + (difference * difference + 4.0 * ab).sqrt());
    let large = a.max(b) - m * q;
    let small = q * q / large;
    c * if a > b { large } else { small }
}

#[cfg(test)]
mod tests {
    use super::*;
    use belvedere_core::map::curved_rays::{Model, Pencil, Sharpness, TurnSpec};
    use belvedere_core::map::spline::{ReferencePlane, SplineBend, default_pivot};
    use belvedere_core::presets::PresetDocument;
    use belvedere_core::{Pinhole, Projection};

    fn camera() -> Pinhole {
        let screen = Projection::Perspective { fov_y: 0.9 };
        let (eye, target) = (DVec3::new(5e5, 4.6e6, 3000.0), DVec3::new(5e5, 4.61e6, 0.0));
        Pinhole::look_at(eye, target, DVec3::Z, screen, [1280, 720], 1.0, None).unwrap()
    }

    fn rays(model: Model, m: Sharpness) -> View {
        let camera = camera();
        let at = |y: f64| camera.eye + DVec3::new(0.0, y, -2000.0);
        let turn = |up: f64, y: f64| TurnSpec {
            viewpoint: camera.eye + DVec3::new(50.0, -80.0, up),
            t0: at(y),
            t1: at(y + 1000.0),
            t2: at(y + 2200.0),
            pencil: Pencil::Parallel { normal: DVec3::Y },
            m,
        };
        let rays = CurvedRays::new(&camera, model, &[turn(700.0, 4000.0), turn(1300.0, 9000.0)]).unwrap();
        View::new(camera, vec![Stage::CurvedRays(rays)]).unwrap()
    }

    fn spline(preset: &str) -> View {
        let (camera, plane) = (camera(), ReferencePlane::level(0.0));
        let document = PresetDocument::builtin(preset).unwrap();
        let bend = SplineBend::new(&camera, &document, &plane, default_pivot(&camera, &plane)).unwrap();
        View::new(camera, vec![Stage::SplineBend(bend)]).unwrap()
    }

    fn ground(n: usize) -> Vec<DVec3> {
        let eye = camera().eye.with_z(0.0);
        (0..n * n)
            .map(|i| {
                let (u, v) = ((i % n) as f64 / n as f64, (i / n) as f64 / n as f64);
                eye + DVec3::new(12e3 * (u - 0.5), 200.0 + 24e3 * v, 1500.0 * (20.0 * u).sin() * (31.0 * v).cos())
            })
            .collect()
    }

    #[test]
    fn prepared_stages_place_points_like_the_stages_themselves() {
        let views = [
            rays(Model::Modified, Sharpness::Bend),
            rays(Model::Modified, Sharpness::Value(4.0)),
            rays(Model::Original, Sharpness::Bend),
            rays(Model::C2, Sharpness::Bend),
            spline("progressive"),
            spline("degressive"),
        ];
        for (k, view) in views.iter().enumerate() {
            for record in 0..view.records() {
                let displacer = Displacer::new(view, Way::Records([record; 2]));
                let (mut worst, mut seen) = (0.0f64, 0);
                for p in ground(90) {
                    let exact = view.displace_in(record, p).ok().map(|d| d.point);
                    let fast = displacer.point(p);
                    assert_eq!(exact.is_some(), fast.is_some(), "view {k}, record {record}: {p}");
                    let (Some(exact), Some(fast)) = (exact, fast) else { continue };
                    let (Ok((a, depth)), Ok((b, _))) = (view.pinhole().project(exact), view.pinhole().project(fast))
                    else {
                        continue;
                    };
                    if depth > 20.0 {
                        worst = worst.max(a.distance(b));
                        seen += 1;
                    }
                }
                assert!(seen > 4000, "view {k}: {seen}");
                assert!(worst < 0.002, "view {k}, record {record}: {worst} px");
            }
        }
    }

    #[test]
    fn rows_and_single_points_agree_to_the_last_bit() {
        for view in [rays(Model::Modified, Sharpness::Bend), spline("progressive")] {
            let displacer = Displacer::new(&view, Way::Records([0; 2]));
            for row in ground(66).chunks(33) {
                let coordinate = |k: usize| row.iter().map(|p| p[k]).collect::<Vec<f64>>();
                let (mut x, mut y, mut z) = (coordinate(0), coordinate(1), coordinate(2));
                assert!(displacer.row(&mut Points { x: &mut x, y: &mut y, z: &mut z }));
                for (i, p) in row.iter().enumerate() {
                    assert_eq!(displacer.point(*p), Some(DVec3::new(x[i], y[i], z[i])));
                }
            }
        }
    }

    #[test]
    fn straight_parts_place_points_like_the_rays_themselves() {
        let view = rays(Model::Modified, Sharpness::Bend);
        for segment in [0, 2, 4] {
            let displacer = Displacer::new(&view, Way::Segment(segment));
            for p in ground(20) {
                let (exact, fast) = (view.displace_along(segment, p).unwrap().point, displacer.point(p).unwrap());
                assert!(exact.distance(fast) < 1e-6, "segment {segment}: {exact} {fast}");
            }
        }
        assert_eq!(Displacer::new(&view, Way::Records([0; 2])).point(DVec3::NAN), None);
    }
}
