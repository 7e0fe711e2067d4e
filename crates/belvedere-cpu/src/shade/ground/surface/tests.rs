use super::*;

fn tilted(cols: usize, rows: usize, void: impl Fn(usize, usize) -> bool) -> Heightfield {
    let heights = (0..cols * rows).map(|i| 100.0 + 3.0 * (i % cols) as f32 - 5.0 * (i / cols) as f32).collect();
    let state = |i: usize| if void(i % cols, i / cols) { NodeState::Void } else { NodeState::Measured };
    let states = (0..cols * rows).map(state).collect();
    Heightfield::new(DVec2::ZERO, DVec2::new(10.0, 20.0), cols, rows, heights, states).unwrap()
}

#[test]
fn a_tilted_plane_has_its_slope_at_every_level_beside_holes_too() {
    let hf = tilted(67, 41, |c, r| (c > 20 && c < 31 && r > 9 && r < 17) || (c == 3 && r == 3));
    let (surface, want) = (Surface::of_map(&hf), DVec2::new(0.3, 0.25).as_vec2());
    let means = MipPyramid::new(&surface);
    for k in 1..=means.top() {
        let [cols, rows] = means.size(k);
        for i in 0..cols * rows {
            let n = means.node(k, i % cols, i / cols);
            assert!((n.truncate().truncate() - want).length() < 1e-4, "level {k}, node {i}: {n}");
        }
    }
    let mut row = Planes::new(67);
    for r in 0..41 {
        surface.row(r, 0, &mut row);
        for c in 0..67 {
            let (n, void) = (row.get(c), hf.states()[r * 67 + c] == NodeState::Void);
            assert!(if void { n == Vec4::ZERO } else { (n.truncate().truncate() - want).length() < 1e-4 });
        }
    }
}

#[test]
fn sums_of_squares_are_those_of_their_nodes() {
    let (cols, rows) = (331, 143);
    let h = |i: usize| 900.0 + 300.0 * (i as f32 * 0.37).sin() + (i / cols) as f32 * 3.1;
    let void = |i: usize| i == 70 * cols + 200;
    let state = |i: usize| if void(i) { NodeState::Void } else { NodeState::Measured };
    let states = (0..cols * rows).map(state).collect();
    let heights = (0..cols * rows).map(h).collect();
    let hf = Heightfield::new(DVec2::ZERO, DVec2::new(10.0, 20.0), cols, rows, heights, states).unwrap();
    let surface = Surface::of_map(&hf);
    for (k, first) in [(1usize, 0), (2, 3), (3, 1), (4, 0)] {
        let n = cols.div_ceil(1 << k) - first;
        for row in 0..rows.div_ceil(1 << k) {
            let [mut sums, mut each] = [Planes::new(n), Planes::new(n)];
            surface.mean_row(k, row, first, &mut sums);
            surface.mean_of_each(k, row, first, &mut each, 0..n);
            for i in 0..n {
                let (a, b) = (sums.get(i), each.get(i));
                let off = (a - b).abs();
                assert!(
                    off.truncate().truncate().max_element() < 2e-4 && off.z < 2e-3,
                    "level {k}, row {row}: {a} {b}"
                );
            }
        }
    }
}

#[test]
fn averages_of_a_row_are_those_of_the_nodes() {
    let hf = tilted(37, 23, |c, r| (c * 7 + r * 3) % 11 == 0);
    let surface = Surface::of_map(&hf);
    for k in [1usize, 2, 3] {
        let cols = 37usize.div_ceil(1 << k);
        let mut got = Planes::new(cols - 1);
        surface.mean_row(k, 1, 1, &mut got);
        for (i, got) in got.xyz[2].iter().enumerate() {
            let (mut sum, mut n) = (0.0, 0.0);
            for r in 1 << k..(2 << k).min(23) {
                for c in (i + 1) << k..((i + 2) << k).min(37) {
                    if hf.states()[r * 37 + c] != NodeState::Void {
                        (sum, n) = (sum + hf.heights()[r * 37 + c], n + 1.0);
                    }
                }
            }
            assert!((got - sum / n).abs() < 1e-3, "level {k} node {i}: {got} {}", sum / n);
        }
    }
}

#[test]
fn huge_grounds_store_a_small_part_of_themselves() {
    for side in [1025usize, 4097, 16_385, 40_000] {
        let nodes = side * side;
        let stored = (nodes >> (2 * first_level(nodes))) * 16 * 4 / 3;
        assert!(nodes <= SMALL_GROUND || stored < nodes, "{side}: {stored} bytes");
    }
}
