//! Colour-relief text of GDAL (`gdaldem color-relief`), also what GRASS writes.
//!
//! One colour a line: height, red, green, blue and, if given, alpha, or height and the name of a colour; separated by
//! blanks, commas or colons. The height is a number, a percentage of the ground's range, or `nv` (no data).
//! `#` begins a comment. Source: GDAL, manual of gdaldem.

use super::colors::{channel, hex, named};
use super::{at_line, shown};
use crate::Loaded;
use belvedere_core::{Warning, WarningKind};
use belvedere_scene::{Color, Ramp, RampHeight, RampStop};

/// Reads the text of a file.
///
/// # Errors
/// One sentence with the number of the line.
pub fn read(text: &str) -> Result<Loaded<Ramp>, String> {
    let mut ramp = Ramp::default();
    let mut warnings = Vec::new();
    for (i, line) in text.lines().enumerate() {
        let line = line.trim();
        if line.is_empty() || line.starts_with('#') {
            continue;
        }
        let is_gap = |c: char| c.is_whitespace() || c == ',' || c == ':';
        let words: Vec<&str> = line.split(is_gap).filter(|w| !w.is_empty()).collect();
        let Some((first, rest)) = words.split_first() else { continue };
        let color = color(rest).map_err(|e| at_line(i + 1, e))?;
        match *first {
            // Voids are not painted.
            w if w.eq_ignore_ascii_case("nv") => {}
            w if w.eq_ignore_ascii_case("default") => {
                let text = at_line(i + 1, "\"default\" is ignored: every height has a colour here");
                warnings.push(Warning::new(WarningKind::Ignored, text).with("line", (i + 1) as f64));
            }
            w => ramp.stops.push(RampStop { height: height(w).map_err(|e| at_line(i + 1, e))?, color }),
        }
    }
    if ramp.stops.is_empty() {
        return Err("it holds no line of the form \"height red green blue\"; give a colour-relief text".into());
    }
    Ok(Loaded::new(ramp, warnings))
}

fn height(word: &str) -> Result<RampHeight, String> {
    let number = |w: &str| w.parse::<f64>().ok().filter(|v| v.is_finite());
    let found = match word.strip_suffix('%') {
        Some(percent) => number(percent).map(|p| RampHeight::Share(p / 100.0)),
        None => number(word).map(RampHeight::Metres),
    };
    found.ok_or_else(|| format!("\"{}\" is no height; give a number, a percentage or nv", shown(word)))
}

fn color(words: &[&str]) -> Result<Color, String> {
    match words {
        [word] => named(word).or_else(|| hex(word)).ok_or_else(|| {
            format!("\"{}\" is no colour that is known by name; give red green blue in 0..=255", shown(word))
        }),
        [r, g, b] => Ok(Color::rgb(channel(r)?, channel(g)?, channel(b)?)),
        [r, g, b, a] => Ok(Color::rgb(channel(r)?, channel(g)?, channel(b)?).with_alpha(channel(a)?)),
        _ => Err(format!("{} values follow the height; give red green blue, or a name", words.len())),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn heights_percentages_names_and_separators_are_read() {
        let text = "# my ramp\n\n3500   white\n2500,235:220 175\n50%   190 185 135 128\n700 240.4 250 150\n\n0 #0a0b0c\nnv 0 0 0 0\n";
        let got = read(text).unwrap().value;
        let want = [
            (RampHeight::Metres(3500.0), Color::rgb(255, 255, 255)),
            (RampHeight::Metres(2500.0), Color::rgb(235, 220, 175)),
            (RampHeight::Share(0.5), Color::rgb(190, 185, 135).with_alpha(128)),
            (RampHeight::Metres(700.0), Color::rgb(240, 250, 150)),
            (RampHeight::Metres(0.0), Color::rgb(10, 11, 12)),
        ];
        assert_eq!(got.stops.len(), want.len());
        for (got, (height, color)) in got.stops.iter().zip(want) {
            assert_eq!((got.height, got.color), (height, color));
        }
    }

    #[test]
    fn wrong_lines_are_named() {
        for (text, line, word) in [
            ("0 0 0 0\nhigh 1 2 3", "line 2", "high"),
            ("0 0 0 300", "line 1", "300"),
            ("0 0 0", "line 1", "2 values"),
            ("# c\n5 mauve", "line 2", "mauve"),
            ("inf 1 2 3", "line 1", "inf"),
            ("# nothing", "no line", "height"),
        ] {
            let e = read(text).unwrap_err();
            assert!(e.contains(line) && e.contains(word), "{text}: {e}");
        }
    }
}
