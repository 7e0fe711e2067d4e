//! Eyes for the built-in scenes, from which a route is in the picture but mostly hidden.

use super::noise::DIRECTIONS;
use belvedere_core::{DVec2, DVec3};
use belvedere_scene::{BoxShape, Heightfield};
use belvedere_sight::clip_segment;
use rayon::prelude::*;

/// An eye and the point that it looks at, scene coordinates.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Viewpoint {
    pub(crate) eye: DVec3,
    pub(crate) look_at: DVec3,
}

/// Tangent of half the vertical field of view of 45 degrees.
const HALF_TAN: f64 = 0.414_213_562_373_095_05;
/// Width over height of the picture.
const ASPECT: f64 = 16.0 / 9.0;
/// Wanted visible share of the line.
const WANTED_SHARE: f64 = 0.36;

/// Share of `line` in the picture, and visible share of that.
fn shares(terrain: &Heightfield, boxes: &[BoxShape], line: &[DVec3], view: Viewpoint) -> (f64, f64) {
    let forward = (view.look_at - view.eye).normalize();
    let right = forward.cross(DVec3::Z).normalize();
    let up = right.cross(forward);
    let (mut inside, mut visible) = (0.0, 0.0);
    for p in line {
        let d = *p - view.eye;
        let depth = d.dot(forward);
        let framed = depth > 1.0
            && d.dot(right).abs() < 0.95 * depth * HALF_TAN * ASPECT
            && d.dot(up).abs() < 0.95 * depth * HALF_TAN;
        if framed {
            inside += 1.0;
            visible += f64::from(u8::from(sees(terrain, boxes, view.eye, *p + DVec3::Z * 2.0)));
        }
    }
    (inside / line.len().max(1) as f64, if inside > 0.0 { visible / inside } else { 0.0 })
}

fn sees(terrain: &Heightfield, boxes: &[BoxShape], eye: DVec3, p: DVec3) -> bool {
    let steps = (eye.truncate().distance(p.truncate()) / terrain.spacing().x).ceil().max(2.0) as usize;
    let clear = (1..steps).all(|k| {
        let q = eye.lerp(p, k as f64 / steps as f64);
        terrain.height_at(q.truncate()).is_none_or(|z| z < q.z)
    });
    clear && !boxes.iter().any(|b| crosses(b, eye, p))
}

/// Whether the segment enters an unrotated box.
fn crosses(b: &BoxShape, eye: DVec3, p: DVec3) -> bool {
    let half = DVec3::new(0.5 * b.size.x, 0.5 * b.size.y, 0.0);
    let (lo, hi) = (b.base - half, b.base + half + DVec3::Z * b.size.z);
    let [enter, leave] = clip_segment(eye.to_array(), (p - eye).to_array(), [lo.to_array(), hi.to_array()]);
    enter < leave
}

/// The best of a fixed set of viewpoints around the line: all of it in the picture, [`WANTED_SHARE`] of it visible, seen from
/// above. `above`: heights over the ground to try, in sides of the terrain; `tilt`: wanted fall over run of the line of sight. Boxes
/// must not be rotated.
pub(crate) fn best_viewpoint(
    terrain: &Heightfield,
    boxes: &[BoxShape],
    line: &[DVec3],
    above: &[f64],
    tilt: f64,
) -> Viewpoint {
    let samples: Vec<DVec3> = line.iter().copied().step_by((line.len() / 120).max(1)).collect();
    let bounds = terrain.bounds();
    let side = bounds.max.x - bounds.min.x;
    let relief = bounds.max.z - bounds.min.z;
    let centre = samples.iter().sum::<DVec3>() / samples.len().max(1) as f64;
    let mut tries = Vec::new();
    for direction in DIRECTIONS {
        for away in [0.3, 0.38, 0.46, 0.54] {
            for above in above {
                for aim in [0.0, 0.12] {
                    tries.push((direction, away * side, above * side, direction * (aim * side)));
                }
            }
        }
    }
    let rated: Vec<(f64, Viewpoint)> = tries
        .into_par_iter()
        .filter_map(|(direction, away, above, aim)| {
            let xy = centre.truncate() + direction * away;
            let (lo, hi) =
                (bounds.min.truncate() + DVec2::splat(0.02 * side), bounds.max.truncate() - DVec2::splat(0.02 * side));
            let at = xy.clamp(lo, hi);
            let eye = at.extend(terrain.height_at(at)? + above);
            let look_at = (centre.truncate() - aim).extend(centre.z);
            let view = Viewpoint { eye, look_at };
            let blocked =
                boxes.iter().any(|b| crosses(b, eye, eye + DVec3::Z) || crosses(b, eye, eye.lerp(look_at, 0.08)));
            let down = (eye.z - look_at.z) / eye.truncate().distance(look_at.truncate()).max(1.0);
            let (framed, visible) = shares(terrain, boxes, &samples, view);
            let tilt = (down - tilt).abs() + 0.2 * ((eye.z - bounds.min.z) / (relief + 0.05 * side) - 1.0).max(0.0);
            let rating = framed - 2.5 * (visible - WANTED_SHARE).abs() - 1.2 * tilt - f64::from(u8::from(blocked));
            Some((rating, view))
        })
        .collect();
    let fallback = Viewpoint { eye: centre + DVec3::new(0.0, -0.4, 0.2) * side, look_at: centre };
    rated.into_iter().fold((f64::NEG_INFINITY, fallback), |b, r| if r.0 > b.0 { r } else { b }).1
}
