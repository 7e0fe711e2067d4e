//! Files that belong together get their names together.

use super::{Temporary, folder_of, ledger, sync_folder};
use crate::IoError;
use std::cell::RefCell;
use std::collections::BTreeSet;
use std::io;
use std::path::{Path, PathBuf};

type Pending = Vec<(Temporary, bool)>;

thread_local! {
    /// Files that wait for the end of [`together`], and whether they may replace others.
    static PENDING: RefCell<Option<Pending>> = const { RefCell::new(None) };
}

/// Flushes a file to the disk and gives it the name of its output; inside [`together`] at its end.
///
/// # Errors
/// [`IoError::Exists`], [`IoError::Os`].
pub fn publish(file: Temporary, overwrite: bool) -> Result<(), IoError> {
    file.file().sync_all().map_err(|e| IoError::os(&file.target, e))?;
    let mut file = Some((file, overwrite));
    PENDING.with_borrow_mut(|pending| {
        if let Some(pending) = pending {
            pending.extend(file.take());
        }
    });
    publish_all(file.into_iter().collect())
}

/// Renames files one right after the other: [`abandon`](super::abandon) comes before or after all of them.
fn publish_all(files: Pending) -> Result<(), IoError> {
    let Some((first, _)) = files.first() else { return Ok(()) };
    let folders: BTreeSet<PathBuf> = files.iter().map(|(file, _)| folder_of(&file.target).to_owned()).collect();
    let interrupted = || IoError::os(&first.target, io::Error::other("the work was interrupted"));
    let turn = ledger::turn().ok_or_else(interrupted)?;
    if let Some((file, _)) = files.iter().find(|(file, overwrite)| !overwrite && file.target.exists()) {
        return Err(IoError::Exists { path: file.target.clone() });
    }
    for (file, overwrite) in files {
        let target = file.target.clone();
        file.rename(overwrite)?;
        ledger::appeared(target);
    }
    drop(turn);
    folders.iter().for_each(|folder| sync_folder(folder));
    Ok(())
}

/// Runs `work`; the files that it writes on this thread get their names together at its end, or none does if it fails.
/// Inside another call they wait for the end of that.
///
/// # Errors
/// Those of `work`; [`IoError::Exists`] and [`IoError::Os`] of the files. If the system fails between two of the names, the files before are
/// there, and the error names the first that is not.
pub fn together<T, E: From<IoError>>(work: impl FnOnce() -> Result<T, E>) -> Result<T, E> {
    /// Takes the files away again if `work` panics.
    struct Batch;
    impl Drop for Batch {
        fn drop(&mut self) {
            drop(PENDING.take());
        }
    }
    if PENDING.with_borrow(Option::is_some) {
        return work();
    }
    PENDING.set(Some(Vec::new()));
    let batch = Batch;
    let value = work()?;
    let files = PENDING.take().unwrap_or_default();
    drop(batch);
    publish_all(files)?;
    Ok(value)
}

/// Where the bytes of an output are: at its path, or inside [`together`] in its temporary file.
pub fn contents_of(path: &Path) -> PathBuf {
    let target = crate::fs::canonicalize(path).unwrap_or_else(|_| path.to_owned());
    let waits = PENDING.with_borrow(|pending| {
        let file = pending.iter().flatten().rfind(|(file, _)| file.target == target)?;
        Some(file.0.path().to_owned())
    });
    waits.unwrap_or_else(|| path.to_owned())
}
