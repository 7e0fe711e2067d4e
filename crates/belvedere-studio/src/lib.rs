//! Editing of scenes: a document with its undo history, and a painter in the background.
//!
//! The document holds all state: every action of the user is an edit of it, and the saved document renders to the same picture elsewhere.

mod beside;
mod camera;
mod find;
mod flight;
mod layers;
mod lengths;
mod object;
mod painter;
mod place;
mod rays;
mod recovery;
mod residues;
mod sections;
mod steps;

pub use beside::{THREADS, beside};
pub use camera::above_ground;
pub use find::{Matches, NameIndex, Named, Wanted, atoms_in, folded, place_in};
pub use flight::{Flight, shown_whole};
pub use layers::{with_layer_renamed, without_layer};
pub use lengths::{Lengths, ground_way, lengths, lengths_geojson};
pub use object::object_at;
pub use painter::{Answer, Painter};
pub use place::FileChange;
pub use rays::{next_turn, sharpness_at, sharpness_knob, with_parallel_planes, with_pivot_line};
pub use recovery::{Recovered, Recovery};
pub use residues::{NamedResidue, read_residues, residues};
pub use sections::{with_levels, with_own_style};
pub use steps::step_name;

use belvedere::placed::Place;
use belvedere::scene_file::{Document, LayerDoc};
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// An edited document with its undo history.
#[derive(Debug, Clone)]
pub struct Editor {
    /// Path of its file, and folders of its files.
    pub place: Place,
    present: Arc<Document>,
    past: Vec<Arc<Document>>,
    future: Vec<Arc<Document>>,
    /// Document in the file; `None` if that is not known.
    saved: Option<Arc<Document>>,
    /// Text of the scene file as it was read or written last; `None` without a file.
    text: Option<Arc<str>>,
    /// The gesture that the last edit belongs to.
    gesture: Option<u64>,
}

impl Editor {
    /// Largest number of undo steps.
    pub const DEPTH: usize = 512;

    /// A document without history.
    pub fn new(document: Document, place: Place) -> Self {
        let present = Arc::new(document);
        let saved = Some(present.clone());
        Self { place, saved, text: None, present, past: Vec::new(), future: Vec::new(), gesture: None }
    }

    /// A document with changes that are not saved.
    pub fn unsaved(document: Document, place: Place) -> Self {
        Self { saved: None, ..Self::new(document, place) }
    }

    /// Another document of the same file, without history and without changes.
    pub fn with_document(&self, document: Document) -> Self {
        Self { text: self.text.clone(), ..Self::new(document, self.place.clone()) }
    }

    /// Adds layers whose files lie in the given folders; one step of undo.
    pub fn add_layers(&mut self, layers: Vec<LayerDoc>, folders: Vec<PathBuf>) {
        self.place.roots.allowed.extend(folders);
        self.edit(|document| document.layer.extend(layers));
    }

    /// The current document.
    pub fn document(&self) -> &Arc<Document> {
        &self.present
    }

    /// Whether the scene file holds all changes.
    pub fn is_saved(&self) -> bool {
        self.place.scene.is_some() && !self.is_changed()
    }

    /// Whether the document has changed since it was opened or saved.
    pub fn is_changed(&self) -> bool {
        self.saved.as_deref() != Some(&*self.present)
    }

    /// Edits the document; one step of undo.
    pub fn edit(&mut self, change: impl FnOnce(&mut Document)) {
        self.gesture = None;
        self.step(change);
    }

    /// Edits the document within a gesture, such as a drag: all edits of one gesture are one step of undo.
    pub fn edit_within(&mut self, gesture: u64, change: impl FnOnce(&mut Document)) {
        if self.gesture == Some(gesture) && !self.past.is_empty() {
            let mut next = (*self.present).clone();
            change(&mut next);
            self.present = Arc::new(next);
            self.future.clear();
        } else {
            // An edit that changed nothing began no step that the next ones could belong to.
            self.gesture = self.step(change).then_some(gesture);
        }
    }

    /// Whether anything changed.
    fn step(&mut self, change: impl FnOnce(&mut Document)) -> bool {
        let mut next = (*self.present).clone();
        change(&mut next);
        if next == *self.present {
            return false;
        }
        self.drop_empty_step();
        self.past.push(std::mem::replace(&mut self.present, Arc::new(next)));
        if self.past.len() > Self::DEPTH {
            self.past.remove(0);
        }
        self.future.clear();
        true
    }

    /// Drops the last step if it changed nothing in the end, such as a drag back to its beginning.
    fn drop_empty_step(&mut self) {
        if self.past.last().is_some_and(|before| **before == *self.present) {
            self.past.pop();
        }
    }

    /// Whether there is a step to undo.
    pub fn can_undo(&self) -> bool {
        !self.past.is_empty()
    }

    /// Whether there is a step to redo.
    pub fn can_redo(&self) -> bool {
        !self.future.is_empty()
    }

    /// Undoes the last step; `false` if there is none.
    pub fn undo(&mut self) -> bool {
        self.drop_empty_step();
        let Some(before) = self.past.pop() else { return false };
        self.future.push(std::mem::replace(&mut self.present, before));
        self.gesture = None;
        true
    }

    /// Redoes the last undone step; `false` if there is none.
    pub fn redo(&mut self) -> bool {
        let Some(after) = self.future.pop() else { return false };
        self.past.push(std::mem::replace(&mut self.present, after));
        self.gesture = None;
        true
    }

    /// Adapts the names of files in all steps to another folder of the scene file.
    pub(crate) fn name_from(&mut self, folder: &Path) {
        let roots = &self.place.roots;
        let steps = self.past.iter_mut().chain(&mut self.future).chain([&mut self.present]);
        steps.for_each(|step| *step = Arc::new(step.seen_from(folder, roots)));
    }

    /// Marks the current document as saved. The next edit begins a step, so that undo leads back to what was saved.
    pub(crate) fn mark_saved(&mut self) {
        self.saved = Some(self.present.clone());
        self.gesture = None;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn editor() -> Editor {
        let text = "format = 1\n[camera]\neye = [0, 0, 10]\nlook_at = [0, 1, 0]\n";
        let source = belvedere::scene_file::parse(Path::new("s.toml"), text).expect("scene");
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
    fn layers_that_are_added_together_are_one_step() {
        let (mut editor, text) = (editor(), "format = 1\n[camera]\neye = [0, 0, 10]\nlook_at = [0, 1, 0]\n");
        let layer = |id: &str| format!("[[layer]]\nkind = 'line'\nid = '{id}'\nsource = 'way.gpx'\n");
        let text = format!("{text}{}{}", layer("a"), layer("b"));
        let layers = belvedere::scene_file::parse(Path::new("s.toml"), &text).expect("scene").document.layer;
        editor.add_layers(layers, vec!["folder".into()]);
        assert_eq!((editor.document().layer.len(), editor.place.roots.allowed.len()), (2, 1));
        assert!(editor.undo() && editor.document().layer.is_empty());
    }

    #[test]
    fn an_edit_that_changes_nothing_is_no_step() {
        let mut editor = editor();
        editor.edit(|d| d.title = String::new());
        assert!(!editor.can_undo() && !editor.is_changed());
    }

    /// A small generator of numbers (Knuth's MMIX constants).
    fn throw(dice: &mut u64, sides: u64) -> u64 {
        *dice = dice.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (*dice >> 33) % sides
    }

    #[test]
    fn gestures_are_steps_and_undo_restores_the_document_before_each() {
        for seed in 0..200 {
            let (mut editor, mut dice) = (editor(), seed);
            // Documents before each step that is not undone.
            let mut before: Vec<Document> = Vec::new();
            let mut undone: Vec<Document> = Vec::new();
            for gesture in 0..40 {
                let present = (**editor.document()).clone();
                match throw(&mut dice, 6) {
                    0 => {
                        assert_eq!(editor.undo(), !before.is_empty());
                        if let Some(last) = before.pop() {
                            assert_eq!(**editor.document(), last, "seed {seed}, gesture {gesture}");
                            undone.push(present);
                        }
                    }
                    1 => {
                        assert_eq!(editor.redo(), !undone.is_empty());
                        if let Some(next) = undone.pop() {
                            assert_eq!(**editor.document(), next);
                            before.push(present);
                        }
                    }
                    2 => editor.mark_saved(),
                    what => {
                        let mut moved = false;
                        for _ in 0..=throw(&mut dice, 4) {
                            let value = 20.0 + throw(&mut dice, 60) as f64;
                            let change = |d: &mut Document| match what {
                                3 => d.camera.fov_y_deg = value,
                                4 => d.title = value.to_string(),
                                _ => d.camera.near = value,
                            };
                            editor.edit_within(gesture, change);
                            moved |= **editor.document() != present;
                        }
                        if moved {
                            undone.clear();
                        }
                        if **editor.document() != present {
                            before.push(present);
                        }
                    }
                }
                let steps = before.len();
                assert!((steps..=steps + 1).contains(&editor.history().1), "seed {seed}: {steps} steps");
            }
            while let Some(last) = before.pop() {
                assert!(editor.undo() && **editor.document() == last, "seed {seed}");
            }
            assert!(!editor.undo());
        }
    }
}
