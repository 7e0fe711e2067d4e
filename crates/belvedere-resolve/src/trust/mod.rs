//! Consent of the user to files outside the folder of a scene: which scene may read which files, remembered in a record of the user's own.
//!
//! A scene may name files in its own folder or below. Others need consent: an allowed folder for one run, or an entry of this record. An
//! entry is a scene file by its canonical path, and single files by theirs, so a scene that someone edits gets no consent for files that
//! it did not name before, and a scene in another place gets none.

mod record;

use crate::BelvedereError;
use belvedere_document::paths::Roots;
use belvedere_io::fs;
use std::path::{Path, PathBuf};

pub use record::Trusted;

/// Switches the record off, if it is set to anything but 0 or nothing.
pub const OFF: &str = "BELVEDERE_NO_TRUST";

/// What scenes may read outside their folders. The default is nothing, and nothing is remembered.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct Trust {
    record: Option<PathBuf>,
    /// Files allowed for this run, by scene file; canonical paths.
    given: Vec<(PathBuf, Vec<PathBuf>)>,
}

/// Files that a scene names outside its folder.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct Outside {
    /// The files, canonical, each once.
    pub files: Vec<PathBuf>,
    /// Names that lead to no file.
    pub missing: Vec<String>,
}

impl Trust {
    /// The record of this user, in the folder for settings; off if [`OFF`] is set, or where the system has no such folder, as in a browser.
    pub fn of_user() -> Self {
        let is_off = std::env::var_os(OFF).is_some_and(|value| !value.is_empty() && value != "0");
        Self { record: settings_folder().filter(|_| !is_off).map(|dir| dir.join("trusted.json")), given: Vec::new() }
    }

    /// A record in a file of one's own.
    pub fn in_file(record: PathBuf) -> Self {
        Self { record: Some(record), given: Vec::new() }
    }

    /// The file of the record; `None` if nothing is remembered.
    pub fn record(&self) -> Option<&Path> {
        self.record.as_deref()
    }

    /// Files that a scene may read outside its folder. A damaged record, or one that others may write, allows nothing.
    pub fn files_of(&self, scene: &Path) -> Vec<PathBuf> {
        let Ok(scene) = fs::canonicalize(scene) else { return Vec::new() };
        let given = self.given.iter().filter(|(of, _)| *of == scene).flat_map(|(_, files)| files.clone());
        let remembered = self.list().into_iter().filter(|entry| entry.scene == scene).flat_map(|entry| entry.files);
        let mut files: Vec<PathBuf> = given.chain(remembered).collect();
        files.sort();
        files.dedup();
        files
    }

    /// Allows a scene to read files until the program ends.
    ///
    /// # Errors
    /// [`BelvedereError::Io`] if the scene is not there.
    pub fn give(&mut self, scene: &Path, files: &[PathBuf]) -> Result<(), BelvedereError> {
        let scene = fs::canonicalize(scene).map_err(|e| belvedere_io::IoError::os(scene, e))?;
        self.given.retain(|(of, _)| *of != scene);
        self.given.push((scene, files.to_vec()));
        Ok(())
    }

    /// Remembers that a scene may read these files (canonical paths), and no others outside its folder. The oldest entries make room.
    /// Returns whether there is a record.
    ///
    /// # Errors
    /// [`BelvedereError::Io`] if the scene is not there or the record cannot be written, [`BelvedereError::Output`] for too many files.
    pub fn remember(&self, scene: &Path, files: &[PathBuf]) -> Result<bool, BelvedereError> {
        let Some(record) = &self.record else { return Ok(false) };
        let scene = fs::canonicalize(scene).map_err(|e| belvedere_io::IoError::os(scene, e))?;
        let known = self.list().into_iter().find(|entry| entry.scene == scene);
        let mut files = files.to_vec();
        files.sort();
        files.dedup();
        let now = Trusted { scene, files };
        if known.as_ref() == Some(&now) || (known.is_none() && now.files.is_empty()) {
            return Ok(true);
        }
        record::change(record, |entries| {
            entries.retain(|entry| entry.scene != now.scene);
            entries.extend((!now.files.is_empty()).then(|| now.clone()));
        })?;
        Ok(true)
    }

    /// Forgets a scene, or all. Returns the number of scenes that were forgotten.
    ///
    /// # Errors
    /// [`BelvedereError::Io`] if the record cannot be written.
    pub fn forget(&self, scene: Option<&Path>) -> Result<usize, BelvedereError> {
        let Some(record) = &self.record else { return Ok(0) };
        // A scene that is gone is still known by its path.
        let named = scene.map(|scene| fs::canonicalize(scene).or_else(|_| std::path::absolute(scene)));
        let named = named.transpose().map_err(|e| belvedere_io::IoError::os(record, e))?;
        let is_meant = |entry: &Trusted| named.as_ref().is_none_or(|scene| entry.scene == *scene);
        let count = self.list().iter().filter(|entry| is_meant(entry)).count();
        if count > 0 {
            record::change(record, |entries| entries.retain(|entry| !is_meant(entry)))?;
        }
        Ok(count)
    }

    /// The remembered scenes and files, the oldest first.
    pub fn list(&self) -> Vec<Trusted> {
        self.record.as_deref().map(record::read).unwrap_or_default()
    }
}

impl Trust {
    /// Files outside its folder that a scene names and that it may not read, wherever they are; to ask the user for consent.
    ///
    /// * `allowed`: folders that are allowed.
    ///
    /// # Errors
    /// Those of [`belvedere_document::read`].
    pub fn lacking(&self, scene: &Path, allowed: &[PathBuf]) -> Result<Vec<PathBuf>, BelvedereError> {
        let mut files = outside(scene, allowed)?.files;
        let trusted = self.files_of(scene);
        let folders: Vec<PathBuf> = allowed.iter().filter_map(|folder| fs::canonicalize(folder).ok()).collect();
        files.retain(|file| !trusted.contains(file) && !folders.iter().any(|folder| file.starts_with(folder)));
        Ok(files)
    }
}

/// Files that a scene names outside its folder.
///
/// * `allowed`: folders in which relative names are looked for, too.
///
/// # Errors
/// Those of [`belvedere_document::read`].
pub fn outside(scene: &Path, allowed: &[PathBuf]) -> Result<Outside, BelvedereError> {
    let mut source = belvedere_document::read(scene)?;
    let scene_dir = scene.parent().map(Path::to_owned).unwrap_or_default();
    let roots = Roots { scene_dir, allowed: allowed.to_vec(), ..Roots::default() };
    let mut found = Outside::default();
    source.document.for_each_path(&mut |name| match roots.locate(name) {
        Some(file) if roots.is_beside(&file) => {}
        Some(file) => found.files.push(file),
        None => found.missing.push(name.clone()),
    });
    found.files.sort();
    found.files.dedup();
    Ok(found)
}

/// The folder for the settings of this program.
fn settings_folder() -> Option<PathBuf> {
    let var = |name: &str| std::env::var_os(name).map(PathBuf::from).filter(|path| path.is_absolute());
    let base = if cfg!(target_os = "windows") {
        var("APPDATA")
    } else if cfg!(target_os = "macos") {
        var("HOME").map(|home| home.join("Library/Application Support"))
    } else {
        var("XDG_CONFIG_HOME").or_else(|| var("HOME").map(|home| home.join(".config")))
    };
    Some(base?.join("belvedere"))
}
