//! Laws of a [`View`].

use super::{Similarity, hostile_points};
use crate::Random;
use belvedere_core::{DVec2, DVec3, Miss, View};

/// A camera under test and the range in which it is tested.
pub struct CameraCase {
    name: String,
    make: Box<dyn Fn(&Similarity) -> View>,
    depth: [f64; 2],
    tolerance_px: f64,
    least_share: f64,
    overlapping: bool,
    upright: bool,
    samples: usize,
    seed: u64,
}

impl CameraCase {
    /// Makes a case. `make` builds the view with all its parameters moved by a similarity. Rays are followed over the range `depth`.
    ///
    /// Defaults: round trips to 1e-9 px, every ray is in the domain over the whole range, one image per point, any rotation allowed, 1000 rays.
    pub fn new(name: impl Into<String>, depth: [f64; 2], make: impl Fn(&Similarity) -> View + 'static) -> Self {
        Self {
            name: name.into(),
            make: Box::new(make),
            depth,
            tolerance_px: 1e-9,
            least_share: 1.0,
            overlapping: false,
            upright: false,
            samples: 1000,
            seed: 0x0ca3_e7a5,
        }
    }

    /// Allowed error of round trips, pixels (default 1e-9).
    pub fn tolerance_px(mut self, tolerance_px: f64) -> Self {
        self.tolerance_px = tolerance_px;
        self
    }

    /// Only this share of the samples has a world point (default 1).
    pub fn least_share(mut self, share: f64) -> Self {
        self.least_share = share;
        self
    }

    /// Allows points to be seen twice: the round trip must be among all images.
    pub fn overlapping(mut self) -> Self {
        self.overlapping = true;
        self
    }

    /// States that the view depends on the vertical, so that it moves with rotations about the vertical only.
    pub fn upright(mut self) -> Self {
        self.upright = true;
        self
    }

    /// Number of random rays (default 1000).
    pub fn samples(mut self, samples: usize) -> Self {
        self.samples = samples;
        self
    }

    /// Seed of the random rays.
    pub fn seed(mut self, seed: u64) -> Self {
        self.seed = seed;
        self
    }

    fn view(&self) -> View {
        (self.make)(&Similarity::IDENTITY)
    }

    fn label(&self) -> String {
        format!("{} (seed {:#x})", self.name, self.seed)
    }

    /// Random pixels, including the corners of the image.
    fn pixels(&self, view: &View) -> Vec<DVec2> {
        let [w, h] = view.pinhole().image.map(f64::from);
        let mut random = Random::new(self.seed);
        let corners = [DVec2::ZERO, DVec2::new(w, 0.0), DVec2::new(0.0, h), DVec2::new(w, h)];
        let inner = (0..self.samples).map(|_| DVec2::new(random.range(0.0, w), random.range(0.0, h)));
        corners.into_iter().chain(inner).collect()
    }

    /// Random pixels with a depth and the world point seen there.
    fn sightings(&self, view: &View) -> Vec<(DVec2, f64, DVec3)> {
        let mut random = Random::new(self.seed ^ 1);
        let pixels = self.pixels(view);
        let seen: Vec<_> = pixels
            .iter()
            .filter_map(|&px| {
                let depth = self.depth[0] * (self.depth[1] / self.depth[0]).powf(random.unit());
                Some((px, depth, view.ray(px).at(depth).ok()?.point))
            })
            .collect();
        let share = seen.len() as f64 / pixels.len() as f64;
        assert!(share >= self.least_share, "{}: only {share:.3} of the rays have a world point", self.label());
        seen
    }
}

/// `project(ray(px).at(d)) = (px, d)`.
///
/// # Panics
/// If the law is broken.
pub fn camera_round_trips(case: &CameraCase) {
    let view = case.view();
    for (px, depth, p) in case.sightings(&view) {
        let images = if case.overlapping { view.project_all(p) } else { view.project(p).into_iter().collect() };
        let error_px = images.iter().map(|i| (i.pixel - px).length()).fold(f64::INFINITY, f64::min);
        assert!(
            error_px <= case.tolerance_px,
            "{}: {px} at {depth} sees {p}, whose images are {images:?}, off by {error_px:e} px",
            case.label()
        );
        let error = images.iter().map(|i| (i.depth / depth - 1.0).abs()).fold(f64::INFINITY, f64::min);
        assert!(error <= 1e-11, "{}: {px} at {depth} sees {p}, depth off by {error:e} of itself", case.label());
        assert!(images.iter().any(|i| i.segment == view.ray(px).at(depth).map_or(u32::MAX, |r| r.segment)));
    }
}

/// Along a ray the points change without a jump, and the depth of their image increases.
///
/// # Panics
/// If the law is broken.
pub fn camera_depth_rises_along_rays(case: &CameraCase) {
    let view = case.view();
    let steps = 60;
    for &px in case.pixels(&view).iter().take(60) {
        let (ray, mut last): (_, Option<(f64, DVec3)>) = (view.ray(px), None);
        for i in 0..=steps {
            let depth = case.depth[0] + (case.depth[1] - case.depth[0]) * f64::from(i) / f64::from(steps);
            let Ok(at) = ray.at(depth) else { continue };
            assert_eq!(at.depth, depth, "{}", case.label());
            if let (Some((depth_before, before)), false) = (last, case.overlapping) {
                let seen = view.project(at.point).map_or(f64::NAN, |i| i.depth);
                assert!(seen > depth_before, "{}: depth {seen} after {depth_before} on ray {px}", case.label());
                assert!((at.point - before).length() > 0.0, "{}: ray {px} stands still at {depth}", case.label());
            }
            last = Some((depth, at.point));
        }
    }
}

/// `jacobian` agrees with central differences of `project`.
///
/// # Panics
/// If the law is broken.
pub fn camera_jacobian_matches_differences(case: &CameraCase) {
    let view = case.view();
    let (mut checked, mut sharp) = (0, 0);
    for (_, depth, p) in case.sightings(&view) {
        let (Ok(j), Ok(at)) = (view.jacobian(p), view.project(p)) else { continue };
        let difference = |h: f64| -> Result<[DVec3; 2], Miss> {
            let (mut x, mut y) = (DVec3::ZERO, DVec3::ZERO);
            for axis in [DVec3::X, DVec3::Y, DVec3::Z] {
                let (ahead, behind) = (view.project(p + h * axis)?, view.project(p - h * axis)?);
                if (ahead.pixel - behind.pixel).length() > 50.0 {
                    return Err(Miss::OutsideDomain); // crossed into the other cell of an overlap
                }
                let slope = (ahead.pixel - behind.pixel) / (2.0 * h);
                (x, y) = (x + slope.x * axis, y + slope.y * axis);
            }
            Ok([x, y])
        };
        let h = 3e-6 * depth;
        let (Ok(coarse), Ok(fine)) = (difference(h), difference(0.5 * h)) else { continue };
        let distance = |a: [DVec3; 2], b: [DVec3; 2]| ((a[0] - b[0]).length() + (a[1] - b[1]).length()) * depth;
        let size = distance(j, [DVec3::ZERO; 2]);
        let noise = 1e-15 * (p.length() + depth) / h * size;
        let allowed = 2.0 * distance(coarse, fine) + 50.0 * noise + 1e-9 * size;
        let error = distance(j, fine);
        let label = case.label();
        assert!(
            error <= allowed,
            "{label}: J at {p} ({at:?}) is {j:?}, differences say {fine:?}, {error:e} > {allowed:e}"
        );
        checked += 1;
        sharp += usize::from(allowed < 1e-4 * size);
    }
    assert!(checked > 0 && sharp * 2 > checked, "{}: only {sharp} of {checked} comparisons are sharp", case.label());
}

/// For no input does the camera panic or return NaN or infinity.
///
/// # Panics
/// If the law is broken.
pub fn camera_never_gives_nan(case: &CameraCase) {
    let view = case.view();
    let eye = view.pinhole().eye;
    let mut points = hostile_points();
    points.extend(hostile_points().into_iter().map(|p| p + eye));
    points.push(eye);
    let mut random = Random::new(case.seed);
    points.extend((0..2000).map(|i| eye + 10f64.powi(i % 12 - 3) * case.depth[0] * random.direction()));
    for p in points {
        for image in view.project(p).into_iter().chain(view.project_all(p)) {
            assert!(image.pixel.is_finite() && image.depth.is_finite(), "{}: {p} -> {image:?}", case.label());
            assert!(image.depth > 0.0, "{}: {p} -> {image:?}", case.label());
        }
        if let Ok([x, y]) = view.jacobian(p) {
            assert!(x.is_finite() && y.is_finite(), "{}: jacobian({p}) = {x}, {y}", case.label());
        }
    }
    let values = [0.0, 0.5, 1e9, -1e9, 1e300, f64::INFINITY, f64::NAN];
    for x in values {
        for y in values {
            for depth in [0.0, -1.0, 1e-300, 1.0, case.depth[0], case.depth[1], 1e30, 1e300, f64::INFINITY, f64::NAN] {
                if let Ok(at) = view.ray(DVec2::new(x, y)).at(depth) {
                    assert!(at.point.is_finite(), "{}: ray ({x}, {y}) at {depth} = {at:?}", case.label());
                }
            }
        }
    }
}

/// Moving the whole scene and all parameters does not change the picture except that depths are scaled.
///
/// # Panics
/// If the law is broken.
pub fn camera_moves_with_its_parameters(case: &CameraCase) {
    let (view, mut random) = (case.view(), Random::new(case.seed ^ 2));
    let sightings = case.sightings(&view);
    for _ in 0..8 {
        let s = Similarity::random(&mut random, 3.0 * case.depth[1], case.upright);
        let moved = (case.make)(&s);
        for &(px, depth, p) in sightings.iter().take(200) {
            let (Ok(a), Ok(b)) = (view.project(p), moved.project(s.point(p))) else {
                panic!("{}: {p} has an image only before or after moving by {s:?}", case.label())
            };
            if case.overlapping && a.segment != b.segment {
                continue;
            }
            // Coordinates far from the origin are rounded, which affects a near point most.
            let rounding =
                f64::EPSILON * (s.translation.length() + s.length(p.length())) / s.length(depth.min(a.depth));
            let tolerance_px = 1e5 * rounding * view.pinhole().scale_px() + case.tolerance_px;
            let error_px = (a.pixel - b.pixel).length();
            assert!(
                error_px <= tolerance_px,
                "{}: {p} (pixel {px}) moved by {s:?} is off by {error_px:e} px",
                case.label()
            );
            let error = (b.depth / s.length(a.depth) - 1.0).abs();
            assert!(error <= 1e5 * rounding + 1e-11, "{}: depth of {p} moved by {s:?} off by {error:e}", case.label());
        }
    }
}
