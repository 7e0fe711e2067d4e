//! Recovery of a document after a crash.

use super::Editor;
use belvedere::placed::Place;
use belvedere::scene_file::paths::Roots;
use belvedere::scene_file::{self, Document};
use belvedere::{BelvedereError, output};
use serde::{Deserialize, Serialize};
use std::fs::{File, TryLockError};
use std::path::{Path, PathBuf};

/// Recovery file of an instance of an application: written while it runs and removed when it ends.
#[derive(Debug)]
pub struct Recovery {
    file: PathBuf,
    /// Lock on the instance's number; the system releases it when the application is killed.
    _lock: File,
    lock: PathBuf,
}

/// State left by an instance that did not end properly.
#[derive(Debug, Clone)]
pub struct Recovered {
    /// The document with its unsaved changes.
    pub editor: Editor,
    /// Further state that the application wrote.
    pub extra: serde_json::Value,
}

impl Recovered {
    /// The state of an application as text, where it has no recovery file, as in a browser.
    ///
    /// # Errors
    /// [`BelvedereError::Text`] if the document or the further state cannot be written.
    pub fn text_of(editor: &Editor, extra: serde_json::Value) -> Result<String, BelvedereError> {
        output::pretty(&Left::of(editor, extra)?)
    }

    /// The state that [`Recovered::text_of`] wrote; `None` for other text. Its document comes back even if its file holds another.
    pub fn of_text(text: &str) -> Option<Self> {
        recovered(text, false)
    }
}

#[derive(Serialize, Deserialize)]
struct Left {
    scene: Option<PathBuf>,
    scene_dir: PathBuf,
    allowed: Vec<PathBuf>,
    #[serde(default)]
    files: Vec<PathBuf>,
    /// Text of the scene file as it was read or written last.
    #[serde(default)]
    text: Option<String>,
    changed: bool,
    document: serde_json::Value,
    #[serde(default)]
    extra: serde_json::Value,
}

impl Left {
    fn of(editor: &Editor, extra: serde_json::Value) -> Result<Self, BelvedereError> {
        let document = serde_json::to_value(&**editor.document());
        Ok(Self {
            scene: editor.place.scene.clone(),
            scene_dir: editor.place.roots.scene_dir.clone(),
            allowed: editor.place.roots.allowed.clone(),
            files: editor.place.roots.files.clone(),
            text: editor.text.as_deref().map(str::to_owned),
            changed: editor.is_changed(),
            document: document.map_err(|e| BelvedereError::Text { what: "the document", reason: e.to_string() })?,
            extra,
        })
    }
}

impl Recovery {
    /// Largest number of instances that run at once.
    const MOST: usize = 64;

    /// Claims a recovery file in `folder` (made if it does not exist), and returns the state that an ended instance left in it.
    ///
    /// # Errors
    /// [`BelvedereError::Io`] if nothing can be written there.
    pub fn claim(folder: &Path) -> Result<(Self, Option<Recovered>), BelvedereError> {
        let os = |path: &Path| {
            let path = path.to_owned();
            move |e| BelvedereError::from(belvedere::io::IoError::os(&path, e))
        };
        std::fs::create_dir_all(folder).map_err(os(folder))?;
        for n in 0..Self::MOST {
            let (file, lock) = (folder.join(format!("state-{n}.json")), folder.join(format!("state-{n}.lock")));
            let held = File::create(&lock).map_err(os(&lock))?;
            match held.try_lock() {
                Ok(()) => {
                    let left = std::fs::read_to_string(&file).ok().and_then(|text| recovered(&text, true));
                    return Ok((Self { file, _lock: held, lock }, left));
                }
                Err(TryLockError::WouldBlock) => {}
                Err(TryLockError::Error(e)) => return Err(os(&lock)(e)),
            }
        }
        Err(BelvedereError::Output {
            path: folder.to_owned(),
            reason: format!("{} instances are running already; end one", Self::MOST),
        })
    }

    /// Writes the state of the application atomically.
    ///
    /// # Errors
    /// [`BelvedereError::Io`].
    pub fn write(&self, editor: &Editor, extra: serde_json::Value) -> Result<(), BelvedereError> {
        output::write_text(&self.file, &output::pretty(&Left::of(editor, extra)?)?, true)
    }

    /// Removes the recovery file at the proper end of the application.
    pub fn end(self) {
        let _ = std::fs::remove_file(&self.file);
        let _ = std::fs::remove_file(&self.lock);
    }
}

/// * `file_counts`: whether a scene without changes is what its file holds now. On a page it does not: the page brings the scene file as it was
///   packed, whatever was saved since.
fn recovered(text: &str, file_counts: bool) -> Option<Recovered> {
    let left: Left = serde_json::from_str(text).ok()?;
    let parsed: Document = scene_file::parse(Path::new("state.json"), &left.document.to_string()).ok()?.document;
    let roots = Roots { scene_dir: left.scene_dir, allowed: left.allowed, files: left.files };
    let on_disk = left.scene.as_deref().and_then(|path| scene_file::read_with_text(path).ok());
    let (saved, now) = on_disk.map(|(source, text)| (source.document, text)).unzip();
    let place = Place { scene: left.scene, roots };
    let editor = match (left.changed, saved) {
        (true, Some(saved)) if file_counts || saved != parsed => {
            let mut editor = Editor::new(saved, place);
            editor.edit(|document| *document = parsed);
            editor
        }
        // The document was never saved, its file is gone, or something else was saved since: this is the only copy.
        (true, _) => Editor::unsaved(parsed, place),
        (false, saved) => Editor::new(saved.filter(|_| file_counts).unwrap_or(parsed), place),
    };
    // Changes were made to the text of then: another program may have written the file since.
    let text = left.text.filter(|_| left.changed && file_counts).or(now);
    let editor = Editor { text: text.map(Into::into), ..editor };
    Some(Recovered { editor, extra: left.extra })
}

#[cfg(test)]
mod tests;
