//! Temporary files beside outputs. Their names tell which process made them, so that the next run removes what a killed one left.

use super::{folder_of, ledger};
use crate::IoError;
use std::collections::BTreeSet;
use std::fs::File;
use std::io;
use std::path::{Path, PathBuf};
use std::sync::{Mutex, PoisonError};
use std::time::Duration;
use tempfile::NamedTempFile;

/// Mark in the names of temporary files; the number of the process follows.
const MARK: &str = ".belvedere-";
/// Ending of temporary files.
const ENDING: &str = ".tmp";
/// Age from which a temporary file is left over, even if its process cannot be asked for.
const OLD: Duration = Duration::from_secs(24 * 3600);

/// A hidden file beside an output, which becomes that output or is removed.
#[derive(Debug)]
pub struct Temporary {
    /// `None` once it was published.
    file: Option<NamedTempFile>,
    pub(super) target: PathBuf,
}

impl Temporary {
    /// An empty file beside `target`, with the permissions of any new file. The first call for a folder removes what killed programs left there.
    ///
    /// # Errors
    /// Those of the system.
    pub fn beside(target: &Path) -> io::Result<Self> {
        let folder = folder_of(target);
        sweep_once(folder);
        // A long name and the rest could pass the limit of the system.
        let name = target.file_name().unwrap_or_default().to_string_lossy();
        let name: String = name.chars().take(20).collect();
        let prefix = format!(".{name}{MARK}{}-", std::process::id());
        let mut builder = tempfile::Builder::new();
        builder.prefix(&prefix).suffix(ENDING);
        #[cfg(unix)]
        builder.permissions(std::os::unix::fs::PermissionsExt::from_mode(0o666)); // less the umask
        let file = ledger::made(|| builder.tempfile_in(folder))?;
        // Held while the process lives, also where its number means nothing, as on a network drive. Not every file system has locks.
        let _ = cfg!(unix).then(|| file.as_file().try_lock());
        Ok(Self { file: Some(file), target: target.to_owned() })
    }

    /// The temporary file.
    pub fn path(&self) -> &Path {
        self.file.as_ref().map_or(Path::new(""), NamedTempFile::path)
    }

    /// The open temporary file.
    pub(super) fn file(&self) -> &File {
        match &self.file {
            Some(file) => file.as_file(),
            None => unreachable!("only publishing takes it, and that takes the whole"),
        }
    }

    /// Renames the file.
    pub(super) fn rename(mut self, overwrite: bool) -> Result<(), IoError> {
        let Some(file) = self.file.take() else { return Ok(()) };
        let path = file.path().to_owned();
        let done = if overwrite { file.persist(&self.target) } else { file.persist_noclobber(&self.target) };
        ledger::gone(&path);
        done.map(drop).map_err(|e| match e.error.kind() {
            io::ErrorKind::AlreadyExists => IoError::Exists { path: self.target.clone() },
            _ => IoError::os(&self.target, e.error),
        })
    }
}

impl Drop for Temporary {
    fn drop(&mut self) {
        if let Some(file) = self.file.take() {
            let path = file.path().to_owned();
            drop(file);
            ledger::gone(&path);
        }
    }
}

/// Folders in which left files were looked for.
static SWEPT: Mutex<BTreeSet<PathBuf>> = Mutex::new(BTreeSet::new());

fn sweep_once(folder: &Path) {
    if SWEPT.lock().unwrap_or_else(PoisonError::into_inner).insert(folder.to_owned()) {
        sweep(folder);
    }
}

/// Removes the temporary files of processes that ended.
fn sweep(folder: &Path) {
    let Ok(entries) = std::fs::read_dir(folder) else { return };
    for entry in entries.flatten() {
        let Some(process) = entry.file_name().to_str().and_then(process_of) else { continue };
        let path = entry.path();
        if entry.file_type().is_ok_and(|kind| kind.is_file()) && !ledger::is_open(&path) && is_left(&path, process) {
            let _ = std::fs::remove_file(path);
        }
    }
}

/// The process that made a temporary file of this name.
fn process_of(name: &str) -> Option<u32> {
    let name = name.strip_suffix(ENDING).filter(|name| name.starts_with('.'))?;
    name.rsplit_once(MARK)?.1.split_once('-')?.0.parse().ok()
}

/// Whether nobody writes a temporary file any more.
fn is_left(path: &Path, process: u32) -> bool {
    let Ok(file) = File::options().read(true).write(true).open(path) else { return false };
    let is_old = || file.metadata().and_then(|m| m.modified()).is_ok_and(|t| t.elapsed().is_ok_and(|age| age > OLD));
    let may_be = if runs(process).is_some_and(|runs| !runs) { true } else { is_old() };
    may_be
        && match file.try_lock() {
            Ok(()) => true,
            Err(std::fs::TryLockError::WouldBlock) => false,
            Err(std::fs::TryLockError::Error(_)) => is_old(),
        }
}

/// Whether another process of this number runs; `None` where that cannot be asked.
fn runs(process: u32) -> Option<bool> {
    // A number is given again: a file of this process that it did not make is of an earlier one.
    if process == std::process::id() {
        return Some(false);
    }
    Path::new("/proc/self").exists().then(|| Path::new("/proc").join(process.to_string()).exists())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_tell_the_process() {
        assert_eq!(process_of(".out.png.belvedere-123-aB3dE.tmp"), Some(123));
        assert_eq!(process_of(".belvedere-7-0.tmp"), Some(7));
        for name in
            ["out.belvedere-1-a.tmp", ".a.belvedere-1-a.png", ".a.belvedere-x-a.tmp", ".a.tmp", ".belvedere-5.tmp"]
        {
            assert_eq!(process_of(name), None, "{name}");
        }
    }

    #[test]
    fn files_of_ended_processes_are_removed_and_others_stay() {
        let folder = tempfile::tempdir().expect("folder");
        let ended = std::process::Command::new(std::env::current_exe().expect("program")).arg("--list").output();
        assert!(ended.is_ok());
        let left = folder.path().join(format!(".a.png.belvedere-{}-abc.tmp", std::process::id()));
        let foreign = folder.path().join(".a.png-abc.tmp");
        for file in [&left, &foreign] {
            std::fs::write(file, "half").expect("written");
        }
        let open = Temporary::beside(&folder.path().join("b.png")).expect("made");
        assert!(!left.exists(), "of an earlier process of this number");
        assert!(foreign.exists() && open.path().exists());
        sweep(folder.path());
        assert!(open.path().exists(), "it is being written");
        let path = open.path().to_owned();
        drop(open);
        assert!(!path.exists());
    }
}
