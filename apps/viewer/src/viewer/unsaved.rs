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

/// Shows a question and its answers with their help, the last of which changes nothing: it is also that of the Escape key and of a click
/// beside.
///
/// * `has_focus`: whether the keyboard is at the answers already; it begins at the first, which loses nothing.
pub(super) fn ask<T: Copy>(
    ctx: &Context,
    id: Id,
    [heading, words]: [&str; 2],
    answers: &[(&str, &str, T)],
    has_focus: &mut bool,
) -> Option<T> {
    let mut given = None;
    let modal = Modal::new(id).show(ctx, |ui| {
        ui.set_max_width(340.0);
        ui.heading(heading);
        ui.label(words);
        ui.add_space(8.0);
        ui.horizontal_wrapped(|ui| {
            for (words, help, answer) in answers {
                let button = ui.add(Button::new(*words));
                if !std::mem::replace(has_focus, true) {
                    button.request_focus();
                }
                let button = if help.is_empty() { button } else { button.on_hover_text(*help) };
                given = if button.clicked() { Some(*answer) } else { given };
            }
        });
    });
    let is_cancelled = modal.backdrop_response.clicked() || ctx.input(|input| input.key_pressed(Key::Escape));
    let cancel = answers.last().filter(|_| is_cancelled);
    cancel.map(|(.., answer)| *answer).or(given)
}

/// The user's answer.
#[derive(Clone, Copy)]
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
        let answers = [
            (tr("Save"), saving, Answer::Save),
            (tr("Discard changes"), discarding, Answer::Discard),
            (tr("Cancel"), "", Answer::Cancel),
        ];
        let words = fill(tr("{0} has changes that are in no file."), &[&title]);
        let answer =
            ask(ctx, Id::unique("unsaved"), [tr("Save the changes?"), &words], &answers, &mut unsaved.has_focus);
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
