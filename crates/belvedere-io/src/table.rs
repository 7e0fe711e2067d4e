//! Names of tables, appended to file names.

use std::path::{Path, PathBuf};

/// Separator between the name of a GeoPackage and that of its table.
const MARK: &str = "?table=";

/// Splits a path into file and table: `town.gpkg?table=streets` is the table `streets` of `town.gpkg`. Only names of
/// GeoPackages are split; the table is not empty.
pub fn split_table(path: &Path) -> (&Path, Option<&str>) {
    let split = path.to_str().and_then(|name| name.rsplit_once(MARK));
    match split {
        Some((file, table)) if !table.is_empty() && file.to_ascii_lowercase().ends_with(".gpkg") => {
            (Path::new(file), Some(table))
        }
        _ => (path, None),
    }
}

/// A file name with a table, the inverse of [`split_table`].
pub fn join_table(file: PathBuf, table: Option<&str>) -> PathBuf {
    let Some(table) = table else { return file };
    let mut name = file.into_os_string();
    name.push(MARK);
    name.push(table);
    name.into()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_names_of_geopackages_are_split() {
        for (name, file, table) in [
            ("a/b.gpkg?table=streets", "a/b.gpkg", Some("streets")),
            ("B.GPKG?table=my table?", "B.GPKG", Some("my table?")),
            ("b.gpkg", "b.gpkg", None),
            ("b.gpkg?table=", "b.gpkg?table=", None),
            ("b.gpkg?layer=x", "b.gpkg?layer=x", None),
            ("b.geojson?table=x", "b.geojson?table=x", None),
        ] {
            assert_eq!(split_table(Path::new(name)), (Path::new(file), table), "{name}");
            assert_eq!(join_table(file.into(), table), Path::new(name));
        }
    }
}
