//! Marks along a line at equal distances over the ground.

use crate::marks::path::LinePoint;
use belvedere_scene::DistanceMarkers;

/// Number of marks on the longest line when the distance is chosen automatically.
const WANTED: f64 = 10.0;
/// Most marks on a line.
const MOST_MARKS: usize = 2000;

/// Distance between marks for lines of these lengths, scene units; `None` if no mark fits.
pub(crate) fn spacing(markers: DistanceMarkers, lengths: impl Iterator<Item = f64>) -> Option<f64> {
    let longest = lengths.fold(0.0, f64::max);
    let every = match markers {
        DistanceMarkers::Every(every) => every,
        DistanceMarkers::Auto => round(longest / WANTED),
    };
    (every > 0.0 && every < longest && longest / every <= MOST_MARKS as f64).then_some(every)
}

/// The next round number (1, 2 or 5 times a power of ten) at or above a value.
fn round(value: f64) -> f64 {
    if !(value > 0.0 && value.is_finite()) {
        return 0.0;
    }
    let power = 10f64.powf(value.log10().floor());
    [1.0, 2.0, 5.0, 10.0].map(|k| k * power).into_iter().find(|v| *v >= value * 0.999_999).unwrap_or(10.0 * power)
}

/// Points at multiples of `every` along the draped line, except its beginning, with their texts.
pub(crate) fn marks(line: &[LinePoint], every: f64) -> Vec<(LinePoint, String)> {
    let mut out = Vec::new();
    let mut next = every;
    for pair in line.windows(2) {
        let (a, b) = (pair[0], pair[1]);
        while next <= b.along && b.along > a.along {
            out.push((a.lerp(b, (next - a.along) / (b.along - a.along)), text(next, every)));
            next = every * (out.len() + 1) as f64;
        }
    }
    out
}

fn text(distance: f64, every: f64) -> String {
    if every >= 1000.0 && every % 500.0 == 0.0 {
        let km = distance / 1000.0;
        return if every % 1000.0 == 0.0 { format!("{km:.0} km") } else { format!("{km:.1} km") };
    }
    format!("{distance:.0} m")
}

#[cfg(test)]
mod tests {
    use super::*;
    use belvedere_core::DVec3;

    #[test]
    fn marks_are_equally_far_apart_over_the_ground() {
        // On a slope of 3 in 4, a line of 5 units covers 4 in plan.
        let at = |x: f64| LinePoint { p: DVec3::new(x, 0.0, 0.75 * x), along: 1.25 * x, on_ground: true };
        let line: Vec<LinePoint> = (0..=64).map(|i| at(f64::from(i) * 62.5)).collect();
        let marks = marks(&line, 1000.0);
        assert_eq!(marks.len(), 5);
        for (i, (on_line, name)) in marks.iter().enumerate() {
            assert!((on_line.p.x - 800.0 * (i + 1) as f64).abs() < 1e-9, "{on_line:?}");
            assert_eq!(*name, format!("{} km", i + 1));
        }
        assert_eq!(spacing(DistanceMarkers::Auto, [700.0, 4300.0].into_iter()), Some(500.0));
        assert_eq!(spacing(DistanceMarkers::Every(1000.0), [900.0].into_iter()), None);
        assert_eq!(text(1500.0, 500.0), "1500 m");
    }
}
