//! Colours as words and numbers.

use super::shown;
use belvedere_scene::Color;

/// Names of colours that both formats share (those of GDAL, and the plain ones of X11).
const NAMES: &[(&str, [u8; 3])] = &[
    ("white", [255, 255, 255]),
    ("black", [0, 0, 0]),
    ("red", [255, 0, 0]),
    ("green", [0, 255, 0]),
    ("blue", [0, 0, 255]),
    ("yellow", [255, 255, 0]),
    ("magenta", [255, 0, 255]),
    ("cyan", [0, 255, 255]),
    ("aqua", [0, 191, 191]),
    ("grey", [191, 191, 191]),
    ("gray", [191, 191, 191]),
    ("orange", [255, 127, 0]),
    ("brown", [191, 127, 63]),
    ("purple", [127, 0, 127]),
    ("violet", [127, 0, 255]),
    ("indigo", [0, 127, 191]),
];

/// A colour by name.
pub(super) fn named(word: &str) -> Option<Color> {
    let found = NAMES.iter().find(|(name, _)| name.eq_ignore_ascii_case(word))?;
    let [r, g, b] = found.1;
    Some(Color::rgb(r, g, b))
}

/// `#rrggbb`.
pub(super) fn hex(word: &str) -> Option<Color> {
    let digits = word.strip_prefix('#').filter(|d| d.len() == 6 && d.bytes().all(|b| b.is_ascii_hexdigit()))?;
    let byte = |i: usize| u8::from_str_radix(digits.get(2 * i..2 * i + 2)?, 16).ok();
    Some(Color::rgb(byte(0)?, byte(1)?, byte(2)?))
}

/// A channel, 0..=255; fractions are rounded.
pub(super) fn channel(word: &str) -> Result<u8, String> {
    let value: f64 = word.parse().map_err(|_| format!("\"{}\" is no number of a colour in 0..=255", shown(word)))?;
    if (0.0..=255.0).contains(&value) {
        return Ok((value + 0.5) as u8);
    }
    Err(format!("a colour has the value {value}, it must lie in 0..=255"))
}

/// Hue in degrees 0..=360, saturation and value 0..=1.
pub(super) fn from_hsv([h, s, v]: [f64; 3]) -> Result<Color, String> {
    if !((0.0..=360.0).contains(&h) && (0.0..=1.0).contains(&s) && (0.0..=1.0).contains(&v)) {
        return Err(format!("{h} {s} {v} is no colour; hue lies in 0..=360, saturation and value in 0..=1"));
    }
    // How far each primary is from the hue, in sixths of the circle.
    let part = |of: f64| {
        let k = (of + h / 60.0).rem_euclid(6.0);
        v - v * s * k.min(4.0 - k).clamp(0.0, 1.0)
    };
    let [r, g, b] = [5.0, 3.0, 1.0].map(|of| (part(of) * 255.0 + 0.5) as u8);
    Ok(Color::rgb(r, g, b))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn colours_are_read_in_every_notation() {
        assert_eq!(named("Red"), Some(Color::rgb(255, 0, 0)));
        assert_eq!(hex("#0a10ff"), Some(Color::rgb(10, 16, 255)));
        assert_eq!((hex("#0a10f"), hex("#0a1ég"), named("mauve")), (None, None, None));
        for (hsv, rgb) in [
            ([0.0, 1.0, 1.0], [255, 0, 0]),
            ([60.0, 1.0, 1.0], [255, 255, 0]),
            ([120.0, 1.0, 1.0], [0, 255, 0]),
            ([240.0, 1.0, 0.5], [0, 0, 128]),
            ([300.0, 0.5, 1.0], [255, 128, 255]),
            ([17.0, 0.0, 0.2], [51, 51, 51]),
        ] {
            assert_eq!(from_hsv(hsv), Ok(Color::rgb(rgb[0], rgb[1], rgb[2])), "{hsv:?}");
        }
        assert!(from_hsv([400.0, 0.0, 0.0]).is_err() && channel("256").is_err() && channel("nan").is_err());
    }
}
