//! Shadows of boxes and triangles on a plane across the light, and tests of bundles of rays against them that are never wrongly negative.

use crate::beam::{Beam, LightAxes, Reach};
use belvedere_core::DVec3;

/// Rounding of single precision, with room.
const SINGLE: f64 = 4e-7;

/// The starts of a bundle of rays towards the sun.
#[derive(Debug, Clone, Copy)]
pub struct Bundle {
    /// Middle of the starts, scene coordinates.
    pub center: DVec3,
    /// The starts lie in the middle plus shares -1..=1 of these two.
    pub half: [DVec3; 2],
    /// Length of the longest ray along the light, scene units.
    pub length: f64,
}

/// A bundle along the axes of the light.
pub(crate) struct Rays {
    /// Middle of the starts.
    pub(crate) at: [f64; 3],
    /// Extent of the starts from there, widened.
    pub(crate) half: [f64; 3],
    /// The same by the two vectors of the bundle.
    halves: [[f64; 3]; 2],
    /// Place of the first start along the light.
    pub(crate) start: f64,
    spread: f64,
    slack: f64,
}

impl Rays {
    /// * `spread`: departure across the light per unit along it; `slack`: widening against rounding, scene units.
    #[inline]
    pub(crate) fn new(light: &LightAxes, bundle: &Bundle, spread: f64, slack: f64) -> Self {
        let at = light.place(bundle.center);
        let halves = bundle.half.map(|half| light.axes.map(|axis| half.dot(axis)));
        let half: [f64; 3] = std::array::from_fn(|k| halves[0][k].abs() + halves[1][k].abs() + slack);
        Self { at, half, halves, start: at[2] - half[2], spread, slack }
    }
}

/// What a solid covers of a plane across the light, and how far it reaches along it. All bounds are widened against rounding.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Shadow {
    low: [f32; 2],
    high: [f32; 2],
    /// Farthest place along the light.
    pub(crate) top: f32,
    /// Outward unit normals of the sides, and their distances from the origin; without direction where there is no side.
    sides: [[f32; 3]; 3],
    /// Place along the light on the plane of a triangle over the origin, and its change along both axes across; not finite for others.
    plane: [f64; 3],
}

impl Shadow {
    pub(crate) fn of_box(reach: &Reach, slack: f64) -> Self {
        Self {
            low: [0, 1].map(|k| ((reach.low[k] - slack) as f32).next_down()),
            high: [0, 1].map(|k| ((reach.high[k] + slack) as f32).next_up()),
            top: ((reach.high[2] + slack) as f32).next_up(),
            sides: [[0.0, 0.0, f32::INFINITY]; 3],
            plane: [f64::NAN; 3],
        }
    }

    /// * `corners`: along the axes of the light.
    pub(crate) fn of_triangle(corners: [[f64; 3]; 3], slack: f64) -> Self {
        let [a, b, c] = corners;
        let all = |pick: fn(f64, f64) -> f64| std::array::from_fn(|k| pick(pick(a[k], b[k]), c[k]));
        let mut out = Self::of_box(&Reach { low: all(f64::min), high: all(f64::max) }, slack);
        let [(bu, bv, bw), (cu, cv, cw)] = [b, c].map(|p| (p[0] - a[0], p[1] - a[1], p[2] - a[2]));
        let area = bu * cv - bv * cu;
        let size = (bu * bu + bv * bv).max(cu * cu + cv * cv);
        // A triangle that the light only grazes has no inner side.
        if !(area.abs() > 1e-6 * size) {
            return out;
        }
        let far = corners.iter().flat_map(|p| [p[0].abs(), p[1].abs()]).fold(0.0, f64::max);
        for (k, side) in out.sides.iter_mut().enumerate() {
            let (p, q) = (corners[k], corners[(k + 1) % 3]);
            let along = [q[0] - p[0], q[1] - p[1]].map(|d| area.signum() * d / (q[0] - p[0]).hypot(q[1] - p[1]));
            let distance = along[1] * p[0] - along[0] * p[1] + slack + SINGLE * far;
            *side = [along[1] as f32, -along[0] as f32, (distance as f32).next_up()];
        }
        let slope = [(bw * cv - cw * bv) / area, (cw * bu - bw * cu) / area];
        out.plane = [a[2] - slope[0] * a[0] - slope[1] * a[1], slope[0], slope[1]];
        out
    }

    /// Whether the shadow may come into a beam.
    pub(crate) fn is_in(&self, beam: &Beam) -> bool {
        let at = beam.section.map(|[from, to]| 0.5 * (from + to));
        self.covers(at, beam.section.map(|[from, to]| 0.5 * (to - from)))
    }

    /// Whether any ray of a bundle may meet the solid.
    #[inline]
    pub(crate) fn may_meet(&self, rays: &Rays) -> bool {
        let depart = rays.spread * (f64::from(self.top) - rays.start).max(0.0);
        self.covers([rays.at[0], rays.at[1]], [rays.half[0] + depart, rays.half[1] + depart]) && !self.is_behind(rays)
    }

    /// Whether it may cover a part of a rectangle across the light.
    #[inline]
    fn covers(&self, at: [f64; 2], half: [f64; 2]) -> bool {
        let is_near =
            |k: usize| f64::from(self.low[k]) <= at[k] + half[k] && f64::from(self.high[k]) >= at[k] - half[k];
        if !(is_near(0) && is_near(1)) {
            return false;
        }
        let far = SINGLE * (at[0].abs() + at[1].abs() + half[0] + half[1]);
        self.sides.iter().all(|side| {
            let [x, y, distance] = side.map(f64::from);
            x * at[0] + y * at[1] - x.abs() * half[0] - y.abs() * half[1] <= distance + far
        })
    }

    /// Whether all starts lie in front of the plane of a triangle, and all rays go away from it.
    #[inline]
    fn is_behind(&self, rays: &Rays) -> bool {
        let [place, u, v] = self.plane;
        let over = |p: [f64; 3]| p[2] - u * p[0] - v * p[1];
        let least = over(rays.at) - place - over(rays.halves[0]).abs() - over(rays.halves[1]).abs();
        let slopes = u.abs() + v.abs();
        rays.spread * slopes < 0.5 && least > rays.slack * (1.0 + slopes)
    }
}
