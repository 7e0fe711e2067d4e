//! Files chosen in a window of our own, where the system has none for it.

use crate::language::tr;
use eframe::egui::{Button, Context, Key, ScrollArea, TextEdit, Ui, Window};
use std::path::{Path, PathBuf};

/// Entries of a folder that are listed, at most.
const MOST_ENTRIES: usize = 400;

/// A question for files.
#[derive(Debug)]
pub(super) struct Ask {
    /// Whether it asks for a name to write to; else for existing files.
    writes: bool,
    folder: PathBuf,
    name: String,
    /// Whether an entry is a folder, and its name; folders first.
    entries: Vec<(bool, String)>,
    chosen: Vec<PathBuf>,
    /// Whether the keyboard is at its field already.
    has_focus: bool,
}

impl Ask {
    pub(super) fn output(folder: &Path, name: &str) -> Self {
        Self::new(true, folder, name)
    }

    pub(super) fn input() -> Self {
        Self::new(false, Path::new(""), "")
    }

    fn new(writes: bool, folder: &Path, name: &str) -> Self {
        let folder =
            if folder.as_os_str().is_empty() { std::env::current_dir().unwrap_or_default() } else { folder.to_owned() };
        let mut ask = Self {
            writes,
            folder: PathBuf::new(),
            name: name.to_owned(),
            entries: Vec::new(),
            chosen: Vec::new(),
            has_focus: false,
        };
        ask.enter(folder);
        ask
    }

    fn enter(&mut self, folder: PathBuf) {
        let listed = std::fs::read_dir(&folder).into_iter().flatten().flatten();
        let named = listed.filter_map(|entry| Some((entry.path().is_dir(), entry.file_name().into_string().ok()?)));
        self.entries = named.filter(|(_, name)| !name.starts_with('.')).collect();
        self.entries.sort_by_key(|(is_folder, name)| (!is_folder, name.to_lowercase()));
        self.entries.truncate(MOST_ENTRIES);
        self.folder = folder;
    }

    /// Shows the window. Returns the chosen files, empty after a cancellation; `None` while the window is open.
    pub(super) fn show(&mut self, ctx: &Context) -> Option<Vec<PathBuf>> {
        let mut answer = None;
        let title = tr(if self.writes { "Write to a file" } else { "Open files" });
        let room = ctx.content_rect();
        Window::new(title)
            .collapsible(false)
            .default_pos(room.center() - 0.5 * room.size().min([520.0, 420.0].into()))
            .show(ctx, |ui| {
                ui.set_width(460.0);
                ui.label(self.folder.display().to_string());
                let label = ui.label(tr("File, or folder to go to"));
                let field = ui.add(TextEdit::singleline(&mut self.name).desired_width(440.0)).labelled_by(label.id);
                if !std::mem::replace(&mut self.has_focus, true) {
                    field.request_focus();
                }
                let entered = field.lost_focus() && ui.input(|input| input.key_pressed(Key::Enter));
                if self.writes && self.folder.join(self.name.trim()).is_file() {
                    ui.label(tr("This file is there already; it will be replaced."));
                }
                self.list(ui);
                ui.horizontal(|ui| {
                    let go = tr(if self.writes { "Write" } else { "Open" });
                    let ready = !self.name.trim().is_empty() || !self.chosen.is_empty();
                    if ui.add_enabled(ready, Button::new(go)).clicked() || (entered && ready) {
                        answer = self.decide();
                    }
                    if ui.button(tr("Cancel")).clicked() || ui.input(|input| input.key_pressed(Key::Escape)) {
                        answer = Some(Vec::new());
                    }
                });
            });
        answer
    }

    fn list(&mut self, ui: &mut Ui) {
        let mut to = None;
        ScrollArea::vertical().max_height(240.0).auto_shrink(false).show(ui, |ui| {
            if let Some(parent) = self.folder.parent()
                && ui.selectable_label(false, tr("one folder up")).clicked()
            {
                to = Some(parent.to_owned());
            }
            for (is_folder, name) in &self.entries {
                let path = self.folder.join(name);
                let shown = if *is_folder { format!("{name}/") } else { name.clone() };
                if !ui.selectable_label(self.chosen.contains(&path), shown).clicked() {
                    continue;
                }
                match (is_folder, self.writes) {
                    (true, _) => to = Some(path),
                    (false, true) => self.name.clone_from(name),
                    (false, false) if self.chosen.contains(&path) => self.chosen.retain(|other| *other != path),
                    (false, false) => self.chosen.push(path),
                }
            }
        });
        if let Some(to) = to {
            self.enter(to);
        }
    }

    /// Acts on the input: enters a folder, or returns the files.
    fn decide(&mut self) -> Option<Vec<PathBuf>> {
        let typed = self.name.trim();
        let path = self.folder.join(typed);
        if !typed.is_empty() && path.is_dir() {
            self.name.clear();
            self.enter(path);
            return None;
        }
        let mut files = std::mem::take(&mut self.chosen);
        files.extend((!typed.is_empty()).then_some(path));
        Some(files)
    }
}
