//! Handles: what an author asks of the ground.

use belvedere_core::map::ground_moves::MoveNet;
use belvedere_core::plain::number;
use belvedere_core::{DVec2, DVec3, polygon};

/// One thing that an author does to the ground.
#[derive(Debug, Clone, PartialEq)]
pub enum Handle {
    /// The ground at a place goes elsewhere.
    Shift {
        /// The place.
        at: [DVec2; 1],
        /// Displacement in plan, scene units.
        by: DVec2,
    },
    /// The ground turns about a place.
    Turn {
        /// The place.
        at: [DVec2; 1],
        /// Angle counter-clockwise as seen from above, radians.
        angle: f64,
    },
    /// The ground at a place goes up, or down.
    Raise {
        /// The place.
        at: [DVec2; 1],
        /// Height, scene units, positive upwards.
        by: f64,
    },
    /// Both sides of a line go away from it, or, where `by` is negative, towards it.
    Widen {
        /// The line, at least two points.
        path: Vec<DVec2>,
        /// How far each side goes, scene units.
        by: f64,
    },
    /// A line becomes straighter.
    Straighten {
        /// The line, at least two points.
        path: Vec<DVec2>,
        /// Share of the way to the straight line between its ends, 0..=1.
        share: f64,
    },
}

/// A handle and how far it takes effect.
#[derive(Debug, Clone, PartialEq)]
pub struct Move {
    /// What is asked for.
    pub handle: Handle,
    /// Up to this distance from the place or line the ground moves in full, scene units.
    pub core: f64,
    /// Beyond this distance nothing moves, scene units.
    pub reach: f64,
}

/// Errors of a handle.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum HandleError {
    /// A number is out of range.
    #[error("{key} is {}, it must be in {}..={}", number(*value), number(*min), number(*max))]
    Range {
        /// The key.
        key: &'static str,
        /// Its value.
        value: f64,
        /// Least.
        min: f64,
        /// Most.
        max: f64,
    },
    /// The moves lie too far apart for a short reach.
    #[error(
        "reach_m is {}; moves that lie so far apart need at least {}: let it reach farther, or take moves that lie closer together",
        number(*reach), number(least.ceil())
    )]
    Apart {
        /// Reach of the move.
        reach: f64,
        /// Least reach, for moves over so much ground.
        least: f64,
    },
    /// The line has no length.
    #[error("the line has {points} points and is {} long; at least 2 points apart from each other are needed", number(*length))]
    TooShort {
        /// Points.
        points: usize,
        /// Length.
        length: f64,
    },
}

/// A place where a handle states the displacement in plan, or up.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Goal {
    pub(super) at: DVec2,
    pub(super) by: DVec3,
}

/// Largest coordinate, and length, that is taken.
const FAR: f64 = 1e9;
/// A line is seen at so many points at most.
const MOST_POINTS: usize = 4000;

impl Handle {
    /// Name of the kind, as scene files write it.
    pub fn kind(&self) -> &'static str {
        match self {
            Self::Shift { .. } => "shift",
            Self::Turn { .. } => "turn",
            Self::Raise { .. } => "raise",
            Self::Widen { .. } => "widen",
            Self::Straighten { .. } => "straighten",
        }
    }

    /// The place, or the points of the line.
    pub fn places(&self) -> &[DVec2] {
        match self {
            Self::Shift { at, .. } | Self::Turn { at, .. } | Self::Raise { at, .. } => at,
            Self::Widen { path, .. } | Self::Straighten { path, .. } => path,
        }
    }

    /// Whether it states heights; the others state the plan.
    pub(super) fn is_height(&self) -> bool {
        matches!(self, Self::Raise { .. })
    }
}

fn in_range(key: &'static str, value: f64, min: f64, max: f64) -> Result<(), HandleError> {
    if (min..=max).contains(&value) { Ok(()) } else { Err(HandleError::Range { key, value, min, max }) }
}

impl Move {
    pub(super) fn check(&self) -> Result<(), HandleError> {
        in_range("reach_m", self.reach, 1e-6, FAR)?;
        in_range("core_m", self.core, 0.0, 0.9 * self.reach)?;
        for p in self.handle.places() {
            in_range("at", p.x, -FAR, FAR)?;
            in_range("at", p.y, -FAR, FAR)?;
        }
        match &self.handle {
            Handle::Shift { by, .. } => {
                in_range("shift_m", by.x, -FAR, FAR)?;
                in_range("shift_m", by.y, -FAR, FAR)
            }
            Handle::Turn { angle, .. } => in_range("angle_deg", angle.to_degrees(), -170.0, 170.0),
            Handle::Raise { by, .. } => in_range("by_m", *by, -FAR, FAR),
            Handle::Widen { path, by } => line(path).and(in_range("by_m", *by, -FAR, FAR)),
            Handle::Straighten { path, share } => line(path).and(in_range("share", *share, 0.0, 1.0)),
        }
    }

    /// The same move, its line with points no closer than about `step`.
    pub(super) fn thinned(&self, step: f64) -> Self {
        let mut out = self.clone();
        if let Handle::Widen { path, .. } | Handle::Straighten { path, .. } = &mut out.handle {
            *path = spaced(path, step).into_iter().map(|(_, p)| p).collect();
        }
        out
    }

    /// Distance in plan from the place or line.
    pub(super) fn distance(&self, p: DVec2) -> f64 {
        let places = self.handle.places();
        let to_ends = places.iter().map(|q| q.distance(p)).fold(f64::INFINITY, f64::min);
        places.windows(2).map(|s| polygon::to_segment(p, s[0], s[1]).length()).fold(to_ends, f64::min)
    }

    /// What it states, at places about `step` apart.
    pub(super) fn goals(&self, step: f64) -> Vec<Goal> {
        match &self.handle {
            Handle::Shift { at: [at], by } => self.in_core(*at, step, |_| by.extend(0.0)),
            Handle::Raise { at: [at], by } => self.in_core(*at, step, |_| DVec3::Z * *by),
            Handle::Turn { at: [at], angle } => {
                self.in_core(*at, step, |d| (DVec2::from_angle(*angle).rotate(d) - d).extend(0.0))
            }
            Handle::Widen { path, by } => self.beside(path, step, *by),
            Handle::Straighten { path, share } => self.along(path, step, *share),
        }
    }

    fn in_core(&self, at: DVec2, step: f64, by: impl Fn(DVec2) -> DVec3) -> Vec<Goal> {
        let n = (self.core / step).floor() as i64;
        let inner = (-n..=n).flat_map(|j| (-n..=n).map(move |i| step * DVec2::new(i as f64, j as f64)));
        let rim = (0..16).map(|k| self.core * DVec2::from_angle(std::f64::consts::TAU * f64::from(k) / 16.0));
        // Around a place without a core the goal is the place itself, a few times over, so that a turn has a direction.
        let least = if self.core < step { 0.5 * step } else { 0.0 };
        let around = (0..4).map(|k| least * DVec2::from_angle(std::f64::consts::FRAC_PI_2 * f64::from(k)));
        let places = inner.filter(|d| d.length() <= self.core).chain(rim).chain(around);
        places.map(|d| Goal { at: at + d, by: by(d) }).collect()
    }

    /// On the line nothing moves; the ground at the distance of the core on both sides goes away from it.
    fn beside(&self, path: &[DVec2], step: f64, by: f64) -> Vec<Goal> {
        let places = spaced(path, step);
        let mut goals = Vec::with_capacity(3 * places.len());
        for (k, (_, at)) in places.iter().enumerate() {
            // The direction is taken over a core's length, so that the sides of a winding line do not cross.
            let (from, to) = (ahead(&places, k, -self.core), ahead(&places, k, self.core));
            let Some(side) = (to - from).perp().try_normalize() else { continue };
            goals.push(Goal { at: *at, by: DVec3::ZERO });
            for sign in [-1.0, 1.0] {
                let edge = *at + sign * self.core * side;
                // On the inner side of a bend another part of the line is nearer.
                if self.distance(edge) > 0.9 * self.core {
                    goals.push(Goal { at: edge, by: (sign * by * side).extend(0.0) });
                }
            }
        }
        goals
    }

    /// The line goes to the straight line between its ends, the ground beside it with it.
    fn along(&self, path: &[DVec2], step: f64, share: f64) -> Vec<Goal> {
        let places = spaced(path, step);
        let (first, last) = (path[0], path[path.len() - 1]);
        let length = places.last().map_or(0.0, |(along, _)| *along).max(f64::MIN_POSITIVE);
        let one = |k: usize| {
            let (along, at) = places[k];
            let by = (share * (first.lerp(last, along / length) - at)).extend(0.0);
            let side = (ahead(&places, k, step) - ahead(&places, k, -step)).perp().normalize_or_zero();
            [0.0, -1.0, 1.0].map(|s| Goal { at: at + s * self.core.min(step) * side, by })
        };
        (0..places.len()).flat_map(one).collect()
    }

    /// Share of what is asked for that a net does.
    pub(super) fn carried_out(&self, net: &MoveNet) -> f64 {
        let (mut done, mut asked) = (0.0, 0.0);
        for goal in self.goals(net.place().step) {
            let mut by = net.at(goal.at);
            if self.handle.is_height() {
                by = DVec3::Z * by.z;
            }
            done += by.dot(goal.by);
            asked += goal.by.length_squared();
        }
        if asked > 0.0 { done / asked } else { 1.0 }
    }
}

fn line(path: &[DVec2]) -> Result<(), HandleError> {
    let length = length(path);
    if path.len() < 2 || !(length > 0.0) { Err(HandleError::TooShort { points: path.len(), length }) } else { Ok(()) }
}

fn length(path: &[DVec2]) -> f64 {
    path.windows(2).map(|pair| pair[0].distance(pair[1])).sum()
}

/// Points along a line about `step` apart, each with its arc length; the ends among them.
fn spaced(path: &[DVec2], step: f64) -> Vec<(f64, DVec2)> {
    let whole = length(path);
    let n = ((whole / step).ceil() as usize).clamp(1, MOST_POINTS);
    let (mut out, mut behind, mut next) = (Vec::with_capacity(n + 1), 0.0, 0);
    for pair in path.windows(2) {
        let long = pair[0].distance(pair[1]);
        while next <= n && whole * next as f64 / n as f64 <= behind + long {
            let along = whole * next as f64 / n as f64;
            let t = if long > 0.0 { (along - behind) / long } else { 0.0 };
            out.push((along, pair[0].lerp(pair[1], t)));
            next += 1;
        }
        behind += long;
    }
    if out.len() <= n {
        out.push((whole, path[path.len() - 1]));
    }
    out
}

/// The point of a spaced line that is so far along from its k-th one.
fn ahead(places: &[(f64, DVec2)], k: usize, by: f64) -> DVec2 {
    let step = (places[places.len() - 1].0 / (places.len() - 1).max(1) as f64).max(f64::MIN_POSITIVE);
    let away = (by.abs() / step).ceil().max(1.0) as usize;
    let at = if by < 0.0 { k.saturating_sub(away) } else { (k + away).min(places.len() - 1) };
    places[at].1
}
