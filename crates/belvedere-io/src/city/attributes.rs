//! Attributes of buildings: names, heights, storeys, and whether they are landmarks.

use super::plan::Repairs;
use belvedere_scene::HeightSource;
use std::collections::BTreeMap;

/// Height of a storey, and of the roof above the last one, metres.
const STOREY_M: f64 = 3.0;
const ABOVE_M: f64 = 1.0;
/// Height of buildings without a known height, metres.
const ASSUMED_M: f64 = 9.0;
/// Most characters of a number that are read.
const MOST_DIGITS: usize = 40;
/// Largest believed height, metres.
const MOST_M: f64 = 2000.0;

const HEIGHTS: [&str; 8] =
    ["height", "measuredheight", "building:height", "building_height", "hoehe", "hauteur", "relh2", "height_m"];
const LEVELS: [&str; 8] = [
    "building:levels",
    "levels",
    "storeysaboveground",
    "num_floors",
    "floors",
    "building_levels",
    "building_l",
    "storeys",
];
const NAMES: [&str; 3] = ["name", "building:name", "label"];
const KINDS: [&str; 7] = ["building", "function", "class", "usage", "amenity", "man_made", "historic"];
const LANDMARKS: [&str; 16] = [
    "church",
    "cathedral",
    "chapel",
    "mosque",
    "synagogue",
    "temple",
    "tower",
    "monument",
    "castle",
    "palace",
    "townhall",
    "stadium",
    "museum",
    "lighthouse",
    "windmill",
    "place_of_worship",
];

/// Attributes by name, whatever their case.
pub(super) trait Attributes {
    /// The attribute as text, if it is there and not empty.
    fn text(&self, key: &str) -> Option<String>;

    /// All attributes that are text or numbers.
    fn all(&self) -> BTreeMap<String, String> {
        BTreeMap::new()
    }
}

/// Height over ground, metres, and its source, from attributes. Values that are not numbers, or not in 0..=2000 m, are counted in
/// `repairs` and ignored. Zero storeys are ignored. Of lists and ranges the largest counts, for heights reach up to the top of a
/// building (OpenStreetMap Wiki, "Simple 3D Buildings").
pub(super) fn height(of: &impl Attributes, repairs: &mut Repairs) -> (f64, HeightSource) {
    let mut believed = |text: Option<String>, metres: fn(&Stated) -> f64| {
        let stated = Stated::of(&text?);
        let fine = stated.as_ref().map(metres).filter(|v| *v > 0.0 && *v <= MOST_M);
        repairs.heights += usize::from(fine.is_none());
        if let (Some(stated), Some(_)) = (stated, fine) {
            repairs.about += usize::from(stated.approximate);
            repairs.several += usize::from(stated.several);
        }
        fine
    };
    if let Some(height) = believed(HEIGHTS.iter().find_map(|k| of.text(k)), |s| s.metres) {
        return (height, HeightSource::Stated);
    }
    let none = |text: &String| Stated::of(text).is_some_and(|s| s.number == 0.0);
    let levels = LEVELS.iter().find_map(|k| of.text(k)).filter(|text| !none(text));
    match believed(levels, |s| if s.number > 0.0 { s.number * STOREY_M + ABOVE_M } else { 0.0 }) {
        Some(height) => (height, HeightSource::Levels),
        None => (ASSUMED_M, HeightSource::Assumed),
    }
}

pub(super) fn name(of: &impl Attributes) -> String {
    NAMES.iter().find_map(|k| of.text(k)).unwrap_or_default()
}

pub(super) fn is_landmark(of: &impl Attributes) -> bool {
    KINDS.iter().filter_map(|k| of.text(k)).any(|value| {
        let value = value.to_lowercase();
        value.split(|c: char| !c.is_alphanumeric() && c != '_').any(|word| LANDMARKS.contains(&word))
    })
}

/// Words and signs before a number that is approximate.
const ABOUT: [&str; 14] =
    ["~", "≈", "±", "approximately", "approx.", "approx", "circa", "about", "etwa", "env.", "ca.", "ca ", "c.", "est."];

/// A number as people write it: `18`, `~18`, `18 m`, `60 ft`, `60'`, `65'6"`, `18,5`, `5;7` or `10-12 ft`.
struct Stated {
    /// The largest number.
    number: f64,
    /// The same as a length, metres; without a unit it is in metres.
    metres: f64,
    /// Whether it is called approximate.
    approximate: bool,
    /// Whether there are several numbers.
    several: bool,
}

impl Stated {
    fn of(text: &str) -> Option<Self> {
        let bare = without_about(text);
        let approximate = bare.len() < text.trim().len();
        let pieces = pieces(&bare);
        // `10-12 ft`: the unit stands once.
        let last = pieces.last().and_then(|piece| unit_m(&first_number(piece)?.1)).unwrap_or(1.0);
        let mut found: Option<(f64, f64)> = None;
        for piece in &pieces {
            let (number, rest) = first_number(without_about(piece).as_str())?;
            // `65'6"`: feet and inches.
            let inches = rest.strip_prefix('\'').and_then(first_number).map_or(0.0, |(inches, _)| inches);
            let metres = number * unit_m(&rest).unwrap_or(last) + 0.0254 * inches;
            if found.is_none_or(|(_, most)| metres > most) {
                found = Some((number, metres));
            }
        }
        let (number, metres) = found?;
        Some(Self { number, metres, approximate, several: pieces.len() > 1 })
    }
}

/// A length, in metres, as heights are read.
pub(super) fn length_m(text: &str) -> Option<f64> {
    Stated::of(text).map(|stated| stated.metres)
}

/// A number, as numbers of storeys are read.
pub(super) fn number(text: &str) -> Option<f64> {
    Stated::of(text).map(|stated| stated.number)
}

fn without_about(text: &str) -> String {
    let mut text = text.trim().to_lowercase();
    while let Some(rest) = ABOUT.iter().find_map(|word| text.strip_prefix(word)) {
        text = rest.trim_start().to_owned();
    }
    text
}

/// The unit that follows a number, metres; `None` if none does.
fn unit_m(rest: &str) -> Option<f64> {
    let unit = rest.trim_start_matches(|c: char| !c.is_alphabetic() && c != '\'');
    let is = |names: &[&str]| names.iter().any(|name| unit.starts_with(name));
    match () {
        () if is(&["ft", "feet", "foot", "'"]) => Some(0.3048),
        () if is(&["cm"]) => Some(0.01),
        () if unit.is_empty() => None,
        () => Some(1.0),
    }
}

/// The parts of a list or a range: at `;`, `/` and at dashes between numbers.
fn pieces(text: &str) -> Vec<String> {
    let mut out = vec![String::new()];
    let mut before = ' ';
    for c in text.chars() {
        let dash = matches!(c, '-' | '–' | '—') && before != ' ' && before != 'e';
        if matches!(c, ';' | '/') || dash {
            out.push(String::new());
        } else if let Some(last) = out.last_mut() {
            last.push(c);
        }
        before = if c == ' ' { before } else { c };
    }
    out.retain(|piece| !piece.trim().is_empty());
    out
}

/// The longest number that a text begins with, and the rest.
fn first_number(text: &str) -> Option<(f64, String)> {
    let text = text.trim().replace(',', ".");
    let of_number = |c: &char| c.is_ascii_digit() || matches!(c, '+' | '-' | '.' | 'e' | 'E');
    let most = text.chars().take(MOST_DIGITS).take_while(of_number).count();
    let number = |end: usize| Some((text[..end].parse::<f64>().ok()?, text[end..].trim_start().to_owned()));
    (1..=most).rev().find_map(number).filter(|(value, _)| value.is_finite())
}

#[cfg(test)]
mod tests;
