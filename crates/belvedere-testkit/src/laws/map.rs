//! Laws of [`SpaceMap`].

use super::{Continuity, Similarity, hostile_points};
use crate::Random;
use belvedere_core::{Aabb, DMat3, DVec3, SpaceMap};

/// A point where two pieces of a map meet, and a direction across the joint.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Joint {
    /// Point on the joint, scene units.
    pub point: DVec3,
    /// Direction across the joint, of any length but 0.
    pub across: DVec3,
}

/// Rotations with which a map moves.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Turns {
    Any,
    /// About the vertical only.
    Upright,
    None,
}

type Maker<M> = Box<dyn Fn(&Similarity) -> M>;
type Inside<M> = Box<dyn Fn(&M, DVec3) -> bool>;

/// A map under test and its promised properties.
pub struct MapCase<M> {
    name: String,
    make: Maker<M>,
    zero: Option<Box<dyn Fn() -> M>>,
    domain: Inside<M>,
    region: Aabb,
    joints: Vec<Joint>,
    continuity: Continuity,
    turns: Turns,
    round_trip: f64,
    least_share: f64,
    samples: usize,
    seed: u64,
}

impl<M: SpaceMap> MapCase<M> {
    /// Makes a case. `make` builds the map with all its parameters moved by a similarity. Test points are drawn from `region`.
    ///
    /// Defaults: declared C1 without known joints, any rotation allowed, round trips to 1e-12 of the size of the scene,
    /// the whole region is in the domain, 2000 points.
    pub fn new(name: impl Into<String>, region: Aabb, make: impl Fn(&Similarity) -> M + 'static) -> Self {
        Self {
            name: name.into(),
            make: Box::new(make),
            zero: None,
            domain: Box::new(|_, _| true),
            region,
            joints: Vec::new(),
            continuity: Continuity::C1,
            turns: Turns::Any,
            round_trip: 1e-12,
            least_share: 1.0,
            samples: 2000,
            seed: 0x0be1_7ede,
        }
    }

    /// Declares the continuity class of the map.
    pub fn continuity(mut self, continuity: Continuity) -> Self {
        self.continuity = continuity;
        self
    }

    /// Gives points where continuity must be measured.
    pub fn joints(mut self, joints: impl IntoIterator<Item = Joint>) -> Self {
        self.joints.extend(joints);
        self
    }

    /// States that the map depends on the vertical, so that it moves with rotations about the vertical only.
    pub fn upright(mut self) -> Self {
        self.turns = Turns::Upright;
        self
    }

    /// States that the map lies along the axes, so that it moves with shift and scale only.
    pub fn unturned(mut self) -> Self {
        self.turns = Turns::None;
        self
    }

    /// Sets the function that builds the map with strength zero.
    pub fn identity_at_zero_strength(mut self, zero: impl Fn() -> M + 'static) -> Self {
        self.zero = Some(Box::new(zero));
        self
    }

    /// Restricts round trips and orientation to points with `inside(map, p)`, at least `least_share` of the region.
    pub fn domain(mut self, least_share: f64, inside: impl Fn(&M, DVec3) -> bool + 'static) -> Self {
        self.domain = Box::new(inside);
        self.least_share = least_share;
        self
    }

    /// Allowed error of round trips, relative to the size of the scene (default 1e-12).
    pub fn round_trip_tolerance(mut self, relative: f64) -> Self {
        self.round_trip = relative;
        self
    }

    /// Number of random points (default 2000).
    pub fn samples(mut self, samples: usize) -> Self {
        self.samples = samples;
        self
    }

    /// Seed of the random points.
    pub fn seed(mut self, seed: u64) -> Self {
        self.seed = seed;
        self
    }

    fn map(&self) -> M {
        (self.make)(&Similarity::IDENTITY)
    }

    fn label(&self) -> String {
        format!("{} (seed {:#x})", self.name, self.seed)
    }

    /// Size of the coordinates, to which rounding errors are proportional.
    fn size(&self) -> f64 {
        let b = &self.region;
        (b.max - b.min).length().max(b.min.abs().max(b.max.abs()).max_element())
    }

    fn diagonal(&self) -> f64 {
        (self.region.max - self.region.min).length()
    }

    fn points_in_domain(&self, map: &M) -> Vec<DVec3> {
        let mut random = Random::new(self.seed);
        let all = (0..self.samples).map(|_| random.point(&self.region));
        let inside: Vec<DVec3> = all.filter(|&p| (self.domain)(map, p)).collect();
        let share = inside.len() as f64 / self.samples as f64;
        assert!(
            share >= self.least_share,
            "{}: only {share:.3} of the region is in the domain, {:.3} declared",
            self.label(),
            self.least_share
        );
        inside
    }
}

/// `invert(apply(p)) = p` and `apply(invert(q)) = q` on the domain.
///
/// # Panics
/// If the law is broken.
pub fn map_round_trips<M: SpaceMap>(case: &MapCase<M>) {
    let (map, tolerance) = (case.map(), case.round_trip * case.size());
    for p in case.points_in_domain(&map) {
        let q = map.apply(p).unwrap_or_else(|miss| panic!("{}: {p} is {miss:?}", case.label()));
        let back = map.invert(q).unwrap_or_else(|miss| panic!("{}: image {q} of {p} is {miss:?}", case.label()));
        let error = (back - p).length();
        assert!(error <= tolerance, "{}: {p} -> {q} -> {back}, off by {error:e} > {tolerance:e}", case.label());
        let again = map.apply(back).unwrap_or_else(|miss| panic!("{}: {back} is {miss:?}", case.label()));
        let error = (again - q).length();
        assert!(error <= tolerance, "{}: {q} -> {back} -> {again}, off by {error:e} > {tolerance:e}", case.label());
    }
}

/// `det J > 0` on the domain.
///
/// # Panics
/// If the law is broken.
pub fn map_keeps_orientation<M: SpaceMap>(case: &MapCase<M>) {
    let map = case.map();
    for p in case.points_in_domain(&map) {
        let j = map.jacobian(p).unwrap_or_else(|miss| panic!("{}: {p} is {miss:?}", case.label()));
        assert!(j.determinant() > 0.0, "{}: det J = {} at {p}", case.label(), j.determinant());
    }
}

/// `jacobian` agrees with central differences of `apply`, within the error estimated from two step widths.
///
/// # Panics
/// If the law is broken.
pub fn map_jacobian_matches_differences<M: SpaceMap>(case: &MapCase<M>) {
    let map = case.map();
    let step = 3e-5 * case.diagonal();
    let noise = 1e-15 * case.size() / step;
    let (mut checked, mut sharp) = (0, 0);
    for p in case.points_in_domain(&map) {
        let j = map.jacobian(p).unwrap_or_else(|miss| panic!("{}: {p} is {miss:?}", case.label()));
        let (Some(coarse), Some(fine)) = (difference(&map, p, step), difference(&map, p, 0.5 * step)) else { continue };
        let doubt = norm(coarse - fine);
        let error = norm(fine - j);
        let allowed = 2.0 * doubt + 50.0 * noise + 1e-10;
        assert!(error <= allowed, "{}: J at {p} is\n{j}, differences say\n{fine}, off by {error:e}", case.label());
        checked += 1;
        sharp += usize::from(allowed < 1e-5);
    }
    assert!(checked > 0 && sharp * 2 > checked, "{}: only {sharp} of {checked} comparisons are sharp", case.label());
}

fn difference<M: SpaceMap>(map: &M, p: DVec3, step: f64) -> Option<DMat3> {
    let column = |axis: DVec3| {
        let (ahead, behind) = (map.apply(p + step * axis).ok()?, map.apply(p - step * axis).ok()?);
        Some((ahead - behind) / (2.0 * step))
    };
    Some(DMat3::from_cols(column(DVec3::X)?, column(DVec3::Y)?, column(DVec3::Z)?))
}

fn norm(m: DMat3) -> f64 {
    m.to_cols_array().iter().map(|v| v * v).sum::<f64>().sqrt()
}

/// With strength zero the map does not move any point.
///
/// # Panics
/// If the law is broken, or if the case has no function for strength zero.
pub fn map_is_identity_at_zero_strength<M: SpaceMap>(case: &MapCase<M>) {
    let zero = case.zero.as_ref().unwrap_or_else(|| panic!("{}: no zero-strength map is given", case.label()));
    let (map, mut random) = (zero(), Random::new(case.seed));
    for _ in 0..case.samples {
        let p = random.point(&case.region);
        let Ok(q) = map.apply(p) else { continue };
        let error = (q - p).length();
        assert!(error <= 1e-15 * case.size(), "{}: at zero strength {p} -> {q}", case.label());
    }
}

/// Derivatives up to the declared order do not jump at the joints: their one-sided values converge as the step shrinks. The next
/// derivative jumps at some joint, so the declared class is not too low.
///
/// # Panics
/// If the law is broken, or if joints are missing for a map that is not smooth.
pub fn map_has_its_continuity<M: SpaceMap>(case: &MapCase<M>) {
    let map = case.map();
    if case.continuity == Continuity::Smooth {
        return;
    }
    assert!(!case.joints.is_empty(), "{}: no joints are given", case.label());
    let mut next_jumps = false;
    for joint in &case.joints {
        let across = joint.across.normalize();
        // Rounding of the point, propagated by the map, and of its image.
        let carried = map.jacobian(joint.point).map_or(1.0, norm) * joint.point.length();
        let coordinates = case.size() + carried + map.apply(joint.point).map_or(0.0, DVec3::length);
        for order in 0..=2 {
            let jump = |h: f64| one_sided_jump(&map, joint.point, across, h, order);
            let h = 1e-3 * case.diagonal();
            let (Some(coarse), Some(fine)) = (jump(h), jump(0.25 * h)) else {
                panic!("{}: joint {joint:?} is not inside the domain", case.label())
            };
            let noise = 4e-14 * coordinates / (0.25 * h).powi(order as i32);
            // A true jump remains when the step shrinks to a quarter; the remainder of a smooth function shrinks about fourfold.
            let vanishes = fine <= 0.5 * coarse + noise;
            if order <= case.continuity.order() {
                assert!(
                    vanishes,
                    "{}: derivative {order} jumps by {fine:e} ({coarse:e} at the wider step) at {joint:?}",
                    case.label()
                );
            } else if order == case.continuity.order() + 1 {
                next_jumps |= !vanishes;
            }
        }
    }
    let measurable = case.continuity < Continuity::C2;
    assert!(next_jumps || !measurable, "{}: smoother than declared ({:?})", case.label(), case.continuity);
}

/// Difference of the one-sided derivatives of `order` at `p` along `d`.
fn one_sided_jump<M: SpaceMap>(map: &M, p: DVec3, d: DVec3, h: f64, order: usize) -> Option<f64> {
    let side = |sign: f64| {
        let f = |k: f64| map.apply(p + sign * k * h * d).ok();
        // For the value itself, a point on either side; for derivatives, where the value is continuous, the joint.
        let (f0, f1, f2, f3) = (f(if order == 0 { 1e-9 } else { 0.0 })?, f(1.0)?, f(2.0)?, f(3.0)?);
        Some(match order {
            0 => f0,
            1 => sign * (-1.5 * f0 + 2.0 * f1 - 0.5 * f2) / h,
            _ => (2.0 * f0 - 5.0 * f1 + 4.0 * f2 - f3) / (h * h),
        })
    };
    let jump = (side(1.0)? - side(-1.0)?).length();
    // The two points that represent the joint itself are 2e-9 h apart.
    Some(if order == 0 { (jump - 1e-8 * h).max(0.0) } else { jump })
}

/// For no input does the map panic or return NaN or infinity.
///
/// # Panics
/// If the law is broken.
pub fn map_never_gives_nan<M: SpaceMap>(case: &MapCase<M>) {
    let map = case.map();
    let mut points = hostile_points();
    points.extend(case.region.corners());
    points.extend(case.joints.iter().map(|j| j.point));
    let mut random = Random::new(case.seed);
    for exponent in -3..12 {
        let reach = 10f64.powi(exponent) * case.diagonal();
        points.extend((0..50).map(|_| case.region.center() + reach * random.direction()));
    }
    for p in points {
        if let Ok(q) = map.apply(p) {
            assert!(q.is_finite(), "{}: apply({p}) = {q}", case.label());
        }
        if let Ok(q) = map.invert(p) {
            assert!(q.is_finite(), "{}: invert({p}) = {q}", case.label());
        }
        if let Ok(j) = map.jacobian(p) {
            assert!(j.is_finite(), "{}: jacobian({p}) = {j}", case.label());
        }
    }
}

/// Moving all parameters and the point moves the image in the same way: `make(s).apply(s(p)) = s(make(1).apply(p))`.
///
/// # Panics
/// If the law is broken.
pub fn map_moves_with_its_parameters<M: SpaceMap>(case: &MapCase<M>) {
    let (map, mut random) = (case.map(), Random::new(case.seed));
    let points = case.points_in_domain(&map);
    for _ in 0..8 {
        let mut s = Similarity::random(&mut random, 3.0 * case.diagonal(), case.turns == Turns::Upright);
        if case.turns == Turns::None {
            s.rotation = Similarity::IDENTITY.rotation;
        }
        let moved = (case.make)(&s);
        let tolerance = 1e3 * f64::EPSILON * (s.length(case.size()) + s.translation.length());
        for &p in points.iter().take(200) {
            let (Ok(a), Ok(b)) = (map.apply(p), moved.apply(s.point(p))) else {
                panic!("{}: {p} has an image only before or after moving by {s:?}", case.label())
            };
            let error = (s.point(a) - b).length();
            assert!(error <= tolerance, "{}: {p} moved by {s:?} is off by {error:e} > {tolerance:e}", case.label());
        }
    }
}
