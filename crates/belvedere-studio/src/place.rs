//! The file of an edited document: opening and saving.

use super::Editor;
use belvedere::io::{fs, split_table};
use belvedere::placed::PlacedDocument;
use belvedere::scene_file::paths::folder_of;
use belvedere::scene_file::{self, Document};
use belvedere::{BelvedereError, Trust, output};
use std::io::Read;
use std::path::{Path, PathBuf};

/// What another program did to a scene file.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum FileChange {
    /// It holds another text.
    Edited,
    /// It was removed, or cannot be read any more.
    Gone,
}

/// The bytes of a file; `None` if it cannot be read.
fn text_on_disk(path: &Path) -> Option<Vec<u8>> {
    let mut bytes = Vec::new();
    fs::File::open(path).ok()?.take(scene_file::MAX_BYTES + 1).read_to_end(&mut bytes).ok()?;
    Some(bytes)
}

impl From<PlacedDocument> for Editor {
    /// A document without history; one that is in no file has changes that are not saved.
    fn from(PlacedDocument { document, place, text }: PlacedDocument) -> Self {
        match text {
            Some(text) => Self { text: Some(text.into()), ..Self::new(document, place) },
            None => Self::unsaved(document, place),
        }
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
        Ok(PlacedDocument::read(path, allowed, trust)?.into())
    }

    /// How the scene file has changed since it was read or written here; `None` if it has not, and without a file.
    pub fn file_change(&self) -> Option<FileChange> {
        let (path, known) = (self.place.scene.as_ref()?, self.text.as_ref()?);
        match text_on_disk(path) {
            None => Some(FileChange::Gone),
            Some(bytes) => (bytes != known.as_bytes()).then_some(FileChange::Edited),
        }
    }

    /// Takes the document that the scene file holds now; one step of undo, so that the present one can come back.
    ///
    /// # Errors
    /// As [`scene_file::read`].
    pub fn reload(&mut self) -> Result<(), BelvedereError> {
        let Some(path) = self.place.scene.clone() else { return Ok(()) };
        let (source, text) = scene_file::read_with_text(&path)?;
        self.edit(|document| *document = source.document);
        self.text = Some(text.into());
        self.mark_saved();
        Ok(())
    }

    /// Writes the scene file: of a file that was read or written here, only the values that were edited; comments, order and all else stay as
    /// they are. Names of its files are adapted: relative to the folder of the scene wherever that is possible.
    ///
    /// # Errors
    /// [`BelvedereError::Output`] if `path` is one of the scene's own files, or its scene file and [`Editor::file_change`] is some;
    /// [`BelvedereError::Io`].
    pub fn save(&mut self, path: &Path) -> Result<(), BelvedereError> {
        if let Some(change) = self.file_change().filter(|_| self.is_own(path)) {
            let reason = match change {
                FileChange::Edited => "was changed by another program since it was read",
                FileChange::Gone => "is not there any more",
            };
            let reason = format!("{reason}; reload it, save under another name, or overwrite it");
            return Err(BelvedereError::Output { path: path.to_owned(), reason });
        }
        self.save_over(path)
    }

    /// As [`Editor::save`], whatever the file holds now.
    ///
    /// # Errors
    /// As [`Editor::save`], except for the change of the file.
    pub fn save_over(&mut self, path: &Path) -> Result<(), BelvedereError> {
        let folder = folder_of(path);
        let document = self.document().seen_from(&folder, &self.place.roots);
        let files = self.files();
        output::check(path, &files, true)?;
        let text = self.text_for(path, &document)?;
        output::write_text(path, &text, true)?;
        if folder != self.place.roots.scene_dir {
            // In the new folder a name may lead to another file.
            self.name_from(&folder);
            let old = std::mem::replace(&mut self.place.roots.scene_dir, folder);
            if !old.as_os_str().is_empty() {
                self.place.roots.allowed.push(old);
            }
        }
        self.place.scene = Some(path.to_owned());
        self.text = Some(text.into());
        self.mark_saved();
        Ok(())
    }

    /// Whether a path leads to the scene file.
    pub fn is_own(&self, path: &Path) -> bool {
        let place = |path: &Path| path.file_name().map(|name| folder_of(path).join(name));
        let real = |path: &Path| fs::canonicalize(path).ok().or_else(|| place(path));
        self.place.scene.as_deref().is_some_and(|scene| real(scene) == real(path))
    }

    /// The text of a scene file: that of the present file with other values, or a new one where there is none in the format of `path`.
    fn text_for(&self, path: &Path, document: &Document) -> Result<String, BelvedereError> {
        let is_json = match &self.text {
            Some(text) if self.is_own(path) => scene_file::is_json(text),
            _ => path.extension().is_some_and(|e| e.eq_ignore_ascii_case("json")),
        };
        let known = self.text.as_deref().filter(|text| scene_file::is_json(text) == is_json);
        match known.and_then(|text| scene_file::rewritten(text, document)) {
            Some(text) => Ok(text),
            None if is_json => output::document_json(document),
            None => output::document_toml(document),
        }
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

#[cfg(test)]
pub(super) mod tests {
    use super::*;

    pub(crate) fn scene(dir: &Path) -> PathBuf {
        let path = dir.join("s.toml");
        let text = "format = 1\n[camera]\neye = [0, 0, 10]\nlook_at = [0, 1, 0]\n[[layer]]\nid = 'a'\nkind = 'mesh'\nsource = 'a.obj'\n";
        std::fs::write(&path, text).expect("scene");
        std::fs::write(dir.join("a.obj"), "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n").expect("mesh");
        path
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

    /// A scene as a user writes it, opened.
    fn written(dir: &Path, name: &str, text: &str) -> (PathBuf, Editor) {
        scene(dir);
        let path = dir.join(name);
        std::fs::write(&path, text).expect("scene");
        let editor = Editor::open(&path, Vec::new()).expect("scene");
        (path, editor)
    }

    const WRITTEN: &str = "# mine\nformat = 1\ntitle = 'Hill' # and this\n[camera]\neye = [0, 0, 10]\nlook_at = [0, 1, 0]\n\
        # a mesh\n[[layer]]\nsource = 'a.obj'\nid = 'a'\nkind = 'mesh'\n";

    fn text(path: &Path) -> String {
        std::fs::read_to_string(path).expect("a file")
    }

    #[test]
    fn a_save_writes_only_what_was_edited() {
        let dir = tempfile::tempdir().expect("folder");
        let (path, mut editor) = written(dir.path(), "s.toml", WRITTEN);
        editor.edit(|d| d.camera.fov_y_deg = 30.0);
        editor.save(&path).expect("saved");
        let once = WRITTEN.replace("look_at = [0, 1, 0]\n", "look_at = [0, 1, 0]\nfov_y_deg = 30.0\n");
        assert_eq!(text(&path), once);
        editor.edit(|d| d.title = "Berg".into());
        editor.save(&path).expect("saved again");
        assert_eq!(text(&path), once.replace("'Hill'", "\"Berg\""));
        let below = dir.path().join("below");
        std::fs::create_dir(&below).expect("folder");
        editor.save(&below.join("t.toml")).expect("saved elsewhere");
        let moved = once.replace("'Hill'", "\"Berg\"").replace("'a.obj'", "\"../a.obj\"");
        assert_eq!(text(&below.join("t.toml")), moved, "names of files are adapted");
    }

    #[test]
    fn a_json_scene_stays_json_and_one_saved_under_another_ending_is_of_its_kind() {
        let dir = tempfile::tempdir().expect("folder");
        let json = "{\"title\": \"H\", \"camera\": {\"look_at\": [0, 1, 0], \"eye\": [0, 0, 10]}}\n";
        let (path, mut editor) = written(dir.path(), "s.json", json);
        editor.edit(|d| d.title = "B".into());
        editor.save(&path).expect("saved");
        assert_eq!(text(&path), json.replace("\"H\"", "\"B\""));
        for name in ["t.toml", "u.json"] {
            let path = dir.path().join(name);
            editor.save(&path).expect("saved");
            assert_eq!(text(&path).starts_with('{'), name == "u.json");
            assert_eq!(scene_file::read(&path).expect("a scene").document, **editor.document());
        }
    }

    #[test]
    fn a_file_that_another_program_changed_is_not_overwritten_without_consent() {
        let dir = tempfile::tempdir().expect("folder");
        let (path, mut editor) = written(dir.path(), "s.toml", WRITTEN);
        assert_eq!(editor.file_change(), None);
        editor.edit(|d| d.camera.fov_y_deg = 30.0);
        let other = WRITTEN.replace("Hill", "Mountain");
        std::fs::write(&path, &other).expect("another program");
        assert_eq!(editor.file_change(), Some(FileChange::Edited));
        let refused = editor.save(&path).expect_err("changed").to_string();
        assert!(refused.contains("changed by another program") && text(&path) == other, "{refused}");
        assert!(editor.save(&dir.path().join(".").join("s.toml")).is_err(), "the same file by another path");
        editor.save(&dir.path().join("copy.toml")).expect("another file");
        assert_eq!(text(&path), other);

        let (path, mut editor) = written(dir.path(), "s.toml", WRITTEN);
        editor.edit(|d| d.camera.fov_y_deg = 30.0);
        std::fs::write(&path, &other).expect("another program");
        editor.reload().expect("reloaded");
        assert!(editor.document().title == "Mountain" && !editor.is_changed() && editor.file_change().is_none());
        assert!(editor.undo() && editor.document().title == "Hill" && editor.document().camera.fov_y_deg == 30.0);
        std::fs::remove_file(&path).expect("removed");
        assert_eq!(editor.file_change(), Some(FileChange::Gone));
        assert!(editor.save(&path).is_err() && editor.reload().is_err() && editor.document().title == "Hill");
        editor.save_over(&path).expect("written again");
        assert!(text(&path).starts_with("# mine\n") && text(&path).contains("# and this"), "{}", text(&path));
        assert_eq!(editor.file_change(), None);
        std::fs::write(&path, text(&path)).expect("touched");
        assert_eq!(editor.file_change(), None, "the same text is no change");
    }
}
