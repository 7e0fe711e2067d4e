//! Colour palette tables of GMT (`.cpt`).
//!
//! A line is a slice of heights with the colours at its ends, `z0 colour z1 colour`, the colour being `r/g/b`, `r g b`,
//! `h-s-v`, a grey, a name or `#rrggbb`; `B`, `F` and `N` give the colours below, above and of no data. Comments may hold
//! `COLOR_MODEL`, `RANGE` and a hinge. Source: GMT reference, "Of colors and color legends".

use super::colors::{channel, from_hsv, hex, named};
use super::{at_line, shown};
use crate::Loaded;
use belvedere_core::{Warning, WarningKind};
use belvedere_scene::{Color, Ramp, RampHeight, RampStop};

/// Parts that a slice with colours between hues is cut into.
const HUE_PARTS: usize = 16;

/// Settings in the comments.
#[derive(Debug, Default)]
struct Header {
    /// Numbers of colours are hue, saturation and value.
    hsv: bool,
    /// Colours lie between hues rather than between red, green and blue.
    between_hues: bool,
    /// Natural range of heights.
    range: Option<[f64; 2]>,
    hinge: bool,
}

/// A colour, also as hue, saturation and value where it was given so.
#[derive(Debug, Clone, Copy)]
struct Tone {
    color: Color,
    hsv: Option<[f64; 3]>,
}

/// Heights and tones at the ends of a slice.
type Slice = [(f64, Tone); 2];

/// Reads the text of a file. Numbers that all lie in -1..=1 are shares of the ground's range, with a hinge at height 0 if
/// the table has one, unless `RANGE` says what they stand for; all others are metres.
///
/// # Errors
/// One sentence with the number of the line.
pub fn read(text: &str) -> Result<Loaded<Ramp>, String> {
    let (mut header, mut ramp, mut slices, mut warnings) =
        (Header::default(), Ramp::default(), Vec::<Slice>::new(), Vec::new());
    for (i, line) in text.lines().enumerate() {
        let fail = |e: String| at_line(i + 1, e);
        let line = line.trim();
        if let Some(comment) = line.strip_prefix('#') {
            header.read(comment).map_err(fail)?;
            continue;
        }
        // A label may follow.
        let words: Vec<&str> = line.split(';').next().unwrap_or("").split_whitespace().collect();
        match words.split_first() {
            None => {}
            Some((&"B", color)) => ramp.below = Some(header.tone(color).map_err(fail)?.color),
            Some((&"F", color)) => ramp.above = Some(header.tone(color).map_err(fail)?.color),
            // Voids are not painted.
            Some((&"N", _)) => {}
            Some(_) => slices.push(header.slice(&words).map_err(fail)?),
        }
    }
    if slices.is_empty() {
        return Err("it holds no slice of the form \"z0 colour z1 colour\"; give a colour palette table".into());
    }
    if slices.windows(2).any(|w| w[0][1].0 > w[1][0].0) {
        let text = "its slices overlap or fall; colours are taken in the order of their heights";
        warnings.push(Warning::new(WarningKind::Repaired, text));
    }
    let height = header.heights(&slices);
    for slice in &slices {
        header.stops(slice, &height, &mut ramp.stops);
    }
    Ok(Loaded::new(ramp, warnings))
}

impl Header {
    fn read(&mut self, comment: &str) -> Result<(), String> {
        let comment = comment.trim();
        let value = |key: &str| comment.strip_prefix(key).map(|v| v.trim().trim_start_matches('=').trim());
        if let Some(model) = value("COLOR_MODEL") {
            self.between_hues = model.eq_ignore_ascii_case("+hsv");
            self.hsv = self.between_hues || model.eq_ignore_ascii_case("hsv");
            if !self.hsv && !model.trim_start_matches('+').eq_ignore_ascii_case("rgb") {
                return Err(format!("the colour model {} is not read; convert the table to RGB", shown(model)));
            }
        } else if let Some(range) = value("RANGE") {
            let ends: Vec<f64> = range.split('/').filter_map(|w| w.trim().parse().ok()).collect();
            match ends[..] {
                [a, b] if a < b && a.is_finite() && b.is_finite() => self.range = Some([a, b]),
                _ => return Err(format!("the range \"{}\" is not of the form low/high", shown(range))),
            }
        } else if comment.starts_with("HARD_HINGE") || comment.starts_with("SOFT_HINGE") || comment.starts_with("HINGE")
        {
            self.hinge = true;
        }
        Ok(())
    }

    fn slice(&self, words: &[&str]) -> Result<Slice, String> {
        // Annotation marks may end the line.
        let words = match words.split_last() {
            Some((&("L" | "U" | "B"), rest)) => rest,
            _ => words,
        };
        let (a, b) = match words.len() {
            4 | 8 => words.split_at(words.len() / 2),
            2 => return Err("this is a table of categories; give one of slices of heights".into()),
            n => return Err(format!("a slice has {n} values; it is written as z0 colour z1 colour")),
        };
        let end = |words: &[&str]| -> Result<(f64, Tone), String> {
            let z = words[0].parse::<f64>().ok().filter(|z| z.is_finite());
            let z = z.ok_or_else(|| format!("\"{}\" is no height", shown(words[0])))?;
            Ok((z, self.tone(&words[1..])?))
        };
        let slice = [end(a)?, end(b)?];
        if slice[0].0 > slice[1].0 {
            return Err(format!("the slice ends at {}, below its start at {}", slice[1].0, slice[0].0));
        }
        Ok(slice)
    }

    fn tone(&self, words: &[&str]) -> Result<Tone, String> {
        let plain = |color: Color| Tone { color, hsv: None };
        let numbers = |parts: &[&str]| -> Result<[f64; 3], String> {
            let read = |w: &str| w.parse::<f64>().map_err(|_| format!("\"{}\" is no number of a colour", shown(w)));
            Ok([read(parts[0])?, read(parts[1])?, read(parts[2])?])
        };
        let from_hues = |hsv: [f64; 3]| from_hsv(hsv).map(|color| Tone { color, hsv: Some(hsv) });
        match words {
            [r, g, b] if self.hsv => from_hues(numbers(&[r, g, b])?),
            [r, g, b] => Ok(plain(Color::rgb(channel(r)?, channel(g)?, channel(b)?))),
            ["-"] => Ok(plain(Color::rgb(0, 0, 0).with_alpha(0))),
            [word] => {
                if let Some(color) = hex(word).or_else(|| named(word)) {
                    return Ok(plain(color));
                }
                // Transparency may follow a colour.
                let word = word.split('@').next().unwrap_or("");
                let rgb: Vec<&str> = word.split('/').collect();
                let hsv: Vec<&str> = word.split('-').collect();
                match (rgb.len(), hsv.len()) {
                    (3, 1) if self.hsv => from_hues(numbers(&rgb)?),
                    (3, 1) => Ok(plain(Color::rgb(channel(rgb[0])?, channel(rgb[1])?, channel(rgb[2])?))),
                    (1, 3) => from_hues(numbers(&hsv)?),
                    (1, 1) => channel(word).map(|v| plain(Color::rgb(v, v, v))),
                    _ => Err(format!("\"{}\" is no colour that is read; write it as red/green/blue", shown(word))),
                }
            }
            _ => Err(format!("a colour has {} values; write it as red/green/blue", words.len())),
        }
    }

    /// Meaning of the table's heights.
    fn heights(&self, slices: &[Slice]) -> Box<dyn Fn(f64) -> RampHeight> {
        let z = slices.iter().flatten().map(|e| e.0);
        let (low, high) = z.fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), z| (a.min(z), b.max(z)));
        let (hinge, shares) = (self.hinge, low >= -1.0 && high <= 1.0 && high > low);
        match self.range {
            Some([a, b]) if hinge && low < 0.0 && high > 0.0 => {
                Box::new(move |z| RampHeight::Metres(if z < 0.0 { z / low * a } else { z / high * b }))
            }
            Some([a, b]) if high > low => Box::new(move |z| RampHeight::Metres(a + (z - low) / (high - low) * (b - a))),
            None if shares && hinge => Box::new(RampHeight::Hinged),
            None if shares => Box::new(move |z| RampHeight::Share((z - low) / (high - low))),
            _ => Box::new(RampHeight::Metres),
        }
    }

    fn stops(&self, [(z0, a), (z1, b)]: &Slice, height: &dyn Fn(f64) -> RampHeight, out: &mut Vec<RampStop>) {
        out.push(RampStop { height: height(*z0), color: a.color });
        if let (true, Some(from), Some(to)) = (self.between_hues, a.hsv, b.hsv) {
            for i in 1..HUE_PARTS {
                let t = i as f64 / HUE_PARTS as f64;
                let hsv = std::array::from_fn(|k| from[k] + t * (to[k] - from[k]));
                if let Ok(color) = from_hsv(hsv) {
                    out.push(RampStop { height: height(z0 + t * (z1 - z0)), color });
                }
            }
        }
        out.push(RampStop { height: height(*z1), color: b.color });
    }
}

#[cfg(test)]
mod tests;
