//! Lit colours of a coarse level, interpolated to the nodes of the next finer one.

use crate::shade::ground::patch::{LightingInputs, Patch};
use crate::shade::ground::tiles::{NODES, RepeatedNodes, STRIDE};
use crate::simd::{LANES, Lanes};

/// Nodes along a side: half as many as those of a tile, and two more around.
const SIDE: usize = STRIDE / 2 + 3;

/// Weights of the node over a finer one, and of those before and after it, for an even or odd position of the finer one. With these
/// weights, linear interpolation between fine nodes and between coarse nodes differ equally at the coarse nodes and halfway
/// to the next fine ones, and less than with other weights.
const WEIGHTS: [[f32; 3]; 2] = [[0.1875, 0.875, -0.0625], [-0.0625, 0.875, 0.1875]];

/// Square roots of lit colours around a tile of the finer level.
pub(crate) struct CoarseColors {
    /// Rows of [`SIDE`], plane by plane.
    planes: [Vec<f32>; 3],
    fine: [RepeatedNodes; 2],
}

/// The same at the nodes of the tile, padded to whole lanes.
pub(crate) struct FineColors([Vec<f32>; 3]);

impl CoarseColors {
    /// * `level`: see [`Patch::new`];
    /// * `fine`: columns and rows of the tile.
    pub(crate) fn new(m: &LightingInputs<'_>, level: (usize, u32), fine: [RepeatedNodes; 2]) -> Self {
        let patch = Patch::new(m, level, fine[0].parents(), fine[1].parents());
        let mut planes = [0; 3].map(|_| Vec::with_capacity(SIDE * SIDE + LANES));
        for nodes in patch.nodes() {
            for (plane, lanes) in planes.iter_mut().zip(nodes.lit_roots(m.light)) {
                plane.extend_from_slice(&lanes);
            }
        }
        Self { planes, fine }
    }

    #[inline(always)]
    pub(crate) fn finer(&self) -> FineColors {
        let [columns, rows] = self.fine;
        let mut all = [0; 3].map(|_| vec![0.0; NODES.next_multiple_of(LANES)]);
        // No closures here: they would be compiled separately, for the oldest processors.
        for (plane, out) in self.planes.iter().zip(&mut all) {
            for (r, out) in rows.all().iter().zip(out.chunks_exact_mut(STRIDE)) {
                let first = rows.parent_of(r).saturating_sub(1) * SIDE;
                if let Some(above) = plane.get(first..first + 3 * SIDE) {
                    finer_row(&columns, &between_rows(above, WEIGHTS[r % 2]), out);
                }
            }
        }
        FineColors(all)
    }
}

impl FineColors {
    /// Colours of [`LANES`] nodes of the tile.
    #[inline(always)]
    pub(crate) fn get(&self, n: usize) -> Option<[Lanes; 3]> {
        let lanes = |plane: &Vec<f32>| plane.get(n * LANES..).and_then(|p| p.first_chunk().copied());
        let [r, g, b] = &self.0;
        Some([lanes(r)?, lanes(g)?, lanes(b)?])
    }
}

#[inline(always)]
fn between_rows(rows: &[f32], [a, b, c]: [f32; 3]) -> [f32; SIDE] {
    let mut out = [0.0; SIDE];
    let (north, here, south) = (&rows[..SIDE], &rows[SIDE..2 * SIDE], &rows[2 * SIDE..3 * SIDE]);
    for i in 0..SIDE {
        out[i] = a * north[i] + b * here[i] + c * south[i];
    }
    out
}

#[inline(always)]
fn finer_row(columns: &RepeatedNodes, row: &[f32; SIDE], out: &mut [f32]) {
    const N: usize = SIDE - 2;
    let [mut even, mut odd] = [[0.0; N]; 2];
    let [[a, b, c], [d, e, f]] = WEIGHTS;
    for i in 0..N {
        even[i] = a * row[i] + b * row[i + 1] + c * row[i + 2];
        odd[i] = d * row[i] + e * row[i + 1] + f * row[i + 2];
    }
    // A tile begins with the node before its first cell, which is odd.
    for (i, pair) in out.chunks_mut(2).enumerate().take(N) {
        pair[0] = odd[i];
        if let ([_, second], Some(even)) = (pair, even.get(i + 1)) {
            *second = *even;
        }
    }
    columns.all().repeat(out);
}
