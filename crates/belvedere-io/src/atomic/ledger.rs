//! What this process is writing and has written: to end at any moment and say truly what is there.

use super::{Temporary, folder_of, sync_folder};
use crate::IoError;
use std::cell::RefCell;
use std::collections::BTreeSet;
use std::io;
use std::path::{Path, PathBuf};
use std::sync::{Mutex, MutexGuard, PoisonError};
use tempfile::NamedTempFile;

#[derive(Debug)]
struct Ledger {
    /// Temporary files that exist.
    open: BTreeSet<PathBuf>,
    /// Outputs in the order in which they first appeared.
    written: Vec<PathBuf>,
    known: BTreeSet<PathBuf>,
    /// Nothing is written any more.
    ended: bool,
}

static LEDGER: Mutex<Ledger> =
    Mutex::new(Ledger { open: BTreeSet::new(), written: Vec::new(), known: BTreeSet::new(), ended: false });

type Pending = Vec<(Temporary, bool)>;

thread_local! {
    /// Files that wait for the end of [`together`], and whether they may replace others.
    static PENDING: RefCell<Option<Pending>> = const { RefCell::new(None) };
}

fn ledger() -> MutexGuard<'static, Ledger> {
    LEDGER.lock().unwrap_or_else(PoisonError::into_inner)
}

/// Makes a temporary file, unless the program ends.
pub(super) fn made(make: impl FnOnce() -> io::Result<NamedTempFile>) -> io::Result<NamedTempFile> {
    let mut ledger = ledger();
    if ledger.ended {
        return Err(io::Error::other("the work was interrupted"));
    }
    let file = make()?;
    ledger.open.insert(file.path().to_owned());
    Ok(file)
}

/// Notes that a temporary file is no more.
pub(super) fn gone(path: &Path) {
    ledger().open.remove(path);
}

/// Whether this process is writing a temporary file.
pub(super) fn is_open(path: &Path) -> bool {
    ledger().open.contains(path)
}

/// Gives a file its name, or lets it wait for the files that it belongs to.
pub(super) fn publish(file: Temporary, overwrite: bool) -> Result<(), IoError> {
    let mut file = Some((file, overwrite));
    PENDING.with_borrow_mut(|pending| {
        if let Some(pending) = pending {
            pending.extend(file.take());
        }
    });
    publish_all(file.into_iter().collect())
}

/// Held while files get their names.
static PUBLISHING: Mutex<()> = Mutex::new(());

/// Renames files one right after the other: [`abandon`] comes before or after all of them.
fn publish_all(files: Pending) -> Result<(), IoError> {
    let Some((first, _)) = files.first() else { return Ok(()) };
    let folders: BTreeSet<PathBuf> = files.iter().map(|(file, _)| folder_of(&file.target).to_owned()).collect();
    let turn = PUBLISHING.lock().unwrap_or_else(PoisonError::into_inner);
    if ledger().ended {
        return Err(IoError::os(&first.target, io::Error::other("the work was interrupted")));
    }
    if let Some((file, _)) = files.iter().find(|(file, overwrite)| !overwrite && file.target.exists()) {
        return Err(IoError::Exists { path: file.target.clone() });
    }
    for (file, overwrite) in files {
        let target = file.target.clone();
        file.rename(overwrite)?;
        let mut ledger = ledger();
        if ledger.known.insert(target.clone()) {
            ledger.written.push(target);
        }
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

/// Ends all writing of this process, and removes its temporary files. Returns the outputs that were written, the oldest first.
/// For programs that end at once: later writing fails.
pub fn abandon() -> Vec<PathBuf> {
    let _turn = PUBLISHING.lock().unwrap_or_else(PoisonError::into_inner);
    let mut ledger = ledger();
    ledger.ended = true;
    for file in std::mem::take(&mut ledger.open) {
        let _ = std::fs::remove_file(file);
    }
    ledger.written.clone()
}

/// The outputs that this process has written, the oldest first.
pub fn written() -> Vec<PathBuf> {
    ledger().written.clone()
}
