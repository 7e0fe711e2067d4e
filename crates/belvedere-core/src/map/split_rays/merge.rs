//! Merge of the two sides of a seam: a last turn of each side towards one viewpoint.
//!
//! The rays of the seam's pixels form a plane on either side. Where the two planes cross, behind the occluder, both sides
//! bend towards the common viewpoint: from there on a ray of the seam is the same on both sides, so the picture is continuous
//! over the seam, and smooth within each side.

use super::{Fork, Merge, Seam, SplitRaysError, region::ImageRegion};
use crate::Pinhole;
use crate::map::curved_rays::{CurvedRays, Model, Pencil, Shape, Sharpness, TurnSpec};
use glam::{DVec2, DVec3};

/// Shares of the seam at which the sides are compared.
const SHARES: [f64; 5] = [0.0, 0.25, 0.5, 0.75, 1.0];
/// Largest distance, pixels, at which the two rays of a seam pixel count as meeting.
const LIMIT_PX: f64 = 0.5;
/// Largest factor by which the moved viewpoint comes nearer to its bend, or farther.
const FARTHEST: f64 = 64.0;

/// The fork with the merge as a last turn of each side.
///
/// The two rays of a pixel meet only if the seam is as long where it comes from the left as where it comes from the right: for that the
/// last viewpoint of the right side (of the left if that has no turn) moves along the ray of the seam's middle, which stays as it is.
///
/// * `turns`: all turns before the fork. `region`: the part of the image that the fork divides.
pub(super) fn resolve(
    root: &Pinhole,
    model: Model,
    turns: &[TurnSpec],
    fork: &Fork,
    merge: &Merge,
    region: &ImageRegion,
) -> Result<Fork, SplitRaysError> {
    if !(merge.reach > 0.0 && merge.reach.is_finite()) {
        return Err(SplitRaysError::Reach { reach: merge.reach });
    }
    for ((_, side), spec) in super::SIDES.into_iter().zip(&fork.sides) {
        if spec.fork.is_some() {
            return Err(SplitRaysError::ForkInMerge { side });
        }
    }
    let meeting = |fork: &Fork| {
        let ways = [0, 1].map(|side| turns.iter().chain(&fork.sides[side].turns).copied().collect::<Vec<_>>());
        Meeting::new(root, model, &ways, fork.seam, region)
    };
    let first = meeting(fork)?;
    let moved = |factor: f64| moved(fork, &first, factor);
    let factor = even(&|factor| meeting(&moved(factor)).map(|m| m.unevenness()), first.unevenness());
    let mut fork = moved(factor);
    let found = meeting(&fork)?;
    let off_px = found.off_px();
    if !(off_px <= LIMIT_PX) {
        return Err(SplitRaysError::UnevenMeeting { off_px, limit: LIMIT_PX });
    }
    for side in &mut fork.sides {
        side.turns.push(found.turn(merge));
    }
    Ok(Fork { merge: None, ..fork })
}

/// The fork with the last viewpoint of one side at `factor` times its distance from the bend of the seam's middle.
fn moved(fork: &Fork, first: &Meeting, factor: f64) -> Fork {
    let mut fork = fork.clone();
    for side in [1, 0] {
        if let (Some(turn), Some(bend)) = (fork.sides[side].turns.last_mut(), first.bends[side]) {
            turn.viewpoint = bend + factor * (turn.viewpoint - bend);
            break;
        }
    }
    fork
}

/// The factor, nearest to 1, at which `unevenness` changes its sign; 1 where it never does.
fn even(unevenness: &dyn Fn(f64) -> Result<f64, SplitRaysError>, at_one: f64) -> f64 {
    if at_one.abs() < 1e-13 {
        return 1.0;
    }
    let other_side = |factor: f64| unevenness(factor).is_ok_and(|u| (u < 0.0) != (at_one < 0.0));
    let steps = 48;
    for step in 1..=steps {
        let at = |i: i32| FARTHEST.powf(f64::from(i) / f64::from(steps));
        for (mut inner, mut outer) in [(at(step - 1), at(step)), (1.0 / at(step - 1), 1.0 / at(step))] {
            if other_side(outer) {
                for _ in 0..60 {
                    let middle = 0.5 * (inner + outer);
                    if other_side(middle) { outer = middle } else { inner = middle }
                }
                return outer;
            }
        }
    }
    1.0
}

/// Where the seam's rays of each side cross the plane of the other side's rays.
struct Meeting {
    /// Per side, where the ray of the seam's middle meets t1 of the last turn; `None` without turns.
    bends: [Option<DVec3>; 2],
    /// Length of the seam in the picture, pixels.
    length_px: f64,
    /// Per side, the crossings at [`SHARES`] of the seam.
    met: [Vec<DVec3>; 2],
}

impl Meeting {
    fn new(
        root: &Pinhole,
        model: Model,
        ways: &[Vec<TurnSpec>; 2],
        seam: Seam,
        region: &ImageRegion,
    ) -> Result<Self, SplitRaysError> {
        let ends = seam.edge(root.image).and_then(|edge| edge.ends(region.corners()));
        let [from, to] = ends.ok_or(SplitRaysError::SeamPoints { from: seam.from, to: seam.to })?;
        let (mut sides, mut bends) = (Vec::with_capacity(2), [None; 2]);
        for ((way, (_, name)), bend) in ways.iter().zip(super::SIDES).zip(&mut bends) {
            let rays = CurvedRays::within(root, model, way, &[from, to])
                .map_err(|error| SplitRaysError::Turn { side: name.into(), error })?;
            let middle = last_line(&rays, from.midpoint(to)).along;
            *bend = rays.turns().last().map(|turn| turn.viewpoint + middle / turn.h.along(middle));
            sides.push(SHARES.map(|share| last_line(&rays, from.lerp(to, share))));
        }
        let normal = |lines: &[Line; 5]| lines[0].along.cross(lines[4].along).normalize_or_zero();
        let normals = [normal(&sides[0]), normal(&sides[1])];
        let cross = |side: usize| {
            let (plane, normal) = (sides[1 - side][2].from, normals[1 - side]);
            sides[side].iter().map(|line| line.meets(plane, normal)).collect::<Option<Vec<_>>>()
        };
        match (cross(0), cross(1)) {
            (Some(left), Some(right)) => Ok(Self { bends, length_px: from.distance(to), met: [left, right] }),
            _ => Err(SplitRaysError::NoMeeting { apart_deg: normals[0].angle_between(normals[1]).to_degrees() }),
        }
    }

    /// Logarithm of the seam's length where it comes from the left over its length from the right; 0 if even.
    fn unevenness(&self) -> f64 {
        let length = |met: &[DVec3]| met[0].distance(met[4]);
        (length(&self.met[0]) / length(&self.met[1])).ln()
    }

    /// Largest distance between the two crossings of one pixel, as pixels along the seam.
    fn off_px(&self) -> f64 {
        let [left, right] = &self.met;
        let off = left.iter().zip(right).map(|(l, r)| l.distance(*r)).fold(0.0, f64::max);
        off / left[0].distance(left[4]) * self.length_px
    }

    fn turn(&self, merge: &Merge) -> TurnSpec {
        let [left, right] = &self.met;
        let middle = left[2].midpoint(right[2]);
        let normal = (middle - merge.viewpoint).reject_from(left[4] - left[0]).normalize_or_zero();
        TurnSpec {
            viewpoint: merge.viewpoint,
            t0: middle - merge.reach * normal,
            t1: middle,
            t2: middle + merge.reach * normal,
            pencil: Pencil::Parallel { normal },
            m: Sharpness::Bend,
        }
    }
}

/// The last straight part of a ray.
#[derive(Debug, Clone, Copy)]
struct Line {
    from: DVec3,
    along: DVec3,
}

impl Line {
    /// Point where it crosses a plane ahead.
    fn meets(&self, point: DVec3, normal: DVec3) -> Option<DVec3> {
        let t = (point - self.from).dot(normal) / self.along.dot(normal);
        (t > 0.0 && t.is_finite()).then(|| self.from + t * self.along)
    }
}

/// The last straight part of the ray of a pixel for which the chain is valid.
fn last_line(rays: &CurvedRays, pixel: DVec2) -> Line {
    let v = rays.root().unproject(pixel, 1.0) - rays.root().eye;
    match rays.pieces(v).ok().and_then(|pieces| pieces.last().cloned()).map(|piece| piece.shape) {
        Some(Shape::Line { from, per_depth }) => Line { from, along: per_depth },
        _ => Line { from: DVec3::NAN, along: DVec3::NAN },
    }
}
