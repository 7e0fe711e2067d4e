//! The solver's grid over the terrain's.

use belvedere_core::DVec2;
use belvedere_disocclusion::internals::Hierarchy;

use super::support::{apart, numbers};

#[test]
fn sizes_follow_the_step_also_when_it_does_not_divide() {
    let size = |c, r, n| {
        let h = Hierarchy::new(c, r, n);
        (h.cols(), h.rows())
    };
    assert_eq!(size(1025, 1025, 129), (129, 129));
    assert_eq!(size(401, 343, 101), (101, 87));
    assert_eq!(size(100, 1201, 129), (12, 129));
    assert_eq!(size(30, 20, 129), (30, 20));
    assert_eq!(size(2, 2, 129), (2, 2));
    assert_eq!(size(1, 7, 3), (1, 3));
    assert_eq!(size(1000, 2, 129), (129, 2));
    assert!(Hierarchy::new(30, 20, 30).is_full() && !Hierarchy::new(30, 20, 29).is_full());
    let h = Hierarchy::new(401, 343, 101);
    assert_eq!(h.step(), DVec2::new(4.0, 342.0 / 86.0));
}

#[test]
fn whole_steps_put_every_node_on_the_fine_grid_or_beside_it() {
    for (cols, rows, nodes, step) in
        [(401, 343, 129, 3.0), (1025, 1025, 129, 8.0), (1201, 600, 129, 9.0), (152, 187, 129, 1.0), (2, 9, 2, 8.0)]
    {
        let h = Hierarchy::whole(cols, rows, nodes);
        assert_eq!(h.step(), DVec2::splat(step), "{cols} x {rows}");
        let over = |n: usize, m: usize| (m - 1) as f64 * step - (n - 1) as f64;
        for over in [over(cols, h.cols()), over(rows, h.rows())] {
            assert!((0.0..step).contains(&over), "{cols} x {rows}: {over} cells beside");
        }
        assert!((h.intervals() - (cols.max(rows) - 1) as f64 / step).abs() < 1e-12);
        let plane: Vec<f64> = (0..cols * rows).map(|i| (i % cols) as f64 - 2.0 * (i / cols) as f64).collect();
        let coarse = h.restrict(&vec![7.0; cols * rows]);
        assert!(coarse.iter().all(|v| (v - 7.0).abs() < 1e-12));
        let at_nodes = |i: usize| step * ((i % h.cols()) as f64 - 2.0 * (i / h.cols()) as f64);
        let spread = h.prolong(&(0..h.nodes()).map(at_nodes).collect::<Vec<_>>());
        assert!(apart(&spread, &plane) < 1e-9, "planes are reproduced");
    }
}

#[test]
fn planes_are_reproduced_and_rows_agree_with_spreading() {
    for (cols, rows, nodes) in [(41, 33, 11), (40, 31, 7), (9, 5, 9), (2, 2, 2), (1, 8, 4), (3, 50, 2)] {
        let h = Hierarchy::new(cols, rows, nodes);
        let node = |i: usize| DVec2::new((i % h.cols()) as f64, (i / h.cols()) as f64) * h.step();
        let plane = |g: DVec2| 3.0 - 0.5 * g.x + 0.25 * g.y;
        let coarse: Vec<f64> = (0..h.nodes()).map(|i| plane(node(i))).collect();
        let fine = h.prolong(&coarse);
        let place = |i: usize| DVec2::new((i % cols) as f64, (i / cols) as f64);
        for (i, x) in fine.iter().enumerate() {
            assert!((x - plane(place(i))).abs() < 1e-12, "{cols} x {rows} / {nodes} at {i}");
        }
        let coarse = numbers(7, h.nodes());
        let fine = h.prolong(&coarse);
        for (i, x) in fine.iter().enumerate() {
            let (places, weights) = h.weights(place(i));
            assert!((weights.iter().sum::<f64>() - 1.0).abs() < 1e-14);
            assert!(places.iter().all(|p| (*p as usize) < h.nodes()) && weights.iter().all(|w| *w >= 0.0));
            assert!((h.at(&coarse, place(i)) - x).abs() < 1e-14);
        }
    }
}

#[test]
fn restricting_is_the_weighted_mean_of_the_transposed_spreading() {
    for (cols, rows, nodes) in [(21, 16, 6), (20, 17, 7), (5, 5, 5), (1, 9, 3)] {
        let h = Hierarchy::new(cols, rows, nodes);
        let fine = numbers(8, cols * rows);
        let (mut sum, mut total) = (vec![0.0; h.nodes()], vec![0.0; h.nodes()]);
        for (i, x) in fine.iter().enumerate() {
            let (places, weights) = h.weights(DVec2::new((i % cols) as f64, (i / cols) as f64));
            for (p, w) in places.iter().zip(weights) {
                sum[*p as usize] += w * x;
                total[*p as usize] += w;
            }
        }
        let mean: Vec<f64> = sum.iter().zip(&total).map(|(s, t)| s / t).collect();
        assert!(apart(&h.restrict(&fine), &mean) < 1e-13, "{cols} x {rows} / {nodes}");
        let flat = h.restrict(&vec![7.0; cols * rows]);
        assert!(apart(&flat, &vec![7.0; h.nodes()]) < 1e-13, "constants stay");
    }
}

#[test]
fn points_outside_take_the_values_of_the_rim() {
    let h = Hierarchy::new(9, 9, 5);
    let coarse = numbers(9, h.nodes());
    assert_eq!(h.at(&coarse, DVec2::new(-5.0, -1.0)), coarse[0]);
    assert_eq!(h.at(&coarse, DVec2::new(99.0, 99.0)), coarse[24]);
}
