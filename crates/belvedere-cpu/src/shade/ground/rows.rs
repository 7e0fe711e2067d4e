//! Rows of averages between the nodes of a stored level.

use crate::shade::ground::planes::Planes;
use crate::shade::ground::surface::{MipPyramid, tap};
use crate::simd::{self, Kernel};

/// Averages of the finest stored level at nodes of a finer one, row after row.
pub(crate) struct RefinedRows {
    /// Spacing of the stored nodes in nodes of the finer level.
    step: f32,
    /// Nodes west and east of each column, and the weight of the eastern one.
    taps: Vec<(usize, usize, f32)>,
    /// The two rows of the stored level that were last interpolated to the columns.
    lines: [(usize, Planes); 2],
}

impl RefinedRows {
    /// * `k`: the finer level, of whose columns there are `n` from `first` on.
    pub(crate) fn new(means: &MipPyramid, k: usize, first: usize, n: usize) -> Self {
        let step = 1.0 / (1u32 << (means.first - k)) as f32;
        let taps = (first..first + n).map(|c| tap(Self::place(step, c), means.levels[0].cols)).collect();
        Self { step, taps, lines: [(usize::MAX, Planes::new(n)), (usize::MAX, Planes::new(n))] }
    }

    fn place(step: f32, i: usize) -> f32 {
        (i as f32 + 0.5) * step - 0.5
    }

    /// A row of the finer level.
    pub(crate) fn row(&mut self, means: &MipPyramid, row: usize, out: &mut Planes) {
        let (north, south, v) = tap(Self::place(self.step, row), means.levels[0].rows);
        if self.lines[1].0 == north {
            self.lines.swap(0, 1);
        }
        for (line, row) in self.lines.iter_mut().zip([north, south]) {
            if line.0 != row {
                line.0 = row;
                means.levels[0].between_columns(row, &self.taps, &mut line.1);
            }
        }
        simd::run(Mix { lines: [&self.lines[0].1, &self.lines[1].1], v, out });
    }
}

/// Mixes two rows.
struct Mix<'a> {
    lines: [&'a Planes; 2],
    v: f32,
    out: &'a mut Planes,
}

impl Kernel for Mix<'_> {
    type Output = ();

    #[inline(always)]
    fn run(self) {
        let Self { lines: [north, south], v, out } = self;
        let planes = out.xyz.iter_mut().zip(&north.xyz).zip(&south.xyz);
        for ((out, north), south) in planes.chain([((&mut out.w, &north.w), &south.w)]) {
            for ((out, a), b) in out.iter_mut().zip(north).zip(south) {
                *out = a + v * (b - a);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::shade::ground::surface::Surface;
    use belvedere_core::DVec2;
    use belvedere_scene::{Heightfield, NodeState};

    #[test]
    fn rows_between_stored_nodes_are_those_of_their_places_in_any_order() {
        let (cols, rows) = (83, 61);
        let heights = (0..cols * rows).map(|i| 500.0 + 90.0 * (i as f32 * 0.37).sin() + (i / cols) as f32).collect();
        let states = vec![NodeState::Measured; cols * rows];
        let hf = Heightfield::new(DVec2::ZERO, DVec2::splat(10.0), cols, rows, heights, states).unwrap();
        let means = MipPyramid::new(&Surface::of_map(&hf));
        assert_eq!(means.first, 1);
        let (first, n) = (5, 70);
        let (mut refined, mut out) = (RefinedRows::new(&means, 0, first, n), Planes::new(n));
        for row in (0..rows).chain((0..rows).rev()).chain([40, 3, 3, 4, 60, 0]) {
            refined.row(&means, row, &mut out);
            for i in 0..n {
                let want = means.at(1, (first + i) as f32, row as f32);
                assert!((out.get(i) - want).abs().max_element() < 1e-3, "{row}, {i}: {} {want}", out.get(i));
            }
        }
    }
}
