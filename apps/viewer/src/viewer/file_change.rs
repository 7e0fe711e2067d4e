//! The question about a scene file that another program changed, before it is written.

use super::Viewer;
use super::unsaved::Next;
use crate::language::{fill, tr};
use belvedere_studio::FileChange;
use eframe::egui::{Button, Context, Id, Key, Modal};

/// The open question.
pub(super) struct Question {
    change: FileChange,
    /// What is done once the scene is saved.
    next: Option<Next>,
    /// Whether the keyboard is at the buttons already.
    has_focus: bool,
}

impl Question {
    pub(super) fn new(change: FileChange, next: Option<Next>) -> Self {
        Self { change, next, has_focus: false }
    }
}

/// The user's answer.
#[derive(Clone, Copy)]
enum Answer {
    Overwrite,
    Reload,
    SaveAs,
    Cancel,
}

impl Viewer {
    /// Shows the question and acts on the answer.
    pub(super) fn ask_about_file(&mut self, ctx: &Context) {
        let Some(question) = &mut self.file_change else { return };
        let Some(path) = self.model.editor.place.scene.clone() else { return };
        let [heading, words, overwrite] = match question.change {
            FileChange::Edited => [
                tr("The file has changed"),
                tr("Another program changed {0} after it was opened or saved here."),
                tr("Overwrite"),
            ],
            FileChange::Gone => [
                tr("The file is gone"),
                tr("{0} was moved or removed after it was opened or saved here."),
                tr("Write it again"),
            ],
        };
        let there = question.change == FileChange::Edited;
        let mut answer = None;
        let modal = Modal::new(Id::unique("file change")).show(ctx, |ui| {
            ui.set_max_width(340.0);
            ui.heading(heading);
            ui.label(fill(words, &[&path.display()]));
            ui.add_space(8.0);
            ui.horizontal_wrapped(|ui| {
                let mut button = |words: &str, help: &str, what: Answer| {
                    let button = ui.add(Button::new(words));
                    // The keyboard begins at an answer that loses nothing.
                    if matches!(what, Answer::SaveAs) && !std::mem::replace(&mut question.has_focus, true) {
                        button.request_focus();
                    }
                    let button = if help.is_empty() { button } else { button.on_hover_text(help) };
                    if button.clicked() {
                        answer = Some(what);
                    }
                };
                button(tr("Save as…"), tr("write this scene to another file"), Answer::SaveAs);
                if there {
                    button(
                        tr("Reload"),
                        tr("take what the file holds now; undo brings this scene back"),
                        Answer::Reload,
                    );
                }
                let lost = if there { tr("what the other program wrote is lost") } else { "" };
                button(overwrite, lost, Answer::Overwrite);
                button(tr("Cancel"), "", Answer::Cancel);
                if ui.input(|input| input.key_pressed(Key::Escape)) {
                    answer = Some(Answer::Cancel);
                }
            });
        });
        if modal.backdrop_response.clicked() {
            answer = Some(Answer::Cancel);
        }
        let Some(answer) = answer else { return };
        let next = self.file_change.take().and_then(|question| question.next);
        ctx.request_repaint();
        match answer {
            Answer::Overwrite => self.save_over(ctx, &path, next),
            Answer::Reload => {
                // The recovery file is written anew, since it says what the scene file holds.
                self.written = None;
                if let Err(e) = self.model.editor.reload() {
                    self.model.notices.error(e.to_string());
                }
            }
            Answer::SaveAs => {
                self.after_saving = next;
                self.choose_output();
            }
            Answer::Cancel => {}
        }
    }
}
