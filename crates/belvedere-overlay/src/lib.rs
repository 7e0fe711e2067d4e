//! What lies over a drawn picture: marks that explain the bend, furniture, legends, pictures of the camera; and pictures as vectors, on paper.
//!
//! Nothing here draws surfaces: frames come from a renderer, and what is drawn on them needs a [`belvedere_scene::Frame`] only.

pub mod badge;
pub mod camera;
pub mod contour;
pub mod curve_inset;
pub mod furniture;
pub mod ghost;
pub mod grid;
pub mod heat;
pub mod highlight;
pub mod notes;
pub mod ring;
pub mod sheet;
pub mod thin;
pub mod vectors;
pub mod widths;

use belvedere_scene::Color;

/// Ink of texts and of the lines of legends.
pub const INK: Color = Color::rgb(38, 44, 54);
/// Background of legends.
pub const PAPER: Color = Color { r: 255, g: 255, b: 255, a: 224 };

/// The next round number (1, 2 or 5 times a power of ten) at or below `value`; 0 if there is none.
fn round_below(value: f64) -> f64 {
    if !(value > 0.0 && value.is_finite()) {
        return 0.0;
    }
    let power = 10f64.powf(value.log10().floor());
    [5.0, 2.0, 1.0, 0.5].map(|k| k * power).into_iter().find(|v| *v <= value * 1.000_001).unwrap_or(power)
}

/// A length with its unit.
pub fn length(value: f64) -> String {
    match value {
        v if v >= 1000.0 => format!("{} km", (v / 100.0).round() / 10.0),
        v if v >= 10.0 => format!("{v:.0} m"),
        v => format!("{} m", (v * 100.0).round() / 100.0),
    }
}

/// A length rounded up, as a bound: metres to three digits, tenths below 10 m.
fn length_above(metres: f64) -> String {
    if metres > 0.0 && metres.is_finite() { number_above(metres) + " m" } else { "0 m".into() }
}

/// A number rounded up to a tenth, above 10 to three digits; 0 unless it is positive and finite.
fn number_above(value: f64) -> String {
    if !(value > 0.0 && value.is_finite()) {
        return "0".into();
    }
    let step = if value < 10.0 { 0.1 } else { 10f64.powf((value.log10().floor() - 2.0).max(0.0)) };
    let up = (value / step - 1e-9).ceil() * step;
    if value < 10.0 { format!("{up:.1}") } else { format!("{up:.0}") }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lengths_are_round_and_readable() {
        assert_eq!([0.7, 1.0, 4.9, 5.0, 99.0, 1234.0].map(round_below), [0.5, 1.0, 2.0, 5.0, 50.0, 1000.0]);
        assert_eq!([round_below(0.0), round_below(f64::NAN), round_below(f64::INFINITY)], [0.0; 3]);
        assert_eq!(
            [0.01, 3.11, 99.2, 100.0, 341.2, 1234.0].map(length_above),
            ["0.1 m", "3.2 m", "100 m", "100 m", "342 m", "1240 m"]
        );
        assert_eq!([0.0, f64::NAN, -3.0].map(length_above), ["0 m"; 3].map(str::to_owned));
        assert_eq!([0.25, 37.4, 2500.0, 30_000.0].map(length), ["0.25 m", "37 m", "2.5 km", "30 km"]);
    }
}
