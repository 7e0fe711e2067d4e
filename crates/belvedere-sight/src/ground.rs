//! Lines of sight over terrain: the largest heights of ever larger blocks let a straight line skip what it clears.

use belvedere_core::{Aabb, DVec2, DVec3};
use belvedere_scene::{Heightfield, NodeState};

/// A heightfield with the largest height of every block of 2^k x 2^k cells (the "maximum mipmap" of Tevs et al. 2008).
pub struct Ground<'a> {
    heightfield: &'a Heightfield,
    levels: Vec<Level>,
}

struct Level {
    cols: usize,
    rows: usize,
    max: Vec<f32>,
    /// Empty unless the pyramid was built with [`Ground::lifted`].
    min: Vec<f32>,
}

/// Range of a vertical displacement over the rectangle between two corners (smallest and largest x, y), scene units.
pub type Lift<'a> = &'a (dyn Fn(DVec2, DVec2) -> [f64; 2] + Sync);

impl<'a> Ground<'a> {
    /// Builds the pyramid: one pass over the nodes, a third more memory than the heights.
    pub fn new(heightfield: &'a Heightfield) -> Self {
        let mut levels = vec![finest(heightfield)];
        while let Some(last) = levels.last()
            && (last.cols > 1 || last.rows > 1)
        {
            let next = coarser(last);
            levels.push(next);
        }
        Self { heightfield, levels }
    }

    /// The pyramid with the smallest heights as well, for rays that may also come from below; `lift` is a vertical
    /// displacement of the surface that the blocks must allow for.
    pub fn lifted(heightfield: &'a Heightfield, lift: Option<Lift<'_>>) -> Self {
        let mut out = Self::new(heightfield);
        let cols = out.levels[0].cols;
        let mut min = lowest(heightfield);
        if let Some(lift) = lift {
            for (i, (min, max)) in min.iter_mut().zip(&mut out.levels[0].max).enumerate() {
                let (nw, se) =
                    (heightfield.node_xy(i % cols, i / cols), heightfield.node_xy(i % cols + 1, i / cols + 1));
                let [lo, hi] = lift(DVec2::new(nw.x, se.y), DVec2::new(se.x, nw.y));
                *min = ((f64::from(*min) + lo) as f32).next_down();
                *max = ((f64::from(*max) + hi) as f32).next_up();
            }
        }
        out.levels[0].min = min;
        for k in 1..out.levels.len() {
            let (fine, coarse) = out.levels.split_at_mut(k);
            let next = coarser(&fine[k - 1]);
            coarse[0] = next;
        }
        out
    }

    /// The heights themselves.
    pub fn heightfield(&self) -> &'a Heightfield {
        self.heightfield
    }

    /// Smallest height of the straight segment `a b` over the drawn surface, metres; negative = under ground.
    ///
    /// Exact for the two triangles per cell of [`Heightfield::surface_in_cell`]. Answers `cap` if the segment never
    /// comes closer than that (or never lies over the terrain), and returns early, with any value below `floor`,
    /// once the height is less than `floor`.
    pub fn min_gap(&self, a: DVec3, b: DVec3, cap: f64, floor: f64) -> f64 {
        let (ga, gb) = (self.heightfield.grid_from_scene(a.truncate()), self.heightfield.grid_from_scene(b.truncate()));
        let Some((t_in, t_out)) = self.clip(ga, gb) else { return cap };
        let line = Line { start: ga, dir: gb - ga, z: a.z, dz: b.z - a.z };
        // Small enough to be nothing, large enough to step over a cell border in f64.
        let nudge = 1e-10;
        let top = self.levels.len() - 1;
        let (mut t, mut level, mut best) = (t_in, top.min(3), cap);
        while t <= t_out {
            let (block, exit) = line.block(&self.levels[level], level, t + nudge, t_out);
            let z_min = (line.z + t * line.dz).min(line.z + exit * line.dz);
            let clear = z_min - f64::from(self.levels[level].max[block.1 * self.levels[level].cols + block.0]) >= best;
            if !clear && level > 0 {
                level -= 1;
                continue;
            }
            if clear {
                level = (level + 1).min(top);
            } else {
                best = best.min(self.gap_in_cell(&line, block, t, exit));
                if best < floor {
                    return best;
                }
            }
            t = exit.max(t + nudge);
        }
        best
    }

    /// Whether the straight segment `a b` stays on or above the drawn surface.
    pub fn sees(&self, a: DVec3, b: DVec3) -> bool {
        self.min_gap(a, b, 0.0, 0.0) >= 0.0
    }

    /// Whether every curve within `reach` (scene units, >= 0) of the straight segment `a b`, point by point, passes the
    /// surface of [`Ground::lifted`] without touching it. Never wrongly true; false also where blocks as small as
    /// `reach` cannot tell.
    pub fn is_clear(&self, a: DVec3, b: DVec3, reach: f64) -> bool {
        let spacing = self.heightfield.spacing().min_element();
        let finest = (0..self.levels.len()).find(|&k| (1usize << k) as f64 * spacing >= reach);
        let finest = finest.unwrap_or(self.levels.len() - 1);
        let mut clear = true;
        self.descend(a, b, reach, finest, &mut |_, _, _| {
            clear = false;
            false
        });
        clear
    }

    /// Whether a box lies beside the surface of [`Ground::lifted`], above all of it or below all of it. Never wrongly true.
    pub fn is_off(&self, bounds: &Aabb) -> bool {
        let hf = self.heightfield;
        let (g, h) = (hf.grid_from_scene(bounds.min.truncate()), hf.grid_from_scene(bounds.max.truncate()));
        let (lo, hi) = (g.min(h), g.max(h));
        let last = DVec2::new((hf.cols() - 1) as f64, (hf.rows() - 1) as f64);
        if hi.cmplt(DVec2::ZERO).any() || lo.cmpgt(last).any() {
            return true;
        }
        let (lo, hi) = (lo.max(DVec2::ZERO), hi.min(last));
        let extent = (hi - lo).max_element();
        let level =
            (0..self.levels.len()).find(|&k| (1usize << k) as f64 * 2.0 >= extent).unwrap_or(self.levels.len() - 1);
        let of = &self.levels[level];
        let index = |x: f64, n: usize| ((x as usize) >> level).min(n - 1);
        let mut clear = true;
        for row in index(lo.y, of.rows)..=index(hi.y, of.rows) {
            for col in index(lo.x, of.cols)..=index(hi.x, of.cols) {
                let [low, high] = of.range((col, row), false);
                clear &= bounds.min.z > f64::from(high) || bounds.max.z < f64::from(low);
            }
        }
        clear
    }

    /// Visits, from `a` to `b`, the cells in which the straight segment comes within `reach` of the heights of the
    /// surface of [`Ground::lifted`], with the parameters (0 at `a`, 1 at `b`) of its part over the cell; until
    /// `visit` says false.
    pub fn walk(&self, a: DVec3, b: DVec3, reach: f64, visit: &mut dyn FnMut([usize; 2], f64, f64) -> bool) {
        self.descend(a, b, reach, 0, visit);
    }

    fn descend(
        &self,
        a: DVec3,
        b: DVec3,
        reach: f64,
        finest: usize,
        visit: &mut dyn FnMut([usize; 2], f64, f64) -> bool,
    ) {
        let spacing = self.heightfield.spacing().min_element();
        let (ga, gb) = (self.heightfield.grid_from_scene(a.truncate()), self.heightfield.grid_from_scene(b.truncate()));
        let wide = finest > 0 || reach > 0.01 * spacing;
        let Some((t_in, t_out)) = self.clip_within(ga, gb, if wide { reach / spacing } else { 0.0 }) else { return };
        let line = Line { start: ga, dir: gb - ga, z: a.z, dz: b.z - a.z };
        let nudge = 1e-10;
        let top = self.levels.len() - 1;
        let (mut t, mut level) = (t_in, finest.max(top.min(4)));
        while t <= t_out {
            let (block, exit) = line.block(&self.levels[level], level, t + nudge, t_out);
            let (z0, z1) = (line.z + t * line.dz, line.z + exit * line.dz);
            let [low, high] = self.levels[level].range(block, wide);
            let clear = z0.min(z1) - f64::from(high) > reach || f64::from(low) - z0.max(z1) > reach;
            if !clear && level > finest {
                level -= 1;
                continue;
            }
            if clear {
                level = (level + 1).min(top);
            } else if !visit([block.0, block.1], t, exit) {
                return;
            }
            t = exit.max(t + nudge);
        }
    }

    /// Part of the segment that lies over the grid.
    fn clip(&self, ga: DVec2, gb: DVec2) -> Option<(f64, f64)> {
        self.clip_within(ga, gb, 0.0)
    }

    /// Part of the segment that lies over the grid or at most `margin` spacings beside it.
    fn clip_within(&self, ga: DVec2, gb: DVec2, margin: f64) -> Option<(f64, f64)> {
        let last = [(self.heightfield.cols() - 1) as f64, (self.heightfield.rows() - 1) as f64];
        let (mut t0, mut t1) = (0.0f64, 1.0f64);
        for (axis, limit) in last.into_iter().enumerate() {
            let (p, d) = (ga[axis], gb[axis] - ga[axis]);
            if !(p.is_finite() && d.is_finite()) {
                return None;
            }
            if d == 0.0 {
                if !(-margin..=limit + margin).contains(&p) {
                    return None;
                }
                continue;
            }
            let (s0, s1) = ((-margin - p) / d, (limit + margin - p) / d);
            t0 = t0.max(s0.min(s1));
            t1 = t1.min(s0.max(s1));
        }
        (t0 <= t1).then_some((t0, t1))
    }

    /// Smallest gap over `t0..t1` inside one cell: it is linear on either side of the diagonal.
    fn gap_in_cell(&self, line: &Line, (col, row): (usize, usize), t0: f64, t1: f64) -> f64 {
        let corner = DVec2::new(col as f64, row as f64);
        let fractions = |t: f64| (line.start + t * line.dir - corner).clamp(DVec2::ZERO, DVec2::ONE);
        let (slope, offset) = (line.dir.x - line.dir.y, line.start.x - corner.x - (line.start.y - corner.y));
        let crossing = if slope == 0.0 { t1 } else { (-offset / slope).clamp(t0, t1) };
        let mut least = f64::INFINITY;
        for (from, to) in [(t0, crossing), (crossing, t1)] {
            let middle = fractions(0.5 * (from + to));
            for t in [from, to] {
                let f = fractions(t);
                if let Some(ground) = self.on_triangle(col, row, f, middle.x >= middle.y) {
                    least = least.min(line.z + t * line.dz - ground);
                }
            }
        }
        least
    }

    fn on_triangle(&self, col: usize, row: usize, f: DVec2, upper: bool) -> Option<f64> {
        // The point may sit on the diagonal up to rounding: keep it in the triangle that the interval lies in.
        let mid = 0.5 * (f.x + f.y);
        let (u, v) = match upper {
            true if f.x <= f.y => (mid + 1e-12, mid),
            false if f.x >= f.y => (mid, mid + 1e-12),
            _ => (f.x, f.y),
        };
        self.heightfield.surface_in_cell(col, row, u, v)
    }
}

impl Level {
    /// Smallest and largest height of a block, of the eight around it too if `wide`.
    fn range(&self, (col, row): (usize, usize), wide: bool) -> [f32; 2] {
        let of = |i: usize| [self.min.get(i).copied().unwrap_or(f32::NEG_INFINITY), self.max[i]];
        if !wide {
            return of(row * self.cols + col);
        }
        let mut out = [f32::INFINITY, f32::NEG_INFINITY];
        for r in row.saturating_sub(1)..(row + 2).min(self.rows) {
            for c in col.saturating_sub(1)..(col + 2).min(self.cols) {
                let [low, high] = of(r * self.cols + c);
                out = [out[0].min(low), out[1].max(high)];
            }
        }
        out
    }
}

struct Line {
    start: DVec2,
    dir: DVec2,
    z: f64,
    dz: f64,
}

impl Line {
    /// Block of `level` at `t`, and where the line leaves it (at most `t_out`).
    fn block(&self, level: &Level, k: usize, t: f64, t_out: f64) -> ((usize, usize), f64) {
        let size = (1usize << k) as f64;
        let at = (self.start + t * self.dir) / size;
        let index = |x: f64, n: usize| (x.max(0.0) as usize).min(n - 1);
        let block = (index(at.x, level.cols), index(at.y, level.rows));
        // The outermost blocks reach on beside the grid.
        let exit = |p: f64, d: f64, i: usize, n: usize| {
            if d > 0.0 && i + 1 < n {
                ((i + 1) as f64 * size - p) / d
            } else if d < 0.0 && i > 0 {
                (i as f64 * size - p) / d
            } else {
                f64::INFINITY
            }
        };
        let leave = exit(self.start.x, self.dir.x, block.0, level.cols);
        let leave = leave.min(exit(self.start.y, self.dir.y, block.1, level.rows));
        (block, leave.max(t).min(t_out))
    }
}

fn finest(hf: &Heightfield) -> Level {
    let (cols, rows) = (hf.cols() - 1, hf.rows() - 1);
    let height = |i: usize| if hf.states()[i] == NodeState::Void { f32::NEG_INFINITY } else { hf.heights()[i] };
    let mut max = Vec::with_capacity(cols * rows);
    for row in 0..rows {
        for col in 0..cols {
            let i = row * hf.cols() + col;
            let corners = [i, i + 1, i + hf.cols(), i + hf.cols() + 1];
            max.push(corners.into_iter().map(height).fold(f32::NEG_INFINITY, f32::max));
        }
    }
    Level { cols, rows, max, min: Vec::new() }
}

/// Smallest height of each cell's solid nodes; infinite where there is none.
fn lowest(hf: &Heightfield) -> Vec<f32> {
    let (cols, rows) = (hf.cols() - 1, hf.rows() - 1);
    let height = |i: usize| if hf.states()[i] == NodeState::Void { f32::INFINITY } else { hf.heights()[i] };
    let cell = |i: usize| {
        let nw = i / cols * hf.cols() + i % cols;
        [nw, nw + 1, nw + hf.cols(), nw + hf.cols() + 1].into_iter().map(height).fold(f32::INFINITY, f32::min)
    };
    (0..cols * rows).map(cell).collect()
}

fn coarser(fine: &Level) -> Level {
    let (cols, rows) = (fine.cols.div_ceil(2), fine.rows.div_ceil(2));
    let mut max = vec![f32::NEG_INFINITY; cols * rows];
    let mut min = vec![f32::INFINITY; if fine.min.is_empty() { 0 } else { cols * rows }];
    for row in 0..fine.rows {
        for col in 0..fine.cols {
            let (from, to) = (row * fine.cols + col, row / 2 * cols + col / 2);
            max[to] = max[to].max(fine.max[from]);
            if let (Some(out), Some(low)) = (min.get_mut(to), fine.min.get(from)) {
                *out = out.min(*low);
            }
        }
    }
    Level { cols, rows, max, min }
}
