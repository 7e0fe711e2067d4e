//! Names of archives: they stand for the one file inside that a loader reads.

use crate::formats::{self, Reader, ends};
use crate::fs::{names_in, unpacked_size};
use crate::{IoError, budget, vrt};
use std::path::{Path, PathBuf};

/// Names that an error lists.
const LISTED: usize = 6;
/// Endings of archives that are a format of their own and are not unpacked here.
const WHOLE: [&str; 3] = [".raw.gz", ".3mf", ".usdz"];

/// The file that `path` stands for: if it is a ZIP or gzip, the one file inside for which `reads` holds, else itself.
///
/// * `most`: largest unpacked size, bytes.
/// * `reads`: whether an entry of this name is read. An archive of one file stands for that file.
///
/// # Errors
/// [`IoError::Os`]; [`IoError::Format`] if the archive holds no such file, or several.
pub(crate) fn content(path: &Path, most: u64, reads: &dyn Fn(&Path) -> bool) -> Result<PathBuf, IoError> {
    let mut path = path.to_owned();
    // Archives in archives, up to three levels.
    for _ in 0..3 {
        let name = path.file_name().map(|n| n.to_string_lossy().to_lowercase()).unwrap_or_default();
        if WHOLE.iter().any(|f| name.ends_with(f)) {
            return Ok(path);
        }
        let Some(names) = names_in(&path).map_err(|e| IoError::os(&path, e))? else { return Ok(path) };
        let name = one_of(&path, names, reads)?;
        if unpacked_size(&path, &name, most).map_err(|e| IoError::os(&path, e))? > most {
            return Err(IoError::format(path, budget::too_large(&name, "", most, "")));
        }
        path = path.join(name);
    }
    Ok(path)
}

fn one_of(path: &Path, names: Vec<String>, reads: &dyn Fn(&Path) -> bool) -> Result<String, IoError> {
    let bad = |reason: String| Err(IoError::format(path, reason));
    let packed = |n: &&String| {
        let inner = Path::new(n.as_str());
        reads(inner) || ["zip", "gz"].iter().any(|e| inner.extension().is_some_and(|x| x.eq_ignore_ascii_case(e)))
    };
    let fit: Vec<&String> = names.iter().filter(packed).collect();
    match (fit.as_slice(), names.as_slice()) {
        ([one], _) => Ok((*one).clone()),
        ([], [one]) => Ok(one.clone()),
        // The main document of a KMZ; others lie beside it in folders.
        _ if let Some(main) = fit.iter().find(|name| name.eq_ignore_ascii_case("doc.kml")) => Ok((*main).clone()),
        ([], []) => bad("the archive holds no file; get it again".into()),
        ([], _) => bad(format!("the archive holds no file of this kind (it holds {})", listed(names.iter()))),
        (several, _) => {
            let first = path.join(several[0].as_str());
            bad(format!(
                "the archive holds {} files of this kind ({}); name the one that is meant: {}",
                several.len(),
                listed(several.iter().copied()),
                first.display()
            ))
        }
    }
}

fn listed<'a>(names: impl ExactSizeIterator<Item = &'a String>) -> String {
    let more = names.len().saturating_sub(LISTED);
    let mut text = names.take(LISTED).map(String::as_str).collect::<Vec<_>>().join(", ");
    if more > 0 {
        text.push_str(&format!(" and {more} more"));
    }
    text
}

/// As [`content`], for one loader: a file that it reads by name comes before those that it may read.
///
/// # Errors
/// As [`content`].
pub(crate) fn content_for(path: &Path, most: u64, reader: Reader) -> Result<PathBuf, IoError> {
    content(path, most, &|p| reader.reads(p)).or_else(|_| content(path, most, &|p| reader.may_read(p)))
}

/// The elevation models of an archive that holds several and nothing else that is read, by name, or of a virtual raster; else none.
///
/// # Errors
/// [`IoError::Os`]; [`IoError::Format`] for a virtual raster that shows anything else than whole files.
pub fn tiles(path: &Path) -> Result<Vec<PathBuf>, IoError> {
    if let Some(files) = vrt::sources(path)? {
        return Ok(files);
    }
    let mut names = names_in(path).map_err(|e| IoError::os(path, e))?.unwrap_or_default();
    let is_read = |name: &String| {
        let name = Path::new(name);
        formats::of_name(name).is_some_and(|format| format.reader.is_some()) && !ends(name, &[".txt"])
    };
    names.retain(is_read);
    names.sort();
    let are_tiles = names.len() > 1 && names.iter().all(|name| Reader::Terrain.reads(Path::new(name)));
    Ok(names.into_iter().filter(|_| are_tiles).map(|name| path.join(name)).collect())
}

/// The file that a name stands for, for any loader. Files whose names tell a format that is read come before others, and pictures, which
/// may belong to a model, last.
///
/// # Errors
/// As those of loaders for archives: no file that is read, or several.
pub fn inside(path: &Path) -> Result<PathBuf, IoError> {
    let most = budget::bytes();
    let is_read = |p: &Path| formats::of_name(p).is_some_and(|format| format.reader.is_some()) && !ends(p, &[".txt"]);
    let may_be = |p: &Path| is_read(p) || ends(p, &[".json", ".jsonl", ".gml"]);
    let picture = |p: &Path| may_be(p) || ends(p, &[".png", ".txt", ".xml"]);
    let error = match content(path, most, &is_read) {
        Ok(found) => return Ok(found),
        Err(error) => error,
    };
    content(path, most, &may_be).or_else(|_| content(path, most, &picture)).map_err(|_| error)
}
