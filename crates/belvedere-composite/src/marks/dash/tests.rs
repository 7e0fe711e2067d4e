use super::*;
use crate::marks::path::LinePoint;
use belvedere_core::{DVec2, DVec3};

/// Beginnings of the dashes along a straight line of 1000 units seen at `px_per_unit` from unit `from` on, scene units.
fn beginnings(from: f64, px_per_unit: f64) -> Vec<f64> {
    let n = ((1000.0 - from) * px_per_unit) as usize;
    let part: Vec<Station> = (0..=n)
        .map(|i| {
            let along = from + i as f64 / px_per_unit;
            let on_line = LinePoint { p: DVec3::X * along, along, on_ground: false };
            Station { pixel: DVec2::new(along * px_per_unit, 10.0), arc_px: i as f64, on_line }
        })
        .collect();
    let mut strokes = Vec::new();
    dashes(&part, 3.0, 1.0, 1.0, &mut strokes);
    let mut starts: Vec<f64> = Vec::new();
    let mut end = f64::NEG_INFINITY;
    for s in &strokes {
        let [a, b] = s.ends().map(|p| f64::from(p.x) / px_per_unit);
        if a > end + 1e-3 {
            starts.push(a);
        }
        end = b;
    }
    starts
}

#[test]
fn dashes_lie_still_on_the_ground() {
    // Dashes keep their positions when a line becomes visible earlier or is seen from slightly nearer.
    let seen = beginnings(0.0, 1.0);
    assert!(seen.len() > 40, "{} dashes", seen.len());
    let period = seen[1] - seen[0];
    assert!((13.2..=26.4).contains(&period), "period {period} px");
    for other in [beginnings(3.7, 1.0), beginnings(101.3, 1.0), beginnings(0.0, 1.04), beginnings(57.0, 0.97)] {
        for start in &other[1..other.len() - 1] {
            let off = (start / period).round() * period - start;
            assert!(off.abs() < 1e-2, "a dash begins at {start}, {off} off the multiples of {period}");
        }
    }
}
