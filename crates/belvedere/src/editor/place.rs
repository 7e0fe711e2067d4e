//! Files of a document: opening, saving, and recovery after a crash.

use super::Editor;
use crate::scene_file::paths::{Roots, folder_of};
use crate::scene_file::{self, Document, SourceDocument};
use crate::{BelvedereError, OpenOptions, Session, Trust, output};
use belvedere_io::split_table;
use belvedere_scene::Progress;
use serde::{Deserialize, Serialize};
use std::fs::{File, TryLockError};
use std::path::{Path, PathBuf};

/// Paths of a document and its files.
#[derive(Debug, Clone, Default)]
pub struct Place {
    /// The scene file; `None` if it was never saved.
    pub scene: Option<PathBuf>,
    /// Folders that its files may lie in.
    pub roots: Roots,
}

impl Place {
    /// The session of a document in this place, as the command line opens it. If the scene file holds the same document, it is among the
    /// inputs.
    ///
    /// # Errors
    /// As [`Session::from_document`].
    pub fn session(&self, document: Document, progress: &Progress) -> Result<Session, BelvedereError> {
        let folder = Some(&self.roots.scene_dir).filter(|dir| !dir.as_os_str().is_empty());
        let allow_roots = folder.into_iter().chain(&self.roots.allowed).cloned().collect();
        let allow_files = self.roots.files.clone();
        let options = OpenOptions { allow_roots, allow_files, progress: progress.clone(), ..OpenOptions::default() };
        let file = self.scene.as_deref().and_then(|path| scene_file::read(path).ok());
        let source = file.filter(|file| file.document == document);
        Session::from_document(source.unwrap_or_else(|| SourceDocument::new(document)), &options)
    }
}

impl Editor {
    /// Opens a scene file.
    ///
    /// * `allowed`: folders beside that of the scene from which its files may come.
    ///
    /// # Errors
    /// As [`scene_file::read`].
    pub fn open(path: &Path, allowed: Vec<PathBuf>) -> Result<Self, BelvedereError> {
        Self::open_trusted(path, allowed, &Trust::default())
    }

    /// Opens a scene file, with the consent that was given to it.
    ///
    /// # Errors
    /// As [`Editor::open`].
    pub fn open_trusted(path: &Path, allowed: Vec<PathBuf>, trust: &Trust) -> Result<Self, BelvedereError> {
        let source = scene_file::read(path)?;
        let roots = Roots { scene_dir: folder_of(path), allowed, files: trust.files_of(path) };
        Ok(Self::new(source.document, Place { scene: Some(path.to_owned()), roots }))
    }

    /// Writes the scene file. Names of its files are adapted: relative to the folder of the scene wherever that is possible.
    ///
    /// # Errors
    /// [`BelvedereError::Output`] if `path` is one of the scene's own files; [`BelvedereError::Io`].
    pub fn save(&mut self, path: &Path) -> Result<(), BelvedereError> {
        let folder = folder_of(path);
        let document = self.document().seen_from(&folder, &self.place.roots);
        let files = self.files();
        output::check(path, &files, true)?;
        output::write_text(path, &output::document_toml(&document)?, true)?;
        if folder != self.place.roots.scene_dir {
            // In the new folder a name may lead to another file.
            self.name_from(&folder);
            let old = std::mem::replace(&mut self.place.roots.scene_dir, folder);
            if !old.as_os_str().is_empty() {
                self.place.roots.allowed.push(old);
            }
        }
        self.place.scene = Some(path.to_owned());
        self.mark_saved();
        Ok(())
    }

    /// The files that the document names, canonical paths.
    fn files(&self) -> Vec<PathBuf> {
        let mut files = Vec::new();
        (**self.document()).clone().for_each_path(&mut |name| {
            files.extend(self.place.roots.resolve(name).ok().map(|file| split_table(&file).0.to_owned()));
        });
        files.sort();
        files.dedup();
        files
    }

    /// Files of the document outside the folder of the scene file, canonical paths: they need consent where the scene is opened.
    pub fn outside(&self) -> Vec<PathBuf> {
        self.files().into_iter().filter(|file| !self.place.roots.is_beside(file)).collect()
    }
}

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
            move |e| BelvedereError::from(belvedere_io::IoError::os(&path, e))
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
    let saved = left.scene.as_deref().and_then(|path| scene_file::read(path).ok()).map(|source| source.document);
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
    Some(Recovered { editor, extra: left.extra })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn scene(dir: &Path) -> PathBuf {
        let path = dir.join("s.toml");
        let text = "format = 1\n[camera]\neye = [0, 0, 10]\nlook_at = [0, 1, 0]\n[[layer]]\nid = 'a'\nkind = 'mesh'\nsource = 'a.obj'\n";
        std::fs::write(&path, text).expect("scene");
        std::fs::write(dir.join("a.obj"), "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n").expect("mesh");
        path
    }

    #[test]
    fn what_a_killed_instance_was_doing_comes_back() {
        let dir = tempfile::tempdir().expect("folder");
        let state = dir.path().join("state");
        let mut editor = Editor::open(&scene(dir.path()), Vec::new()).expect("scene");
        editor.edit(|d| d.title = "changed".into());
        let (recovery, left) = Recovery::claim(&state).expect("place");
        assert!(left.is_none());
        recovery.write(&editor, serde_json::json!({ "tool": 3 })).expect("written");
        let (other, left) = Recovery::claim(&state).expect("a second instance");
        assert!(left.is_none(), "what a living instance does is its own");
        other.end();
        drop(recovery); // Dropped as the system does for a killed process.
        let (recovery, left) = Recovery::claim(&state).expect("place");
        let left = left.expect("left behind");
        assert!(left.editor.document().title == "changed" && left.editor.is_changed() && left.extra["tool"] == 3);
        assert_eq!(left.editor.place.scene, editor.place.scene);
        recovery.end();
        assert!(Recovery::claim(&state).expect("place").1.is_none(), "an instance that ended left something");
    }

    #[test]
    fn a_scene_that_was_never_saved_comes_back_changed() {
        let dir = tempfile::tempdir().expect("folder");
        let path = scene(dir.path());
        let source = scene_file::read(&path).expect("scene");
        let mut editor = Editor::new(source.document, Place::default());
        editor.edit(|d| d.title = "changed".into());
        let (recovery, _) = Recovery::claim(&dir.path().join("state")).expect("place");
        recovery.write(&editor, serde_json::Value::Null).expect("written");
        drop(recovery);
        let mut left = Recovery::claim(&dir.path().join("state")).expect("place").1.expect("left behind").editor;
        assert!(left.is_changed() && left.document().title == "changed");
        left.save(&dir.path().join("t.toml")).expect("saved");
        assert!(left.is_saved() && !left.is_changed());
    }

    #[test]
    fn the_state_comes_back_from_text_with_its_changes_and_without_its_file() {
        let dir = tempfile::tempdir().expect("folder");
        let mut editor = Editor::open(&scene(dir.path()), vec!["elsewhere".into()]).expect("scene");
        for changed in [false, true] {
            let text = Recovered::text_of(&editor, serde_json::json!({ "tool": 3 })).expect("text");
            let left = Recovered::of_text(&text).expect("state");
            assert_eq!(left.editor.document(), editor.document());
            assert_eq!((left.editor.is_changed(), &left.extra["tool"]), (changed, &3.into()));
            assert_eq!(left.editor.place.roots.allowed, editor.place.roots.allowed);
            editor.edit(|d| d.title = "changed".into());
        }
        editor.mark_saved();
        let text = Recovered::text_of(&editor, serde_json::Value::Null).expect("text");
        let left = Recovered::of_text(&text).expect("state").editor;
        assert!(left.document().title == "changed" && !left.is_changed(), "the file holds an older document");
        assert!(Recovered::of_text("no state").is_none());
    }

    #[test]
    fn a_scene_that_was_undone_to_what_the_page_brings_after_a_save_is_changed() {
        let dir = tempfile::tempdir().expect("folder");
        let path = scene(dir.path());
        let packed = std::fs::read(&path).expect("scene");
        let mut editor = Editor::open(&path, Vec::new()).expect("scene");
        editor.edit(|d| d.title = "changed".into());
        editor.save(&path).expect("saved");
        assert!(editor.undo() && editor.is_changed());
        let text = Recovered::text_of(&editor, serde_json::Value::Null).expect("text");
        std::fs::write(&path, packed).expect("the page is loaded again");
        let left = Recovered::of_text(&text).expect("state").editor;
        assert!(left.is_changed() && left.document() == editor.document());
    }

    #[test]
    fn files_are_found_from_wherever_a_scene_is_saved() {
        let dir = tempfile::tempdir().expect("folder");
        let mut editor = Editor::open(&scene(dir.path()), Vec::new()).expect("scene");
        let below = dir.path().join("below");
        std::fs::create_dir(&below).expect("folder");
        editor.save(&below.join("t.toml")).expect("saved");
        assert!(editor.is_saved());
        let mut trust = Trust::default();
        trust.give(&below.join("t.toml"), &editor.outside()).expect("scene");
        let there = Editor::open_trusted(&below.join("t.toml"), Vec::new(), &trust).expect("again");
        let mut names = Vec::new();
        (**there.document()).clone().for_each_path(&mut |name| names.push(name.clone()));
        assert_eq!(names, ["../a.obj"]);
        assert!(there.place.roots.resolve(&names[0]).is_ok());
        let refused = editor.save(&dir.path().join("a.obj")).expect_err("one of its own files");
        assert!(refused.to_string().contains("input"), "{refused}");
    }
}
