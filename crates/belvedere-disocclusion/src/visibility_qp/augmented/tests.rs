use super::*;
use crate::smooth::{Between, Smoother};

/// The multipliers are those at which no row's own step gains anything, also where a lake moves as one, and for rows that occur twice.
#[test]
fn the_minimum_is_that_of_every_row() {
    let (cols, rows) = (23usize, 19usize);
    for lake in [false, true] {
        let mut metric = Metric::new(Smoother::new(cols, rows, 0.4, 0.0).unwrap());
        if lake {
            metric.tie(&[(6..12).flat_map(|y| (4..9).map(move |x| y * 23 + x)).collect()]);
        }
        let node = |i: usize| Between::node((i % (cols * rows)) as u32, cols, rows);
        let of = |k: usize| {
            let (a, b) = (k * 37, k * 53 + 11);
            let mut row = Row::ceiling((a % (cols * rows)) as u32, node(a), 0.0);
            if !k.is_multiple_of(3) {
                (row.nodes[1], row.weights[1], row.len) = ((b % (cols * rows)) as u32, -0.3, 2);
                row.points[1] = (-0.3, node(b));
            }
            row
        };
        let all: Vec<Row> = (0..60usize).map(|k| of(k / 2 * (1 + k % 5))).collect();
        let terms = Terms {
            wanted: (0..all.len()).map(|k| ((k * 7919) % 13) as f64 - 6.0).collect(),
            diagonal: (0..all.len()).map(|k| 1e-3 * (1 + k % 7) as f64).collect(),
            allowed: vec![1e-9; all.len()],
        };
        let rest = vec![0.0; all.len()];
        let (m, done) = Augmented::new(&metric, &all).minimum(&terms, (&rest, &rest), 60, &|| true);
        assert!(done && m.iter().filter(|m| **m > 0.0).count() > 10);
        let mut nodes = vec![0.0; cols * rows];
        for (row, m) in all.iter().zip(&m) {
            row.entries().for_each(|(node, w)| nodes[node as usize] += w * m);
        }
        metric.solve(&mut nodes);
        for (k, (row, m)) in all.iter().zip(&m).enumerate() {
            let slope = row.at(&nodes) + terms.diagonal[k] * m - terms.wanted[k];
            let off = if *m > 0.0 { slope.abs() } else { (-slope).max(0.0) };
            assert!(off < 1e-7, "row {k}: multiplier {m}, slope {slope}");
        }
    }
}

#[test]
fn the_line_search_finds_the_least_value() {
    let random = &mut belvedere_testkit::Random::new(5);
    let mut tried = 0;
    for _ in 0..200 {
        let mut some = || (0..9).map(|_| random.range(-3.0, 3.0)).collect::<Vec<f64>>();
        let (over, rise) = (some(), some());
        let terms = Terms { wanted: some(), diagonal: vec![0.01; 9], allowed: vec![0.0; 9] };
        let (slope, curvature) = (-100.0, 1.0);
        let whole = |far: f64| {
            let rows = over.iter().zip(&rise).map(|(over, rise)| (over + far * rise).max(0.0).powi(2) / 0.02);
            far * slope + 0.5 * far * far * curvature + rows.sum::<f64>()
        };
        // Down from the start.
        if whole(1e-6) >= whole(0.0) {
            continue;
        }
        tried += 1;
        let least = whole(terms.line_search(&over, &rise, slope, curvature));
        assert!(least < whole(0.0));
        assert!((0..=2000).all(|k| whole(0.1 * f64::from(k)) >= least - 1e-9 * least.abs()), "{least}");
    }
    assert!(tried > 40, "{tried}");
}
