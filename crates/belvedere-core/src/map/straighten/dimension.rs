//! What differs between a curve in plan and a curve in space: vectors, offsets across the curve, and turns along it.

use glam::{DQuat, DVec2, DVec3};
use std::f64::consts::PI;
use std::fmt::{Debug, Display};
use std::iter::Sum;
use std::ops::{Add, AddAssign, Mul, Neg, Sub};

/// A vector of two or three components.
pub trait Vector:
    Copy
    + Debug
    + Default
    + Display
    + PartialEq
    + Send
    + Sync
    + 'static
    + Add<Output = Self>
    + Sub<Output = Self>
    + Neg<Output = Self>
    + AddAssign
    + Mul<f64, Output = Self>
    + Sum
{
    /// Unit vectors along the axes of the scene.
    const AXES: &'static [Self];
    /// Components.
    fn components(&self) -> &[f64];
    /// Scalar product.
    fn dot(self, other: Self) -> f64;

    /// Square of the length.
    fn length_squared(self) -> f64 {
        self.dot(self)
    }

    /// Length.
    fn length(self) -> f64 {
        self.length_squared().sqrt()
    }

    /// Distance of two points.
    fn distance(self, other: Self) -> f64 {
        (self - other).length()
    }

    /// Point between two, at a share of the way.
    fn lerp(self, to: Self, share: f64) -> Self {
        self + (to - self) * share
    }

    /// The unit vector of this direction, or another.
    fn unit_or(self, other: Self) -> Self {
        let unit = self * (1.0 / self.length());
        if unit.components().iter().all(|c| c.is_finite()) { unit } else { other }
    }

    /// Largest absolute component; NaN if one is not a number.
    fn most(self) -> f64 {
        self.components().iter().fold(0.0, |most, c| if c.is_nan() || c.abs() > most { c.abs() } else { most })
    }

    /// Cell of a lattice of this spacing.
    fn cell(self, spacing: f64) -> [i64; 3] {
        let mut cell = [0; 3];
        cell.iter_mut().zip(self.components()).for_each(|(cell, c)| *cell = (c / spacing).floor() as i64);
        cell
    }
}

impl Vector for DVec2 {
    const AXES: &'static [Self] = &[Self::X, Self::Y];

    fn components(&self) -> &[f64] {
        self.as_ref()
    }

    fn dot(self, other: Self) -> f64 {
        self.dot(other)
    }
}

impl Vector for DVec3 {
    const AXES: &'static [Self] = &[Self::X, Self::Y, Self::Z];

    fn components(&self) -> &[f64] {
        self.as_ref()
    }

    fn dot(self, other: Self) -> f64 {
        self.dot(other)
    }
}

/// What lies across a curve: an offset from it, scene units, or its curvature, 1 / scene unit.
pub trait Across:
    Copy
    + Debug
    + Default
    + PartialEq
    + Send
    + Sync
    + 'static
    + Add<Output = Self>
    + Sub<Output = Self>
    + Mul<f64, Output = Self>
{
    /// Scalar product.
    fn dot(self, other: Self) -> f64;

    /// Length.
    fn length(self) -> f64 {
        self.dot(self).sqrt()
    }
}

impl Across for f64 {
    fn dot(self, other: Self) -> f64 {
        self * other
    }

    fn length(self) -> f64 {
        self.abs()
    }
}

impl Across for DVec2 {
    fn dot(self, other: Self) -> f64 {
        self.dot(other)
    }
}

/// In plan or in space.
pub trait Dimension: Copy + Debug + PartialEq + Send + Sync + Sized + 'static {
    /// Positions.
    type Vector: Vector;
    /// Offsets across the curve.
    type Across: Across;
    /// Turn of the frame of a curve from the axes of the scene, or between two of its frames.
    type Turn: Copy + Debug + PartialEq + Send + Sync;
    /// What is straightened, for messages.
    const SHAPE: Shape;

    /// The part of a point that takes part.
    fn of(p: DVec3) -> Self::Vector;
    /// The point `p` with this part in place of its own.
    fn with(part: Self::Vector, p: DVec3) -> DVec3;
    /// A turn to a unit tangent.
    fn towards(tangent: Self::Vector) -> Self::Turn;
    /// The least turn from one direction to another, neither of them 0.
    fn between(from: Self::Vector, to: Self::Vector) -> Self::Turn;
    /// First the one turn, then the other about the axes that it turned.
    fn then(first: Self::Turn, second: Self::Turn) -> Self::Turn;
    /// The turn back.
    fn back(turn: Self::Turn) -> Self::Turn;
    /// A turned vector.
    fn turned(turn: Self::Turn, v: Self::Vector) -> Self::Vector;
    /// The vector with these parts along and across a frame.
    fn vector(turn: Self::Turn, along: f64, across: Self::Across) -> Self::Vector;
    /// Parts of a vector along and across a frame.
    fn parts(turn: Self::Turn, v: Self::Vector) -> (f64, Self::Across);
    /// Way and turn over the first `s` of a piece of length `spacing` whose curvature is linear, in the frame of its start. `spacing` times
    /// either curvature is at most 0.06.
    fn advance(curvature: [Self::Across; 2], spacing: f64, s: f64) -> (Self::Vector, Self::Turn);
    /// Those of the bounds `normal . offset <= distance` that shorter offsets than `most` may pass without passing another one.
    fn needed(bounds: Vec<(Self::Across, f64)>, most: f64) -> Vec<(Self::Across, f64)>;
    /// Offsets of this length to several sides of the curve; of the negative length those to the other sides.
    fn spread(length: f64) -> Vec<Self::Across>;
}

/// What is straightened.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Shape {
    /// A strip along a route.
    Strip,
    /// A tube along a centreline.
    Tube,
}

impl Shape {
    /// Its name.
    pub fn name(self) -> &'static str {
        match self {
            Self::Strip => "strip",
            Self::Tube => "tube",
        }
    }

    /// The curve in its middle.
    pub fn line(self) -> &'static str {
        match self {
            Self::Strip => "route",
            Self::Tube => "centreline",
        }
    }

    /// Largest distance from the curve.
    pub fn width(self) -> &'static str {
        match self {
            Self::Strip => "half width",
            Self::Tube => "radius",
        }
    }

    /// Coordinates of a place, for messages.
    pub(super) fn place(self, at: DVec3) -> String {
        match self {
            Self::Strip => format!("({:.2}, {:.2})", at.x, at.y),
            Self::Tube => format!("({:.2}, {:.2}, {:.2})", at.x, at.y, at.z),
        }
    }
}

/// Nodes and weights of the Gauss-Legendre rule with four points on 0..=1.
const GAUSS: [[f64; 2]; 4] = [
    [0.069_431_844_202_973_71, 0.173_927_422_568_726_93],
    [0.330_009_478_207_571_87, 0.326_072_577_431_273_1],
    [0.669_990_521_792_428_1, 0.326_072_577_431_273_1],
    [0.930_568_155_797_026_3, 0.173_927_422_568_726_93],
];

/// In plan: what is straightened keeps its heights. Offsets are positive to the left, curvatures where the curve turns left.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Plan;

impl Dimension for Plan {
    type Vector = DVec2;
    type Across = f64;
    /// Cosine and sine.
    type Turn = DVec2;
    const SHAPE: Shape = Shape::Strip;

    fn of(p: DVec3) -> DVec2 {
        p.truncate()
    }

    fn with(part: DVec2, p: DVec3) -> DVec3 {
        part.extend(p.z)
    }

    fn towards(tangent: DVec2) -> DVec2 {
        tangent
    }

    fn between(from: DVec2, to: DVec2) -> DVec2 {
        DVec2::new(from.dot(to), from.perp_dot(to)).normalize_or(DVec2::X)
    }

    fn then(first: DVec2, second: DVec2) -> DVec2 {
        second.rotate(first).normalize()
    }

    fn back(turn: DVec2) -> DVec2 {
        DVec2::new(turn.x, -turn.y)
    }

    fn turned(turn: DVec2, v: DVec2) -> DVec2 {
        v.rotate(turn)
    }

    fn vector(turn: DVec2, along: f64, across: f64) -> DVec2 {
        DVec2::new(along, across).rotate(turn)
    }

    fn parts(turn: DVec2, v: DVec2) -> (f64, f64) {
        (turn.dot(v), turn.perp_dot(v))
    }

    fn advance([k0, k1]: [f64; 2], spacing: f64, s: f64) -> (DVec2, DVec2) {
        let rate = 0.5 * (k1 - k0) / spacing;
        let angle = |t: f64| t * (k0 + rate * t);
        let way = GAUSS.iter().map(|[at, weight]| *weight * DVec2::from_angle(angle(at * s))).sum::<DVec2>();
        (s * way, DVec2::from_angle(angle(s)))
    }

    fn needed(bounds: Vec<(f64, f64)>, _: f64) -> Vec<(f64, f64)> {
        let least =
            |side: f64| bounds.iter().filter(|(normal, _)| *normal == side).copied().min_by(|a, b| a.1.total_cmp(&b.1));
        [-1.0, 1.0].into_iter().filter_map(least).collect()
    }

    fn spread(length: f64) -> Vec<f64> {
        vec![length]
    }
}

/// In space. Offsets and curvatures are those along two normals of the curve that do not turn about it: the rotation-minimising frame
/// (Bishop 1975), whose normals change along the tangent alone.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Space;

impl Dimension for Space {
    type Vector = DVec3;
    type Across = DVec2;
    type Turn = DQuat;
    const SHAPE: Shape = Shape::Tube;

    fn of(p: DVec3) -> DVec3 {
        p
    }

    fn with(part: DVec3, _: DVec3) -> DVec3 {
        part
    }

    fn towards(tangent: DVec3) -> DQuat {
        DQuat::from_rotation_arc(DVec3::X, tangent)
    }

    fn between(from: DVec3, to: DVec3) -> DQuat {
        DQuat::from_rotation_arc(from.normalize_or(DVec3::X), to.normalize_or(DVec3::X))
    }

    fn then(first: DQuat, second: DQuat) -> DQuat {
        (first * second).normalize()
    }

    fn back(turn: DQuat) -> DQuat {
        turn.conjugate()
    }

    fn turned(turn: DQuat, v: DVec3) -> DVec3 {
        turn * v
    }

    fn vector(turn: DQuat, along: f64, across: DVec2) -> DVec3 {
        turn * DVec3::new(along, across.x, across.y)
    }

    fn parts(turn: DQuat, v: DVec3) -> (f64, DVec2) {
        let v = turn.conjugate() * v;
        (v.x, DVec2::new(v.y, v.z))
    }

    fn advance([k0, k1]: [DVec2; 2], spacing: f64, s: f64) -> (DVec3, DQuat) {
        let rate = (k1 - k0) * (1.0 / spacing);
        // The frame turns at (0, -k.y, k.x) about its own axes. The exponential of the integral is right where these axes stay the same;
        // the term along the tangent is the next one of Magnus's series.
        let twist = k0.perp_dot(rate) / 12.0;
        let turn = |t: f64| {
            let k = t * (k0 + (0.5 * t) * rate);
            DVec3::new(t * t * t * twist, -k.y, k.x)
        };
        let way = GAUSS.iter().map(|[at, weight]| *weight * tangent_after(turn(at * s))).sum::<DVec3>();
        let turn = turn(s);
        let [sine, cosine] = sine_and_cosine(0.25 * turn.length_squared());
        let v = 0.5 * sine * turn;
        (s * way, DQuat::from_xyzw(v.x, v.y, v.z, 1.0 - 0.25 * cosine * turn.length_squared()))
    }

    fn needed(mut bounds: Vec<(DVec2, f64)>, most: f64) -> Vec<(DVec2, f64)> {
        // A square is cut by one bound after the other, the nearest first; of each side is kept which bound it is.
        bounds.sort_by(|a, b| a.1.total_cmp(&b.1));
        let corner = |x: f64, y: f64| (DVec2::new(x * most, y * most), None);
        let mut polygon: Vec<(DVec2, Option<usize>)> =
            vec![corner(-1.0, -1.0), corner(1.0, -1.0), corner(1.0, 1.0), corner(-1.0, 1.0)];
        for (k, (normal, distance)) in bounds.iter().enumerate() {
            let beyond = |p: DVec2| normal.dot(p) - distance;
            if polygon.iter().all(|(p, _)| beyond(*p) <= 0.0) {
                continue;
            }
            let mut cut = Vec::with_capacity(polygon.len() + 1);
            for (i, (p, side)) in polygon.iter().enumerate() {
                let q = polygon[(i + 1) % polygon.len()].0;
                let (a, b) = (beyond(*p), beyond(q));
                if a <= 0.0 {
                    cut.push((*p, *side));
                }
                if (a <= 0.0) != (b <= 0.0) {
                    let crossing = p.lerp(q, a / (a - b));
                    cut.push((crossing, if a <= 0.0 { Some(k) } else { *side }));
                }
            }
            polygon = cut;
        }
        if polygon.is_empty() {
            return vec![(DVec2::X, f64::NEG_INFINITY)];
        }
        let mut kept: Vec<usize> = polygon.into_iter().filter_map(|(_, side)| side).collect();
        kept.sort_unstable();
        kept.dedup();
        kept.into_iter().map(|k| bounds[k]).collect()
    }

    fn spread(length: f64) -> Vec<DVec2> {
        [0.0, 0.25, 0.5, 0.75].map(|share| length * DVec2::from_angle(share * PI)).into()
    }
}

/// The x axis turned by a small rotation vector (Rodrigues).
fn tangent_after(turn: DVec3) -> DVec3 {
    let [sine, cosine] = sine_and_cosine(turn.length_squared());
    let across = DVec3::new(0.0, turn.z, -turn.y);
    DVec3::X + sine * across + cosine * turn.cross(across)
}

/// `sin(x) / x` and `(1 - cos(x)) / x^2` by the square of a small `x`: right to rounding up to 0.2.
fn sine_and_cosine(square: f64) -> [f64; 2] {
    let series = |first: f64, terms: [f64; 5]| {
        let (mut sum, mut term) = (first, first);
        for n in terms {
            term *= -square / n;
            sum += term;
        }
        sum
    };
    [series(1.0, [6.0, 20.0, 42.0, 72.0, 110.0]), series(0.5, [12.0, 30.0, 56.0, 90.0, 132.0])]
}
