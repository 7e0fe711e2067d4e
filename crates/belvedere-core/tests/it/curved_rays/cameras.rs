//! Cameras under test: hand-made ones that are easy to picture, and random valid chains.

use belvedere_core::map::curved_rays::{CurvedRays, Model, Pencil, Sharpness, TurnSpec};
use belvedere_core::{DVec3, Pinhole, Projection, Stage, View};
use belvedere_testkit::Random;
use belvedere_testkit::laws::Similarity;

pub(crate) fn pinhole(s: &Similarity, eye: DVec3, look_at: DVec3) -> Pinhole {
    let projection = Projection::Perspective { fov_y: 40f64.to_radians() };
    Pinhole::look_at(
        s.point(eye),
        s.point(look_at),
        s.direction(DVec3::Z),
        projection,
        [1280, 720],
        s.length(1.0),
        None,
    )
    .unwrap()
}

pub(crate) fn moved(turn: &TurnSpec, s: &Similarity) -> TurnSpec {
    let pencil = match turn.pencil {
        Pencil::Line { point, dir } => Pencil::Line { point: s.point(point), dir: s.direction(dir) },
        Pencil::Parallel { normal } => Pencil::Parallel { normal: s.direction(normal) },
    };
    let [viewpoint, t0, t1, t2] = [turn.viewpoint, turn.t0, turn.t1, turn.t2].map(|p| s.point(p));
    TurnSpec { viewpoint, t0, t1, t2, pencil, m: turn.m }
}

/// A root eye at the origin looking along +y, and turns.
#[derive(Debug, Clone)]
pub(crate) struct Spec {
    pub(crate) turns: Vec<TurnSpec>,
}

impl Spec {
    pub(crate) fn rays(&self, model: Model, s: &Similarity) -> CurvedRays {
        let turns: Vec<TurnSpec> = self.turns.iter().map(|t| moved(t, s)).collect();
        CurvedRays::new(&pinhole(s, DVec3::ZERO, DVec3::Y), model, &turns).unwrap_or_else(|e| panic!("{model:?}: {e}"))
    }

    pub(crate) fn view(&self, model: Model, s: &Similarity) -> View {
        View::new(pinhole(s, DVec3::ZERO, DVec3::Y), vec![Stage::CurvedRays(self.rays(model, s))]).unwrap()
    }
}

fn vec(x: f64, y: f64, z: f64) -> DVec3 {
    DVec3::new(x, y, z)
}

/// A street corner: rays turn left by 45 degrees about a vertical line on the left.
pub(crate) fn street_corner() -> Spec {
    let line = vec(-70.0, 100.0, 0.0);
    let arm = |angle: f64, length: f64| line + length * vec(angle.to_radians().cos(), angle.to_radians().sin(), 0.0);
    let turn = TurnSpec {
        viewpoint: vec(70.0, 29.0, 0.0),
        t0: arm(-22.5, 70.0),
        t1: arm(0.0, 70.0),
        t2: arm(22.5, 70.0),
        pencil: Pencil::Line { point: line, dir: DVec3::Z },
        m: Sharpness::Bend,
    };
    Spec { turns: vec![turn] }
}

/// Parallel planes, viewpoint moved to the right and up.
pub(crate) fn sideways() -> Spec {
    let turn = TurnSpec {
        viewpoint: vec(30.0, -5.0, 12.0),
        t0: vec(0.0, 60.0, 0.0),
        t1: vec(0.0, 75.0, 0.0),
        t2: vec(0.0, 100.0, 0.0),
        pencil: Pencil::Parallel { normal: vec(0.05, -1.0, 0.1) },
        m: Sharpness::Bend,
    };
    Spec { turns: vec![turn] }
}

/// Three turns that zigzag along a path, the second one about a slanted line.
pub(crate) fn zigzag() -> Spec {
    chain(&[vec(0.0, 100.0, 0.0), vec(40.0, 190.0, 5.0), vec(10.0, 290.0, 0.0), vec(40.0, 390.0, 10.0)], 150.0, 0.15)
}

/// Five gentle turns to one side.
pub(crate) fn long_bend() -> Spec {
    let knots: Vec<DVec3> = (1..=6)
        .map(|i| {
            let t = f64::from(i) * 0.16;
            600.0 * vec(1.0 - t.cos(), t.sin(), 0.02 * t)
        })
        .collect();
    chain(&knots, 300.0, 0.22)
}

/// A turn at every knot but the last: planes across the path, viewpoints `back` behind the knots.
pub(crate) fn chain(knots: &[DVec3], back: f64, share: f64) -> Spec {
    let mut turns = Vec::new();
    let mut from = DVec3::ZERO;
    let mut viewpoint = DVec3::ZERO;
    let mut half_width = 0.68 * knots[0].length();
    for pair in knots.windows(2) {
        let [knot, next] = [pair[0], pair[1]];
        let (ahead, beyond) = ((knot - from).normalize(), (next - knot).normalize());
        let axis = ahead.cross(beyond).normalize();
        let inside = (beyond - ahead).normalize();
        let length = share * (knot - from).length().min((next - knot).length());
        let line = knot + 1.35 * half_width * inside;
        turns.push(TurnSpec {
            viewpoint: knot - back * beyond,
            t0: knot - length * ahead,
            t1: knot,
            t2: knot + length * beyond,
            pencil: Pencil::Line { point: line, dir: axis },
            m: Sharpness::Bend,
        });
        half_width *= (next - (knot - back * beyond)).length() / back;
        viewpoint = knot - back * beyond;
        from = knot;
    }
    let _ = viewpoint;
    Spec { turns }
}

/// A random chain of `turns` turns that bend more or less; `None` if the random numbers give an invalid one.
pub(crate) fn random_chain(random: &mut Random, turns: usize, model: Model, bend: f64) -> Option<Spec> {
    let mut knots = vec![vec(random.range(-5.0, 5.0), random.range(90.0, 120.0), random.range(-5.0, 5.0))];
    let mut direction = DVec3::Y;
    for _ in 0..turns {
        direction = (direction + bend * random.direction()).normalize();
        let last = knots[knots.len() - 1];
        knots.push(last + random.range(80.0, 130.0) * direction);
    }
    let mut spec = chain(&knots, random.range(150.0, 400.0), random.range(0.1, 0.32));
    for turn in &mut spec.turns {
        let shift = 5.0 * random.direction();
        turn.viewpoint += shift;
        if random.unit() < 0.3 {
            turn.pencil = Pencil::Parallel { normal: (turn.t2 - turn.t0).normalize() + 0.05 * random.direction() };
        }
        turn.m = match random.below(4) {
            0 => Sharpness::Value(random.range(0.6, 4.0)),
            1 => Sharpness::Left,
            2 => Sharpness::Mid,
            _ => Sharpness::Bend,
        };
    }
    CurvedRays::new(&pinhole(&Similarity::IDENTITY, DVec3::ZERO, DVec3::Y), model, &spec.turns).ok().map(|_| spec)
}
