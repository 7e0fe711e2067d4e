//! Candidate cameras around the features: each holds all of them, as large as its picture allows, or the middle of them larger.

use super::evaluate::Evaluator;
use super::options::RevealOptions;
use belvedere_core::{DVec2, DVec3, Pinhole, Projection};

/// Eyes are tried in this many directions.
const DIRECTIONS: usize = 24;
/// Pitches as shares of half the field of view, and where the features lie in the picture: up to 1 the horizon lies in it and the features
/// below, from steeper ones a bend brings it there.
const PITCHES: [(f64, Window); 8] =
    [(0.7, LOW), (0.85, LOW), (0.55, LOW), (1.0, LOW), (0.6, LOWEST), (0.35, LOWEST), (1.35, MIDDLE), (1.8, MIDDLE)];
/// Fields of view as shares of the widest: through a narrow one, from farther away, all of a long feature is about as large, and data that
/// are hardly wider than it fill the picture.
const LENSES: [f64; 4] = [1.0, 0.82, 0.61, 0.41];
/// Distances as shares of the one from which all features fit into their window: from farther away steep ground is seen under one angle.
const DISTANCES: [f64; 5] = [1.0, 1.25, 0.8, 1.7, 2.6];
/// Share from which on a view is worth trying only where it looks down.
const FAR: f64 = 2.0;
/// Where features lie that fit into a picture, shares of its half width and half height.
#[derive(Debug, Clone, Copy)]
struct Window {
    aside: f64,
    /// Lower and upper border, from the middle upwards.
    up: [f64; 2],
}

/// In the lower two thirds, under ground that leads to a horizon, and a sky.
const LOW: Window = Window { aside: 0.74, up: [-0.84, 0.42] };
/// At the foot of the picture, under mountains that stand high over them, and a sky.
const LOWEST: Window = Window { aside: 0.74, up: [-0.86, -0.3] };
/// Around the middle.
const MIDDLE: Window = Window { aside: 0.74, up: [-0.72, 0.72] };
/// Most pixels of the reference picture that a grid cell among the features may take up: nearer, a few smooth humps fill the picture.
pub(super) const MOST_PER_CELL_PX: f64 = 90.0;
/// Least distance of the eye from the features, cells.
const NEAREST_CELLS: f64 = 8.0;

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
        for (pitch, window) in PITCHES.map(|(p, window)| (p * 0.5 * fov_y, window)) {
            for direction in 0..DIRECTIONS {
                let heading = std::f64::consts::TAU * direction as f64 / DIRECTIONS as f64;
                let ahead = DVec3::new(heading.sin(), heading.cos(), 0.0);
                let forward = pitch.cos() * ahead - pitch.sin() * DVec3::Z;
                let fit = Fit::of(&points, forward, (fov_y, window), options.reference());
                fits.extend(fit.map(|fit| (fit, fov_y, heading, pitch > 0.5 * fov_y)));
            }
        }
    }
    let mut out = Vec::new();
    for share in DISTANCES {
        for (fit, fov_y, heading, _) in fits.iter().filter(|(.., looks_down)| share < FAR || *looks_down) {
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
    /// The middle of the window at the median depth of the points.
    target: DVec3,
    /// Distance from the eye to it along `forward`.
    distance: f64,
}

impl Fit {
    /// In the axes of the camera every border of the picture is a plane through the eye, so that each pair of opposite borders bounds how
    /// far ahead the eye may be; the nearer bound holds.
    fn of(points: &[DVec3], forward: DVec3, (fov_y, window): (f64, Window), image: [u32; 2]) -> Option<Self> {
        let [width, height] = image.map(f64::from);
        let right = forward.cross(DVec3::Z).normalize();
        let up = right.cross(forward);
        let half = (0.5 * fov_y).tan();
        let aside = half * window.aside * width / height;
        let [low, high] = window.up.map(|up| half * up);
        let (lower, upper) = (DVec2::new(-aside, low), DVec2::new(aside, high));
        let (mut least, mut most) = (DVec2::INFINITY, DVec2::NEG_INFINITY);
        let mut depths: Vec<f64> = Vec::with_capacity(points.len());
        for p in points {
            let (aside, z) = (DVec2::new(p.dot(right), p.dot(up)), p.dot(forward));
            most = most.max(aside - upper * z);
            least = least.min(aside - lower * z);
            depths.push(z);
        }
        depths.sort_by(f64::total_cmp);
        let middle = *depths.get(depths.len() / 2)?;
        let z = ((least - most) / (upper - lower)).min_element().min(*depths.first()?);
        let aside = 0.5 * ((least + lower * z) + (most + upper * z));
        let eye = aside.x * right + aside.y * up + z * forward;
        let distance = middle - z;
        let target = eye + distance * (forward + 0.5 * (low + high) * up);
        (eye.is_finite()).then_some(Self { eye, forward, target, distance })
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
    let image = options.reference();
    let scale = 0.5 * f64::from(image[1]) / (0.5 * fov_y).tan();
    // Small features are looked at from where the grid still carries the picture.
    let least = (scale * cell / MOST_PER_CELL_PX).min(0.6 * extent).max(NEAREST_CELLS * cell);
    let distance = (share * fit.distance).max(least);
    let eye = fit.target + (distance / fit.distance) * (fit.eye - fit.target);
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
    Pinhole::look_at(eye, eye + distance * fit.forward, DVec3::Z, projection, image, 1.0, None).ok()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_fit_is_the_nearest_eye_that_holds_every_point_in_its_window() {
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
            let window = [LOW, MIDDLE][case % 2];
            let ahead = DVec3::new(heading.sin(), heading.cos(), 0.0);
            let forward = pitch.cos() * ahead - pitch.sin() * DVec3::Z;
            let fit = Fit::of(&points, forward, (fov_y, window), [1280, 720]).unwrap();
            let lens = Projection::Perspective { fov_y };
            let camera = Pinhole::look_at(fit.eye, fit.eye + forward, DVec3::Z, lens, [1280, 720], 0.1, None).unwrap();
            // Places in the window, -1..=1 to the right and upwards.
            let [low, high] = window.up;
            let places = points.iter().map(|p| {
                let at = (camera.project(*p).unwrap().0 - camera.center_px()) / camera.center_px();
                DVec2::new(at.x / window.aside, (-at.y - 0.5 * (low + high)) / (0.5 * (high - low)))
            });
            let most = places.map(|at| at.abs().max_element()).fold(0.0, f64::max);
            assert!((most - 1.0).abs() < 1e-6, "case {case}: the outermost point lies at {most} of the window");
        }
    }
}
