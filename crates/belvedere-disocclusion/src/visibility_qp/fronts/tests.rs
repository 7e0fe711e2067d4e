use super::super::cholesky::Cholesky;
use super::*;
use std::collections::BTreeSet;

#[test]
fn it_solves_as_a_dense_factor_does() {
    for (cols, rows, far, tied) in [(31, 23, 60, 0), (40, 9, 5, 3), (17, 17, 300, 2), (3, 2, 1, 0), (1, 9, 0, 0)] {
        let nodes = cols * rows;
        let mut stands_for: Vec<u32> = (0..nodes as u32).collect();
        for k in 0..tied {
            stands_for[nodes / 2 + k] = (nodes / 2 - 1) as u32;
        }
        let own = |node: usize| stands_for[node];
        let (mut squares, mut pairs) = (Squares::default(), BTreeSet::new());
        let mut all: Vec<(Vec<(u32, f64)>, f64)> = Vec::new();
        for node in 0..nodes {
            let mut entries = vec![(own(node), -2.0)];
            entries.extend((node % cols > 0).then(|| (own(node - 1), 1.0)));
            entries.extend((node % cols + 1 < cols).then(|| (own(node + 1), 0.7)));
            entries.extend((node >= cols).then(|| (own(node - cols), 1.1)));
            entries.extend((node + cols < nodes).then(|| (own(node + cols), 0.9)));
            all.extend([(entries, 1.0), (vec![(own(node), 1.0)], 0.01)]);
        }
        for k in 0..far {
            let cell = |k: usize| {
                let (x, y) = (k * 37 % (cols - 1), (k * 61 + k / 5) % (rows - 1));
                [y * cols + x, y * cols + x + 1, (y + 1) * cols + x, (y + 1) * cols + x + 1].map(own)
            };
            let pair = [cell(k), cell(7 * k + 3)];
            let weight = |i: usize| 0.3 + 0.1 * ((i + k) % 5) as f64 - if i < 4 { 0.0 } else { 0.9 };
            all.push((pair.concat().into_iter().enumerate().map(|(i, node)| (node, weight(i))).collect(), 10.0));
            pairs.insert(pair);
        }
        all.iter().for_each(|(entries, scale)| squares.push(entries.iter().copied(), *scale));
        let factor = Factor::new(&Dissection::new([cols, rows], &stands_for, &pairs), &squares);

        let mut dense = vec![0.0; nodes * nodes];
        for (entries, scale) in &all {
            for (i, a) in entries {
                entries.iter().for_each(|(j, b)| dense[*i as usize * nodes + *j as usize] += scale * a * b);
            }
        }
        // Nodes that are not unknowns of their own stand alone.
        (0..nodes).filter(|i| own(*i) != *i as u32).for_each(|i| dense[i * nodes + i] = 1.0);
        let mut cholesky = Cholesky::default();
        for i in 0..nodes {
            cholesky.push(dense[i * nodes..i * nodes + i].iter().copied(), dense[i * nodes + i], 0.0);
        }
        let right: Vec<f64> = (0..nodes).map(|i| ((i * 7919) % 13) as f64 - 6.0).collect();
        let (mut got, mut expected) = (right.clone(), right);
        factor.solve(&mut got);
        cholesky.solve(&mut expected);
        let size = expected.iter().fold(0.0, |size: f64, x| size.max(x.abs()));
        let apart = got.iter().zip(&expected).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
        assert!(apart < 1e-9 * size, "{cols} x {rows}: {apart:e} of {size}");
    }
}
