//! Files that another file names.

use super::{archive_of, canonicalize, metadata};
use crate::IoError;
use std::io;
use std::path::{Path, PathBuf};

/// The file that stands beside `path` under the same name with another ending, in small or capital letters, with the ending of `path` or
/// without (`dem.prj`, `dem.PRJ`, `dem.Prj`, `dem.asc.prj`).
pub(crate) fn sidecar(path: &Path, ending: &str) -> Option<PathBuf> {
    let capital = ending.to_ascii_uppercase();
    let title: String = capital.chars().take(1).chain(ending.chars().skip(1)).collect();
    let endings = [ending, &capital, &title];
    let longer = |e: &&str| {
        let mut name = path.file_name().unwrap_or_default().to_os_string();
        name.push(".");
        name.push(e);
        path.with_file_name(name)
    };
    let named = endings.iter().map(|e| path.with_extension(e)).chain(endings.iter().map(longer));
    named.into_iter().find(|p| metadata(p).is_ok_and(|m| m.is_file()))
}

/// The bytes of a file that stands beside `path`, as [`sidecar`] finds it.
///
/// # Errors
/// [`IoError::Os`], also for a link that leads out of the folder; [`IoError::Format`] for more than `most` bytes.
pub(crate) fn read_sidecar(path: &Path, file: &Path, most: u64) -> Result<Vec<u8>, IoError> {
    if !may_be_read(path, file) {
        // No fault of the format: that is looked for in the file.
        let reason = "is a link that leads out of its folder; put the file itself there";
        return Err(IoError::os(file, io::Error::new(io::ErrorKind::PermissionDenied, reason)));
    }
    let size = metadata(file).map_err(|e| IoError::os(file, e))?.len();
    if size > most {
        let reason = format!("has {size} bytes, at most {most} are read; it is damaged or something else");
        return Err(IoError::format(file, reason));
    }
    super::read(file).map_err(|e| IoError::os(file, e))
}

/// Whether `file` may be read because `path` names it: after links are followed it lies in the folder of `path` or below, or, where `path`
/// itself is a link, on the same [`shelf`]; also if there is no such file.
fn may_be_read(path: &Path, file: &Path) -> bool {
    // Entries of one archive are no links, and there are none in memory.
    let same_archive = archive_of(path) != path && archive_of(path) == archive_of(file);
    if same_archive || cfg!(target_family = "wasm") {
        return true;
    }
    let folder = path.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new("."));
    match (canonicalize(folder), canonicalize(file)) {
        (Ok(folder), Ok(file)) => {
            let on_one_shelf = |real: PathBuf| !real.starts_with(&folder) && file.starts_with(shelf(&real));
            file.starts_with(&folder) || canonicalize(path).is_ok_and(on_one_shelf)
        }
        (_, found) => found.is_err_and(|e| e.kind() == io::ErrorKind::NotFound),
    }
}

/// Folders by which stores of data are known whose files have hashes for names, each in a folder of its own: git-annex, and caches of DVC.
const STORES: [[&str; 2]; 3] = [["annex", "objects"], [".dvc", "cache"], ["files", "md5"]];

/// The folder in which a file is kept with those that belong to it: its own, or of a store of hashes the whole store.
///
/// * `real`: canonical path of the file.
pub fn shelf(real: &Path) -> PathBuf {
    let folder = real.parent().unwrap_or(Path::new(""));
    let is_store = |folder: &Path| {
        let ends_with = |[above, name]: [&str; 2]| folder.ends_with(Path::new(above).join(name));
        STORES.into_iter().any(ends_with)
    };
    folder.ancestors().find(|folder| is_store(folder)).unwrap_or(folder).to_owned()
}

/// Path of a file that the file `path` names; refused if it is remote, absolute or leads out of the folder, also by a link
/// (see `may_be_read`).
pub(crate) fn beside(path: &Path, name: &str) -> Result<PathBuf, String> {
    let relative = Path::new(name);
    let stays =
        relative.components().all(|c| matches!(c, std::path::Component::Normal(_) | std::path::Component::CurDir));
    if name.is_empty() || name.contains(':') || name.contains('\\') || !stays {
        let name = shown(name);
        return Err(format!("it names {name}, which is not a file below its own folder; put the file beside it"));
    }
    let file = path.parent().unwrap_or(Path::new("")).join(relative);
    if !may_be_read(path, &file) {
        return Err(format!(
            "it names {}, a link that leads out of its folder; put the file itself there",
            shown(name)
        ));
    }
    Ok(file)
}

/// A name as messages quote it.
fn shown(name: &str) -> String {
    format!("{:?}", name.chars().take(60).collect::<String>())
}

/// Other spellings of the name of a file that another file names: without quotes, with percent signs decoded, with slashes for backslashes,
/// and of an absolute path, which is of the machine on which it was written, the last part.
pub(crate) fn spellings(name: &str) -> Vec<String> {
    let plain = name.trim().trim_matches(['"', '\'']).replace('\\', "/");
    let decoded = percent_decoded(&plain);
    let mut out = vec![plain, decoded];
    if out[0].starts_with('/') || out[0].contains(':') {
        out = out.iter().map(|name| name.rsplit('/').next().unwrap_or(name).to_owned()).collect();
    }
    out.dedup();
    out
}

/// A text with its percent signs decoded; those that stand for nothing stay.
pub(crate) fn percent_decoded(text: &str) -> String {
    let bytes = text.as_bytes();
    let (mut out, mut at) = (Vec::with_capacity(bytes.len()), 0);
    while at < bytes.len() {
        let code = bytes.get(at + 1..at + 3).and_then(|c| std::str::from_utf8(c).ok());
        let code =
            code.filter(|c| c.bytes().all(|b| b.is_ascii_hexdigit())).and_then(|c| u8::from_str_radix(c, 16).ok());
        match (bytes[at], code) {
            (b'%', Some(byte)) => {
                out.push(byte);
                at += 3;
            }
            (byte, _) => {
                out.push(byte);
                at += 1;
            }
        }
    }
    String::from_utf8(out).unwrap_or_else(|_| text.to_owned())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn stores_of_hashes_are_one_shelf() {
        for (file, want) in [
            ("/data/alps/dem.asc", "/data/alps"),
            ("/p/.git/annex/objects/X1/2f/KEY.asc/KEY.asc", "/p/.git/annex/objects"),
            ("/p/.dvc/cache/files/md5/ab/cdef", "/p/.dvc/cache/files/md5"),
            ("/p/.dvc/cache/ab/cdef", "/p/.dvc/cache"),
            ("/mnt/shared/files/md5/ab/cdef", "/mnt/shared/files/md5"),
            ("/p/objects/ab/cdef", "/p/objects/ab"),
        ] {
            assert_eq!(shelf(Path::new(file)), Path::new(want), "{file}");
        }
    }

    #[test]
    fn names_of_files_have_several_spellings() {
        for (name, want) in [
            ("\"a b.mtl\"", "a b.mtl"),
            ("a%20b.mtl", "a b.mtl"),
            ("C:\\models\\T%C3%BCr.png", "Tür.png"),
            (".\\maps\\a.png", "./maps/a.png"),
            ("/home/me/a.mtl", "a.mtl"),
        ] {
            assert!(spellings(name).iter().any(|s| s == want), "{name}: {:?}", spellings(name));
        }
        for (uri, want) in [
            ("a%20b.bin", "a b.bin"),
            ("W%C3%BCrfel.bin", "Würfel.bin"),
            ("100%.bin", "100%.bin"),
            ("%zz%4", "%zz%4"),
            ("%ff.bin", "%ff.bin"),
        ] {
            assert_eq!(percent_decoded(uri), want, "{uri}");
        }
    }
}
