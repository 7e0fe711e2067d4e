//! Outputs: never written over an input, over an existing file only on request, and never left half written.

use crate::BelvedereError;
use crate::scene_file::Document;
use belvedere_io::{fs, split_table};
use serde::Serialize;
use std::path::{Path, PathBuf};

/// Returns an error if `path` is one of `inputs`, exists while `overwrite` is false, or cannot be created: its folder is missing or
/// cannot be written. Call it before long work.
///
/// # Errors
/// [`BelvedereError::Output`], [`BelvedereError::Io`].
pub fn check(path: &Path, inputs: &[PathBuf], overwrite: bool) -> Result<(), BelvedereError> {
    if let Ok(real) = fs::canonicalize(path)
        && inputs.iter().any(|input| fs::canonicalize(split_table(input).0).is_ok_and(|input| input == real))
    {
        return Err(BelvedereError::Output {
            path: path.to_owned(),
            reason: "is an input of this command and is never written; choose another output".into(),
        });
    }
    belvedere_io::atomic::check_output(path, overwrite)?;
    let target = fs::canonicalize(path).unwrap_or_else(|_| path.to_owned());
    // A device is written directly.
    if fs::metadata(&target).is_ok_and(|meta| !meta.is_file()) {
        return Ok(());
    }
    check_writable(&folder_of(&target), path)
}

/// [`check`] for all files that one call writes. Two of them may not be the same.
///
/// # Errors
/// As [`check`]; [`BelvedereError::Output`] for a path that is named twice.
pub fn check_all(paths: &[PathBuf], inputs: &[PathBuf], overwrite: bool) -> Result<(), BelvedereError> {
    let mut places: Vec<PathBuf> = Vec::with_capacity(paths.len());
    for path in paths {
        check(path, inputs, overwrite)?;
        let place = place_of(path);
        if places.contains(&place) {
            let reason = "is named for two outputs; give each a name of its own".into();
            return Err(BelvedereError::Output { path: path.to_owned(), reason });
        }
        places.push(place);
    }
    Ok(())
}

/// Returns an error if `path` is a file, or a folder in which nothing can be written or that cannot be made.
///
/// # Errors
/// [`BelvedereError::Output`].
pub fn check_folder(path: &Path) -> Result<(), BelvedereError> {
    let Some(there) = path.ancestors().map(or_here).find(|folder| fs::symlink_metadata(folder).is_ok()) else {
        return Ok(());
    };
    if fs::metadata(there).is_ok_and(|meta| !meta.is_dir()) {
        let reason = "is a file, a folder is needed; name another".into();
        return Err(BelvedereError::Output { path: there.to_owned(), reason });
    }
    check_writable(there, path)
}

/// Makes and removes a file in `folder`: permissions alone do not tell whether that is possible.
#[cfg(not(target_family = "wasm"))]
fn check_writable(folder: &Path, output: &Path) -> Result<(), BelvedereError> {
    static COUNT: std::sync::atomic::AtomicU32 = std::sync::atomic::AtomicU32::new(0);
    let count = COUNT.fetch_add(1, std::sync::atomic::Ordering::Relaxed);
    let probe = folder.join(format!(".belvedere-{}-{count}.tmp", std::process::id()));
    let made = std::fs::OpenOptions::new().write(true).create_new(true).open(&probe);
    match made {
        Ok(file) => {
            drop(file);
            // A file that cannot be removed is no reason not to write another.
            let _ = std::fs::remove_file(&probe);
            Ok(())
        }
        // What another run left there was written.
        Err(e) if e.kind() == std::io::ErrorKind::AlreadyExists => Ok(()),
        Err(e) => {
            let reason = format!("cannot be written: folder {}: {e}; choose another folder", folder.display());
            Err(BelvedereError::Output { path: output.to_owned(), reason })
        }
    }
}

#[cfg(target_family = "wasm")]
fn check_writable(_: &Path, _: &Path) -> Result<(), BelvedereError> {
    Ok(())
}

/// Where a file lies or will lie; equal for two spellings of one path.
fn place_of(path: &Path) -> PathBuf {
    let place = fs::canonicalize(path).unwrap_or_else(|_| {
        let folder = folder_of(path);
        fs::canonicalize(&folder).unwrap_or(folder).join(path.file_name().unwrap_or_default())
    });
    // These systems do not tell large letters from small ones.
    let folds = cfg!(any(target_os = "windows", target_os = "macos"));
    if folds { place.to_string_lossy().to_lowercase().into() } else { place }
}

fn folder_of(path: &Path) -> PathBuf {
    or_here(path.parent().unwrap_or(Path::new(""))).to_owned()
}

fn or_here(folder: &Path) -> &Path {
    if folder.as_os_str().is_empty() { Path::new(".") } else { folder }
}

/// `value` as JSON, one line, ending in a newline; numbers round-trip exactly.
///
/// # Errors
/// [`BelvedereError::Text`] if a map has keys that are not strings, which does not occur in reports.
pub fn json<T: Serialize>(value: &T) -> Result<String, BelvedereError> {
    let text =
        serde_json::to_string(value).map_err(|e| BelvedereError::Text { what: "the report", reason: e.to_string() })?;
    Ok(text + "\n")
}

/// Writes a text as a whole or not at all.
///
/// # Errors
/// [`BelvedereError::Io`].
pub fn write_text(path: &Path, text: &str, overwrite: bool) -> Result<(), BelvedereError> {
    Ok(belvedere_io::atomic::write_atomic(path, overwrite, |out| out.write_all(text.as_bytes()))?)
}

/// A document as TOML.
///
/// # Errors
/// [`BelvedereError::Text`], which does not occur for valid documents.
pub fn document_toml(document: &Document) -> Result<String, BelvedereError> {
    toml::to_string(document).map_err(|e| BelvedereError::Text { what: "the document", reason: e.to_string() })
}

/// A document as JSON, indented.
///
/// # Errors
/// As [`document_toml`].
pub fn document_json(document: &Document) -> Result<String, BelvedereError> {
    pretty(document)
}

/// The JSON Schema of scene documents.
///
/// # Errors
/// As [`document_toml`].
pub fn schema_json() -> Result<String, BelvedereError> {
    pretty(&schemars::schema_for!(Document))
}

/// `value` as indented JSON, ending in a newline.
///
/// # Errors
/// As [`json`].
pub fn pretty<T: Serialize>(value: &T) -> Result<String, BelvedereError> {
    let text = serde_json::to_string_pretty(value)
        .map_err(|e| BelvedereError::Text { what: "the document", reason: e.to_string() })?;
    Ok(text + "\n")
}
