//! Names of outputs: their endings say what is written, and no two are the same.

use std::path::{Path, PathBuf};

/// Endings of formats; an output is not named after one that it does not have.
const KNOWN: [&str; 30] = [
    "jpg", "jpeg", "png", "tif", "tiff", "webp", "gif", "bmp", "svg", "pdf", "json", "toml", "geojson", "xml", "yaml",
    "yml", "txt", "csv", "asc", "hgt", "gpx", "obj", "ply", "stl", "gltf", "glb", "mp4", "avi", "exr", "npy",
];

/// Refuses names with the ending of another format than those that are written.
///
/// * `endings`: of what is written, the best one first.
/// * `what`: a sentence that says what is written.
pub(crate) fn named(path: &Path, endings: &[&str], what: &str) -> anyhow::Result<()> {
    let ending = path.extension().and_then(|e| e.to_str()).unwrap_or_default().to_ascii_lowercase();
    let is_other = KNOWN.contains(&ending.as_str()) && !endings.contains(&ending.as_str());
    let best = endings.first().copied().unwrap_or_default();
    anyhow::ensure!(!is_other, "{}: {what}, not .{ending}; name the output .{best}", path.display());
    Ok(())
}

/// The same for pictures.
pub(crate) fn png_named(path: &Path) -> anyhow::Result<()> {
    named(path, &["png"], "pictures are written as PNG")
}

/// Refuses two outputs of one name.
pub(crate) fn distinct(paths: &[PathBuf]) -> anyhow::Result<()> {
    let twice = paths.iter().enumerate().find(|(i, path)| paths[..*i].contains(path));
    match twice {
        Some((_, path)) => Err(anyhow::anyhow!("{}: two outputs have this name; give each its own", path.display())),
        None => Ok(()),
    }
}
