//! Scenes of an earlier load of the page that wait for files which the browser has lost. They wait until their files come, or until the user
//! gives them up; other scenes may be opened meanwhile.

use super::unsaved::Next;
use super::{Extra, Viewer};
use crate::language::{fill, tr};
use crate::menu::WaitingScene;
use belvedere_studio::{Editor, Recovered};
use eframe::egui::Context;
use std::path::{Path, PathBuf};

/// Names of missing files that a message lists.
const LISTED: usize = 12;

/// A scene that waits.
#[derive(Debug)]
pub(super) struct Waiting {
    /// Its state.
    pub(super) text: String,
    title: String,
    /// Names of the files that it still needs.
    missing: Vec<String>,
}

impl Waiting {
    /// Files of the scene that are there, canonical.
    pub(super) fn files(&self) -> Vec<PathBuf> {
        let mut files = Vec::new();
        if let Some(left) = Recovered::of_text(&self.text) {
            each_file(&left.editor, |_, file| files.extend(file));
        }
        files
    }
}

impl Viewer {
    /// Lets a state wait, and the states that waited beside it; those whose files are all there wait, too, until they are called.
    pub(super) fn wait_for_files(&mut self, text: &str) {
        let Some(mut left) = Recovered::of_text(text) else { return };
        let mut extra: Extra = serde_json::from_value(left.extra).unwrap_or_default();
        for other in std::mem::take(&mut extra.waiting) {
            self.wait_for_files(&other);
        }
        left.extra = serde_json::to_value(extra).unwrap_or_default();
        let Ok(text) = Recovered::text_of(&left.editor, left.extra) else { return };
        if self.resumed.waiting.iter().any(|other| other.text == text) {
            return;
        }
        let missing = missing(&left.editor);
        self.tell_missing(&missing);
        self.resumed.waiting.push(Waiting { text, title: left.editor.document().title.clone(), missing });
    }

    /// Whether files that have come belong to scenes that wait; the first that has all its files is shown.
    pub(super) fn resumes(&mut self, ctx: &Context) -> bool {
        let (mut came, mut ready, mut still) = (false, None, Vec::new());
        for waiting in &mut self.resumed.waiting {
            let Some(left) = Recovered::of_text(&waiting.text) else { continue };
            let missing = missing(&left.editor);
            if missing.len() >= waiting.missing.len() {
                continue;
            }
            came = true;
            waiting.missing = missing;
            if waiting.missing.is_empty() {
                ready = ready.or_else(|| Some(waiting.text.clone()));
            } else {
                still.push(waiting.missing.clone());
            }
        }
        still.iter().for_each(|missing| self.tell_missing(missing));
        if let Some(text) = ready {
            self.go_on_to(ctx, Next::Return(text));
        }
        came
    }

    /// Shows a scene that waited, without a question.
    pub(super) fn return_to_waiting(&mut self, text: &str) {
        self.resumed.waiting.retain(|waiting| waiting.text != text);
        self.resume(text);
    }

    /// Shows the `i`-th scene that waits, if its files are there.
    pub(super) fn call_waiting(&mut self, ctx: &Context, i: usize) {
        if let Some(waiting) = self.resumed.waiting.get(i) {
            let text = waiting.text.clone();
            self.go_on_to(ctx, Next::Return(text));
        }
    }

    /// Gives up the `i`-th scene that waits.
    pub(super) fn give_up(&mut self, i: usize) {
        if i < self.resumed.waiting.len() {
            self.resumed.waiting.remove(i);
            self.resumed.gave_up = true;
        }
    }

    /// The scenes that wait, for the menu.
    pub(super) fn waiting(&self) -> Vec<WaitingScene> {
        let title =
            |title: &str| if title.is_empty() { tr("the scene without a title").into() } else { title.to_owned() };
        let entry = |waiting: &Waiting| WaitingScene { title: title(&waiting.title), missing: list(&waiting.missing) };
        self.resumed.waiting.iter().map(entry).collect()
    }

    fn tell_missing(&mut self, missing: &[String]) {
        if missing.is_empty() {
            return;
        }
        let words = tr(
            "The scene that you had open needs files that the browser does not have any more: {0}. Drop them on the page, and it comes back. It waits in the menu File, where you can give it up.",
        );
        self.model.notices.error(fill(words, &[&list(missing)]));
    }
}

fn list(missing: &[String]) -> String {
    let list = missing.iter().take(LISTED).cloned().collect::<Vec<_>>().join(", ");
    if missing.len() > LISTED { fill(tr("{0} and {1} more"), &[&list, &(missing.len() - LISTED)]) } else { list }
}

/// Calls `each` with every name of a file in the document, and the file that it leads to.
pub(super) fn each_file(editor: &Editor, mut each: impl FnMut(&str, Option<PathBuf>)) {
    let mut document = (**editor.document()).clone();
    document.for_each_path(&mut |name| {
        let file = editor.place.roots.resolve(name).ok();
        each(name, file.map(|file| belvedere::io::split_table(Path::new(&file)).0.to_owned()));
    });
}

/// Names of files in the document that lead to none.
pub(super) fn missing(editor: &Editor) -> Vec<String> {
    let mut names = Vec::new();
    each_file(editor, |name, file| {
        if file.is_none() && !names.iter().any(|other| other == name) {
            names.push(name.to_owned());
        }
    });
    names
}

#[cfg(test)]
mod tests;
