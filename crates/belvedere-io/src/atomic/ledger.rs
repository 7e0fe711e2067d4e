//! What this process is writing and has written: to end at any moment and say truly what is there.

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

/// Held while files get their names.
static PUBLISHING: Mutex<()> = Mutex::new(());

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

/// Lets nobody else name files, and nobody end the writing, while the guard lives; `None` if it has ended.
pub(super) fn turn() -> Option<MutexGuard<'static, ()>> {
    let turn = PUBLISHING.lock().unwrap_or_else(PoisonError::into_inner);
    let has_ended = ledger().ended;
    (!has_ended).then_some(turn)
}

/// Notes an output that appeared.
pub(super) fn appeared(target: PathBuf) {
    let mut ledger = ledger();
    if ledger.known.insert(target.clone()) {
        ledger.written.push(target);
    }
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
