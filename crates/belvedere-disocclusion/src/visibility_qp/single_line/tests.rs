use super::super::problem::{Candidate, LinesOfSight, QpProblem};
use super::super::surface::Lattice;
use super::*;
use crate::cells::tests::noise;
use belvedere_core::DVec2;

/// Rises from the point, bows aside and ends in the eye.
struct Bowed;

impl LinesOfSight for Bowed {
    fn trace(&self, grid: DVec2, z: f64, out: &mut Vec<(DVec2, f64)>) {
        let (eye, top) = (DVec2::new(38.0, 3.0), 130.0);
        out.extend((0..=6).map(|k| {
            let t = f64::from(k) / 6.0;
            (grid.lerp(eye, t) + DVec2::new(8.0 * t * (1.0 - t), 0.0), z + t * (2.0 - t) * (top - z))
        }));
    }
}

#[test]
fn what_has_room_is_not_missed_however_the_ground_moves() {
    let (nodes, coarse) = (41, 21);
    let heights: Vec<f64> = (0..nodes * nodes).map(|i| 90.0 * noise(i, 1) * noise(i / 5, 2)).collect();
    let step = DVec2::splat((nodes - 1) as f64 / (coarse - 1) as f64);
    let mut surface = Surface::new(&heights, nodes, nodes, Lattice { cols: coarse, rows: coarse, step });
    let candidates: Vec<Candidate> = (0..60)
        .map(|id| Candidate { id, grid: DVec2::new(1.0 + 0.5 * f64::from(id), 38.0 - 0.3 * f64::from(id)), lift: 2.0 })
        .collect();
    let problem = QpProblem { candidates: &candidates, sight: &Bowed, target: None, ceilings: None };
    let seen = CandidateLine::all(&problem, &surface);
    let clearance = Clearance { margin: 1.0, tolerance: 0.2, near: 0.3, guard: 1.5 };
    let fresh = || (0..seen.len()).map(|k| SingleLine::new(k, &seen[k])).collect::<Vec<_>>();
    let (mut lines, mut touches, mut roomy) = (fresh(), 0, 0);
    for round in 0..40 {
        for (line, mut anew) in lines.iter_mut().zip(fresh()) {
            roomy += line.rooms.iter().filter(|room| **room > 0.0).count();
            let found = line.walk(&seen, &surface, &clearance);
            assert_eq!(found, anew.walk(&seen, &surface, &clearance), "round {round}");
            touches += found.len();
        }
        // A hill grows steadily, the rest goes up and down and sinks.
        let step = |i: usize| {
            let (x, y) = (i % coarse, i / coarse);
            let hill = (9..13).contains(&x) && (8..12).contains(&y);
            if hill { 2.0 } else { 2.0 * (noise(i, 10 + round) - 0.7) }
        };
        let u: Vec<f64> = surface.u.iter().enumerate().map(|(i, u)| u + step(i)).collect();
        let rose: Vec<f64> = surface.u.iter().zip(&u).map(|(before, after)| after - before).collect();
        let rise = Rise::new(&surface.lattice, &rose);
        lines.iter_mut().for_each(|line| line.moved(&seen, &rise));
        surface.displace(&u);
    }
    assert!(touches > 300 && roomy > 1000, "{touches} touches, {roomy} chords with room");
}
