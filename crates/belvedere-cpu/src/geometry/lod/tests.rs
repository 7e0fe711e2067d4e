use super::*;
use belvedere_core::DVec2;

fn rough(cols: usize, rows: usize, void: Option<usize>) -> Heightfield {
    let mut seed = 5u64;
    let mut random = || {
        seed = seed.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (seed >> 40) as f32 / (1 << 24) as f32
    };
    let wave = |i: usize| 80.0 * ((i % cols) as f32 * 0.05).sin() * ((i / cols) as f32 * 0.07).cos();
    let heights = (0..cols * rows).map(|i| wave(i) + random()).collect();
    let mut states = vec![NodeState::Measured; cols * rows];
    void.into_iter().for_each(|i| states[i] = NodeState::Void);
    Heightfield::new(DVec2::ZERO, DVec2::ONE, cols, rows, heights, states).unwrap()
}

/// Height of the triangle of three nodes over a position.
fn over(t: [[f64; 3]; 3], [x, y]: [f64; 2]) -> Option<f64> {
    let cross = |a: [f64; 2], b: [f64; 2]| a[0] * b[1] - a[1] * b[0];
    let from = |p: [f64; 3]| [p[0] - t[0][0], p[1] - t[0][1]];
    let (u, v, p) = (from(t[1]), from(t[2]), [x - t[0][0], y - t[0][1]]);
    let area = cross(u, v);
    let (b, c) = (cross(p, v) / area, cross(u, p) / area);
    let inside = area != 0.0 && b >= -1e-9 && c >= -1e-9 && b + c <= 1.0 + 1e-9;
    inside.then(|| t[0][2] + b * (t[1][2] - t[0][2]) + c * (t[2][2] - t[0][2]))
}

/// Largest distance in height between the ground and a block drawn with these seams, at nodes and between them.
fn distance(hf: &Heightfield, level: usize, block: [usize; 2], seam: [bool; 4]) -> f64 {
    let ((from, to), step) = (nodes(hf, level, block), 1 << level);
    let cells = [0, 1].map(|axis| (to[axis] - from[axis]) / step);
    let mut worst = 0.0f64;
    for (c, r) in (0..cells[0]).flat_map(|c| (0..cells[1]).map(move |r| (c, r))) {
        for triangle in crate::geometry::grid::CELL_TRIANGLES {
            let t = triangle.map(|n| {
                let kept = crate::geometry::grid::kept_node(seam, cells, [c + (n & 1), r + (n >> 1)]);
                let at = [from[0] + step * kept[0], from[1] + step * kept[1]];
                [at[0] as f64, at[1] as f64, f64::from(hf.heights()[at[1] * hf.cols() + at[0]])]
            });
            let low = [0, 1].map(|k| t.iter().map(|p| p[k]).fold(f64::INFINITY, f64::min));
            let high = [0, 1].map(|k| t.iter().map(|p| p[k]).fold(0.0, f64::max));
            for j in 0..=((high[1] - low[1]) * 4.0) as usize {
                for i in 0..=((high[0] - low[0]) * 4.0) as usize {
                    let p = [low[0] + 0.25 * i as f64, low[1] + 0.25 * j as f64];
                    let Some(z) = over(t, p) else { continue };
                    let true_z = hf.surface_at(DVec2::new(p[0], -p[1])).expect("inside");
                    worst = worst.max((z - true_z).abs());
                }
            }
        }
    }
    worst
}

#[test]
fn errors_bound_the_distance_from_the_ground_with_and_without_seams() {
    let hf = rough(257, 193, None);
    let tree = Tree::new(&hf);
    assert_eq!(tree.levels(), 4);
    for (level, block) in [(0, [3, 2]), (1, [0, 0]), (1, [3, 1]), (2, [1, 0]), (2, [0, 1]), (3, [0, 0])] {
        let span = tree.span(level, block);
        let plain = distance(&hf, level, block, [false; 4]);
        assert!(plain <= f64::from(span.error) + 1e-4, "level {level}: {plain} > {}", span.error);
        assert!(f64::from(span.error) <= 1.2 * plain + 1e-4, "level {level}: {} for {plain}", span.error);
        for side in 0..4 {
            let seam: [bool; 4] = std::array::from_fn(|k| k == side);
            let bound = f64::from(span.error + span.seam[side]);
            if bound.is_finite() {
                let sewn = distance(&hf, level, block, seam);
                assert!(sewn <= bound + 1e-4, "level {level}, side {side}: {sewn} > {bound}");
            }
        }
    }
}

#[test]
fn heights_side_by_side_are_those_of_the_ground() {
    for (cols, rows) in [(257, 193), (100, 65), (8, 9), (2, 2)] {
        let hf = rough(cols, rows, None);
        let sparse = DecimatedHeights::new(&hf);
        assert!(DecimatedHeights::bytes((cols * rows) as u64) <= 4 * sparse.heights.len() as u64);
        let mut apart = 0;
        for (step, r) in [1, 2, 4, 8, 16, 32, 64].into_iter().flat_map(|step| (0..rows).map(move |r| (step, r))) {
            for first in 0..cols {
                let (from, by) = sparse.row(&hf, [first, r], step);
                apart += usize::from(by != step);
                for (i, c) in (first..cols).step_by(step).enumerate() {
                    assert_eq!(from[i * by], hf.heights()[r * cols + c], "{cols} x {rows}: {c}, {r}, step {step}");
                }
            }
        }
        assert_eq!(apart, 4 * sparse.heights.len(), "steps of 8 to 64 from every node that is there");
    }
}

#[test]
fn blocks_with_holes_or_odd_sides_are_drawn_in_full() {
    let tree = Tree::new(&rough(257, 193, Some(40 * 257 + 70)));
    assert!(tree.span(1, [1, 0]).error.is_infinite(), "a hole");
    assert!(tree.span(1, [0, 0]).error.is_finite() && tree.span(0, [2, 1]).error == 0.0);
    assert!(tree.span(2, [0, 0]).error.is_infinite(), "the hole again");
    let odd = Tree::new(&rough(100, 65, None));
    assert!(odd.span(1, [1, 0]).error.is_infinite(), "99 cells do not pair");
    assert!(odd.span(1, [0, 0]).error.is_finite());
}
