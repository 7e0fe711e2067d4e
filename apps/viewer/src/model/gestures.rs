//! Edits of the document, and which of them are one gesture, that is one step of undo.

use super::Model;
use belvedere::scene_file::Document;
use eframe::egui::{Context, Event, Id, Key, Response};

impl Model {
    /// Edits the document; one step of undo.
    pub(crate) fn edit(&mut self, change: impl FnOnce(&mut Document)) {
        self.by = None;
        self.editor.edit(change);
    }

    /// Edits the document in the course of a gesture. All edits by the same control, or the same way of moving the camera, are one step of undo
    /// until the next gesture begins; an edit by another one begins it.
    pub(crate) fn edit_on(&mut self, by: Id, change: impl FnOnce(&mut Document)) {
        if self.by != Some(by) {
            self.begin_gesture_of(by);
        }
        self.editor.edit_within(self.gesture, change);
    }

    /// A new gesture.
    pub(crate) fn begin_gesture(&mut self) {
        self.gesture += 1;
    }

    /// A new gesture that edits over many frames, such as a preview that is played.
    pub(crate) fn begin_gesture_of(&mut self, by: Id) {
        self.by = Some(by);
        self.begin_gesture();
    }

    /// Whether nothing else has edited since `by` did.
    pub(crate) fn was_edited_by(&self, by: Id) -> bool {
        self.by == Some(by)
    }

    /// The control if it has a new value, for [`Model::edit_on`]. A drag is one gesture, as is what is typed while the control has the keyboard.
    pub(crate) fn changed(&mut self, response: &Response) -> Option<Id> {
        if response.drag_started() || response.gained_focus() {
            self.begin_gesture();
        }
        // A number that loses the keyboard takes the digits that it showed, which is no edit.
        if !response.changed() || response.lost_focus() && !is_typed(&response.ctx) {
            return None;
        }
        if !response.dragged() && !response.drag_stopped() && !response.has_focus() && !response.lost_focus() {
            self.begin_gesture();
        }
        Some(response.id)
    }

    /// Begins a gesture when the keyboard has come to another control: what is typed there until it leaves is one.
    pub(crate) fn follow_focus(&mut self, ctx: &Context) {
        let focus = ctx.memory(|memory| memory.focused());
        if std::mem::replace(&mut self.focus, focus) != focus && focus.is_some() {
            self.begin_gesture();
        }
    }

    /// Undoes the last step, or redoes the last undone one.
    pub(crate) fn step(&mut self, back: bool) {
        self.by = None;
        match back {
            true => self.editor.undo(),
            false => self.editor.redo(),
        };
    }

    /// Undoes or redoes until `steps` steps are not undone.
    pub(crate) fn go_to(&mut self, steps: usize) {
        self.by = None;
        self.editor.go_to(steps);
    }
}

/// Whether a key was pressed in this frame that may change a text.
fn is_typed(ctx: &Context) -> bool {
    let types = |event: &Event| match event {
        Event::Text(_) | Event::Paste(_) | Event::Cut => true,
        Event::Key { key, pressed, .. } => *pressed && *key != Key::Tab,
        _ => false,
    };
    ctx.input(|input| input.events.iter().any(types))
}
