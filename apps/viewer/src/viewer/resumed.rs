//! What a page keeps for the time when it is loaded again: the scene as it was, and which files it needs.

use super::waiting::{Waiting, each_file, missing};
use super::{Extra, Viewer};
use crate::language::tr;
use belvedere::io::fs;
use belvedere::scene_file::Document;
use belvedere_studio::Recovered;
#[cfg(target_family = "wasm")]
use eframe::egui::Context;
use std::collections::BTreeSet;
use std::path::PathBuf;
use std::sync::Arc;

/// State of keeping.
#[derive(Debug, Default)]
pub(super) struct Resumed {
    /// The last state that was told, and whether it had changes.
    told: Option<(Arc<Document>, Extra, bool)>,
    /// Number of scenes that came in place of others.
    scenes: u32,
    /// The number that the first scene has.
    first: u32,
    /// Scenes that wait for files.
    pub(super) waiting: Vec<Waiting>,
    /// Whether the user gave up a scene that waited.
    pub(super) gave_up: bool,
}

impl Resumed {
    /// * `opens`: whether files are opened at the start.
    pub(super) fn new(opens: bool) -> Self {
        Self { first: u32::from(opens), ..Self::default() }
    }

    /// Another scene comes in place of the current one.
    pub(super) fn another(&mut self) {
        self.scenes += 1;
    }
}

#[cfg_attr(not(target_family = "wasm"), allow(dead_code))]
impl Viewer {
    /// The state as text if it has changed since the last call; never that of an untouched first scene.
    pub(crate) fn left(&mut self) -> Option<String> {
        let is_there = !self.model.is_opening() && self.model.shown.is_some();
        is_there.then(|| self.state_text()).flatten()
    }

    /// As [`Viewer::left`], of a scene that may have no picture yet.
    pub(super) fn state_text(&mut self) -> Option<String> {
        let is_changed = self.is_changed();
        let present = (self.model.document().clone(), self.extra(), is_changed);
        let is_first = self.resumed.told.is_none();
        let is_told = self.resumed.told.as_ref().is_some_and(|(document, extra, changed)| {
            Arc::ptr_eq(document, &present.0) && (extra, *changed) == (&present.1, present.2)
        });
        if is_told {
            return None;
        }
        let beside = serde_json::to_value(&present.1).unwrap_or_default();
        self.resumed.told = Some(present);
        let is_untouched =
            is_first && self.resumed.scenes <= self.resumed.first && !is_changed && !self.resumed.gave_up;
        (!is_untouched).then(|| Recovered::text_of(&self.model.editor, beside).ok()).flatten()
    }

    /// State of the window beside the document.
    pub(super) fn extra(&self) -> Extra {
        Extra {
            look: self.model.look.clone(),
            tab: self.panels.tab,
            bookmarks: self.bookmarks.clone(),
            waiting: self.resumed.waiting.iter().map(|waiting| waiting.text.clone()).collect(),
        }
    }

    /// Shows the scene of a state that [`Viewer::left`] wrote; if files of it are missing, says which and waits for them.
    ///
    /// Returns whether it is shown.
    pub(super) fn resume(&mut self, text: &str) -> bool {
        let Some(left) = Recovered::of_text(text) else { return false };
        if !missing(&left.editor).is_empty() {
            self.wait_for_files(text);
            return false;
        }
        self.take_up(left);
        true
    }

    /// Shows a scene as it was left, and the window as it was beside it.
    pub(super) fn take_up(&mut self, left: Recovered) {
        self.replace(left.editor);
        self.model.stay();
        let extra: Extra = serde_json::from_value(left.extra).unwrap_or_default();
        (self.model.look, self.panels.tab) = (extra.look, extra.tab);
        self.bookmarks = extra.bookmarks;
        extra.waiting.iter().for_each(|text| self.wait_for_files(text));
    }

    /// Number of scenes that came in place of others; `None` while one is on its way.
    pub(crate) fn scene_number(&self) -> Option<u32> {
        (!self.is_opening() && self.model.shown.is_some()).then_some(self.resumed.scenes)
    }

    /// Files that the scene and those that wait read, canonical.
    pub(crate) fn needs(&self) -> Vec<PathBuf> {
        let mut files: BTreeSet<PathBuf> = BTreeSet::new();
        each_file(&self.model.editor, |_, file| files.extend(file));
        files.extend(self.resumed.waiting.iter().flat_map(Waiting::files));
        let read = self.model.shown.iter().flat_map(|shown| shown.session.input_paths());
        files.extend(read.map(|file| fs::canonicalize(&file).unwrap_or(file)));
        files.into_iter().collect()
    }

    /// Lets the browser forget the files that it keeps.
    #[cfg(target_family = "wasm")]
    pub(super) fn forget_files(&mut self, ctx: &Context) {
        crate::browser::page::call("forget", &[]);
        let words = tr("The browser has forgotten your files; the scene keeps them until the page is closed.");
        self.model.notices.say(words, ctx.input(|input| input.time));
    }

    /// Says that the browser does not keep the scene for the time when the page is loaded again.
    ///
    /// * `is_full`: whether there is no room for it; else the browser refuses.
    pub(crate) fn tell_not_remembered(&mut self, is_full: bool) {
        let words = if is_full {
            tr(
                "The browser has no room to keep this scene: if the page is loaded again, an older state of it comes back. Save it to a file.",
            )
        } else {
            tr("The browser keeps no scenes here: when the page is loaded again, this one is gone. Save it to a file.")
        };
        self.model.notices.error(words);
    }

    /// Says once that the browser keeps no more files.
    ///
    /// * `is_full`: whether there is no room for them; else the browser refuses.
    pub(crate) fn tell_not_kept(&mut self, is_full: bool) {
        let words = if is_full {
            tr(
                "The browser has no room to keep this file: open it again when the page has been loaded again. All else goes on.",
            )
        } else {
            tr(
                "The browser keeps no files here, as in a private window: open them again when the page has been loaded again. All else goes on.",
            )
        };
        self.model.notices.error(words);
    }
}

#[cfg(test)]
mod tests;
