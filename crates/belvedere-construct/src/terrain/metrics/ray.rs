//! Straight rays against the drawn surface, cell by cell.

use super::super::Field;
use belvedere_core::grid::Grid;
use belvedere_core::{DVec2, DVec3};

/// Steps along a ray inside a cell are at most this long, cells; the surface is bent only by the displacement.
const STEP: f64 = 0.25;

/// The displaced ground as it is drawn, seen from the eye.
pub(super) struct Drawn<'a> {
    field: &'a Field,
    delta: &'a Grid,
    eye: DVec2,
    eye_z: f64,
    guard: f64,
    /// Nothing is higher than this.
    highest: f64,
}

/// Part of a ray over one cell.
struct Part {
    col: usize,
    row: usize,
    t: [f64; 2],
}

impl<'a> Drawn<'a> {
    pub(super) fn new(field: &'a Field, delta: &'a Grid, eye: DVec3, guard: f64) -> Self {
        let highest = field.datum() + field.relief() + delta.range()[1].max(0.0);
        Self { field, delta, eye: field.grid_from_scene(eye.truncate()), eye_z: eye.z, guard, highest }
    }

    fn delta_at(&self, g: DVec2) -> f64 {
        self.delta.sample(self.field.scene_from_grid(g)).unwrap_or(0.0)
    }

    /// Largest height of the ground over the ray from a point `lift` above it to the eye, beyond the guard; any negative
    /// number if it is below the ray everywhere; `None` where there is no ground.
    pub(super) fn excess(&self, g: DVec2, lift: f64) -> Option<f64> {
        let z = self.field.surface_at(g)? + self.delta_at(g) + lift;
        let (dir, dz) = (self.eye - g, self.eye_z - z);
        let length = dir.length();
        let mut worst = -1.0f64;
        if length <= self.guard {
            return Some(worst);
        }
        let mut t = self.guard / length;
        let steps = [dir.x, dir.y].map(|d| if d == 0.0 { f64::INFINITY } else { 1.0 / d.abs() });
        while t < 1.0 {
            // Above everything, and rising from here.
            if dz >= 0.0 && z + t * dz > self.highest {
                break;
            }
            // The cell just ahead.
            let ahead = g + (t + 1e-9 * steps[0].min(steps[1])) * dir;
            let Some((col, row)) = self.cell(ahead) else {
                t = self.enter(g, dir, t);
                continue;
            };
            let border = |p: f64, d: f64, i: usize| match d {
                d if d > 0.0 => ((i + 1) as f64 - p) / d,
                d if d < 0.0 => (i as f64 - p) / d,
                _ => f64::INFINITY,
            };
            let leave = border(g.x, dir.x, col).min(border(g.y, dir.y, row)).min(1.0);
            let leave = leave.max(t + 1e-9 * steps[0].min(steps[1]));
            let part = Part { col, row, t: [t, leave.min(1.0)] };
            worst = worst.max(self.excess_in(&part, g, dir, (z, dz), worst));
            t = leave;
        }
        Some(worst)
    }

    fn cell(&self, g: DVec2) -> Option<(usize, usize)> {
        let inside =
            g.x >= 0.0 && g.y >= 0.0 && g.x <= (self.field.cols() - 1) as f64 && g.y <= (self.field.rows() - 1) as f64;
        inside.then(|| ((g.x as usize).min(self.field.cols() - 2), (g.y as usize).min(self.field.rows() - 2)))
    }

    /// The ray has left the grid, which is convex: it does not come back, unless it only started beside it.
    fn enter(&self, g: DVec2, dir: DVec2, t: f64) -> f64 {
        let last = DVec2::new((self.field.cols() - 1) as f64, (self.field.rows() - 1) as f64);
        let p = g + t * dir;
        let slack = 1e-6;
        let outside = p.x < -slack || p.y < -slack || p.x > last.x + slack || p.y > last.y + slack;
        // On the rim by rounding: a little further.
        if outside { 1.0 } else { t + 1e-6 / dir.length() }
    }

    /// The same over one cell; anything not above `least` may come back as that.
    fn excess_in(&self, part: &Part, g: DVec2, dir: DVec2, (z, dz): (f64, f64), least: f64) -> f64 {
        let cols = self.field.cols();
        let nw = part.row * cols + part.col;
        let nodes = [nw, nw + 1, nw + cols, nw + cols + 1];
        let height = nodes.map(|i| self.field.heights()[i]);
        let void = nodes.map(|i| self.field.void()[i]);
        let top = height.into_iter().fold(f64::NEG_INFINITY, f64::max) + self.delta.range()[1].max(0.0);
        let low = (z + part.t[0] * dz).min(z + part.t[1] * dz);
        if top - low <= least {
            return least;
        }
        let corner = DVec2::new(part.col as f64, part.row as f64);
        let local = |t: f64| g + t * dir - corner;
        let across = dir.x - dir.y;
        let diagonal = (g.y - corner.y - (g.x - corner.x)) / across;
        let middle = if diagonal > part.t[0] && diagonal < part.t[1] { diagonal } else { part.t[1] };
        let mut worst = least;
        for [from, to] in [[part.t[0], middle], [middle, part.t[1]]] {
            if to <= from {
                continue;
            }
            let m = local(0.5 * (from + to));
            // North-east of the diagonal: north-west, north-east, south-east; else the south-west instead.
            let upper = m.x >= m.y;
            let hole = void[0] || void[3] || void[if upper { 1 } else { 2 }];
            if hole {
                continue;
            }
            let slope = if upper {
                DVec2::new(height[1] - height[0], height[3] - height[1])
            } else {
                DVec2::new(height[3] - height[2], height[2] - height[0])
            };
            let count = ((to - from) * dir.length() / STEP).ceil().max(1.0) as usize;
            for k in 0..=count {
                let t = from + (to - from) * k as f64 / count as f64;
                let ground = height[0] + slope.dot(local(t)) + self.delta_at(g + t * dir);
                worst = worst.max(ground - (z + t * dz));
            }
        }
        worst
    }
}
