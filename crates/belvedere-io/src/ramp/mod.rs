//! Colour ramps by height: GDAL colour-relief text and GMT `.cpt`.

mod colors;
pub mod cpt;
pub mod gdal;

use crate::{InputFile, IoError, Loaded, fs};
use belvedere_scene::Ramp;
use std::io::Read;
use std::path::Path;

/// Largest file that is read as a ramp, bytes.
const MAX_BYTES: u64 = 4 << 20;

/// Reads a ramp: `.cpt` as GMT's format, anything else as GDAL's.
///
/// # Errors
/// [`IoError::Os`]; [`IoError::Format`] with the number of the line that is no line of the format, for a file without
/// colours, and for one that is larger than any ramp.
pub fn load_ramp(path: &Path) -> Result<Loaded<Ramp>, IoError> {
    let os = |e| IoError::os(path, e);
    let mut bytes = Vec::new();
    fs::File::open(path).map_err(os)?.take(MAX_BYTES + 1).read_to_end(&mut bytes).map_err(os)?;
    let bad = |reason: String| IoError::format(path, reason);
    if bytes.len() as u64 > MAX_BYTES {
        return Err(bad(format!("it is larger than {MAX_BYTES} bytes; a colour ramp is a short text, give one")));
    }
    let text = std::str::from_utf8(bytes.strip_prefix(b"\xef\xbb\xbf").unwrap_or(&bytes))
        .map_err(|_| bad("it is no text; give a GDAL colour-relief text or a GMT .cpt".into()))?;
    let is_cpt = path.extension().is_some_and(|e| e.eq_ignore_ascii_case("cpt"));
    let read = if is_cpt { cpt::read(text) } else { gdal::read(text) };
    let mut loaded = read.map_err(bad)?;
    loaded.warnings = loaded.warnings.into_iter().map(|w| w.in_file(path)).collect();
    Ok(loaded.with_file(InputFile::of(path, &bytes)))
}

/// A message about a line, which counts from 1.
fn at_line(line: usize, reason: impl std::fmt::Display) -> String {
    format!("line {line}: {reason}")
}

/// A word of a file, shortened for messages.
fn shown(word: &str) -> String {
    word.chars().take(40).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn no_text_is_ever_a_panic() {
        let pieces = [
            "0 ",
            "nv",
            "50%",
            "B ",
            "1/2/3",
            "# RANGE = ",
            "#",
            "\n",
            "-",
            "255 ",
            "NaN ",
            "é",
            "hsv-",
            ";",
            "1e400 ",
            "L",
        ];
        let mut seed = 9u64;
        for _ in 0..3000 {
            let mut text = String::new();
            for _ in 0..24 {
                seed = seed.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
                text.push_str(pieces[(seed >> 33) as usize % pieces.len()]);
            }
            for read in [cpt::read(&text), gdal::read(&text)].into_iter().flatten() {
                assert!(!read.value.stops.is_empty());
                assert!(read.value.resolved([0.0, 1.0]).iter().all(|s| s.0.is_finite()), "{text}");
            }
        }
    }
}
