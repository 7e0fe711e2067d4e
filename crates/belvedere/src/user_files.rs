//! Files that the user named beside a scene.

use crate::BelvedereError;
use std::path::{Path, PathBuf};

/// The full path of a file that the user named, whose folder is allowed from now on.
pub(crate) fn of_user(name: &str, allowed: &mut Vec<PathBuf>) -> Result<String, BelvedereError> {
    let path = belvedere_io::fs::canonicalize(name).map_err(|e| belvedere_io::IoError::os(Path::new(name), e))?;
    allowed.extend(path.parent().map(Path::to_owned));
    path.to_str().map(str::to_owned).ok_or_else(|| BelvedereError::not_utf8(name))
}
