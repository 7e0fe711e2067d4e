//! Kind of areas: by their properties, else by the names of layer and file. The table is in docs/areas-and-sea.md.

use super::{Geometry, Vectors};
use belvedere_scene::AreaSurface::{self, Forest, Glacier, Outline, Park, Water};
use std::collections::BTreeMap;

/// Kind of the areas of a file, and the reason.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct AreaKind {
    /// Surface of the areas; [`AreaSurface::Outline`] if it is not known.
    pub surface: AreaSurface,
    /// The reason as one clause, for sidecars.
    pub why: String,
}

/// Properties that only areas of one kind have, with any value.
const KEYS: [(AreaSurface, &[&str]); 3] = [
    // Randolph, GLIMS and Swiss glacier inventories.
    (Glacier, &["rgiid", "rgi_id", "glimsid", "glims_id", "glac_id", "glac_name", "sgi_id", "sgi-id", "glacier_id"]),
    (Water, &["hylak_id", "lake_id", "lake_name"]),
    // World Database on Protected Areas, Natura 2000.
    (Park, &["wdpaid", "wdpa_id", "wdpa_pid", "iucn_cat", "sitecode"]),
];

/// Properties and values of each kind: land cover comes before land use.
const VALUES: [(&str, AreaSurface, &[&str]); 11] = [
    ("natural", Glacier, &["glacier"]),
    ("natural", Water, &["water", "bay", "strait"]),
    ("natural", Forest, &["wood"]),
    ("waterway", Water, &["riverbank", "river", "canal", "dock"]),
    ("landuse", Water, &["reservoir", "basin"]),
    ("landuse", Forest, &["forest"]),
    ("landcover", Water, &["water"]),
    ("landcover", Forest, &["trees"]),
    ("leisure", Park, &["park", "nature_reserve", "garden"]),
    ("boundary", Park, &["national_park", "protected_area"]),
    ("protected_area", Park, &["yes"]),
];

/// Properties that hold a class in words.
const CLASSES: [&str; 11] = [
    "fclass",
    "featurecla",
    "class",
    "subclass",
    "type",
    "kind",
    "category",
    "objektart",
    "feature",
    "desig",
    "desig_eng",
];

/// Properties that hold a class of CORINE Land Cover, and the classes.
const CORINE_KEYS: [&str; 6] = ["code_18", "code_12", "code_06", "code_00", "code_90", "clc_code"];
const CORINE: [(AreaSurface, &[&str]); 4] = [
    (Glacier, &["335"]),
    (Forest, &["311", "312", "313"]),
    (Water, &["511", "512", "521", "522", "523"]),
    (Park, &["141"]),
];

/// Words of names and classes. Parks come first: a park may bear the name of a lake, and is see-through.
const WORDS: [(AreaSurface, &[&str]); 4] = [
    (
        Park,
        &[
            "park",
            "parks",
            "parc",
            "parcs",
            "parque",
            "parques",
            "parco",
            "parchi",
            "reserve",
            "reserves",
            "protected",
            "wilderness",
            "nationalpark",
            "nationalparks",
            "naturpark",
            "naturparks",
            "schutzgebiet",
            "schutzgebiete",
            "naturschutzgebiet",
            "naturschutzgebiete",
        ],
    ),
    (
        Glacier,
        &[
            "glacier",
            "glaciers",
            "glaciated",
            "gletscher",
            "glaciar",
            "glaciares",
            "ghiacciaio",
            "ghiacciai",
            "icecap",
            "icecaps",
            "icefield",
            "icefields",
            "rgi",
            "glims",
        ],
    ),
    (
        Water,
        &[
            "water",
            "waters",
            "waterbody",
            "waterbodies",
            "lake",
            "lakes",
            "reservoir",
            "reservoirs",
            "pond",
            "ponds",
            "lagoon",
            "lagoons",
            "river",
            "rivers",
            "riverbank",
            "riverbanks",
            "ocean",
            "oceans",
            "sea",
            "seas",
            "gewässer",
            "gewaesser",
            "wasser",
            "lac",
            "lacs",
            "lago",
            "lagos",
            "laghi",
            "estany",
            "estanys",
        ],
    ),
    (
        Forest,
        &[
            "forest",
            "forests",
            "wood",
            "woods",
            "woodland",
            "woodlands",
            "wald",
            "wälder",
            "waelder",
            "forêt",
            "forêts",
            "foret",
            "forets",
            "bosque",
            "bosques",
            "bosco",
            "boschi",
        ],
    ),
];

/// Kind of the areas of a file. Properties decide if they give the kind of at least half of the areas: that of nine of ten of these,
/// else an outline. Otherwise the first name with a known word decides: of `names`, the file's layer and the file itself.
/// * `names`: names of the layer that the file is for.
pub fn area_kind(vectors: &Vectors, names: &[&str]) -> AreaKind {
    let areas: Vec<_> = vectors.features.iter().filter(|f| matches!(f.geometry, Geometry::Polygons(_))).collect();
    let found: Vec<(AreaSurface, String)> = areas.iter().filter_map(|f| of_properties(&f.properties)).collect();
    if !found.is_empty() && 2 * found.len() >= areas.len() {
        return of_found(&found, areas.len());
    }
    let stem = vectors.path.file_stem().map(|s| s.to_string_lossy().into_owned()).unwrap_or_default();
    let layers = names.iter().copied().chain([vectors.layer.as_str()]).map(|name| ("layer", name));
    for (what, name) in layers.chain([("file", stem.as_str())]) {
        if let Some((surface, word)) = of_words(name) {
            return AreaKind { surface, why: format!("the name of the {what}, \"{name}\", says {word}") };
        }
    }
    let why = "neither properties nor names say what the areas are".into();
    AreaKind { surface: Outline, why }
}

/// The kind of nine of ten of these areas, else an outline.
fn of_found(found: &[(AreaSurface, String)], areas: usize) -> AreaKind {
    let kinds = [Glacier, Water, Forest, Park];
    let count = |kind: AreaSurface| found.iter().filter(|f| f.0 == kind).count();
    if let Some(surface) = kinds.into_iter().find(|k| 10 * count(*k) >= 9 * found.len()) {
        let mut reasons: BTreeMap<&str, usize> = BTreeMap::new();
        found.iter().filter(|f| f.0 == surface).for_each(|f| *reasons.entry(&f.1).or_default() += 1);
        let usual = reasons.iter().max_by_key(|(_, n)| **n).map(|(reason, _)| *reason).unwrap_or_default();
        return AreaKind { surface, why: format!("{usual}; so say {} of {areas} areas", count(surface)) };
    }
    let all = kinds.into_iter().filter(|k| count(*k) > 0);
    let all: Vec<String> = all.map(|k| format!("{} {}", count(k), k.name())).collect();
    let why = format!("the areas are of several kinds ({}); one file for each would show them", all.join(", "));
    AreaKind { surface: Outline, why }
}

/// Kind of one area, and the property that gives it.
fn of_properties(properties: &BTreeMap<String, String>) -> Option<(AreaSurface, String)> {
    let tags: BTreeMap<String, &str> =
        properties.iter().map(|(k, v)| (k.to_ascii_lowercase(), v.trim())).filter(|(_, v)| !v.is_empty()).collect();
    let tag = |key: &str| tags.get(key).copied().unwrap_or_default();
    // Rock inside a glacier of the GLIMS inventory.
    if tag("line_type").eq_ignore_ascii_case("intrnl_rock") {
        return None;
    }
    let keyed = |wanted: AreaSurface| {
        let (surface, keys) = KEYS.iter().find(|k| k.0 == wanted)?;
        keys.iter().find(|key| !tag(key).is_empty()).map(|key| (*surface, format!("property {key}")))
    };
    let said = |key: &str| format!("property {key} = {}", tag(key));
    let valued = |only: fn(AreaSurface) -> bool| {
        let mut rules = VALUES.iter().filter(|(_, kind, _)| only(*kind));
        rules.find(|(key, _, values)| values.iter().any(|v| tag(key).eq_ignore_ascii_case(v))).map(|r| (r.1, said(r.0)))
    };
    let water = (!["", "no"].contains(&tag("water"))).then(|| (Water, said("water")));
    let corine = || {
        let of = |key: &&str| CORINE.iter().find(|c| c.1.contains(&tag(key))).map(|c| (c.0, said(key)));
        CORINE_KEYS.iter().find_map(of)
    };
    let class = || CLASSES.iter().find_map(|key| of_words(tag(key)).map(|(surface, _)| (surface, said(key))));
    keyed(Glacier)
        .or_else(|| keyed(Water))
        .or_else(|| valued(|kind| kind != Park))
        .or(water)
        .or_else(corine)
        .or_else(class)
        .or_else(|| valued(|kind| kind == Park))
        .or_else(|| keyed(Park))
}

/// Kind by the words of a name, and the word that gives it.
fn of_words(name: &str) -> Option<(AreaSurface, String)> {
    let mut spaced = String::new();
    let mut before = ' ';
    for c in name.chars() {
        if before.is_lowercase() && c.is_uppercase() {
            spaced.push(' ');
        }
        spaced.push(if c.is_alphabetic() { c } else { ' ' });
        before = c;
    }
    let words: Vec<String> = spaced.split_whitespace().map(str::to_lowercase).collect();
    WORDS.iter().find_map(|(surface, known)| {
        let word = words.iter().find(|word| known.contains(&word.as_str()))?;
        Some((*surface, word.clone()))
    })
}

#[cfg(test)]
mod tests;
