//! Candidate cameras around the features.

use super::evaluate::Evaluator;
use super::options::RevealOptions;
use belvedere_core::{DVec2, DVec3, Pinhole, Projection};

/// Eyes are tried in this many directions.
const DIRECTIONS: usize = 24;
/// Pitches as shares of half the field of view: the horizon stays in the upper part of the picture.
const PITCHES: [f64; 4] = [0.5, 0.65, 0.8, 1.0];
/// Distances as shares of the one from which all features fit in the width.
const DISTANCES: [f64; 4] = [1.12, 0.85, 0.62, 0.45];
/// Middle shares of the features that the picture is centred on: all of them, or the denser half.
const CORES: [f64; 2] = [0.98, 0.6];

/// A camera to be evaluated, and its heading.
#[derive(Debug, Clone)]
pub(crate) struct Eye {
    pub(crate) pinhole: Pinhole,
    /// Heading in degrees clockwise from north: for spreading the choice.
    pub(crate) heading_deg: f64,
}

/// All cameras worth evaluating: eyes in a ring of directions, at several distances and pitches.
pub(crate) fn candidates(evaluator: &Evaluator<'_>, options: &RevealOptions) -> Vec<Eye> {
    let points: Vec<(DVec2, f64)> = evaluator.samples.iter().map(|s| (s.p_world.truncate(), s.p_world.z)).collect();
    let mut out = Vec::new();
    for direction in 0..DIRECTIONS {
        let heading = std::f64::consts::TAU * direction as f64 / DIRECTIONS as f64;
        let forward = DVec2::new(heading.sin(), heading.cos());
        let right = DVec2::new(forward.y, -forward.x);
        for core in CORES {
            let Some(extent) = Extent::of(&points, forward, right, core) else { continue };
            for fov_y in [options.fov_y, 0.75 * options.fov_y] {
                for pitch in PITCHES.map(|p| p * 0.5 * fov_y) {
                    for share in DISTANCES {
                        let eye = camera(evaluator, options, &extent, [forward, right], (fov_y, pitch, share));
                        out.extend(eye.map(|pinhole| Eye { pinhole, heading_deg: heading.to_degrees() }));
                    }
                }
            }
        }
    }
    out
}

/// Extents of the features along and across a heading.
struct Extent {
    center: DVec2,
    z: f64,
    half_width: f64,
    half_depth: f64,
}

impl Extent {
    fn of(points: &[(DVec2, f64)], forward: DVec2, right: DVec2, core: f64) -> Option<Self> {
        let range = |axis: DVec2| {
            let mut along: Vec<f64> = points.iter().map(|p| p.0.dot(axis)).collect();
            along.sort_by(f64::total_cmp);
            let last = along.len().checked_sub(1)? as f64;
            let at = |q: f64| along[(q * last).round() as usize];
            Some((at(0.5 - 0.5 * core), at(0.5 + 0.5 * core)))
        };
        let ((f0, f1), (r0, r1)) = (range(forward)?, range(right)?);
        let mut heights: Vec<f64> = points.iter().map(|p| p.1).collect();
        heights.sort_by(f64::total_cmp);
        Some(Self {
            center: 0.5 * (f0 + f1) * forward + 0.5 * (r0 + r1) * right,
            z: heights[heights.len() / 2],
            half_width: 0.5 * (r1 - r0),
            half_depth: 0.5 * (f1 - f0),
        })
    }
}

/// A camera that looks at the middle of the extent, if its eye lies near the terrain and clear of it.
fn camera(
    evaluator: &Evaluator<'_>,
    options: &RevealOptions,
    extent: &Extent,
    [forward, _right]: [DVec2; 2],
    (fov_y, pitch, share): (f64, f64, f64),
) -> Option<Pinhole> {
    let [width, height] = options.image.map(f64::from);
    let half_tan_x = (0.5 * fov_y).tan() * width / height;
    let cell = evaluator.heightfield.spacing().max_element();
    // Wide enough for the width, and far enough that the depth of the features fits between the eye and the horizon.
    let wide = extent.half_width / half_tan_x + 0.4 * extent.half_depth;
    let distance = share * wide.max(1.5 * extent.half_depth).max(30.0 * cell);
    let target = extent.center.extend(extent.z);
    let eye = target - distance * pitch.cos() * forward.extend(0.0) + DVec3::Z * distance * pitch.sin();
    let bounds = evaluator.heightfield.bounds();
    let outside = (eye - eye.clamp(bounds.min, bounds.max)).truncate().length();
    if outside > 0.5 * (bounds.max - bounds.min).truncate().max_element() {
        return None;
    }
    let clearance = evaluator.obstacles.above_ground(eye).unwrap_or(f64::INFINITY);
    // Summits near the eye must not fill the picture: clear the highest ground around by a little.
    if clearance < (0.01 * distance).max(2.0 * cell) {
        return None;
    }
    let projection = Projection::Perspective { fov_y };
    Pinhole::look_at(eye, target, DVec3::Z, projection, options.image, 1.0, None).ok()
}
