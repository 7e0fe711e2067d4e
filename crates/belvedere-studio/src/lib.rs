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
mod tests;
