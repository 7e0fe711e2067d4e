//! Files that another file names.

use std::path::{Path, PathBuf};

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
