use super::super::surface::Lattice;
use super::*;
use belvedere_core::DVec2;

/// Reproducible numbers in 0..1.
fn number(i: usize) -> f64 {
    (i as f64 * 0.618_033_988_749_895).fract()
}

#[test]
fn lines_abreast_miss_what_each_of_them_misses_alone() {
    let clearance = Clearance { margin: 1.0, tolerance: 0.2, near: 0.3, guard: 1.5 };
    for (cols, rows, nodes) in [(33, 25, [5, 4]), (41, 31, [6, 7]), (12, 12, [12, 12]), (9, 7, [1, 2])] {
        let step =
            DVec2::new((cols - 1) as f64 / (nodes[0] - 1).max(1) as f64, (rows - 1) as f64 / (nodes[1] - 1) as f64);
        let heights: Vec<f64> = (0..cols * rows).map(|i| 40.0 * number(i * i)).collect();
        let mut surface = Surface::new(&heights, cols, rows, Lattice { cols: nodes[0], rows: nodes[1], step });
        surface.displace(&(0..nodes[0] * nodes[1]).map(|i| -30.0 * number(7 * i + 3)).collect::<Vec<_>>());
        let last = DVec2::new((cols - 1) as f64, (rows - 1) as f64);
        for case in 0..40 {
            let r = |k: usize| number(100 * case + k);
            let eye = match case % 4 {
                0 => DVec2::new(r(1), r(2)) * last,
                1 => DVec2::new(r(1) * 3.0 - 1.0, -5.0),
                // Along the lines of the grid and through nodes.
                2 => DVec2::new((r(1) * last.x).floor(), (r(2) * last.y).floor()),
                _ => DVec2::new(last.x, last.y),
            };
            let first = if case % 4 == 2 { DVec2::new(eye.x, 0.0) } else { DVec2::new(r(3), r(4)) * last };
            let lines: Vec<(usize, Chord, [f64; 2])> = (0..1 + case % LANES)
                .filter_map(|k| {
                    let point = (first + 0.3 * k as f64).min(last);
                    let chord = Chord { ends: [point, eye], z: [20.0 * r(5), 60.0 * r(6)], tau: [0.0, 1.0] };
                    Some((k, chord, chord.part(&surface, point, clearance.guard)?))
                })
                .collect();
            if lines.is_empty() {
                continue;
            }
            let parts = [[0.0, 1.0], [0.2, 0.4 + 0.2 * r(7)], [0.999, 1.0]];
            let mut found = Vec::new();
            Lanes::new(&lines, &clearance).most(&surface, &parts, &mut found);
            for (part, found) in parts.iter().zip(&found) {
                for ((_, chord, whole), found) in lines.iter().zip(found) {
                    let part = [part[0].max(whole[0]), part[1].min(whole[1])];
                    let missing = |t: f64| {
                        let at = chord.ends[0] + t * (chord.ends[1] - chord.ends[0]);
                        let line = chord.z[0] + t * (chord.z[1] - chord.z[0]);
                        let ground = surface.ground(at) + surface.displacement(at);
                        ground - line + (clearance.margin - clearance.tolerance) * clearance.share(t)
                    };
                    // Kinks, and the ends of lines; what lies at the end of a part counts in one of its neighbours.
                    let mut all = f64::NEG_INFINITY;
                    if part[0] <= part[1] {
                        chord.kinks(&surface, part, &clearance, &mut |touch| {
                            let end = part.iter().any(|t| (t - touch.tau).abs() < 1e-12);
                            let inside = touch.tau > part[0] && touch.tau < part[1] && !end;
                            if whole.contains(&touch.tau) || inside {
                                all = all.max(missing(touch.tau));
                            }
                        });
                    }
                    let between = (0..=300).map(|k| missing(part[0] + (part[1] - part[0]) * f64::from(k) / 300.0));
                    let most = between.fold(all, f64::max);
                    let context = format!("{cols} x {rows}, case {case}, {part:?}: {found} for {all}, {most}");
                    if part[0] <= part[1] {
                        assert!(*found >= all - 1e-9 && (part != *whole || *found >= most - 1e-9), "{context}");
                        assert!(*found <= all.max(most) + 1e-9, "{context}");
                    } else {
                        assert_eq!(*found, f64::NEG_INFINITY, "{context}");
                    }
                }
            }
        }
    }
}
