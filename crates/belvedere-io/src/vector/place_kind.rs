//! What a point of a map is, told by its properties.

use belvedere_scene::PlaceKind;
use std::collections::BTreeMap;

/// Words of values, in lower case, and what they mean. The keys of OpenStreetMap come first.
const KNOWN: [(&str, &[&str], PlaceKind); 19] = [
    ("natural", &["peak", "volcano", "hill"], PlaceKind::Peak),
    ("natural", &["saddle"], PlaceKind::Pass),
    ("mountain_pass", &["yes"], PlaceKind::Pass),
    ("tourism", &["alpine_hut", "wilderness_hut"], PlaceKind::Hut),
    ("amenity", &["shelter"], PlaceKind::Hut),
    ("tourism", &["viewpoint"], PlaceKind::Viewpoint),
    ("amenity", &["parking"], PlaceKind::Parking),
    ("aerialway", &["station", "gondola", "cable_car", "chair_lift"], PlaceKind::Lift),
    ("railway", &["funicular"], PlaceKind::Lift),
    ("place", &["city"], PlaceKind::City),
    ("place", &["town"], PlaceKind::Town),
    ("place", &["village", "suburb", "borough"], PlaceKind::Village),
    ("place", &["hamlet", "isolated_dwelling", "farm", "neighbourhood", "quarter"], PlaceKind::Hamlet),
    ("place", &["locality"], PlaceKind::Locality),
    ("natural", &["spring", "water", "cave_entrance"], PlaceKind::Locality),
    ("aeroway", &["aerodrome"], PlaceKind::Locality),
    ("waterway", &["waterfall"], PlaceKind::Locality),
    ("historic", &["castle", "ruins", "monument"], PlaceKind::Locality),
    ("tourism", &["attraction", "information"], PlaceKind::Locality),
];
/// Keys of other collections that hold the kind, in lower case.
const KIND_KEYS: [&str; 9] =
    ["kind", "type", "class", "fclass", "featurecla", "feature_type", "feature", "category", "objektart"];
/// Words of such values and what they mean, the special ones first.
const WORDS: [(&str, PlaceKind); 22] = [
    ("peak", PlaceKind::Peak),
    ("summit", PlaceKind::Peak),
    ("gipfel", PlaceKind::Peak),
    ("mountain pass", PlaceKind::Pass),
    ("saddle", PlaceKind::Pass),
    ("pass", PlaceKind::Pass),
    ("mountain", PlaceKind::Peak),
    ("alpine_hut", PlaceKind::Hut),
    ("hut", PlaceKind::Hut),
    ("shelter", PlaceKind::Hut),
    ("refuge", PlaceKind::Hut),
    ("viewpoint", PlaceKind::Viewpoint),
    ("parking", PlaceKind::Parking),
    ("car park", PlaceKind::Parking),
    ("cable car", PlaceKind::Lift),
    ("lift", PlaceKind::Lift),
    ("city", PlaceKind::City),
    ("admin-0 capital", PlaceKind::City),
    ("town", PlaceKind::Town),
    ("village", PlaceKind::Village),
    ("hamlet", PlaceKind::Hamlet),
    ("locality", PlaceKind::Locality),
];
/// Keys of heights and of numbers of people, in lower case.
const HEIGHT_KEYS: [&str; 9] =
    ["ele", "elevation", "elev", "height_m", "altitude", "alt_m", "hoehe", "elevation_m", "ele_m"];
const PEOPLE_KEYS: [&str; 6] = ["population", "pop_max", "pop", "einwohner", "population_total", "inhabitants"];

/// What the properties say that a point is; `None` if they say nothing known.
pub fn place_kind(properties: &BTreeMap<String, String>) -> Option<PlaceKind> {
    let value = |key: &str| properties.get(key).map(|value| value.trim().to_lowercase());
    let tagged = KNOWN.iter().find(|(key, words, _)| value(key).is_some_and(|v| words.contains(&v.as_str())));
    tagged.map(|(.., kind)| *kind).or_else(|| {
        let of_kind = |(key, _): &(&String, &String)| KIND_KEYS.contains(&key.to_lowercase().as_str());
        properties.iter().filter(of_kind).find_map(|(_, value)| {
            let value = value.trim().to_lowercase();
            // Whole words alone: a carpet is no car park, and Passau no pass.
            let has =
                |word: &str| value == word || value.split(|c: char| !c.is_alphanumeric()).any(|part| part == word);
            WORDS.iter().find(|(word, _)| has(word)).map(|(_, kind)| *kind)
        })
    })
}

/// The height that the properties state, metres: of `ele` and its like; decimal commas and a unit behind it are read.
pub fn stated_height(properties: &BTreeMap<String, String>) -> Option<f64> {
    first_number(properties, &HEIGHT_KEYS, |height| (-500.0..=9000.0).contains(&height))
}

/// The number of people that the properties state, > 0.
pub fn stated_people(properties: &BTreeMap<String, String>) -> Option<f64> {
    first_number(properties, &PEOPLE_KEYS, |people| people > 0.0)
}

fn first_number(properties: &BTreeMap<String, String>, keys: &[&str], is_one: fn(f64) -> bool) -> Option<f64> {
    let of = |key: &&str| properties.iter().find(|(k, _)| k.to_lowercase() == **key).and_then(|(_, v)| number(v));
    keys.iter().filter_map(of).find(|value| is_one(*value))
}

/// A number at the beginning of a value, with a decimal point or comma and `m` or `ft` behind it; metres for heights.
pub fn number(value: &str) -> Option<f64> {
    let value = value.trim();
    let end = value.find(|c: char| !(c.is_ascii_digit() || matches!(c, '.' | ',' | '-' | '+' | '\'' | '’' | ' ')));
    let (digits, unit) = value.split_at(end.unwrap_or(value.len()));
    let digits: String = digits.chars().filter(|c| !matches!(c, '\'' | '’' | ' ')).collect();
    // 2864,4 has a decimal comma, 12,345 one of thousands; 1,234.5 both.
    let thousands = match digits.rsplit_once(',') {
        Some((before, after)) => digits.contains('.') || before.contains(',') || after.len() == 3,
        None => false,
    };
    let plain = if thousands { digits.replace(',', "") } else { digits.replace(',', ".") };
    let value: f64 = plain.parse().ok().filter(|v: &f64| v.is_finite())?;
    match unit.trim().trim_end_matches('.').to_lowercase().as_str() {
        "" | "m" | "metres" | "meter" | "meters" | "müm" | "m ü. m" => Some(value),
        "ft" | "feet" | "′" => Some(0.3048 * value),
        _ => None,
    }
}

#[cfg(test)]
mod tests;
