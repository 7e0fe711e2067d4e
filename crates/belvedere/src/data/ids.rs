//! Ids of layers of files: they stand in legends, messages and records, so they are made of the files' names.

use crate::scene_file::LayerDoc;
use belvedere_io::{arrays, split_table};
use belvedere_resolve::vectors::FeatureKind;
use std::path::Path;

/// Endings that stand before another one, or say no more than the format.
const ENDINGS: [&str; 7] = [".osm", ".geo", ".gpx", ".kml", ".geojson", ".json", ".csv"];
/// Names of arrays that nobody named, before their number.
const UNNAMED: &str = "features";

/// The name of a file without its endings, that of a table of a file, or that of an array; empty where it says nothing.
pub(super) fn stem(source: &str) -> String {
    if let Some(name) = source.strip_prefix(arrays::SCHEME) {
        let number = name.strip_prefix(UNNAMED).unwrap_or(name);
        let is_numbered = number.len() < name.len() && !number.is_empty() && number.chars().all(|c| c.is_ascii_digit());
        return if is_numbered { String::new() } else { name.to_owned() };
    }
    if source.starts_with("builtin:") {
        return String::new();
    }
    let (file, table) = split_table(Path::new(source));
    let stem = file.file_stem().and_then(|stem| stem.to_str()).unwrap_or_default();
    let stem = ENDINGS.iter().find_map(|ending| stem.strip_suffix(ending)).unwrap_or(stem);
    table.unwrap_or(stem).trim().to_owned()
}

/// An id that no other layer has: the name of the file, or what its features are where it has none.
pub(super) fn of_file(source: &str, kind: FeatureKind, others: &[LayerDoc]) -> String {
    let stem = stem(source);
    free(if stem.is_empty() { kind.plural() } else { &stem }, others)
}

/// The id, with a number behind it where another layer has it.
pub(super) fn free(id: &str, others: &[LayerDoc]) -> String {
    let taken = |id: &str| others.iter().any(|layer| layer.id() == id);
    let numbered = (1..).map(|k| if k == 1 { id.to_owned() } else { format!("{id}-{k}") });
    numbered.into_iter().find(|id| !taken(id)).unwrap_or_default()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ids_are_the_names_of_files_and_no_numbers() {
        for (source, wanted) in [
            ("/a/b/GR 11.gpx", "GR 11"),
            ("town.osm.pbf", "town"),
            ("tracks.gpx.gz", "tracks"),
            ("array:alps", "alps"),
            ("array:features1", ""),
            ("array:features", "features"),
            ("builtin:massif?seed=7", ""),
        ] {
            assert_eq!(stem(source), wanted, "{source}");
        }
        assert_eq!(of_file("array:features1", FeatureKind::Lines, &[]), "lines");
    }
}
