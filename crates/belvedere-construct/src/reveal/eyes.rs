//! Candidate cameras around the features: each holds all of them, as large as its picture allows, or the middle of them larger.

use super::evaluate::Evaluator;
use super::options::RevealOptions;
use belvedere_core::{DVec2, DVec3, Pinhole, Projection};

/// Eyes are tried in this many directions.
const DIRECTIONS: usize = 24;
/// Pitches as shares of half the field of view: up to 0.9 the horizon lies in the picture, from steeper ones a bend brings it there.
const PITCHES: [f64; 5] = [0.65, 0.82, 1.0, 1.35, 1.8];
/// Fields of view as shares of the widest: through a narrow one, from farther away, all of a long feature is about as large, and data that
/// are hardly wider than it fill the picture.
const LENSES: [f64; 3] = [1.0, 0.75, 0.5];
/// Distances as shares of the one from which all features fit into the picture.
const DISTANCES: [f64; 4] = [1.0, 1.25, 0.8, 0.6];
/// Share of the half width and of the half height of the picture that the features take up where they fit.
const FITTED: DVec2 = DVec2::new(0.88, 0.72);
/// Most pixels that a grid cell among the features may take up: ground that is magnified more looks smeared.
const MOST_PER_CELL_PX: f64 = 8.0;

/// A camera to be evaluated, and its heading.
#[derive(Debug, Clone)]
pub(crate) struct Eye {
    pub(crate) pinhole: Pinhole,
    /// Heading in degrees clockwise from north: for spreading the choice.
    pub(crate) heading_deg: f64,
}

/// All cameras worth evaluating: eyes in a ring of directions, at several distances and pitches; the most usual distances and pitches first.
pub(crate) fn candidates(evaluator: &Evaluator<'_>, options: &RevealOptions) -> Vec<Eye> {
    let points: Vec<DVec3> = evaluator.samples.iter().map(|s| s.p_world).collect();
    let mut fits = Vec::new();
    for lens in LENSES {
        let fov_y = lens * options.fov_y;
        for pitch in PITCHES.map(|p| p * 0.5 * fov_y) {
            for direction in 0..DIRECTIONS {
                let heading = std::f64::consts::TAU * direction as f64 / DIRECTIONS as f64;
                let ahead = DVec3::new(heading.sin(), heading.cos(), 0.0);
                let forward = pitch.cos() * ahead - pitch.sin() * DVec3::Z;
                fits.extend(Fit::of(&points, forward, fov_y, options.image).map(|fit| (fit, fov_y, heading)));
            }
        }
    }
    let mut out = Vec::new();
    for share in DISTANCES {
        for (fit, fov_y, heading) in &fits {
            let eye = camera(evaluator, options, fit, (*fov_y, share));
            out.extend(eye.map(|pinhole| Eye { pinhole, heading_deg: heading.to_degrees() }));
        }
    }
    out
}

/// The nearest eye from which all points lie in the middle of the picture.
struct Fit {
    eye: DVec3,
    forward: DVec3,
    /// Distance from the eye to the middle of the points along `forward`.
    distance: f64,
}

impl Fit {
    /// In the axes of the camera every border of the picture is a plane through the eye, so that each pair of opposite borders bounds how
    /// far ahead the eye may be; the nearer bound holds.
    fn of(points: &[DVec3], forward: DVec3, fov_y: f64, image: [u32; 2]) -> Option<Self> {
        let [width, height] = image.map(f64::from);
        let right = forward.cross(DVec3::Z).normalize();
        let up = right.cross(forward);
        let tangent = FITTED * (0.5 * fov_y).tan() * DVec2::new(width / height, 1.0);
        let (mut least, mut most) = (DVec2::INFINITY, DVec2::NEG_INFINITY);
        let mut depths: Vec<f64> = Vec::with_capacity(points.len());
        for p in points {
            let (aside, z) = (DVec2::new(p.dot(right), p.dot(up)), p.dot(forward));
            most = most.max(aside - tangent * z);
            least = least.min(aside + tangent * z);
            depths.push(z);
        }
        depths.sort_by(f64::total_cmp);
        let middle = *depths.get(depths.len() / 2)?;
        let aside = 0.5 * (least + most);
        let z = (0.5 * (least - most) / tangent).min_element().min(*depths.first()?);
        let eye = aside.x * right + aside.y * up + z * forward;
        (eye.is_finite()).then_some(Self { eye, forward, distance: middle - z })
    }
}

/// A camera at a share of the fitted distance, if its eye lies near the terrain and clear of it.
fn camera(
    evaluator: &Evaluator<'_>,
    options: &RevealOptions,
    fit: &Fit,
    (fov_y, share): (f64, f64),
) -> Option<Pinhole> {
    let cell = evaluator.heightfield.spacing().max_element();
    let bounds = evaluator.heightfield.bounds();
    let extent = (bounds.max - bounds.min).truncate().max_element();
    let scale = 0.5 * f64::from(options.image[1]) / (0.5 * fov_y).tan();
    // Small features are looked at from where the grid still carries the picture.
    let least = (scale * cell / MOST_PER_CELL_PX).min(0.6 * extent).max(30.0 * cell);
    let distance = (share * fit.distance).max(least);
    let eye = fit.eye - (distance - fit.distance) * fit.forward;
    let outside = (eye - eye.clamp(bounds.min, bounds.max)).truncate().length();
    if outside > extent {
        return None;
    }
    let clearance = evaluator.obstacles.above_ground(eye).unwrap_or(f64::INFINITY);
    // Summits near the eye must not fill the picture: clear the highest ground around by a little.
    if clearance < (0.01 * distance).max(2.0 * cell) {
        return None;
    }
    let projection = Projection::Perspective { fov_y };
    Pinhole::look_at(eye, eye + distance * fit.forward, DVec3::Z, projection, options.image, 1.0, None).ok()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_fit_is_the_nearest_eye_that_holds_every_point() {
        let mut seed = 1u64;
        let mut random = || {
            seed = seed.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            (seed >> 40) as f64 / f64::from(1u32 << 24)
        };
        for case in 0..60 {
            let size = DVec3::new(1.0 + 9000.0 * random(), 1.0 + 9000.0 * random(), 2000.0 * random());
            let middle = DVec3::new(5e5, 5e6, 1000.0);
            let points: Vec<DVec3> =
                (0..40).map(|_| middle + size * (DVec3::new(random(), random(), random()) - 0.5)).collect();
            let (heading, pitch, fov_y) = (6.3 * random(), 0.1 + 0.4 * random(), 0.4 + 0.6 * random());
            let ahead = DVec3::new(heading.sin(), heading.cos(), 0.0);
            let forward = pitch.cos() * ahead - pitch.sin() * DVec3::Z;
            let fit = Fit::of(&points, forward, fov_y, [1280, 720]).unwrap();
            let lens = Projection::Perspective { fov_y };
            let look =
                |eye: DVec3| Pinhole::look_at(eye, eye + forward, DVec3::Z, lens, [1280, 720], 0.1, None).unwrap();
            let outermost = |camera: &Pinhole| {
                let off = points.iter().map(|p| {
                    let pixel = camera.project(*p).unwrap().0;
                    ((pixel - camera.center_px()) / camera.center_px()).abs() / FITTED
                });
                off.map(|o| o.max_element()).fold(0.0, f64::max)
            };
            let most = outermost(&look(fit.eye));
            assert!((most - 1.0).abs() < 1e-6, "case {case}: the outermost point lies at {most} of the margin");
        }
    }
}
