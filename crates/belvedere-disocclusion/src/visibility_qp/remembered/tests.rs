use super::*;
use std::sync::atomic::{AtomicUsize, Ordering};

/// Lines that bow upwards, and how many were traced.
struct Bowed(AtomicUsize);

impl LinesOfSight for Bowed {
    fn trace(&self, grid: DVec2, z: f64, out: &mut Vec<(DVec2, f64)>) {
        self.0.fetch_add(1, Ordering::Relaxed);
        let eye = DVec2::new(50.0, 0.0);
        out.extend((0..=10).map(|k| {
            let t = f64::from(k) / 10.0;
            (grid.lerp(eye, t), z + (900.0 - z) * t + 30.0 * t * (1.0 - t))
        }));
    }
}

#[test]
fn a_line_is_traced_once_while_its_point_stays_near_and_shifted_between() {
    let lines = RememberedLines::new(Bowed(AtomicUsize::new(0)));
    let (grid, mut first, mut again) = (DVec2::new(3.0, 7.0), Vec::new(), Vec::new());
    lines.trace(grid, 500.0, &mut first);
    lines.trace(grid, 500.013, &mut again);
    assert_eq!(lines.sight.0.load(Ordering::Relaxed), 1);
    let mut exact = Vec::new();
    Bowed(AtomicUsize::new(0)).trace(grid, 500.013, &mut exact);
    assert_eq!(again.len(), exact.len());
    for (a, b) in again.iter().zip(&exact) {
        assert!(a.0 == b.0 && (a.1 - b.1).abs() < 1e-9, "{a:?} {b:?}");
    }
    assert!((again[0].1 - 500.013).abs() < 1e-12, "the point itself lies where it is");
    lines.trace(grid, 501.0, &mut Vec::new());
    lines.trace(grid + 1e-9, 501.0, &mut Vec::new());
    assert_eq!(lines.sight.0.load(Ordering::Relaxed), 3, "another height, another point");
}

#[test]
fn answers_do_not_depend_on_what_was_traced_before() {
    let (fresh, used) =
        (RememberedLines::new(Bowed(AtomicUsize::new(0))), RememberedLines::new(Bowed(AtomicUsize::new(0))));
    let grid = DVec2::new(3.0, 7.0);
    for k in 0..7 {
        used.trace(grid, 499.9 + 0.03 * f64::from(k), &mut Vec::new());
    }
    let (mut a, mut b) = (Vec::new(), Vec::new());
    fresh.trace(grid, 500.0, &mut a);
    used.trace(grid, 500.0, &mut b);
    assert_eq!(a, b);
}
