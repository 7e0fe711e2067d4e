use super::*;

/// Bellman-Ford: relaxes all edges until nothing changes; a slow reference.
fn cheapest_by_relaxation(hf: &Heightfield, from: usize, to: usize, cost: &RouteCost) -> f64 {
    let (cols, rows) = (hf.cols(), hf.rows());
    let [lo, hi] = hf.z_range();
    let mut best = vec![f64::INFINITY; cols * rows];
    best[from] = 0.0;
    loop {
        let mut changed = false;
        for i in 0..cols * rows {
            let Some(p) = hf.node(i % cols, i / cols) else { continue };
            for (dc, dr) in [(-1, -1), (0, -1), (1, -1), (-1, 0), (1, 0), (-1, 1), (0, 1), (1, 1)] {
                let (c, r) = ((i % cols) as i64 + dc, (i / cols) as i64 + dr);
                if c < 0 || r < 0 || c >= cols as i64 || r >= rows as i64 {
                    continue;
                }
                let Some(q) = hf.node(c as usize, r as usize) else { continue };
                let run = p.truncate().distance(q.truncate());
                let slope = (q.z - p.z) / run / 0.25;
                let high = (0.5 * (p.z + q.z) - lo) / (hi - lo);
                let total =
                    best[i] + run * (1.0 + cost.slope_weight * slope * slope + cost.height_weight * high * high);
                let j = r as usize * cols + c as usize;
                if total < best[j] - 1e-9 {
                    (best[j], changed) = (total, true);
                }
            }
        }
        if !changed {
            return best[to];
        }
    }
}

#[test]
fn the_search_finds_the_cheapest_way() {
    let hilly = |c: usize, r: usize| ((c * 7 + r * 13) % 11) as f32 + ((c * c + 3 * r) % 17) as f32;
    let heights = (0..576).map(|i| hilly(i % 24, i / 24)).collect();
    let state =
        |i: usize| if (i % 24 * 5 + i / 24 * 3).is_multiple_of(13) { NodeState::Void } else { NodeState::Measured };
    let hf = Heightfield::new(DVec2::ZERO, DVec2::splat(10.0), 24, 24, heights, (0..576).map(state).collect()).unwrap();
    let cost = RouteCost::default();
    let (from, to) = ((1, 2), (22, 20));
    let reference = cheapest_by_relaxation(&hf, from.1 * 24 + from.0, to.1 * 24 + to.0, &cost);
    let z: Vec<f32> = (0..576).map(|i| hf.node(i % 24, i / 24).map_or(f32::NAN, |p| p.z as f32)).collect();
    let window = Window { col: 0, row: 0, cols: 24, rows: 24 };
    let ends = [from.1 * 24 + from.0, to.1 * 24 + to.0];
    let (_, found) = search(hf.spacing(), window, &z, ends, &cost).unwrap();
    assert!((found - reference).abs() < 1e-3 * reference, "found {found}, reference {reference}");
}
