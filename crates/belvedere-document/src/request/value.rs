//! Values of options as texts.

use crate::place::Place;
use crate::{StylisationDoc, SwitchOrLength, SwitchOrStrength, SwitchOrVisibility};

/// Smallest and largest factor of heights.
pub const EXAGGERATION: [f64; 2] = [0.01, 100.0];
/// Most pixels along a side of a picture.
const MAX_SIDE: u32 = 65535;

/// Finite numbers between commas.
fn numbers(text: &str) -> Option<Vec<f64>> {
    text.split(',').map(|t| t.trim().parse().ok().filter(|v: &f64| v.is_finite())).collect()
}

/// A number that is finite.
pub fn number(text: &str) -> Result<f64, String> {
    text.trim().parse().ok().filter(|v: &f64| v.is_finite()).ok_or_else(|| "give a number".into())
}

/// Width and height in pixels, such as `1280x720`.
pub fn size(text: &str) -> Result<[u32; 2], String> {
    let sides = text.split_once(['x', 'X']).map(|(w, h)| [w.trim().parse(), h.trim().parse()]);
    match sides {
        Some([Ok(w), Ok(h)]) if [w, h].iter().all(|side| (1..=MAX_SIDE).contains(side)) => Ok([w, h]),
        Some([Ok(_), Ok(_)]) => Err(format!("each side must have 1 to {MAX_SIDE} pixels, such as 1280x720")),
        _ => Err("give width and height in pixels, such as 1280x720".into()),
    }
}

/// A number of coverage samples: 1, 4 or 16.
pub fn samples(text: &str) -> Result<u32, String> {
    text.trim().parse().ok().filter(|n| matches!(n, 1 | 4 | 16)).ok_or_else(|| "give 1, 4 or 16".into())
}

/// A place with a height, such as `1.5,42.5,2400` or `42.5N,1.5E,+20`.
pub fn with_height(text: &str) -> Result<Place, String> {
    let place: Place = text.parse()?;
    let without = "an eye needs a height: give X,Y,Z, Z in metres, or +20 for 20 m above the ground";
    if place.has_height() { Ok(place) } else { Err(without.into()) }
}

/// A place without a height, such as `1.5,42.5`.
pub(crate) fn position(text: &str) -> Result<Place, String> {
    let place: Place = text.parse()?;
    if place.has_height() { Err("give X,Y without a height".into()) } else { Ok(place) }
}

/// A permitted error in pixels, 0..=64.
pub(crate) fn lod(text: &str) -> Result<f64, String> {
    let px = text.parse().ok().filter(|px| (0.0..=64.0).contains(px));
    px.ok_or_else(|| "give an error in pixels in 0..=64; 0 draws every cell".into())
}

/// `phi`, `phi=25:80` or `phi=25:80:0.5`, degrees; values that are not given are 0.
pub(crate) fn sweep(text: &str) -> Result<[f64; 3], String> {
    let wrong = || "give phi, or phi=FIRST:LAST[:STEP] in degrees, such as phi=25:80".to_owned();
    if text == "phi" {
        return Ok([0.0; 3]);
    }
    let range = text.strip_prefix("phi=").ok_or_else(wrong)?;
    match numbers(&range.replace(':', ",")).as_deref() {
        Some([first, last]) if first != last => Ok([*first, *last, 0.0]),
        Some([first, last, step]) if first != last && *step > 0.0 => Ok([*first, *last, *step]),
        _ => Err(wrong()),
    }
}

/// The first and the last frame of a part, such as `0:249`.
pub(crate) fn part(text: &str) -> Result<[usize; 2], String> {
    let ends: Option<Vec<usize>> = text.split(':').map(|end| end.trim().parse().ok()).collect();
    match ends.as_deref() {
        Some([first, last]) if first <= last => Ok([*first, *last]),
        _ => Err("give FIRST:LAST, frames counted from 0, such as 0:249".into()),
    }
}

/// The name of a fallback for a target that no bend shows; the text unchanged.
pub(crate) fn fallback(text: &str) -> Result<String, String> {
    text.parse::<crate::Fallback>().map(|_| text.to_owned())
}

/// A file and what its lines are; the text unchanged.
pub(crate) fn line_class(text: &str) -> Result<String, String> {
    super::class_of_file(text).map(|_| text.to_owned())
}

/// A paper; the text unchanged.
pub(crate) fn paper(text: &str) -> Result<String, String> {
    crate::paper::parse_paper(text, [1, 1]).map(|_| text.to_owned())
}

/// A length in scene units, > 0.
pub fn spacing(text: &str) -> Result<f64, String> {
    text.trim().parse().ok().filter(|v: &f64| *v > 0.0 && v.is_finite()).ok_or("give a length greater than 0".into())
}

/// `true`, or a length.
pub(crate) fn contours(text: &str) -> Result<SwitchOrLength, String> {
    if text == "true" { Ok(SwitchOrLength::Switch(true)) } else { spacing(text).map(SwitchOrLength::Length) }
}

/// A time of the sun; the text unchanged.
pub(crate) fn time(text: &str) -> Result<String, String> {
    crate::sun::check_time(text).map(|()| text.trim().to_owned())
}

/// The direction of light: azimuth and altitude in degrees, such as `250,12`.
pub(crate) fn light(text: &str) -> Result<[f64; 2], String> {
    let angles = numbers(text).and_then(|v| <[f64; 2]>::try_from(v).ok());
    let fits = |[azimuth, altitude]: &[f64; 2]| azimuth.abs() <= 360.0 && *altitude > 0.0 && *altitude <= 90.0;
    angles.filter(fits).ok_or_else(|| {
        "give the azimuth, degrees clockwise from north, and the altitude above 0 and up to 90, such as 250,12".into()
    })
}

/// Haze: a switch, or the visibility in kilometres.
pub(crate) fn haze(text: &str) -> Result<SwitchOrVisibility, String> {
    match text.trim() {
        "on" => Ok(SwitchOrVisibility::Switch(true)),
        "off" => Ok(SwitchOrVisibility::Switch(false)),
        text => {
            let km = text.parse().ok().filter(|km| (1e-6..=1e6).contains(km));
            km.map(SwitchOrVisibility::Kilometres)
                .ok_or_else(|| "give on, off, or a visibility in kilometres, such as 40".into())
        }
    }
}

/// A share.
pub(crate) fn share(text: &str) -> Result<f64, String> {
    let text = text.trim();
    let share = match text.strip_suffix('%') {
        Some(percent) => percent.trim_end().parse().ok().map(|percent: f64| percent / 100.0),
        None => text.parse().ok(),
    };
    let share = share.filter(|share| (0.0..=1.0).contains(share));
    share.ok_or_else(|| "give a share in 0..=1, such as 0.4 or 40%".into())
}

/// A factor of heights.
pub(crate) fn exaggeration(text: &str) -> Result<f64, String> {
    let [least, most] = EXAGGERATION;
    let factor = text.trim().parse().ok().filter(|v| (least..=most).contains(v));
    factor.ok_or_else(|| format!("give a factor in {least}..={most}, such as 1.5"))
}

/// The strengths of edges and, if given, of depth unsharp masking, such as `0.7,4`; 0 leaves one out.
pub(crate) fn stylise(text: &str) -> Result<StylisationDoc, String> {
    let strengths = numbers(text).ok_or("give strengths, such as 0.7,4")?;
    let strength = |value: f64| Some(SwitchOrStrength::Strength(value));
    let document = match strengths[..] {
        [edges] => StylisationDoc { edges: strength(edges), unsharp: None },
        [edges, unsharp] => StylisationDoc { edges: strength(edges), unsharp: strength(unsharp) },
        _ => return Err("give one strength or two, such as 0.7,4".into()),
    };
    document.strengths().map_err(|(_, reason)| reason)?;
    Ok(document)
}

/// An axis such as `-y` as a unit vector.
pub(crate) fn axis(text: &str) -> Result<[f64; 3], String> {
    let (sign, name) = text.strip_prefix('-').map_or((1.0, text.trim_start_matches('+')), |name| (-1.0, name));
    let index = ["x", "y", "z"].iter().position(|axis| name.eq_ignore_ascii_case(axis));
    let index = index.ok_or_else(|| format!("{text:?} is no axis; give x, y, z, -x, -y or -z"))?;
    let mut out = [0.0; 3];
    out[index] = sign;
    Ok(out)
}
