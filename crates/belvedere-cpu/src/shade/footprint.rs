//! Footprint of a pixel on the ground.

use belvedere_core::DVec2;

/// The longer side of a pixel's footprint is at most this many times its side on ground that faces the eye, since the derivatives of
/// slivers are not reliable.
pub(crate) const LONGEST: f64 = 24.0;

/// The part of the map that a pixel covers: an ellipse by its axes.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Footprint {
    /// Longer axis, scene units.
    pub(crate) major: DVec2,
    /// Length of the shorter axis, scene units.
    pub(crate) minor: f64,
}

impl Footprint {
    /// * `axes`: displacement on the map per pixel to the right and per pixel down, scene units;
    /// * `facing`: side of the square that the pixel would cover on ground that faces the eye, a lower bound, scene units.
    pub(crate) fn new([a, b]: [DVec2; 2], facing: f64) -> Self {
        // The ellipse that a circle on the image becomes: eigenvectors of the axes' matrix times its transpose.
        let (p, q, r) = (a.x * a.x + b.x * b.x, a.y * a.y + b.y * b.y, a.x * a.y + b.x * b.y);
        let spread = (0.25 * (p - q) * (p - q) + r * r).sqrt();
        let (long, short) = (0.5 * (p + q) + spread, 0.5 * (p + q) - spread);
        if !long.is_finite() {
            return Self { major: DVec2::X * facing, minor: facing };
        }
        let direction = if p > q { DVec2::new(long - q, r) } else { DVec2::new(r, long - p) };
        let length = long.sqrt().clamp(facing, LONGEST * facing);
        Self { major: direction.normalize_or(DVec2::X) * length, minor: short.max(0.0).sqrt().clamp(facing, length) }
    }

    /// Length of the longer axis.
    pub(crate) fn length(&self) -> f64 {
        self.major.length()
    }

    /// Width of the footprint along a unit vector, scene units.
    pub(crate) fn along(&self, direction: DVec2) -> f64 {
        let length = self.length();
        let (u, v) = (self.major.dot(direction), self.major.perp_dot(direction) / length * self.minor);
        (u * u + v * v).sqrt()
    }

    /// Number of squares, `most` at most, that cover the footprint side by side along the longer axis, and their side.
    pub(crate) fn samples(&self, most: usize) -> (usize, f64) {
        let n = ((self.length() / self.minor - 1e-6).ceil() as usize).clamp(1, most);
        (n, self.minor.max(self.length() / n as f64))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn axes_are_those_of_the_ellipse() {
        // A circle squeezed to 2 by 10 and turned, whatever the turn of the image.
        for turn in 0..20 {
            let (on_map, on_image) =
                (DVec2::from_angle(f64::from(turn) * 0.3), DVec2::from_angle(f64::from(turn) * 1.1));
            let to_map = |v: DVec2| on_map.rotate(v * DVec2::new(10.0, 2.0));
            let print = Footprint::new([to_map(on_image.rotate(DVec2::X)), to_map(on_image.rotate(DVec2::Y))], 1.0);
            assert!((print.length() - 10.0).abs() < 1e-9 && (print.minor - 2.0).abs() < 1e-9, "{print:?}");
            assert!(print.major.perp_dot(on_map).abs() < 1e-9);
            let wide = [on_map, on_map.perp(), (on_map + on_map.perp()).normalize()].map(|d| print.along(d));
            let want = [10.0, 2.0, 52f64.sqrt()];
            assert!(wide.iter().zip(want).all(|(a, b)| (a - b).abs() < 1e-9), "{wide:?}");
            let is = |(n, side): (usize, f64), want: (usize, f64)| n == want.0 && (side - want.1).abs() < 1e-9;
            assert!(is(print.samples(16), (5, 2.0)) && is(print.samples(2), (2, 5.0)), "{print:?}");
        }
    }

    #[test]
    fn nonsense_becomes_the_least_there_is() {
        for axes in [[DVec2::NAN; 2], [DVec2::ZERO; 2], [DVec2::X * 1e300; 2], [DVec2::X * 1e-300; 2]] {
            let print = Footprint::new(axes, 3.0);
            assert!(print.length() >= 2.999 && print.length() <= 73.0 && print.minor >= 2.999, "{axes:?}: {print:?}");
        }
    }
}
