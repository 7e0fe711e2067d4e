//! Lines of sight over a heightfield.

use crate::beam::Beam;
use crate::{GridLine, Pyramid};
use belvedere_core::{Aabb, DVec2, DVec3};
use belvedere_scene::{CellTriangle, Heightfield, NodeState};

/// A heightfield with the smallest and largest height of every block of 2^k x 2^k cells (the "maximum mipmap" of Tevs et
/// al. 2008), so that a line skips the blocks that it clears.
pub struct Ground<'a> {
    heightfield: &'a Heightfield,
    ranges: Pyramid<[f32; 2]>,
}

/// Range of a vertical displacement over the rectangle between two corners (smallest and largest x, y), scene units.
pub type Lift<'a> = &'a (dyn Fn(DVec2, DVec2) -> [f64; 2] + Sync);

/// Step of the line's parameter over the border of a cell: above the rounding of f64, and negligible as a length.
const NUDGE: f64 = 1e-10;

/// Next step of a walk along a line, from a block.
enum Step {
    /// Leave the block and continue in larger ones.
    Coarser,
    /// Continue in the smaller blocks of the block.
    Finer,
    /// Leave the block.
    On,
    /// End the walk.
    Stop,
}

impl<'a> Ground<'a> {
    /// Builds the pyramid: one pass over the nodes, and two and two thirds times the memory of the heights.
    pub fn new(heightfield: &'a Heightfield) -> Self {
        Self::lifted(heightfield, None)
    }

    /// The same for a surface with a vertical displacement, whose range the blocks include.
    pub fn lifted(heightfield: &'a Heightfield, lift: Option<Lift<'_>>) -> Self {
        let hf = heightfield;
        let leaf = |[col, row]: [usize; 2]| {
            let nw = row * hf.cols() + col;
            let solid = |i: &usize| hf.states()[*i] != NodeState::Void;
            let corners = [nw, nw + 1, nw + hf.cols(), nw + hf.cols() + 1].into_iter().filter(solid);
            let range = corners.map(|i| [hf.heights()[i]; 2]).fold(NOTHING, union);
            let Some(lift) = lift else { return range };
            let (nw, se) = (hf.node_xy(col, row), hf.node_xy(col + 1, row + 1));
            let [low, high] = lift(DVec2::new(nw.x, se.y), DVec2::new(se.x, nw.y));
            let [from, to] = range.map(f64::from);
            [((from + low) as f32).next_down(), ((to + high) as f32).next_up()]
        };
        let parent = |_, _, children: &[[f32; 2]]| children.iter().copied().fold(NOTHING, union);
        Self { heightfield, ranges: Pyramid::new([hf.cols() - 1, hf.rows() - 1], 1, leaf, parent) }
    }

    /// The heightfield.
    pub fn heightfield(&self) -> &'a Heightfield {
        self.heightfield
    }

    /// Smallest height of the straight segment `a b` over the drawn surface, metres; negative = under ground.
    ///
    /// Exact for the two triangles per cell of [`Heightfield::surface_in_cell`]. Returns `cap` if the segment never
    /// comes closer than that (or never lies over the terrain), and returns early, with any value below `floor`,
    /// once the height is less than `floor`.
    pub fn min_gap(&self, a: DVec3, b: DVec3, cap: f64, floor: f64) -> f64 {
        let line = self.line(a, b);
        let Some(part) = line.plan.over(self.nodes(), 0.0) else { return cap };
        let mut best = cap;
        self.descend(&line, part, 3.min(self.ranges.levels() - 1), |level, block, [t, exit]| {
            let lowest = line.z(t).min(line.z(exit));
            if lowest - f64::from(self.ranges.block(level, block)[1]) >= best {
                return Step::Coarser;
            }
            if level > 0 {
                return Step::Finer;
            }
            best = best.min(self.gap_in_cell(&line, block, [t, exit]));
            if best < floor { Step::Stop } else { Step::On }
        });
        best
    }

    /// Whether the straight segment `a b` stays on or above the drawn surface.
    pub fn sees(&self, a: DVec3, b: DVec3) -> bool {
        self.min_gap(a, b, 0.0, 0.0) >= 0.0
    }

    /// Whether every curve within `reach` (scene units, >= 0) of the straight segment `a b`, point by point, passes the
    /// surface of [`Ground::lifted`] without touching it. `true` is certain; `false` may be wrong where
    /// blocks as small as `reach` are too coarse.
    pub fn is_clear(&self, a: DVec3, b: DVec3, reach: f64) -> bool {
        let finest = self.ranges.level_of(reach / self.heightfield.spacing().min_element());
        let mut clear = true;
        self.near(a, b, reach, finest, &mut |_, _, _| {
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
        let level = self.ranges.level_of(0.5 * (hi - lo).max_element());
        let [first, end] = [lo, hi].map(|g| self.ranges.block_at(level, g));
        self.ranges.fold(level, first, end, true, |clear, [low, high]| {
            clear && (bounds.min.z > f64::from(*high) || bounds.max.z < f64::from(*low))
        })
    }

    /// Upper bound of the places along a beam at which a point of it above the height `low` lies on the surface of [`Ground::lifted`] or under
    /// it; minus infinity where none does.
    pub(crate) fn highest_along(&self, beam: &Beam, low: f64) -> f64 {
        let top = self.ranges.levels() - 1;
        let mut best = f64::NEG_INFINITY;
        let mut stack = vec![(top, [0usize; 2])];
        while let Some((level, block)) = stack.pop() {
            let high = f64::from(self.ranges.block(level, block)[1]);
            // Blocks without ground, and those that end below.
            if !(high >= low) {
                continue;
            }
            let side = self.ranges.side(level) as usize;
            let ends = [0, 1].map(|axis| ((block[axis] + 1) * side).min(self.nodes()[axis] - 1));
            let (nw, se) = (
                self.heightfield.node_xy(block[0] * side, block[1] * side),
                self.heightfield.node_xy(ends[0], ends[1]),
            );
            let half = DVec3::new(0.5 * (se.x - nw.x), 0.5 * (nw.y - se.y), 0.5 * (high - low));
            let center = (0.5 * (nw + se)).extend(0.5 * (high + low));
            if !beam.meets(center, half) {
                continue;
            }
            let most = beam.highest_in(center, half).min(beam.place_at_height(high));
            if most <= best {
                continue;
            }
            if level == 0 {
                best = most;
                continue;
            }
            let size = self.ranges.size(level - 1);
            for child in [[0, 0], [1, 0], [0, 1], [1, 1]].map(|step| [0, 1].map(|axis| 2 * block[axis] + step[axis])) {
                if child[0] < size[0] && child[1] < size[1] {
                    stack.push((level - 1, child));
                }
            }
        }
        best
    }

    /// Visits, from `a` to `b`, the cells in which the straight segment comes within `reach` of the heights of the
    /// surface of [`Ground::lifted`], with the parameters (0 at `a`, 1 at `b`) of its part over the cell; until
    /// `visit` returns `false`.
    pub fn walk(&self, a: DVec3, b: DVec3, reach: f64, visit: &mut dyn FnMut([usize; 2], f64, f64) -> bool) {
        self.near(a, b, reach, 0, visit);
    }

    /// Visits the blocks of level `finest` that the segment may touch, with its part over each.
    fn near(&self, a: DVec3, b: DVec3, reach: f64, finest: usize, visit: &mut dyn FnMut([usize; 2], f64, f64) -> bool) {
        let spacing = self.heightfield.spacing().min_element();
        // Beyond a small reach the blocks beside the line count too.
        let wide = finest > 0 || reach > 0.01 * spacing;
        let line = self.line(a, b);
        let margin = if wide { reach / spacing } else { 0.0 };
        let Some(part) = line.plan.over(self.nodes(), margin) else { return };
        let first = finest.max(4.min(self.ranges.levels() - 1));
        self.descend(&line, part, first, |level, block, [t, exit]| {
            let (z0, z1) = (line.z(t), line.z(exit));
            let [low, high] = self.range(level, block, wide);
            if z0.min(z1) - f64::from(high) > reach || f64::from(low) - z0.max(z1) > reach {
                Step::Coarser
            } else if level > finest {
                Step::Finer
            } else if visit(block, t, exit) {
                Step::On
            } else {
                Step::Stop
            }
        });
    }

    /// Walks along a part of a line from block to block, beginning at a level.
    fn descend(
        &self,
        line: &Line,
        [mut t, end]: [f64; 2],
        mut level: usize,
        mut step: impl FnMut(usize, [usize; 2], [f64; 2]) -> Step,
    ) {
        let top = self.ranges.levels() - 1;
        while t <= end {
            let (block, exit) = line.plan.block(self.ranges.side(level), self.ranges.size(level), t + NUDGE);
            let exit = exit.max(t + NUDGE).min(end);
            match step(level, block, [t, exit]) {
                Step::Finer => {
                    level -= 1;
                    continue;
                }
                Step::Coarser => level = (level + 1).min(top),
                Step::On => {}
                Step::Stop => return,
            }
            t = exit.max(t + NUDGE);
        }
    }

    fn line(&self, a: DVec3, b: DVec3) -> Line {
        let [from, to] = [a, b].map(|p| self.heightfield.grid_from_scene(p.truncate()));
        Line { plan: GridLine::between(from, to), foot: a.z, rise: b.z - a.z }
    }

    fn nodes(&self) -> [usize; 2] {
        [self.heightfield.cols(), self.heightfield.rows()]
    }

    /// Smallest and largest height of a block, of the eight around it too if `wide`.
    fn range(&self, level: usize, block: [usize; 2], wide: bool) -> [f32; 2] {
        if !wide {
            return *self.ranges.block(level, block);
        }
        let size = self.ranges.size(level);
        let last = [0, 1].map(|axis| (block[axis] + 1).min(size[axis] - 1));
        self.ranges.fold(level, block.map(|k| k.saturating_sub(1)), last, NOTHING, |a, b| union(a, *b))
    }

    /// Smallest gap over a part of the line inside one cell: it is linear on either side of the diagonal.
    fn gap_in_cell(&self, line: &Line, cell: [usize; 2], part: [f64; 2]) -> f64 {
        let corner = DVec2::new(cell[0] as f64, cell[1] as f64);
        let mut least = f64::INFINITY;
        for (triangle, part) in line.plan.by_triangle(cell, part) {
            for t in part {
                let fractions = (line.plan.at(t) - corner).clamp(DVec2::ZERO, DVec2::ONE);
                if let Some(ground) = self.on_triangle(cell, triangle, fractions) {
                    least = least.min(line.z(t) - ground);
                }
            }
        }
        least
    }

    fn on_triangle(&self, [col, row]: [usize; 2], triangle: CellTriangle, f: DVec2) -> Option<f64> {
        // The point may sit on the diagonal up to rounding: keep it in the triangle that the interval lies in.
        let middle = 0.5 * (f.x + f.y);
        let (u, v) = match triangle {
            CellTriangle::NorthEast if f.x <= f.y => (middle + 1e-12, middle),
            CellTriangle::SouthWest if f.x >= f.y => (middle, middle + 1e-12),
            _ => (f.x, f.y),
        };
        self.heightfield.surface_in_cell(col, row, u, v)
    }
}

/// A straight line in space: its plan, its height at the start and its rise from start to end.
struct Line {
    plan: GridLine,
    foot: f64,
    rise: f64,
}

impl Line {
    fn z(&self, t: f64) -> f64 {
        self.foot + t * self.rise
    }
}

/// The empty range of heights.
const NOTHING: [f32; 2] = [f32::INFINITY, f32::NEG_INFINITY];

fn union(a: [f32; 2], b: [f32; 2]) -> [f32; 2] {
    [a[0].min(b[0]), a[1].max(b[1])]
}
