//! The large forms of terrain: its average by a wide Gaussian.

use belvedere_core::DVec2;
use belvedere_core::map::relief::BaseSurface;
use belvedere_scene::{Heightfield, NodeState};
use rayon::prelude::*;

/// Control heights per `sigma`.
const PER_SIGMA: f64 = 2.0;
/// Control heights on the longer side at most.
const CONTROL_HEIGHTS: f64 = 2048.0;
/// Reach of the average, multiples of `sigma`.
const REACH: f64 = 4.0;

/// Terrain averaged by a Gaussian of standard deviation `sigma`, scene units, > 0, over the nodes with data; `None` without any.
pub fn large_forms(terrain: &Heightfield, sigma: f64) -> Option<BaseSurface> {
    let [cols, rows] = [terrain.cols(), terrain.rows()];
    let size = terrain.spacing() * DVec2::new((cols - 1) as f64, (rows - 1) as f64);
    let spacing = (sigma / PER_SIGMA).max(terrain.spacing().max_element()).max(size.max_element() / CONTROL_HEIGHTS);
    let south_west = terrain.node_xy(0, rows - 1);
    let [across, up] = [size.x, size.y].map(|s| (s / spacing).ceil() as usize + 1);
    let mut sums = vec![[0.0f64; 2]; across * up];
    for r in 0..rows {
        for c in 0..cols {
            let i = r * cols + c;
            if terrain.states().get(i).is_some_and(|s| *s == NodeState::Void) {
                continue;
            }
            let at = ((terrain.node_xy(c, r) - south_west) / spacing).round().as_usizevec2();
            let sum = &mut sums[at.y.min(up - 1) * across + at.x.min(across - 1)];
            *sum = [sum[0] + f64::from(terrain.heights()[i]), sum[1] + 1.0];
        }
    }
    let total = sums.iter().fold([0.0; 2], |t, s| [t[0] + s[0], t[1] + s[1]]);
    if total[1] == 0.0 {
        return None;
    }
    let mean = total[0] / total[1];
    let reach = (REACH * sigma / spacing).ceil() as usize;
    let weights: Vec<f64> = (0..=reach).map(|i| (-0.5 * (i as f64 * spacing / sigma).powi(2)).exp()).collect();
    let blurred = blurred(&blurred(&sums, across, &weights), up, &weights);
    // Far from all data the mean takes over.
    let height = |s: &[f64; 2]| (s[0] + 1e-9 * mean) / (s[1] + 1e-9);
    BaseSurface::new(south_west, spacing, across, blurred.iter().map(height).collect()).ok()
}

/// Weighted sums along rows of `width`, turned: what were rows are columns.
fn blurred(of: &[[f64; 2]], width: usize, weights: &[f64]) -> Vec<[f64; 2]> {
    let height = of.len() / width;
    let reach = weights.len() - 1;
    (0..width)
        .into_par_iter()
        .flat_map_iter(|x| {
            (0..height).map(move |y| {
                let row = &of[y * width..(y + 1) * width];
                let near = x.saturating_sub(reach)..=(x + reach).min(width - 1);
                near.fold([0.0; 2], |sum, i| {
                    let w = weights[i.abs_diff(x)];
                    [sum[0] + w * row[i][0], sum[1] + w * row[i][1]]
                })
            })
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn terrain(height: impl Fn(DVec2) -> f32) -> Heightfield {
        let (cols, rows, spacing) = (101, 81, 10.0);
        let heights = (0..cols * rows)
            .map(|i| height(DVec2::new((i % cols) as f64 * spacing, 800.0 - (i / cols) as f64 * spacing)))
            .collect();
        Heightfield::measured(DVec2::new(0.0, 800.0), DVec2::splat(spacing), cols, rows, heights).expect("terrain")
    }

    #[test]
    fn slopes_stay_and_what_is_small_goes() {
        let slope = |xy: DVec2| 0.3 * xy.x - 0.2 * xy.y;
        let bumps = |xy: DVec2| 30.0 * (xy.x / 20.0).sin() * (xy.y / 20.0).sin();
        let base = large_forms(&terrain(|xy| (slope(xy) + bumps(xy)) as f32), 100.0).expect("a surface");
        for at in [[500.0, 400.0], [450.0, 420.0], [520.0, 380.0]].map(DVec2::from) {
            let off = base.height(at) - slope(at);
            assert!(off.abs() < 3.0, "{at}: {off}");
        }
        let flat = large_forms(&terrain(|_| 700.0), 35.0).expect("a surface");
        for at in [[0.0, 0.0], [1000.0, 800.0], [333.0, 17.0], [-500.0, 5000.0]].map(DVec2::from) {
            assert!((flat.height(at) - 700.0).abs() < 1e-6, "{at}: {}", flat.height(at));
        }
    }
}
