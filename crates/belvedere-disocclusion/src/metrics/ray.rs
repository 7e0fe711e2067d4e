//! Lines of sight against the drawn surface, cell by cell.

use super::super::Field;
use super::super::visibility_qp::LinesOfSight;
use belvedere_core::DVec2;
use belvedere_core::grid::Grid;

/// Steps along a line inside a cell are at most this long, cells; the surface is bent only by the displacement.
const STEP: f64 = 0.25;

/// The displaced ground as it is drawn: two triangles per cell plus the bilinear displacement.
pub(super) struct Drawn<'a> {
    field: &'a Field,
    delta: &'a Grid,
    guard: f64,
    /// Nothing is higher than this.
    highest: f64,
}

/// Part of a chord over one cell.
struct Part {
    col: usize,
    row: usize,
    t: [f64; 2],
}

/// A place on a line of sight: grid coordinates and height.
pub(super) type Place = (DVec2, f64);

/// The ground that rises most over a line of sight.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Worst {
    /// By how much; any negative number if it is below the line everywhere, infinite if there is no line.
    pub(super) over: f64,
    /// Where, grid coordinates; the point itself where nothing rises over its line.
    pub(super) at: DVec2,
}

impl<'a> Drawn<'a> {
    pub(super) fn new(field: &'a Field, delta: &'a Grid, guard: f64) -> Self {
        let highest = field.datum() + field.relief() + delta.range()[1].max(0.0);
        Self { field, delta, guard, highest }
    }

    fn delta_at(&self, g: DVec2) -> f64 {
        self.delta.sample(self.field.scene_from_grid(g)).unwrap_or(0.0)
    }

    /// The line of sight of a point `lift` above the ground, from there to the eye; fewer than two places if there is none,
    /// `None` where there is no ground.
    pub(super) fn line(&self, g: DVec2, lift: f64, sight: &dyn LinesOfSight) -> Option<Vec<Place>> {
        let z = self.field.surface_at(g)? + self.delta_at(g) + lift;
        let mut line = Vec::new();
        sight.trace(g, z, &mut line);
        Some(line)
    }

    /// Largest height of the ground over a line of sight, beyond the guard; any negative number if it is below the line
    /// everywhere, infinite if there is no line.
    pub(super) fn excess(&self, line: &[Place]) -> f64 {
        self.worst(line).over
    }

    /// As [`Self::excess`], with its place.
    pub(super) fn worst(&self, line: &[Place]) -> Worst {
        let [(at, _), _, ..] = *line else { return Worst { over: f64::INFINITY, at: DVec2::ZERO } };
        let mut worst = Worst { over: -1.0, at };
        for pair in line.windows(2) {
            if let Some(from) = beyond(at, self.guard, pair[0], pair[1]) {
                self.excess_of(from, pair[1], &mut worst);
            }
        }
        worst
    }

    /// As [`Self::excess`], of the ground nearer than the guard; negative if there is no line.
    pub(super) fn near_excess(&self, line: &[Place]) -> f64 {
        let mut worst = Worst { over: -1.0, at: DVec2::ZERO };
        for pair in line.windows(2) {
            let leaves = beyond(line[0].0, self.guard, pair[0], pair[1]);
            if leaves != Some(pair[0]) {
                self.excess_of(pair[0], leaves.unwrap_or(pair[1]), &mut worst);
            }
            if leaves.is_some() {
                break;
            }
        }
        worst.over
    }

    /// The same over one chord, where that is more than `worst`.
    fn excess_of(&self, from: Place, to: Place, worst: &mut Worst) {
        let (g, dir) = (from.0, to.0 - from.0);
        let (z, dz) = (from.1, to.1 - from.1);
        let Some([mut t, last]) = self.clip(g, dir) else { return };
        let steps = [dir.x, dir.y].map(|d| if d == 0.0 { f64::INFINITY } else { 1.0 / d.abs() });
        // Enough to step over a border in spite of rounding.
        let nudge = 1e-9 * steps[0].min(steps[1]).min(1e9);
        while t < last {
            // Above everything, and rising from here.
            if dz >= 0.0 && z + t * dz > self.highest {
                break;
            }
            let ahead = g + (t + nudge) * dir;
            let col = (ahead.x.max(0.0) as usize).min(self.field.cols() - 2);
            let row = (ahead.y.max(0.0) as usize).min(self.field.rows() - 2);
            let border = |p: f64, d: f64, i: usize| match d {
                d if d > 0.0 => ((i + 1) as f64 - p) / d,
                d if d < 0.0 => (i as f64 - p) / d,
                _ => f64::INFINITY,
            };
            let leave = border(g.x, dir.x, col).min(border(g.y, dir.y, row)).max(t + nudge).min(last);
            self.excess_in(&Part { col, row, t: [t, leave] }, g, dir, (z, dz), worst);
            t = if leave > t { leave } else { last };
        }
    }

    /// Part of a chord over the grid.
    fn clip(&self, g: DVec2, dir: DVec2) -> Option<[f64; 2]> {
        let (mut from, mut to) = (0.0f64, 1.0f64);
        for (axis, nodes) in [self.field.cols(), self.field.rows()].into_iter().enumerate() {
            let (p, d, limit) = (g[axis], dir[axis], (nodes - 1) as f64);
            if d == 0.0 {
                if !(0.0..=limit).contains(&p) {
                    return None;
                }
                continue;
            }
            let (a, b) = (-p / d, (limit - p) / d);
            from = from.max(a.min(b));
            to = to.min(a.max(b));
        }
        (from < to).then_some([from, to])
    }

    /// The same over one cell.
    fn excess_in(&self, part: &Part, g: DVec2, dir: DVec2, (z, dz): (f64, f64), worst: &mut Worst) {
        let cols = self.field.cols();
        let nw = part.row * cols + part.col;
        let nodes = [nw, nw + 1, nw + cols, nw + cols + 1];
        let height = nodes.map(|i| self.field.heights()[i]);
        let void = nodes.map(|i| self.field.void()[i]);
        let top = height.into_iter().fold(f64::NEG_INFINITY, f64::max) + self.delta.range()[1].max(0.0);
        let low = (z + part.t[0] * dz).min(z + part.t[1] * dz);
        if top - low <= worst.over {
            return;
        }
        let corner = DVec2::new(part.col as f64, part.row as f64);
        let local = |t: f64| g + t * dir - corner;
        let across = dir.x - dir.y;
        let diagonal = (g.y - corner.y - (g.x - corner.x)) / across;
        let middle = if diagonal > part.t[0] && diagonal < part.t[1] { diagonal } else { part.t[1] };
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
                let at = g + t * dir;
                let over = height[0] + slope.dot(local(t)) + self.delta_at(at) - (z + t * dz);
                if over > worst.over {
                    *worst = Worst { over, at };
                }
            }
        }
    }
}

/// The start of the part of a chord that lies beyond `guard` cells of `p`.
fn beyond(p: DVec2, guard: f64, a: Place, b: Place) -> Option<Place> {
    if a.0.distance(p) >= guard {
        return Some(a);
    }
    let (d, f) = (b.0 - a.0, a.0 - p);
    // |f + t d| = guard, the crossing outwards.
    let (aa, bb, cc) = (d.length_squared(), f.dot(d), f.length_squared() - guard * guard);
    let t = (-bb + (bb * bb - aa * cc).max(0.0).sqrt()) / aa;
    (t.is_finite() && t <= 1.0).then(|| (a.0 + t * d, a.1 + t * (b.1 - a.1)))
}
