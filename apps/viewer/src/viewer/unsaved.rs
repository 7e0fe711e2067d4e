//! The question about changes that are not saved, before anything takes the scene away.

use super::Viewer;
use crate::language::{fill, tr};
use belvedere_studio::Editor;
use eframe::egui::{Button, Context, Id, Key, Modal, ViewportCommand};
use std::sync::Arc;

/// What takes the scene away.
pub(super) enum Next {
    /// The application ends.
    Quit,
    /// Another scene comes.
    Show(Box<Editor>),
    /// A scene that waited for files comes, of that state.
    Return(String),
}

/// The open question.
pub(super) struct Unsaved {
    next: Next,
    /// Whether the keyboard is at the buttons already.
    has_focus: bool,
}

#[cfg(test)]
impl Unsaved {
    /// What was to be done.
    pub(super) fn into_next(self) -> Next {
        self.next
    }
}

/// The user's answer.
enum Answer {
    Save,
    Discard,
    Cancel,
}

impl Viewer {
    /// Whether the scene has changes that are in no file.
    pub fn is_changed(&self) -> bool {
        self.model.editor.is_changed()
    }

    /// Whether a question waits for its answer.
    pub(super) fn asks(&self) -> bool {
        let asks = self.unsaved.is_some() || self.file_change.is_some();
        asks || self.chosen_input.is_some() || self.chosen_output.is_some()
    }

    /// Does what takes the scene away; asks first if it has changes that are not saved.
    pub(super) fn go_on_to(&mut self, ctx: &Context, next: Next) {
        if self.is_changed() {
            self.unsaved = Some(Unsaved { next, has_focus: false });
            ctx.request_repaint();
        } else {
            self.go_on(ctx, next);
        }
    }

    /// Does it without a question.
    pub(super) fn go_on(&mut self, ctx: &Context, next: Next) {
        match next {
            Next::Quit => {
                self.may_close = Some(self.document().clone());
                ctx.send_viewport_cmd(ViewportCommand::Close);
            }
            Next::Show(editor) => self.replace(*editor),
            Next::Return(text) => self.return_to_waiting(&text),
        }
    }

    /// Keeps the window open until the question is answered.
    pub(super) fn closing(&mut self, ctx: &Context) {
        let is_asked = ctx.input(|input| input.viewport().close_requested());
        let may_close = self.may_close.as_ref().is_some_and(|document| Arc::ptr_eq(document, self.document()));
        if is_asked && self.is_changed() && !may_close {
            ctx.send_viewport_cmd(ViewportCommand::CancelClose);
            self.file_change = None;
            self.go_on_to(ctx, Next::Quit);
        }
    }

    /// Shows the question and acts on the answer.
    pub(super) fn question(&mut self, ctx: &Context) {
        let Some(unsaved) = &mut self.unsaved else { return };
        let mut answer = None;
        let title = match self.model.editor.document().title.as_str() {
            "" => tr("This scene"),
            title => title,
        };
        let [saving, discarding] = match unsaved.next {
            Next::Quit => [tr("save, then quit"), tr("quit; the changes are lost")],
            Next::Show(_) | Next::Return(_) => {
                [tr("save, then open the other scene"), tr("open the other scene; the changes are lost")]
            }
        };
        let modal = Modal::new(Id::unique("unsaved")).show(ctx, |ui| {
            ui.set_max_width(340.0);
            ui.heading(tr("Save the changes?"));
            ui.label(fill(tr("{0} has changes that are in no file."), &[&title]));
            ui.add_space(8.0);
            ui.horizontal_wrapped(|ui| {
                let save = ui.add(Button::new(tr("Save")));
                if !std::mem::replace(&mut unsaved.has_focus, true) {
                    save.request_focus();
                }
                if save.on_hover_text(saving).clicked() {
                    answer = Some(Answer::Save);
                }
                if ui.button(tr("Discard changes")).on_hover_text(discarding).clicked() {
                    answer = Some(Answer::Discard);
                }
                if ui.button(tr("Cancel")).clicked() || ui.input(|input| input.key_pressed(Key::Escape)) {
                    answer = Some(Answer::Cancel);
                }
            });
        });
        if modal.backdrop_response.clicked() {
            answer = Some(Answer::Cancel);
        }
        let Some(answer) = answer else { return };
        let Some(Unsaved { next, .. }) = self.unsaved.take() else { return };
        ctx.request_repaint();
        match (answer, self.model.editor.place.scene.clone()) {
            (Answer::Cancel, _) => {}
            (Answer::Discard, _) => self.go_on(ctx, next),
            (Answer::Save, Some(path)) => self.save(ctx, &path, Some(next)),
            (Answer::Save, None) => {
                self.after_saving = Some(next);
                self.choose_output();
            }
        }
    }
}
