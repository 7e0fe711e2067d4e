use super::super::metric::Metric;
use super::super::row::Row;
use super::*;

fn sets() -> [Vec<u32>; 2] {
    let lake = (6..12).flat_map(|y| (4..9).map(move |x| y * 21 + x)).collect();
    let pond = vec![15 * 21 + 12, 15 * 21 + 13, 16 * 21 + 12];
    [lake, pond]
}

#[test]
fn the_inverse_is_level_and_its_entries_are_those_of_rows() {
    let mut metric = Metric::new(Smoother::new(21, 19, 0.4, 0.0).unwrap());
    metric.tie(&sets());
    for k in [0u32, 7 * 21 + 5, 15 * 21 + 12, 9 * 21 + 14, 200] {
        let mut u = vec![0.0; 21 * 19];
        u[k as usize] = 1.0;
        metric.solve(&mut u);
        for set in sets() {
            let values: Vec<f64> = set.iter().map(|n| u[*n as usize]).collect();
            assert!(values.iter().all(|v| *v == values[0]), "{values:?}");
        }
        let row = |n: u32| Row::ceiling(n, Between::node(n, 21, 19), 0.0);
        let shared = |n: u32| metric.shared(&row(n).points).unwrap();
        for other in [0u32, 6 * 21 + 4, 100, 9 * 21 + 13, 300] {
            let entry = row(k).product(&row(other), &metric) - product(&shared(k), &shared(other));
            assert!((entry - u[other as usize]).abs() < 1e-10, "{k} {other}: {entry} and {}", u[other as usize]);
        }
    }
}

#[test]
fn the_level_displacement_next_to_one_is_the_nearest() {
    let (nodes, w) = (21 * 19, 0.4);
    let mut metric = Metric::new(Smoother::new(21, 19, w, 0.0).unwrap());
    metric.tie(&sets());
    let from: Vec<f64> = (0..nodes).map(|i| ((i * 7919) % 31) as f64 - 15.0).collect();
    let mut level = from.clone();
    metric.level(&mut level);
    let norm = |u: &[f64]| {
        let mut bent = vec![0.0; u.len()];
        crate::smooth::laplacian(21, u, &mut bent);
        bent.iter().map(|v| v * v).sum::<f64>() + w * w * u.iter().map(|v| v * v).sum::<f64>()
    };
    let apart = |u: &[f64]| norm(&u.iter().zip(&from).map(|(a, b)| a - b).collect::<Vec<_>>());
    let least = apart(&level);
    for k in 0..20 {
        let mut other = level.clone();
        let step = 0.01 * f64::from(k % 5 - 2) + 0.003;
        match k % 2 {
            0 => sets()[0].iter().for_each(|n| other[*n as usize] += step),
            _ => other[(k as usize * 61) % 80] += step,
        }
        assert!(apart(&other) > least, "{k}: {} and {least}", apart(&other));
    }
}
