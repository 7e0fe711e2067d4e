//! The question about a scene file that another program changed, before it is written.

use super::Viewer;
use super::unsaved::{Next, ask};
use crate::language::{fill, tr};
use belvedere_studio::FileChange;
use eframe::egui::{Context, Id};

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
        let (heading, words, overwrite, lost) = match question.change {
            FileChange::Edited => (
                tr("The file has changed"),
                tr("Another program changed {0} after it was opened or saved here."),
                tr("Overwrite"),
                tr("what the other program wrote is lost"),
            ),
            FileChange::Gone => (
                tr("The file is gone"),
                tr("{0} was moved or removed after it was opened or saved here."),
                tr("Write it again"),
                "",
            ),
        };
        let mut answers = vec![
            (tr("Save as…"), tr("write this scene to another file"), Answer::SaveAs),
            (tr("Reload"), tr("take what the file holds now; undo brings this scene back"), Answer::Reload),
            (overwrite, lost, Answer::Overwrite),
            (tr("Cancel"), "", Answer::Cancel),
        ];
        answers.retain(|(.., answer)| question.change == FileChange::Edited || !matches!(answer, Answer::Reload));
        let words = fill(words, &[&path.display()]);
        let answer = ask(ctx, Id::unique("file change"), [heading, &words], &answers, &mut question.has_focus);
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
