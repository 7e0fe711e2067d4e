//! What a file says of the things in a city, and which of them a text means.

use std::collections::BTreeMap;

/// What a file says of a building or another solid.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct CityAbout {
    /// Id, as that of the building in the city.
    pub id: String,
    /// Name, possibly empty.
    pub name: String,
    /// Attributes that are text or numbers.
    pub attributes: BTreeMap<String, String>,
}

impl CityAbout {
    /// Whether a text means it: its id, its name in any case, or `key=value` of an attribute in any case.
    pub fn is_meant(&self, by: &str) -> bool {
        self.id == by || is_meant(by, &self.name, &self.attributes)
    }
}

/// Properties that hold ids.
pub(super) const IDS: [&str; 6] = ["id", "@id", "osm_id", "full_id", "fid", "uid"];

/// Whether a text means a thing with a name and properties: by its name in any case, by its id, or by `key=value`, in any case; `key=*` is
/// any value.
pub fn is_meant(by: &str, name: &str, properties: &BTreeMap<String, String>) -> bool {
    let by = by.trim();
    let same = |a: &str, b: &str| a.trim().to_lowercase() == b.to_lowercase();
    let has = |key: &str, value: &str| {
        properties.iter().any(|(k, v)| k.eq_ignore_ascii_case(key) && (value == "*" || same(v, value)))
    };
    !by.is_empty()
        && (same(name, by)
            || IDS.iter().any(|key| has(key, by))
            || by.split_once('=').is_some_and(|(key, value)| has(key.trim(), value.trim())))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn things_are_meant_by_name_id_or_property() {
        let properties = [("id", "way/7"), ("leisure", "park"), ("name:fr", "Parc = Parc")];
        let properties = properties.map(|(k, v)| (k.to_owned(), v.to_owned())).into();
        let meant = |by: &str| is_meant(by, "Městský park", &properties);
        for by in [
            "Městský park",
            "MĚSTSKÝ PARK",
            "way/7",
            "leisure=park",
            "Leisure = Park",
            "leisure=*",
            "name:fr=Parc = Parc",
        ] {
            assert!(meant(by), "{by}");
        }
        for by in ["", "park", "leisure", "leisure=", "way/8", "="] {
            assert!(!meant(by), "{by}");
        }
    }
}
