//! What attributes of buildings say: names, heights, storeys, and whether they are landmarks.

use belvedere_scene::HeightSource;

/// Metres of a storey, and of what is above the last.
const STOREY_M: f64 = 3.0;
const ABOVE_M: f64 = 1.0;
/// Height of buildings of which nothing is known, metres.
const ASSUMED_M: f64 = 9.0;
/// Heights beyond are mistakes, metres.
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
}

/// Height over ground and where it is from, of what attributes say; values out of 0..=2000 m are counted and not believed.
pub(super) fn height(of: &impl Attributes, odd: &mut usize) -> (f64, HeightSource) {
    let mut believed = |value: Option<f64>| {
        let fine = value.filter(|v| *v > 0.0 && *v <= MOST_M);
        *odd += usize::from(value.is_some() && fine.is_none());
        fine
    };
    let metres = HEIGHTS.iter().find_map(|k| of.text(k));
    if let Some(height) = believed(metres.as_deref().and_then(length_m)) {
        return (height, HeightSource::Stated);
    }
    let levels = LEVELS.iter().find_map(|k| of.text(k));
    let from_levels = levels.as_deref().and_then(first_number).map(|n| n * STOREY_M + ABOVE_M);
    match believed(from_levels.filter(|h| *h != ABOVE_M)) {
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

/// A length such as `12`, `12.5 m`, `12,5m` or `40 ft`, metres.
fn length_m(text: &str) -> Option<f64> {
    let number = first_number(text)?;
    let unit = text.trim_start_matches(|c: char| c.is_ascii_digit() || matches!(c, '+' | '-' | '.' | ',' | ' '));
    let feet = unit.starts_with("ft") || unit.starts_with("feet") || unit.starts_with('\'');
    Some(if feet { 0.3048 * number } else { number })
}

fn first_number(text: &str) -> Option<f64> {
    let text = text.trim().replace(',', ".");
    let end = text.find(|c: char| !(c.is_ascii_digit() || matches!(c, '+' | '-' | '.'))).unwrap_or(text.len());
    text[..end].parse::<f64>().ok().filter(|v| v.is_finite())
}

#[cfg(test)]
mod tests {
    use super::*;

    impl Attributes for &[(&str, &str)] {
        fn text(&self, key: &str) -> Option<String> {
            self.iter().find(|(k, _)| *k == key).map(|(_, v)| (*v).to_owned())
        }
    }

    #[test]
    fn heights_are_stated_or_follow_from_storeys_or_are_assumed() {
        let mut odd = 0;
        for (attributes, want, source) in [
            (&[("height", "12,5 m")][..], 12.5, HeightSource::Stated),
            (&[("height", "40 ft")][..], 12.192, HeightSource::Stated),
            (&[("height", "40'")][..], 12.192, HeightSource::Stated),
            (&[("height", "tall"), ("levels", "4")][..], 13.0, HeightSource::Levels),
            (&[("building:levels", "2.5")][..], 8.5, HeightSource::Levels),
            (&[("levels", "0")][..], 9.0, HeightSource::Assumed),
            (&[][..], 9.0, HeightSource::Assumed),
        ] {
            let (height, from) = height(&attributes, &mut odd);
            assert!((height - want).abs() < 1e-9 && from == source, "{attributes:?}: {height} {from:?}");
        }
        assert_eq!(odd, 0);
        assert_eq!(height(&&[("height", "-4"), ("levels", "3")][..], &mut odd), (10.0, HeightSource::Levels));
        assert_eq!(height(&&[("height", "99999")][..], &mut odd), (9.0, HeightSource::Assumed));
        assert_eq!(odd, 2);
        assert!(is_landmark(&&[("building", "Church;ruins")][..]) && !is_landmark(&&[("building", "towerblock")][..]));
    }
}
