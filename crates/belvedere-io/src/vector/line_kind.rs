//! What a line of a map is, told by its properties, or by the name of its file.

use belvedere_scene::LineClass;
use std::collections::BTreeMap;

/// Keys of OpenStreetMap in the order in which they decide; values in lower case, none = any but "no"; and what they mean.
const KNOWN: [(&str, &[&str], LineClass); 14] = [
    ("aerialway", &[], LineClass::Lift),
    (
        "railway",
        &["rail", "light_rail", "narrow_gauge", "tram", "subway", "funicular", "preserved"],
        LineClass::Railway,
    ),
    ("waterway", &["river", "canal", "riverbank"], LineClass::River),
    ("waterway", &["stream", "ditch", "drain", "brook", "tidal_channel"], LineClass::Stream),
    ("highway", &["motorway", "trunk", "primary", "secondary"], LineClass::MainRoad),
    ("highway", &["motorway_link", "trunk_link", "primary_link", "secondary_link"], LineClass::MainRoad),
    ("highway", &["track", "service"], LineClass::Track),
    ("highway", &["path", "footway", "bridleway", "steps", "cycleway", "via_ferrata", "pedestrian"], LineClass::Path),
    ("highway", &[], LineClass::Road),
    ("sac_scale", &[], LineClass::Path),
    ("route", &["hiking", "foot", "bicycle", "mtb", "running", "horse"], LineClass::Route),
    ("boundary", &[], LineClass::Border),
    ("admin_level", &[], LineClass::Border),
    ("route", &["ski", "piste"], LineClass::Piste),
];
/// Keys of other collections that hold the kind, in lower case.
const KIND_KEYS: [&str; 9] =
    ["kind", "type", "class", "fclass", "featurecla", "feature_type", "feature", "category", "objektart"];
/// Words of such values, of layers and of files, in the singular, and what they mean; those of more letters first.
const WORDS: [(&str, LineClass); 26] = [
    ("aerialway", LineClass::Lift),
    ("cableway", LineClass::Lift),
    ("chairlift", LineClass::Lift),
    ("gondola", LineClass::Lift),
    ("lift", LineClass::Lift),
    ("railway", LineClass::Railway),
    ("railroad", LineClass::Railway),
    ("motorway", LineClass::MainRoad),
    ("highway", LineClass::MainRoad),
    ("road", LineClass::Road),
    ("street", LineClass::Road),
    ("track", LineClass::Track),
    ("footpath", LineClass::Path),
    ("path", LineClass::Path),
    ("trail", LineClass::Path),
    ("waterway", LineClass::River),
    ("river", LineClass::River),
    ("canal", LineClass::River),
    ("stream", LineClass::Stream),
    ("brook", LineClass::Stream),
    ("piste", LineClass::Piste),
    ("skirun", LineClass::Piste),
    ("border", LineClass::Border),
    ("boundary", LineClass::Border),
    ("boundaries", LineClass::Border),
    ("route", LineClass::Route),
];

/// What the properties say that a line is; `None` if they say nothing known.
pub fn line_kind(properties: &BTreeMap<String, String>) -> Option<LineClass> {
    let value = |key: &str| properties.get(key).map(|value| value.trim().to_lowercase());
    let grade = value("piste:difficulty");
    if value("piste:type").is_some_and(|kind| kind != "no") || grade.is_some() {
        return Some(piste(grade.as_deref().unwrap_or_default()));
    }
    let is = |wanted: &[&str], value: &str| match wanted {
        [] => !value.is_empty() && value != "no",
        _ => wanted.contains(&value),
    };
    let tagged = KNOWN.iter().find(|(key, wanted, _)| value(key).is_some_and(|value| is(wanted, &value)));
    tagged.map(|(.., class)| *class).or_else(|| {
        let of_kind = |(key, _): &(&String, &String)| KIND_KEYS.contains(&key.to_lowercase().as_str());
        properties.iter().filter(of_kind).find_map(|(_, value)| of_words(value))
    })
}

/// The class of a grade of difficulty: the colours are those of Europe.
fn piste(grade: &str) -> LineClass {
    match grade {
        "novice" | "green" => LineClass::PisteGreen,
        "easy" | "blue" => LineClass::PisteBlue,
        "intermediate" | "red" => LineClass::PisteRed,
        "advanced" | "expert" | "extreme" | "black" => LineClass::PisteBlack,
        _ => LineClass::Piste,
    }
}

/// What the name of a file or layer says that its lines are. Tracks may be those of a receiver and say nothing.
pub fn line_words(name: &str) -> Option<LineClass> {
    of_words(name).filter(|class| *class != LineClass::Track)
}

/// What a text says: whole words alone, in the plural as well.
fn of_words(name: &str) -> Option<LineClass> {
    let name = name.trim().to_lowercase();
    let parts: Vec<&str> = name.split(|c: char| !c.is_alphabetic()).collect();
    let has = |word: &str| parts.iter().any(|part| *part == word || part.strip_suffix('s') == Some(word));
    WORDS.iter().find(|(word, _)| has(word)).map(|(_, class)| *class)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn tags_decide_before_words_and_unknown_ones_say_nothing() {
        let kind = |tags: &[(&str, &str)]| {
            line_kind(&tags.iter().map(|(key, value)| ((*key).to_owned(), (*value).to_owned())).collect())
        };
        for (tags, wanted) in [
            (&[("highway", "path")][..], Some(LineClass::Path)),
            (&[("highway", "tertiary")], Some(LineClass::Road)),
            (&[("highway", "trunk_link")], Some(LineClass::MainRoad)),
            (&[("waterway", "Stream")], Some(LineClass::Stream)),
            (
                &[("piste:type", "downhill"), ("piste:difficulty", "easy"), ("highway", "track")],
                Some(LineClass::PisteBlue),
            ),
            (&[("piste:type", "nordic")], Some(LineClass::Piste)),
            (&[("piste:type", "no"), ("aerialway", "gondola")], Some(LineClass::Lift)),
            (&[("boundary", "administrative"), ("admin_level", "2")], Some(LineClass::Border)),
            (&[("railway", "rail")], Some(LineClass::Railway)),
            (&[("fclass", "rivers")], Some(LineClass::River)),
            (&[("waterway", "dam")], None),
            (&[("highway", "no")], None),
            (&[("name", "River walk")], None),
        ] {
            assert_eq!(kind(tags), wanted, "{tags:?}");
        }
    }

    #[test]
    fn names_of_files_tell_by_whole_words() {
        assert_eq!(line_words("main_rivers-2"), Some(LineClass::River));
        assert_eq!(line_words("National boundaries"), Some(LineClass::Border));
        assert_eq!(line_words("Streamwood"), None);
        assert_eq!(line_words("gr11"), None);
        assert_eq!(line_words("tracks"), None);
    }
}
