//! The file of the record: small, private, changed by one program at a time, and worth nothing if it is damaged.

use crate::BelvedereError;
use belvedere_io::IoError;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use std::fs::{File, OpenOptions, TryLockError};
use std::io::{self, Write};
use std::path::{Path, PathBuf};
use std::time::Duration;

/// Largest size, bytes: more is not read, and the oldest entries make room.
const MOST_BYTES: usize = 1 << 20;
/// Most scenes.
const MOST_SCENES: usize = 500;
/// Tries for the lock, and the time between two of them.
const TRIES: (usize, Duration) = (if cfg!(test) { 3000 } else { 150 }, Duration::from_millis(20));

/// A scene, and the files outside its folder that it may read; canonical paths.
#[derive(Debug, Clone, PartialEq, Eq, JsonSchema, Serialize, Deserialize)]
pub struct Trusted {
    /// The scene file.
    pub scene: PathBuf,
    /// The files.
    pub files: Vec<PathBuf>,
}

#[derive(JsonSchema, Serialize, Deserialize)]
struct Content {
    format: u32,
    scenes: Vec<Trusted>,
}

/// The entries, the oldest first; none if the file is missing, no regular file, damaged, too large, or may be written by others.
pub(super) fn read(path: &Path) -> Vec<Trusted> {
    use std::io::Read;
    if is_odd(path) {
        return Vec::new();
    }
    let Ok(file) = File::open(path) else { return Vec::new() };
    if !file.metadata().is_ok_and(|meta| meta.is_file() && is_private(&meta)) {
        return Vec::new();
    }
    let mut text = String::new();
    let limit = MOST_BYTES as u64 + 1;
    match file.take(limit).read_to_string(&mut text) {
        Ok(bytes) if bytes <= MOST_BYTES => {}
        _ => return Vec::new(),
    }
    let content: Option<Content> = serde_json::from_str(&text).ok();
    content.filter(|content| content.format == 1).map(|content| content.scenes).unwrap_or_default()
}

/// Changes the entries; programs that do so at the same time wait for each other.
pub(super) fn change(path: &Path, edit: impl FnOnce(&mut Vec<Trusted>)) -> Result<(), BelvedereError> {
    // A link to the record stays a link.
    let path = &std::fs::canonicalize(path).unwrap_or_else(|_| path.to_owned());
    let os = |e| BelvedereError::from(IoError::os(path, e));
    if let Some(folder) = path.parent() {
        make_folder(folder).map_err(os)?;
    }
    let _lock = lock(&path.with_extension("lock")).map_err(os)?;
    let mut scenes = read(path);
    edit(&mut scenes);
    write(path, &bounded(path, scenes)?).map_err(os)
}

/// The text of the newest entries that fit the limits.
fn bounded(path: &Path, mut scenes: Vec<Trusted>) -> Result<String, BelvedereError> {
    scenes.drain(..scenes.len().saturating_sub(MOST_SCENES));
    loop {
        let content = Content { format: 1, scenes };
        let text = serde_json::to_string_pretty(&content).map_err(|e| IoError::os(path, io::Error::other(e)))? + "\n";
        if text.len() <= MOST_BYTES {
            return Ok(text);
        }
        scenes = content.scenes;
        if scenes.len() <= 1 {
            let files = scenes.first().map_or(0, |entry| entry.files.len());
            let reason = format!("cannot remember {files} files of one scene; put the scene beside its files");
            return Err(BelvedereError::Output { path: path.to_owned(), reason });
        }
        // A quarter at a time, so that a long list is not written out once per entry.
        scenes.drain(..scenes.len().div_ceil(4).min(scenes.len() - 1));
    }
}

fn write(path: &Path, text: &str) -> io::Result<()> {
    let beside = path.with_extension("tmp");
    // What a killed program left.
    let _ = std::fs::remove_file(&beside);
    let mut options = OpenOptions::new();
    options.write(true).create_new(true);
    #[cfg(unix)]
    std::os::unix::fs::OpenOptionsExt::mode(&mut options, 0o600);
    let mut file = options.open(&beside)?;
    let written = file.write_all(text.as_bytes()).and_then(|()| file.sync_all());
    drop(file);
    written.and_then(|()| std::fs::rename(&beside, path)).inspect_err(|_| {
        let _ = std::fs::remove_file(&beside);
    })
}

fn make_folder(folder: &Path) -> io::Result<()> {
    let mut builder = std::fs::DirBuilder::new();
    builder.recursive(true);
    #[cfg(unix)]
    std::os::unix::fs::DirBuilderExt::mode(&mut builder, 0o700);
    builder.create(folder)
}

/// Whether something lies there that is no regular file: opening a pipe waits for its other end.
fn is_odd(path: &Path) -> bool {
    std::fs::metadata(path).is_ok_and(|meta| !meta.is_file())
}

/// Holds the lock until the file is dropped; the system drops it with the process. Where the file system has no locks the last writer wins.
fn lock(path: &Path) -> io::Result<Option<File>> {
    if is_odd(path) {
        return Ok(None);
    }
    let mut options = OpenOptions::new();
    options.write(true).create(true).truncate(false);
    #[cfg(unix)]
    std::os::unix::fs::OpenOptionsExt::mode(&mut options, 0o600);
    let file = options.open(path)?;
    for _ in 0..TRIES.0 {
        match file.try_lock() {
            Ok(()) => return Ok(Some(file)),
            Err(TryLockError::WouldBlock) => std::thread::sleep(TRIES.1),
            Err(TryLockError::Error(_)) => return Ok(None),
        }
    }
    Err(io::Error::other("another program is changing it; try again"))
}

/// Whether the file is of this user, and no other may write it.
#[cfg(unix)]
fn is_private(meta: &std::fs::Metadata) -> bool {
    use std::os::unix::fs::MetadataExt;
    meta.mode() & 0o022 == 0 && owner_of_new_files().is_some_and(|own| own == meta.uid())
}

/// The user as whom this process makes files.
#[cfg(unix)]
fn owner_of_new_files() -> Option<u32> {
    use std::os::unix::fs::MetadataExt;
    use std::sync::OnceLock;
    static OWNER: OnceLock<Option<u32>> = OnceLock::new();
    *OWNER.get_or_init(|| {
        let probe = std::env::temp_dir().join(format!(".belvedere-{}-owner.tmp", std::process::id()));
        let _ = std::fs::remove_file(&probe);
        let made = OpenOptions::new().write(true).create_new(true).open(&probe);
        let owner = made.and_then(|file| file.metadata()).map(|meta| meta.uid()).ok();
        let _ = std::fs::remove_file(&probe);
        // Without a place for files the process itself tells, where the system shows it as a folder.
        owner.or_else(|| std::fs::metadata("/proc/self").ok().map(|meta| meta.uid()))
    })
}

#[cfg(not(unix))]
fn is_private(_: &std::fs::Metadata) -> bool {
    true
}
