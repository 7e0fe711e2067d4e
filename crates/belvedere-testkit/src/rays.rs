//! Random curved ray cameras, as varied as the conditions of validity allow.

use crate::Random;
use belvedere_core::map::curved_rays::{CurvedRays, Model, Pencil, Sharpness, TurnSpec};
use belvedere_core::map::split_rays::{Fork, Seam, SplitRays, SplitSpec};
use belvedere_core::{DVec2, DVec3, Pinhole, Projection, Stage, View};
use glam::DQuat;

/// All ray models.
pub const MODELS: [Model; 5] = [Model::Modified, Model::Original, Model::C0, Model::C2, Model::Circular];

/// A pinhole and valid turns behind it. Lengths are about a hundred scene units each.
#[derive(Debug, Clone)]
pub struct RandomRays {
    /// Where rays start.
    pub pinhole: Pinhole,
    /// Shape of the rays.
    pub model: Model,
    /// Valid turns, in ray order.
    pub turns: Vec<TurnSpec>,
}

/// The end of a chain: the viewpoint of its last part, the axis of that part, and half the width of the picture per unit of distance.
#[derive(Debug, Clone, Copy)]
struct End {
    viewpoint: DVec3,
    axis: DVec3,
    /// Approximate distance from the viewpoint at which the last turn ends.
    from: f64,
    half_width: f64,
}

impl RandomRays {
    /// A camera of `turns` turns, or `None` if a few dozen random attempts per turn give no valid one.
    ///
    /// Bends of up to 100 degrees in any plane, wedges of up to 150, common lines in any direction or none, viewpoints beside the axis, all
    /// sharpnesses.
    /// * `image`: size of the picture, pixels.
    pub fn new(random: &mut Random, model: Model, turns: usize, image: [u32; 2]) -> Option<Self> {
        let eye = 20.0 * random.direction();
        let forward = random.direction();
        let fov_y = random.range(15.0, 75.0).to_radians();
        let lens = Projection::Perspective { fov_y };
        let up = forward.any_orthonormal_vector();
        let up = DQuat::from_axis_angle(forward, random.range(-3.0, 3.0)) * up;
        let pinhole = Pinhole::look_at(eye, eye + forward, up, lens, image, 0.5, None).ok()?;
        let [w, h] = image.map(f64::from);
        let half_width = (0.5 * fov_y).tan() * (w / h).max(1.0);
        let mut end = End { viewpoint: eye, axis: forward, from: 0.0, half_width };
        let mut out = Self { pinhole, model, turns: Vec::new() };
        for _ in 0..turns {
            end = out.turn(random, &end)?;
        }
        Some(out)
    }

    /// The camera as a view.
    ///
    /// # Panics
    /// If the turns have been replaced by invalid ones.
    pub fn view(&self) -> View {
        let rays = CurvedRays::new(&self.pinhole, self.model, &self.turns).unwrap_or_else(|e| panic!("{e}"));
        View::new(self.pinhole.clone(), vec![Stage::CurvedRays(rays)]).expect("one stage is in order")
    }

    /// Adds a valid turn behind `end`.
    fn turn(&mut self, random: &mut Random, end: &End) -> Option<End> {
        for attempt in 0..60 {
            // The more attempts it takes, the gentler the turn becomes.
            let gentle = 1.0 - f64::from(attempt) / 70.0;
            let (turn, next) = random_turn(random, end, gentle);
            self.turns.push(turn);
            if CurvedRays::if_valid(&self.pinhole, self.model, &self.turns).is_some() {
                return Some(next);
            }
            self.turns.pop();
        }
        None
    }
}

fn random_turn(random: &mut Random, end: &End, gentle: f64) -> (TurnSpec, End) {
    let distance = end.from + random.range(40.0, 160.0);
    let bend = end.viewpoint + distance * end.axis;
    let axle = end.axis.any_orthonormal_vector();
    let axle = DQuat::from_axis_angle(end.axis, random.range(-3.2, 3.2)) * axle;
    let angle = gentle * random.range(0.0, 100.0f64).to_radians();
    let ahead = DQuat::from_axis_angle(axle, angle) * end.axis;
    let back = distance * if random.unit() < 0.3 { random.range(0.25, 1.0) } else { random.range(1.0, 4.0) };
    let aside = if random.unit() < 0.5 { 0.0 } else { gentle * random.range(0.0, 0.3) };
    let viewpoint = bend - back * (ahead + aside * random.direction());
    let m = match random.below(5) {
        0 => Sharpness::Value(random.range(0.4, 6.0)),
        1 => Sharpness::Left,
        2 => Sharpness::Mid,
        _ => Sharpness::Bend,
    };
    let across = (ahead + end.axis).normalize_or(end.axis);
    let narrow = if random.unit() < 0.2 { 0.1 } else { 1.0 };
    let half = end.half_width * distance;
    let next = End {
        viewpoint,
        axis: (bend - viewpoint).normalize(),
        from: (bend - viewpoint).length() + 20.0,
        half_width: half / (bend - viewpoint).length(),
    };
    if random.unit() < 0.2 {
        let normal = (across + 0.3 * gentle * random.direction()).normalize();
        let along = |share: f64| narrow * gentle * share * (distance - end.from);
        let (t0, t2) = (along(random.range(0.05, 0.7)), along(random.range(0.05, 1.2)));
        let (t0, t2) = (bend - t0 * end.axis, bend + t2 * ahead);
        return (TurnSpec { viewpoint, t0, t1: bend, t2, pencil: Pencil::Parallel { normal }, m }, next);
    }
    // The common line: across the turn, oblique to it, or in any direction.
    let dir = match random.below(4) {
        0 => random.direction(),
        1 => (axle + 0.5 * random.direction()).normalize(),
        _ => axle,
    };
    let inside = dir.cross(across).normalize_or(axle);
    let inside = if random.unit() < 0.15 { -inside } else { inside };
    let wide = random.unit() < 0.4;
    let line = bend + half * if wide { random.range(0.9, 1.6) } else { random.range(0.8, 3.5) } * inside;
    let open =
        if wide { random.range(90.0, 150.0f64) } else { narrow * gentle * random.range(2.0, 150.0f64) }.to_radians();
    let share = if wide { random.range(0.2, 0.6) } else { random.range(0.15, 0.85) };
    let turned = |by: f64| line + DQuat::from_axis_angle(dir, by) * (bend - line);
    // The direction around the line that leads onwards.
    let on = if (turned(1e-3) - bend).dot(across) > 0.0 { 1.0 } else { -1.0 };
    let (t0, t2) = (turned(-on * open * share), turned(on * open * (1.0 - share)));
    (TurnSpec { viewpoint, t0, t1: bend, t2, pencil: Pencil::Line { point: line, dir }, m }, next)
}

/// Rays that branch at a seam, each side with one or two turns of its own; `None` if the random attempts give no valid ones.
pub fn random_split(random: &mut Random, model: Model, image: [u32; 2]) -> Option<(View, SplitSpec)> {
    let common = random.below(2);
    let base = RandomRays::new(random, model, common, image)?;
    let slant = random.range(-0.2, 0.2);
    let x = random.range(0.35, 0.65);
    let seam = Seam { from: DVec2::new(x + slant, 1.0), to: DVec2::new(x - slant, 0.0) };
    for _ in 0..40 {
        let mut side = || {
            let mut rays = base.clone();
            let eye = base.turns.last().map_or(base.pinhole.eye, |turn| turn.viewpoint);
            let bend = base.turns.last().map_or(base.pinhole.forward, |turn| (turn.t1 - turn.viewpoint).normalize());
            let from = base.turns.last().map_or(0.0, |turn| turn.t1.distance(turn.viewpoint) + 20.0);
            let end = End { viewpoint: eye, axis: bend, from, half_width: 0.6 };
            let gentle = random.range(0.2, 0.9);
            rays.turns = vec![random_turn(random, &end, gentle).0];
            SplitSpec { turns: rays.turns, fork: None }
        };
        let fork = Fork { seam, sides: [side(), side()], merge: None };
        let spec = SplitSpec { turns: base.turns.clone(), fork: Some(Box::new(fork)) };
        if let Ok(split) = SplitRays::new(&base.pinhole, model, &spec) {
            let view = View::new(base.pinhole.clone(), vec![Stage::SplitRays(split)]).ok()?;
            return Some((view, spec));
        }
    }
    None
}
