use super::super::dual::Dual;
use super::*;
use crate::smooth::{Between, Smoother};

/// A displacement of one node, or of one against another.
fn row(k: usize, nodes: usize) -> Row {
    let node = |i: usize| Between::node((i % (nodes * nodes)) as u32, nodes, nodes);
    let (a, b) = (k * 37 + k / 7, k * 53 + 11);
    let mut row = Row::ceiling((a % (nodes * nodes)) as u32, node(a), 0.0);
    if !k.is_multiple_of(3) {
        let share = -0.1 * (k % 7) as f64;
        (row.nodes[1], row.weights[1], row.len) = ((b % (nodes * nodes)) as u32, share, 2);
        row.points[1] = (share, node(b));
    }
    row
}

fn negated(mut row: Row) -> Row {
    row.weights.iter_mut().for_each(|w| *w = -*w);
    row.points.iter_mut().for_each(|p| p.0 = -p.0);
    row
}

/// Rows of a seeded program, on a grid of `nodes` a side, with their excess.
fn program(seed: u64, nodes: usize, count: usize, copies: bool) -> Vec<(Row, f64)> {
    let mut random = belvedere_testkit::Random::new(seed);
    let mut out: Vec<(Row, f64)> = Vec::new();
    for k in 0..count {
        let excess = 12.0 * random.unit() - 6.0;
        let earlier = out.get((random.unit() * k as f64) as usize).copied();
        out.push(match earlier {
            Some((row, same)) if copies && k % 3 == 1 => (row, same + 0.1 * (k % 2) as f64),
            // No displacement meets both.
            Some((row, same)) if copies && k % 9 == 2 => (negated(row), 1.0 - same),
            _ => (row((random.unit() * 1e4) as usize, nodes), excess),
        });
    }
    out
}

/// Solves a program without a matrix, by crowds or by the sparse factor, and by the active set.
fn solved(metric: &mut Metric, program: &[(Row, f64)], soft: f64, many: usize) -> (MatrixFree, Dual, bool) {
    let (mut free, mut dual) = (MatrixFree { many: Some(many), ..MatrixFree::default() }, Dual::default());
    for (k, (row, excess)) in program.iter().enumerate() {
        let products: Vec<f64> = program[..=k].iter().map(|(other, _)| row.product(other, metric)).collect();
        free.push(row, products[k], 1e-7, [soft, *excess, 0.0]);
        dual.push(&products, soft, *excess, 0.0);
    }
    let met = free.cycles(metric, 0.0, [40, NEWTON_STEPS], NEARNESS, &|| true);
    assert!(dual.solve(1e-9, &|| true));
    (free, dual, met)
}

#[test]
fn multipliers_are_those_of_the_active_set() {
    let nodes = 25;
    let mut metric = Metric::new(Smoother::new(nodes, nodes, 0.4, 0.0).unwrap());
    let rows: Vec<(Row, f64)> = (0..300).map(|k| (row(k, nodes), ((k * 7919) % 13) as f64 - 6.0)).collect();
    for (soft, many) in [(0.0, usize::MAX), (0.05, usize::MAX), (0.0, 0), (0.05, 0)] {
        let (free, dual, met) = solved(&mut metric, &rows, soft, many);
        assert!(met);
        let (mut held, mut largest) = (0, 0.0f64);
        for k in 0..rows.len() {
            held += usize::from(dual.multiplier(k) > 0.0);
            largest = largest.max(dual.multiplier(k));
        }
        let apart = (free.energy() - dual.energy()).abs() / dual.energy();
        assert!(apart < 1e-6, "energies {} and {}", free.energy(), dual.energy());
        let off = |k: usize| (free.multiplier(k) - dual.multiplier(k)).abs();
        let off = (0..rows.len()).map(off).fold(0.0, f64::max) / largest;
        assert!(off < 1e-3 && held > 30 && held < 250, "{held} held, multipliers {off} apart");
    }
}

#[test]
fn random_programs_have_the_energy_of_the_active_set() {
    let mut held = 0;
    for (seed, (nodes, count, copies)) in
        [(25, 200, false), (25, 200, true), (9, 60, true), (2, 9, true), (2, 1, false), (9, 0, false)]
            .into_iter()
            .cycle()
            .take(24)
            .enumerate()
    {
        let mut metric = Metric::new(Smoother::new(nodes, nodes, 0.4, 0.0).unwrap());
        let program = program(seed as u64, nodes, count, copies);
        for many in [0, usize::MAX] {
            let (free, dual, met) = solved(&mut metric, &program, 0.02, many);
            let label = format!("seed {seed}, {nodes} nodes, {} rows, from {many}", program.len());
            assert!(met, "{label}");
            let apart = (free.energy() - dual.energy()).abs();
            assert!(apart <= 1e-6 * dual.energy(), "{label}: {} and {}", free.energy(), dual.energy());
            held += (0..program.len()).filter(|k| free.multiplier(*k) > 0.0).count();
        }
    }
    assert!(held > 500, "{held}");
}

#[test]
fn threads_change_nothing() {
    let of = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| {
            let mut metric = Metric::new(Smoother::new(41, 41, 0.4, 0.0).unwrap());
            let program = program(7, 41, 500, true);
            let (free, ..) = solved(&mut metric, &program, 0.02, 0);
            free.m.iter().map(|m| m.to_bits()).collect::<Vec<_>>()
        })
    };
    let one = of(1);
    assert!(one.iter().filter(|m| **m > 0).count() > 50);
    assert!([2, 3, 7].into_iter().all(|threads| of(threads) == one));
}

#[test]
fn it_stops_when_told_to() {
    let nodes = 25;
    let mut metric = Metric::new(Smoother::new(nodes, nodes, 0.4, 0.0).unwrap());
    let mut free = MatrixFree::default();
    for k in 0..200 {
        let row = row(k, nodes);
        let square = row.product(&row, &metric);
        free.push(&row, square, 1e-9, [0.0, 5.0, 0.0]);
    }
    assert!(!free.solve(&mut metric, Effort::Exact, &|| false));
    // Half-way, with a sparse factor: multipliers that were taken are no worse than none.
    let mut direct = MatrixFree { many: Some(0), ..free.clone() };
    let asked = std::sync::atomic::AtomicUsize::new(0);
    direct.solve(&mut metric, Effort::Exact, &|| asked.fetch_add(1, std::sync::atomic::Ordering::Relaxed) < 3);
    assert!(direct.m.iter().all(|m| *m >= 0.0) && direct.energy() >= 0.0);
    let gain: f64 = direct.m.iter().map(|m| 5.0 * m).sum();
    assert!(gain >= direct.energy(), "{gain} {}", direct.energy());
    assert!(direct.solve(&mut metric, Effort::Within(0.01), &|| true));
    // To a billionth of a metre in as many cycles as it takes.
    assert!(free.cycles(&mut metric, 0.0, [40, NEWTON_STEPS], NEARNESS, &|| true));
}
