//! Files that another file names.

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
    named.into_iter().find(|p| super::metadata(p).is_ok_and(|m| m.is_file()))
}

/// Path of a file that the file `path` names; refused if it is remote, absolute or leads out of the folder.
pub(crate) fn beside(path: &Path, name: &str) -> Result<PathBuf, String> {
    let relative = Path::new(name);
    let stays =
        relative.components().all(|c| matches!(c, std::path::Component::Normal(_) | std::path::Component::CurDir));
    if name.is_empty() || name.contains(':') || name.contains('\\') || !stays {
        let shown: String = name.chars().take(60).collect();
        return Err(format!("it names {shown:?}, which is not a file below its own folder; put the file beside it"));
    }
    Ok(path.parent().unwrap_or(Path::new("")).join(relative))
}
