//! Inputs named `-`: standard input, kept in a temporary file where a loader needs one.

use anyhow::{Context as _, ensure};
use belvedere::BelvedereError;
use belvedere::io::formats::{self, Reader};
use belvedere::request::OfData;
use belvedere::scene_file::{self, SourceDocument};
use belvedere::verbs::open_files::scene_or_data;
use std::io::{IsTerminal, Read};
use std::path::{Path, PathBuf};
use std::sync::OnceLock;
use tempfile::TempDir;

/// Largest input, bytes.
const LARGEST_INPUT: u64 = 2 << 30;
/// How much of its beginning tells what it is, bytes.
const BEGINNING: usize = 4096;

/// Standard input of one run.
#[derive(Default)]
pub(crate) struct Stdin {
    folder: OnceLock<TempDir>,
}

impl Stdin {
    /// A scene: a file, or standard input, whose files lie below the current folder.
    pub(crate) fn scene(&self, path: &Path) -> anyhow::Result<SourceDocument> {
        if !is_stdin(path) {
            return Ok(scene_file::read(path).map_err(BelvedereError::from)?);
        }
        let text = String::from_utf8(self.read()?).context("standard input is no text in UTF-8")?;
        Ok(scene_file::parse(path, &text).map_err(BelvedereError::from)?)
    }

    /// A scene, or data that can be drawn without one, of which something is said.
    pub(crate) fn drawable(&self, paths: &[PathBuf], said: &OfData) -> anyhow::Result<SourceDocument> {
        match paths {
            [path] if is_stdin(path) => self.scene(path),
            paths => {
                ensure!(!paths.iter().any(|path| is_stdin(path)), "-: standard input is a scene, which is drawn alone");
                Ok(scene_or_data(paths, said)?)
            }
        }
    }

    /// A file of data: itself, or one that holds standard input.
    pub(crate) fn data(&self, path: &Path) -> anyhow::Result<PathBuf> {
        self.kept(path, |bytes| {
            ending(bytes).context(
                "-: standard input is no GPX, KML, TCX, GeoJSON, FlatGeobuf, table with coordinates, CityJSON, CityGML, OpenStreetMap, GeoTIFF or ESRI ASCII; give a file",
            )
        })
    }

    /// The same for a file of points or pixels.
    pub(crate) fn json(&self, path: &Path) -> anyhow::Result<PathBuf> {
        self.kept(path, |_| Ok("json"))
    }

    /// Whether an input came from standard input.
    pub(crate) fn was_read(&self) -> bool {
        self.folder.get().is_some()
    }

    fn kept(&self, path: &Path, ending: impl Fn(&[u8]) -> anyhow::Result<&'static str>) -> anyhow::Result<PathBuf> {
        if !is_stdin(path) {
            return Ok(path.to_owned());
        }
        let bytes = self.read()?;
        let folder = self.folder.get().context("-: there is no folder for standard input")?;
        let file = folder.path().join(format!("stdin.{}", ending(&bytes)?));
        std::fs::write(&file, bytes).with_context(|| file.display().to_string())?;
        Ok(file)
    }

    /// All of standard input.
    fn read(&self) -> anyhow::Result<Vec<u8>> {
        ensure!(!self.was_read(), "-: only one input can be standard input; give a file for the other");
        ensure!(
            !std::io::stdin().is_terminal(),
            "-: standard input is a terminal; send a file or the output of a program to it, or name a file"
        );
        let folder = tempfile::tempdir().context("-: no temporary folder can be made")?;
        let _ = self.folder.set(folder);
        let mut bytes = Vec::new();
        std::io::stdin()
            .lock()
            .take(LARGEST_INPUT + 1)
            .read_to_end(&mut bytes)
            .context("-: standard input cannot be read")?;
        ensure!(
            bytes.len() as u64 <= LARGEST_INPUT,
            "-: standard input has more than {} GiB; name a file",
            LARGEST_INPUT >> 30
        );
        ensure!(!bytes.is_empty(), "-: standard input is empty; send a file or the output of a program to it");
        Ok(bytes)
    }
}

/// Whether an input is standard input, which is written as standard output is.
fn is_stdin(path: &Path) -> bool {
    path == Path::new("-")
}

/// The ending of files with such contents.
fn ending(bytes: &[u8]) -> Option<&'static str> {
    let beginning = String::from_utf8_lossy(&bytes[..bytes.len().min(BEGINNING)]);
    let text = beginning.trim_start_matches('\u{feff}').trim_start();
    if bytes.starts_with(b"II*\0") || bytes.starts_with(b"MM\0*") || bytes.starts_with(b"II+\0") {
        return Some("tif");
    }
    if text.starts_with('{') {
        return Some(if text.contains("\"CityJSON\"") { "city.json" } else { "geojson" });
    }
    if text.get(..5).is_some_and(|word| word.eq_ignore_ascii_case("ncols")) {
        return Some("asc");
    }
    let has = |word: &str| text.starts_with('<') && text.contains(word);
    match () {
        () if has("<gpx") => Some("gpx"),
        () if has("<osm") => Some("osm"),
        () if has("CityModel") => Some("gml"),
        () => {
            let known = formats::readable_content(bytes).filter(|format| format.reader == Some(Reader::Features));
            known.map(|format| format.endings[0].trim_start_matches('.'))
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn contents_tell_the_format() {
        let of = |text: &str| ending(text.as_bytes());
        assert_eq!(of("\u{feff}<?xml version='1.0'?>\n<gpx version='1.1'>"), Some("gpx"));
        assert_eq!([of(" {\"type\": 1}"), of("{\"type\":\"CityJSON\"}")], [Some("geojson"), Some("city.json")]);
        assert_eq!([of("NCOLS 3"), of("II*\0"), of("<osm>")], [Some("asc"), Some("tif"), Some("osm")]);
        assert_eq!([of("<kml/>"), of("lon;lat\n1;2"), of("fgb\u{3}fgb\0")], [Some("kml"), Some("csv"), Some("fgb")]);
        assert_eq!([of("gpx"), of("<html>"), of("")], [None; 3]);
    }
}
