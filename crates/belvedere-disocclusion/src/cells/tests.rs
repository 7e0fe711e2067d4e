use super::*;
use belvedere_core::DVec2;
use belvedere_scene::{Heightfield, NodeState};

/// A field of `cols` x `rows` nodes; NaN = void.
pub(crate) fn field_of(cols: usize, rows: usize, spacing: DVec2, height: impl Fn(usize, usize) -> f64) -> Field {
    let heights: Vec<f32> = (0..cols * rows).map(|i| height(i % cols, i / cols) as f32).collect();
    let states = heights.iter().map(|h| if h.is_nan() { NodeState::Void } else { NodeState::Measured }).collect();
    let hf = Heightfield::new(DVec2::new(500.0, 800.0), spacing, cols, rows, heights, states).unwrap();
    Field::new(&hf, |_| 0.0).unwrap()
}

/// Repeatable noise, 0..1.
pub(crate) fn noise(i: usize, seed: u64) -> f64 {
    let mut x = (i as u64).wrapping_mul(0x9E37_79B9_7F4A_7C15).wrapping_add(seed.wrapping_mul(0xD1B5_4A32_D192_ED03));
    x = (x ^ (x >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
    x = (x ^ (x >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
    ((x ^ (x >> 31)) >> 11) as f64 / (1u64 << 53) as f64
}

fn summit_labels(cells: &Cells) -> Vec<u32> {
    cells.labels().iter().map(|&c| if c == NO_CELL { NO_CELL } else { cells.summits()[c as usize] }).collect()
}

/// Whole metres, so that many neighbours are equal; every `void`-th node (roughly) without data.
fn rough(cols: usize, rows: usize, steps: f64, void: f64, seed: u64) -> Field {
    field_of(cols, rows, DVec2::new(30.0, 24.0), |c, r| {
        let i = r * cols + c;
        // The first node always holds data.
        if i > 0 && noise(i, seed + 99) < void {
            return f64::NAN;
        }
        let hill = ((c as f64) / 5.0).sin() * ((r as f64) / 4.0).cos();
        (steps * (noise(i, seed) + 1.5 * hill)).floor()
    })
}

#[test]
fn labels_are_those_of_the_obvious_algorithm() {
    for (seed, (cols, rows)) in [(23, 17), (2, 31), (40, 3), (16, 16), (25, 24), (2, 2)].into_iter().enumerate() {
        for steps in [0.0, 3.0, 40.0] {
            for void in [0.0, 0.15, 0.6] {
                let field = rough(cols, rows, steps, void, seed as u64);
                for keep in [1, 4, 1000] {
                    let cells = Cells::new(&field, keep);
                    let (labels, persistence) = reference::partition(&field, keep);
                    let case = format!("{cols} x {rows}, {steps} steps, {void} void, keep {keep}");
                    assert_eq!(summit_labels(&cells), labels, "{case}");
                    let ours: Vec<_> =
                        cells.summits().iter().copied().zip(cells.persistence().iter().copied()).collect();
                    assert_eq!(ours, persistence.into_iter().collect::<Vec<_>>(), "{case}");
                }
            }
        }
    }
}

#[test]
fn two_hills_and_a_bump_are_two_cells_and_the_bump_follows_the_saddle() {
    // Heights 30 (at 2), 20 (at 12) and a bump of 12 at 8 whose higher saddle (10) leads east.
    let profile = [10.0, 20.0, 30.0, 20.0, 10.0, 5.0, 8.0, 10.5, 12.0, 11.0, 13.0, 18.0, 20.0, 9.0];
    let field = field_of(14, 3, DVec2::splat(10.0), |c, r| profile[c] - if r == 1 { 0.0 } else { 1.0 });
    let all = Cells::new(&field, 10);
    assert_eq!(all.summits(), [16, 22, 26], "on the middle row");
    assert_eq!(all.persistence(), [f64::INFINITY, 1.0, 15.0]);
    let two = Cells::new(&field, 2);
    assert_eq!(two.summits(), [16, 26]);
    let row: Vec<u32> = two.labels()[14..28].to_vec();
    assert_eq!(row, [0, 0, 0, 0, 0, 0, 1, 1, 1, 1, 1, 1, 1, 1]);
    assert_eq!(Cells::new(&field, 1).labels(), [0; 42]);
}

#[test]
fn flat_ground_is_one_cell_and_so_is_the_smallest() {
    let flat = field_of(9, 7, DVec2::splat(10.0), |_, _| 400.0);
    let cells = Cells::new(&flat, 5);
    assert_eq!((cells.len(), cells.summits(), cells.labels()), (1, &[62][..], &[0; 63][..]));
    assert_eq!((cells.mean_height(0), cells.higher(0, -1.0), cells.higher(0, 0.0)), (0.0, (1.0, 0.0), (0.0, 0.0)));
    assert!(cells.neighbours(0).0.is_empty());
    let tiny = field_of(2, 2, DVec2::splat(10.0), |c, r| (c + 2 * r) as f64);
    assert_eq!(Cells::new(&tiny, 5).summits(), [3]);
    assert_eq!(Cells::default_count(&tiny), 1);
}

#[test]
fn parts_without_a_way_between_them_keep_a_cell_each() {
    let field = field_of(9, 4, DVec2::splat(10.0), |c, r| if c == 4 { f64::NAN } else { (10 * c + r) as f64 });
    let cells = Cells::new(&field, 1);
    assert_eq!(cells.len(), 2);
    assert_eq!(cells.persistence(), [f64::INFINITY; 2]);
    assert!(cells.labels().iter().zip(field.void()).all(|(&c, &v)| (c == NO_CELL) == v));
    assert!(cells.neighbours(0).0.is_empty(), "voids are no border");
}

#[test]
fn tables_know_shares_and_means_above_any_height() {
    let field = rough(60, 55, 300.0, 0.05, 5);
    let cells = Cells::new(&field, 9);
    assert_eq!(cells.len(), 9);
    for cell in 0..cells.len() {
        let heights: Vec<f64> = (0..field.heights().len())
            .filter(|&i| cells.labels()[i] == cell as u32)
            .map(|i| field.heights()[i] - field.datum())
            .collect();
        assert_eq!(heights.len(), cells.size(cell));
        let mean = heights.iter().sum::<f64>() / heights.len() as f64;
        assert!((cells.mean_height(cell) - mean).abs() < 1e-9);
        for h in [-1.0, 0.0, 50.0, 123.0, 200.5, heights[0], 1e6] {
            let above: Vec<f64> = heights.iter().copied().filter(|&x| x > h).collect();
            let (kappa, bar) = cells.higher(cell, h);
            assert_eq!(kappa, above.len() as f64 / heights.len() as f64);
            let expected = if above.is_empty() {
                heights.iter().copied().fold(0.0, f64::max)
            } else {
                above.iter().sum::<f64>() / above.len() as f64
            };
            assert!((bar - expected).abs() < 1e-9);
        }
    }
}

#[test]
fn border_shares_count_edges_and_add_up_to_one() {
    let field = rough(37, 41, 200.0, 0.03, 8);
    let cells = Cells::new(&field, 7);
    let (cols, labels) = (field.cols(), cells.labels());
    for cell in 0..cells.len() {
        let mut counts = std::collections::BTreeMap::<u32, usize>::new();
        for i in (0..labels.len()).filter(|&i| labels[i] == cell as u32) {
            let (c, r) = (i % cols, i / cols);
            let west_east = [c.checked_sub(1).map(|_| i - 1), (c + 1 < cols).then(|| i + 1)];
            let north_south = [r.checked_sub(1).map(|_| i - cols), (r + 1 < field.rows()).then(|| i + cols)];
            for j in west_east.into_iter().chain(north_south).flatten() {
                if labels[j] != cell as u32 && labels[j] != NO_CELL {
                    *counts.entry(labels[j]).or_default() += 1;
                }
            }
        }
        let total: usize = counts.values().sum();
        let (neighbours, shares) = cells.neighbours(cell);
        assert_eq!(neighbours, counts.keys().copied().collect::<Vec<_>>());
        for (share, count) in shares.iter().zip(counts.values()) {
            assert_eq!(*share, *count as f64 / total as f64);
        }
        assert!((shares.iter().sum::<f64>() - 1.0).abs() < 1e-12);
    }
}

#[test]
fn a_higher_datum_a_mirror_and_a_transposition_do_not_change_the_cells() {
    // No two heights are equal: no ties to break.
    let (cols, rows) = (48, 39);
    let h = |c: usize, r: usize| {
        (200.0 * (c as f64 / 6.0).sin() * (r as f64 / 5.0).cos()).floor() + ((r * cols + c) as f64) / 2048.0
    };
    let square = DVec2::splat(30.0);
    let cells = Cells::new(&field_of(cols, rows, square, h), 8);
    let raised = Cells::new(&field_of(cols, rows, square, |c, r| h(c, r) + 512.0), 8);
    assert_eq!((cells.labels(), cells.summits()), (raised.labels(), raised.summits()));
    assert_eq!(cells.higher(3, 77.0), raised.higher(3, 77.0));
    let mirrored = summit_labels(&Cells::new(&field_of(cols, rows, square, |c, r| h(cols - 1 - c, r)), 8));
    let transposed = summit_labels(&Cells::new(&field_of(rows, cols, square, |c, r| h(r, c)), 8));
    for (i, &s) in summit_labels(&cells).iter().enumerate() {
        let (c, r) = (i % cols, i / cols);
        let (sc, sr) = (s as usize % cols, s as usize / cols);
        assert_eq!(mirrored[r * cols + cols - 1 - c] as usize, sr * cols + cols - 1 - sc);
        assert_eq!(transposed[c * rows + r] as usize, sc * rows + sr);
    }
}

#[test]
fn threads_do_not_matter() {
    let field = rough(400, 300, 900.0, 0.01, 3);
    let with = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| Cells::new(&field, 75))
    };
    assert_eq!(with(1), with(3));
}
