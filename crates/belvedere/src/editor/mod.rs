//! Scenes in the hands of a user: one document with its past and future, a session that follows it, and a painter beside the window.
//!
//! The document is everything: whatever a user does is an edit of it, and what is saved renders to the same picture elsewhere.

mod beside;
mod camera;
mod live;
mod object;
mod painter;
mod place;
mod rays;
mod thin;

pub use beside::{THREADS, beside};
pub use camera::{above_ground, framed, navigation, set_camera};
pub use live::{Judged, LiveSession, Order, Pace, Shown, Sides};
pub use object::object_at;
pub use painter::{Answer, Painter};
pub use place::{Place, Recovered, Recovery};
pub use rays::{next_turn, sharpness_at, sharpness_knob, with_parallel_planes, with_pivot_line};

use crate::scene_file::{Document, LayerDoc};
use std::path::PathBuf;
use std::sync::Arc;

/// A document that is edited, and what it was before.
#[derive(Debug, Clone)]
pub struct Editor {
    /// Where it and its files lie.
    pub place: Place,
    present: Arc<Document>,
    past: Vec<Arc<Document>>,
    future: Vec<Arc<Document>>,
    /// What the file holds; `None` if that is not known.
    saved: Option<Arc<Document>>,
    /// The gesture that the last edit belongs to.
    gesture: Option<u64>,
}

impl Editor {
    /// Documents that are remembered.
    pub const DEPTH: usize = 512;

    /// A document without a past.
    pub fn new(document: Document, place: Place) -> Self {
        let present = Arc::new(document);
        let saved = Some(present.clone());
        Self { place, saved, present, past: Vec::new(), future: Vec::new(), gesture: None }
    }

    /// A document that was changed since it was saved, if it ever was.
    pub(crate) fn unsaved(document: Document, place: Place) -> Self {
        Self { saved: None, ..Self::new(document, place) }
    }

    /// Adds layers whose files lie in those folders; one step of undo.
    pub fn add_layers(&mut self, layers: Vec<LayerDoc>, folders: Vec<PathBuf>) {
        self.place.roots.allowed.extend(folders);
        self.edit(|document| document.layer.extend(layers));
    }

    /// The document as it is.
    pub fn document(&self) -> &Arc<Document> {
        &self.present
    }

    /// Whether everything is in the file of the scene.
    pub fn is_saved(&self) -> bool {
        self.place.scene.is_some() && !self.is_changed()
    }

    /// Whether anything was changed since it was opened or saved.
    pub fn is_changed(&self) -> bool {
        self.saved.as_deref() != Some(&*self.present)
    }

    /// Edits the document; one step of undo.
    pub fn edit(&mut self, change: impl FnOnce(&mut Document)) {
        self.gesture = None;
        self.step(change);
    }

    /// Edits it in the course of a gesture, such as a drag: all edits of one gesture are one step of undo.
    pub fn edit_within(&mut self, gesture: u64, change: impl FnOnce(&mut Document)) {
        if self.gesture == Some(gesture) && !self.past.is_empty() {
            let mut next = (*self.present).clone();
            change(&mut next);
            self.present = Arc::new(next);
            self.future.clear();
        } else {
            self.step(change);
            self.gesture = Some(gesture);
        }
    }

    fn step(&mut self, change: impl FnOnce(&mut Document)) {
        let mut next = (*self.present).clone();
        change(&mut next);
        if next == *self.present {
            return;
        }
        self.past.push(std::mem::replace(&mut self.present, Arc::new(next)));
        if self.past.len() > Self::DEPTH {
            self.past.remove(0);
        }
        self.future.clear();
    }

    /// Whether there is something to take back.
    pub fn can_undo(&self) -> bool {
        !self.past.is_empty()
    }

    /// Whether there is something to do again.
    pub fn can_redo(&self) -> bool {
        !self.future.is_empty()
    }

    /// Takes the last step back; `false` if there is none.
    pub fn undo(&mut self) -> bool {
        let Some(before) = self.past.pop() else { return false };
        self.future.push(std::mem::replace(&mut self.present, before));
        self.gesture = None;
        true
    }

    /// Does again what was taken back last; `false` if there is nothing.
    pub fn redo(&mut self) -> bool {
        let Some(after) = self.future.pop() else { return false };
        self.past.push(std::mem::replace(&mut self.present, after));
        self.gesture = None;
        true
    }

    /// What is there now is what the file holds.
    pub(crate) fn mark_saved(&mut self) {
        self.saved = Some(self.present.clone());
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn editor() -> Editor {
        let text = "format = 1\n[camera]\neye = [0, 0, 10]\nlook_at = [0, 1, 0]\n";
        let source = crate::scene_file::parse(std::path::Path::new("s.toml"), text).expect("scene");
        Editor::new(source.document, Place::default())
    }

    #[test]
    fn a_gesture_is_one_step() {
        let mut editor = editor();
        editor.edit(|d| d.title = "a".into());
        for fov in [40.0, 35.0, 30.0] {
            editor.edit_within(1, |d| d.camera.fov_y_deg = fov);
        }
        editor.edit_within(2, |d| d.camera.fov_y_deg = 20.0);
        assert!(editor.undo() && editor.document().camera.fov_y_deg == 30.0);
        assert!(editor.undo() && editor.document().camera.fov_y_deg == 45.0 && editor.document().title == "a");
        assert!(editor.redo() && editor.document().camera.fov_y_deg == 30.0);
        editor.edit(|d| d.title = "b".into());
        assert!(!editor.redo(), "what was undone is gone after an edit");
    }

    #[test]
    fn an_edit_that_changes_nothing_is_no_step() {
        let mut editor = editor();
        editor.edit(|d| d.title = String::new());
        assert!(!editor.can_undo() && !editor.is_changed());
    }
}
