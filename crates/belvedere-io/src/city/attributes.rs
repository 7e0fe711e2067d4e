//! Attributes of buildings: names, heights, storeys, and whether they are landmarks.

use belvedere_scene::HeightSource;

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
}

/// Height over ground, metres, and its source, from attributes. Values that are not numbers, or not in 0..=2000 m, are counted in `odd`
/// and ignored. Zero storeys are ignored.
pub(super) fn height(of: &impl Attributes, odd: &mut usize) -> (f64, HeightSource) {
    let mut believed = |text: Option<String>, metres: fn(&str) -> Option<f64>| {
        let text = text?;
        let fine = metres(&text).filter(|v| *v > 0.0 && *v <= MOST_M);
        *odd += usize::from(fine.is_none());
        fine
    };
    if let Some(height) = believed(HEIGHTS.iter().find_map(|k| of.text(k)), length_m) {
        return (height, HeightSource::Stated);
    }
    let levels = LEVELS.iter().find_map(|k| of.text(k)).filter(|text| first_number(text).is_none_or(|(n, _)| n != 0.0));
    match believed(levels, |text| first_number(text).filter(|(n, _)| *n > 0.0).map(|(n, _)| n * STOREY_M + ABOVE_M)) {
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

/// A length such as `12`, `12.5 m`, `12,5m`, `40 ft` or `10-12 ft` (the first number counts), in metres.
pub(super) fn length_m(text: &str) -> Option<f64> {
    let (number, rest) = first_number(text)?;
    let unit = rest.trim_start_matches(|c: char| !c.is_alphabetic() && c != '\'');
    let feet = unit.starts_with("ft") || unit.starts_with("feet") || unit.starts_with('\'');
    // `65'6"`: feet and inches.
    let inches = rest.strip_prefix('\'').and_then(first_number).map_or(0.0, |(inches, _)| inches);
    Some(if feet { 0.3048 * (number + inches / 12.0) } else { number })
}

/// The longest number that a text begins with, and the rest: `2;3` is 2, `10-12 m` is 10.
fn first_number(text: &str) -> Option<(f64, String)> {
    let text = text.trim().replace(',', ".");
    let of_number = |c: &char| c.is_ascii_digit() || matches!(c, '+' | '-' | '.' | 'e' | 'E');
    let most = text.chars().take(MOST_DIGITS).take_while(of_number).count();
    let number = |end: usize| Some((text[..end].parse::<f64>().ok()?, text[end..].trim_start().to_owned()));
    (1..=most).rev().find_map(number).filter(|(value, _)| value.is_finite())
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
            (&[("height", "65'6\"")][..], 19.9644, HeightSource::Stated),
            (&[("height", "1e2")][..], 100.0, HeightSource::Stated),
            (&[("height", "10-12 ft")][..], 3.048, HeightSource::Stated),
            (&[("building:levels", "2;3")][..], 7.0, HeightSource::Levels),
            (&[("building:levels", "2.5")][..], 8.5, HeightSource::Levels),
            (&[("levels", "0")][..], 9.0, HeightSource::Assumed),
            (&[][..], 9.0, HeightSource::Assumed),
        ] {
            let (height, from) = height(&attributes, &mut odd);
            assert!((height - want).abs() < 1e-9 && from == source, "{attributes:?}: {height} {from:?}");
        }
        assert_eq!(odd, 0);
        assert_eq!(height(&&[("height", "-4"), ("levels", "3")][..], &mut odd), (10.0, HeightSource::Levels));
        for text in ["99999", "1e300", "1e999", "NaN", "inf", "0", "tall", "~12", "-"] {
            assert_eq!(height(&&[("height", text)][..], &mut odd), (9.0, HeightSource::Assumed), "{text}");
        }
        assert_eq!(height(&&[("height", "tall"), ("levels", "4")][..], &mut odd), (13.0, HeightSource::Levels));
        for text in ["-1", "1000", "two"] {
            assert_eq!(height(&&[("levels", text)][..], &mut odd), (9.0, HeightSource::Assumed), "{text}");
        }
        assert_eq!(odd, 1 + 9 + 1 + 3);
        assert!(is_landmark(&&[("building", "Church;ruins")][..]) && !is_landmark(&&[("building", "towerblock")][..]));
    }
}
