//! Whom a file asks to be named: what it says of its author and its rights, near its beginning.

use crate::{GeoTiff, Limits, fs};
use std::io::Read;
use std::path::Path;

/// What pictures of OpenStreetMap's data say (ODbL 1.0, section 4.3; its attribution guideline).
pub const OPENSTREETMAP: &str = "© OpenStreetMap contributors";

/// Bytes at the beginning of a file that are searched.
const HEAD: u64 = 1 << 16;
/// Longest text that is taken, characters.
const LONGEST: usize = 160;

/// Whom the data of a file ask to be named, as far as the file says so; `None` if it does not, or cannot be read.
///
/// Extracts of OpenStreetMap are known by their ending and content, JSON (GeoJSON, Overpass, CityJSON) by members and ids that name
/// OpenStreetMap and else by `attribution`, `copyright` and the contact of CityJSON, GPX by the author of its rights, GeoTIFF by the tags
/// Copyright and Artist.
pub fn of_file(path: &Path) -> Option<String> {
    let name = path.file_name()?.to_string_lossy().to_lowercase();
    if [".osm.pbf", ".osm", ".osm.bz2", ".osm.gz"].iter().any(|ending| name.ends_with(ending)) {
        return Some(OPENSTREETMAP.to_owned());
    }
    if !fs::metadata(path).is_ok_and(|m| m.is_file()) {
        return None;
    }
    let mut head = Vec::new();
    fs::File::open(path).ok()?.take(HEAD).read_to_end(&mut head).ok()?;
    if matches!(head.get(..2), Some(b"II" | b"MM")) {
        let tiff = GeoTiff::open(path, Limits::default()).ok()?.value;
        return tiff.credit().and_then(|text| tidy(&text));
    }
    of_head(&String::from_utf8_lossy(&head))
}

/// The same for the beginning of a text.
fn of_head(text: &str) -> Option<String> {
    let begins = text.trim_start_matches('\u{feff}').trim_start();
    let is_json = begins.starts_with(['{', '[', '\u{1e}']);
    if !is_json && !begins.starts_with('<') {
        return None;
    }
    let small = text.to_lowercase();
    let by_ids = ["node/", "way/", "relation/"]
        .iter()
        .any(|id| small.contains(&format!("\"@id\": \"{id}")) || small.contains(&format!("\"@id\":\"{id}")));
    if small.contains("openstreetmap") || by_ids || begins.starts_with("<osm ") || small.contains("<osm version") {
        return Some(OPENSTREETMAP.to_owned());
    }
    if is_json {
        return ["attribution", "copyright", "contactName"].iter().find_map(|key| tidy(&member(text, key)?));
    }
    let (_, rest) = text.split_once("<copyright")?;
    let (_, author) = rest.split_once('>')?.0.split_once("author=")?;
    let quote = author.chars().next().filter(|c| ['"', '\''].contains(c))?;
    tidy(author[1..].split(quote).next()?).map(|name| format!("© {name}"))
}

/// The text of the first member of that name.
fn member(text: &str, key: &str) -> Option<String> {
    let quoted = format!("\"{key}\"");
    let after = text.split(&quoted).skip(1).map(str::trim_start).find_map(|rest| rest.strip_prefix(':'))?;
    serde_json::Deserializer::from_str(after).into_iter::<serde_json::Value>().next()?.ok()?.as_str().map(str::to_owned)
}

/// A text on one line, not too long; `None` if nothing is left.
fn tidy(text: &str) -> Option<String> {
    let words: Vec<&str> = text.split_whitespace().collect();
    let line = words.join(" ");
    let line: String = match line.char_indices().nth(LONGEST) {
        Some((end, _)) => format!("{}…", &line[..end]),
        None => line,
    };
    (!line.is_empty()).then_some(line)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn texts_name_whom_they_ask_to_be_named() {
        let osm = Some(OPENSTREETMAP.to_owned());
        let overpass = r#"{"version": 0.6, "osm3s": {"copyright": "The data included in this document is from www.openstreetmap.org."}}"#;
        assert_eq!(of_head(overpass), osm);
        assert_eq!(of_head(r#"{"type":"FeatureCollection","features":[{"properties":{"@id": "way/12"}}]}"#), osm);
        assert_eq!(of_head("\u{feff}<?xml version='1.0'?>\n<osm version=\"0.6\">"), osm);
        assert_eq!(of_head(r#"{"attribution" : "© swisstopo\n 2024", "a": 1}"#), Some("© swisstopo 2024".into()));
        let city = r#"{"type":"CityJSON","metadata":{"pointOfContact":{"contactName":"3D geoinformation"}}}"#;
        assert_eq!(of_head(city), Some("3D geoinformation".into()));
        let gpx = "<gpx><metadata><copyright author=\"A. Walker\"><year>2020</year></copyright>";
        assert_eq!(of_head(gpx), Some("© A. Walker".into()));
        // Nothing of these says so.
        let silent = [
            r#"{"type":"FeatureCollection","features":[]}"#,
            "<gpx></gpx>",
            "ncols 4",
            "",
            r#"{"copyright": 3}"#,
            r#"{"attribution": "   "}"#,
            r#"{"attribution"#,
        ];
        assert!(silent.iter().all(|text| of_head(text).is_none()));
        assert_eq!(tidy(&"ab ".repeat(100)).map(|text| text.chars().count()), Some(LONGEST + 1));
    }
}
