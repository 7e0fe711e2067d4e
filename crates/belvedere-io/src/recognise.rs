//! Recognition of files that no loader reads.

use crate::formats::{self, Format, HEAD, Reader};
use crate::table::split_table;
use crate::{IoError, fs};
use std::io::Read;
use std::path::Path;

/// The format of a file that no loader reads under its name.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Recognised {
    /// The format.
    pub format: &'static Format,
    /// Whether the file is damaged: its name is of a format that is read, but its content begins like no known format.
    pub is_broken: bool,
}

/// The format of a file, if it is known and no loader reads it under its name; `None` for files of loaders and of unknown formats.
///
/// # Errors
/// [`IoError::Os`].
pub fn recognise(path: &Path) -> Result<Option<Recognised>, IoError> {
    let (path, _) = split_table(path);
    let by_name = formats::of_name(path);
    // Loaders report errors in their own files; only cities are recognised by content.
    if by_name.and_then(|format| format.reader).is_some_and(|reader| reader != Reader::City) {
        return Ok(None);
    }
    let by_content = formats::of_content(&head(path)?);
    let is_broken = by_content.is_none() && by_name.is_some_and(|format| format.reader.is_some());
    let format = by_content.or(by_name).filter(|format| format.reader != Some(Reader::Features));
    Ok(format.map(|format| Recognised { format, is_broken }))
}

/// The format of a file by its first bytes.
///
/// # Errors
/// [`IoError::Os`].
pub(crate) fn of_content(path: &Path) -> Result<Option<&'static Format>, IoError> {
    Ok(formats::of_content(&head(path)?))
}

fn head(path: &Path) -> Result<Vec<u8>, IoError> {
    let file = fs::File::open(path).map_err(|e| IoError::os(path, e))?;
    let mut head = Vec::new();
    file.take(HEAD).read_to_end(&mut head).map_err(|e| IoError::os(path, e))?;
    Ok(head)
}

/// The format of a file that a loader reads: by its name, or by its first bytes where the name tells none.
///
/// # Errors
/// [`IoError::Os`].
pub(crate) fn readable(path: &Path) -> Result<Option<&'static Format>, IoError> {
    let (path, _) = split_table(path);
    match formats::of_name(path).filter(|format| format.reader.is_some()) {
        // Grids and atoms share an ending.
        Some(format) if format.endings == [".xyz"] => {
            let held = formats::of_content(&head(path)?).filter(|held| held.endings == format.endings);
            Ok(Some(held.unwrap_or(format)))
        }
        Some(format) => Ok(Some(format)),
        None => Ok(formats::readable_content(&head(path)?)),
    }
}

/// The ending, in lower case, by which a loader reads a file: that of its name, or of the format of its first bytes where the name
/// tells no format that is read.
pub(crate) fn ending(path: &Path) -> String {
    let own = path.extension().map(|e| e.to_string_lossy().to_ascii_lowercase()).unwrap_or_default();
    if formats::of_name(path).is_some_and(|format| format.reader.is_some()) {
        return own;
    }
    let known = readable(path).ok().flatten();
    known.map_or(own, |format| format.endings[0].trim_start_matches('.').to_owned())
}

/// Replaces the error of a loader where the file explains it, whatever its name: it is empty, of a known format that no loader reads, or
/// holds another kind of data than its name says.
pub(crate) fn explain(error: IoError) -> IoError {
    let IoError::Format { path, .. } = &error else { return error };
    let Ok(head) = head(path) else { return error };
    let by_name = formats::of_name(path);
    if head.is_empty() {
        let kind = by_name.map_or_else(String::new, |format| format!(" and so no {}", format.name));
        return IoError::format(path, format!("is empty{kind}; get it again"));
    }
    if let Some(format) = formats::of_content(&head).filter(|format| format.reader.is_none()) {
        return IoError::format(path, Recognised { format, is_broken: false }.reason());
    }
    if let (Some(named), Some(held)) = (by_name.filter(|f| f.reader.is_some()), formats::readable_content(&head))
        && named.reader != held.reader
    {
        if named.endings == held.endings {
            return IoError::format(path, format!("holds {} ({}); {}", held.name, held.holds, held.advice()));
        }
        let reason = format!(
            "holds {} ({}), but its name says {}; rename it so that it ends in {}",
            held.name, held.holds, named.name, held.endings[0]
        );
        return IoError::format(path, reason);
    }
    match recognise(path) {
        Ok(Some(known)) => IoError::format(path, known.reason()),
        _ => error,
    }
}

/// The error of a file that is not of the wanted kind.
///
/// * `wanted`: the kind and its formats.
pub(crate) fn not_a(path: &Path, wanted: &str) -> IoError {
    let by_content = head(path).ok().and_then(|head| formats::readable_content(&head));
    let by_name = formats::of_name(path).filter(|format| format.reader.is_some());
    let reason = match (by_content, by_name) {
        (Some(format), _) => format!("is {} ({}), not {wanted}", format.name, format.holds),
        (None, Some(format)) if wanted.contains(format.name) => {
            format!("is {} by its name, but does not begin like one; it is damaged or something else", format.name)
        }
        (None, Some(format)) => format!("is {} ({}) by its name, not {wanted}", format.name, format.holds),
        (None, None) if formats::ends(path, &[".toml"]) => {
            format!("is a scene or preset document by its name, not {wanted}")
        }
        (None, None) => format!("is not {wanted}; convert it, or choose another file"),
    };
    IoError::format(path, reason)
}

impl Recognised {
    /// Why a loader does not read the file, and what to do.
    pub fn reason(&self) -> String {
        let Self { format, is_broken } = self;
        if *is_broken {
            return format!(
                "is {format} by its name, but does not begin like one; it is damaged or cut off, get it again"
            );
        }
        let unread = if format.reader.is_some() { "" } else { ", which this version does not read" };
        format!("is {format}{unread}; {}", format.advice())
    }
}
