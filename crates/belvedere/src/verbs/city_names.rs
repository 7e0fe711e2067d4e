//! Names in cities and maps that `--see` understands.

use crate::BelvedereError;
use crate::scene_file::suggestion;
use belvedere_io::load_vectors;
use belvedere_io::{CityFile, Limits, load_city};
use schemars::JsonSchema;
use serde::Serialize;
use std::collections::BTreeMap;
use std::path::Path;

/// Most names of a list.
const LISTED: usize = 40;
/// Most ids that stand as examples, and most values of a property for which they are listed.
const EXAMPLES: usize = 3;
/// Properties whose values tell kinds of things.
const KINDS: [&str; 8] = ["building", "highway", "railway", "waterway", "leisure", "landuse", "natural", "amenity"];

/// What `reveal --see` understands in a city or map, each with the number of things that it means.
#[derive(Debug, Clone, Default, JsonSchema, Serialize)]
pub struct CitySee {
    /// Names of buildings, the first forty.
    pub buildings: BTreeMap<String, usize>,
    /// Buildings with a name.
    pub named_buildings: usize,
    /// Ids of some buildings.
    pub ids: Vec<String>,
    /// Names of streets, railways and rivers, those of most pieces, at most forty.
    pub ways: BTreeMap<String, usize>,
    /// Names of land cover, at most forty.
    pub areas: BTreeMap<String, usize>,
    /// `key=value` that mean most things, at most forty.
    pub kinds: BTreeMap<String, usize>,
}

pub(crate) fn is_building(properties: &BTreeMap<String, String>) -> bool {
    ["building", "building:part"].iter().any(|key| properties.get(*key).is_some_and(|value| value != "no"))
}

/// The most frequent names, at most [`LISTED`].
fn most(counts: BTreeMap<String, usize>) -> BTreeMap<String, usize> {
    let mut list: Vec<(String, usize)> = counts.into_iter().filter(|(name, _)| !name.is_empty()).collect();
    list.sort_by(|a, b| b.1.cmp(&a.1).then_with(|| a.0.cmp(&b.0)));
    list.truncate(LISTED);
    list.into_iter().collect()
}

fn count<'n>(names: impl Iterator<Item = &'n str>) -> BTreeMap<String, usize> {
    let mut counts = BTreeMap::new();
    names.for_each(|name| *counts.entry(name.to_owned()).or_insert(0) += 1);
    counts
}

impl CitySee {
    pub(crate) fn of(file: &CityFile) -> Self {
        let buildings = count(file.city.buildings.iter().map(|b| b.name.as_str()).filter(|name| !name.is_empty()));
        let ids = file.city.buildings.iter().map(|b| b.id.clone()).filter(|id| !id.is_empty());
        let mut kinds: BTreeMap<String, usize> = BTreeMap::new();
        let mut add = |properties: &BTreeMap<String, String>| {
            for key in KINDS {
                if let Some(value) = properties.get(key) {
                    *kinds.entry(format!("{key}={value}")).or_insert(0) += 1;
                }
            }
        };
        file.about.iter().for_each(|about| add(&about.attributes));
        // Only maps have tags of streets and land cover.
        if let Ok(vectors) = load_vectors(&file.path) {
            vectors.value.features.iter().filter(|f| !is_building(&f.properties)).for_each(|f| add(&f.properties));
        }
        Self {
            named_buildings: buildings.values().sum(),
            buildings: most(buildings),
            ids: ids.take(EXAMPLES).collect(),
            ways: most(count(file.city.ways.iter().map(|w| w.name.as_str()))),
            areas: most(count(file.city.areas.iter().map(|a| a.name.as_str()))),
            kinds: most(kinds),
        }
    }
}

/// What can be named in cities, in words, with the nearest name to `see`.
pub(crate) fn known_names(cities: &[&Path], see: &str) -> Result<String, BelvedereError> {
    let of = |path: &Path| Ok::<_, BelvedereError>(CitySee::of(&load_city(path, None, &Limits::default())?.value));
    let all: Vec<CitySee> = cities.iter().map(|path| of(path)).collect::<Result<_, _>>()?;
    let names =
        all.iter().flat_map(|s| s.buildings.keys().chain(s.ways.keys()).chain(s.areas.keys()).chain(s.kinds.keys()));
    let names: Vec<&str> = names.map(String::as_str).collect();
    let ids: Vec<&str> = all.iter().flat_map(|s| &s.ids).map(String::as_str).collect();
    let list = if names.is_empty() { &ids } else { &names };
    let near = if see.is_empty() {
        list.iter().take(6).copied().collect::<Vec<_>>().join(", ")
    } else {
        suggestion(see, list)
    };
    let joint = if near.ends_with('?') { "" } else { ";" };
    Ok(format!("{near}{joint} `belvedere info` lists names, ids and key=value"))
}
