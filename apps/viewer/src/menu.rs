//! The menu bar: files, undo steps, bookmarks.

use crate::builtin::BUILTIN;
use crate::keys::{self, Command};
use crate::language::{fill, heard, tr};
use crate::model::Model;
use crate::settings::Settings;
use belvedere::scene_file::CameraDoc;
use eframe::egui::{Button, Context, Grid, Label, MenuBar, RichText, Role, ScrollArea, Ui, WidgetInfo, Window};
use serde::{Deserialize, Serialize};
use std::path::PathBuf;

/// A choice in the menu.
pub(crate) enum Choice {
    Command(Command),
    Builtin(usize),
    Recent(PathBuf),
    GoTo(usize),
    /// Removes a bookmark.
    Forget(usize),
    /// Shows a scene that waited for files.
    Return(usize),
    /// Gives up a scene that waits for files.
    GiveUp(usize),
    /// Undoes or redoes to that number of steps.
    Step(usize),
    /// The browser forgets the files that it keeps.
    #[cfg(target_family = "wasm")]
    ForgetFiles,
}

/// A camera kept under a name.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub(crate) struct Bookmark {
    pub(crate) name: String,
    pub(crate) camera: CameraDoc,
}

/// A scene that waits for files.
pub(crate) struct WaitingScene {
    pub(crate) title: String,
    /// The files that are missing, as a list; empty: the scene can come back.
    pub(crate) missing: String,
}

/// An entry with its keys at its right. Returns whether it was chosen.
fn item(ui: &mut Ui, command: Command, enabled: bool) -> bool {
    let (words, keys) = (keys::words(command), keys::shortcut(ui.ctx(), command));
    let response = ui.add_enabled(enabled, Button::new(words).shortcut_text(keys));
    response.widget_info(|| WidgetInfo::labeled(Role::Button, enabled, words));
    response.clicked()
}

/// Shows the bar.
pub(crate) fn bar(
    ui: &mut Ui,
    model: &mut Model,
    settings: &mut Settings,
    recent: &[PathBuf],
    bookmarks: &[Bookmark],
    waiting: &[WaitingScene],
) -> Option<Choice> {
    let mut choice = None;
    MenuBar::new().ui(ui, |ui| {
        ui.menu_button(tr("File"), |ui| choice = file(ui, recent, waiting));
        ui.menu_button(tr("Edit"), |ui| {
            let can = [model.editor.can_undo(), model.editor.can_redo()];
            for (command, can) in [Command::Undo, Command::Redo].into_iter().zip(can) {
                if item(ui, command, can) {
                    choice = Some(Choice::Command(command));
                }
            }
            ui.menu_button(tr("Steps"), |ui| {
                if let Some(steps) = steps(ui, model) {
                    choice = Some(Choice::Step(steps));
                }
            });
        });
        ui.menu_button(tr("Places"), |ui| choice = places(ui, bookmarks).or(choice.take()));
        ui.menu_button(tr("View"), |ui| settings.menu(ui));
        ui.menu_button(tr("Help"), |ui| {
            for command in [Command::Help, Command::Welcome] {
                if item(ui, command, true) {
                    choice = Some(Choice::Command(command));
                }
            }
        });
        if ui.ctx().content_rect().width() >= 600.0 {
            ui.toggle_value(&mut model.look.panel, tr("Panel")).on_hover_text(keys::shortcut(ui.ctx(), Command::Panel));
        }
        let title = &model.document().title;
        let state = if model.editor.is_changed() { tr("changed") } else { "" };
        ui.add(Label::new(RichText::new(format!("{title}  {state}")).weak()).truncate());
    });
    choice
}

fn file(ui: &mut Ui, recent: &[PathBuf], waiting: &[WaitingScene]) -> Option<Choice> {
    let mut choice = None;
    if item(ui, Command::Open, true) {
        choice = Some(Choice::Command(Command::Open));
    }
    ui.menu_button(tr("Built-in scenes"), |ui| {
        for (i, (name, _)) in BUILTIN.iter().enumerate() {
            if ui.button(tr(name)).clicked() {
                choice = Some(Choice::Builtin(i));
            }
        }
    });
    ui.menu_button(tr("Recent files"), |ui| {
        if recent.is_empty() {
            ui.weak(tr("none yet"));
        }
        for path in recent {
            if ui.button(path.display().to_string()).clicked() {
                choice = Some(Choice::Recent(path.clone()));
            }
        }
    });
    ui.separator();
    for (i, scene) in waiting.iter().enumerate() {
        let back = ui.add_enabled(scene.missing.is_empty(), Button::new(fill(tr("Back to {0}"), &[&scene.title])));
        if back.on_disabled_hover_text(fill(tr("It waits for {0}"), &[&scene.missing])).clicked() {
            choice = Some(Choice::Return(i));
        }
        let give_up = ui.button(fill(tr("Give up {0}"), &[&scene.title]));
        if give_up.on_hover_text(tr("Its changes are in no file; they are lost.")).clicked() {
            choice = Some(Choice::GiveUp(i));
        }
    }
    if !waiting.is_empty() {
        ui.separator();
    }
    #[cfg(target_family = "wasm")]
    {
        let forget = ui.button(tr("Forget my files"));
        let why = tr("The browser keeps the files that you open until another scene is opened.");
        if forget.on_hover_text(why).clicked() {
            choice = Some(Choice::ForgetFiles);
        }
        ui.separator();
    }
    // A page is closed by its browser, which asks the same question.
    let quit = cfg!(not(target_family = "wasm")).then_some(Command::Quit);
    for command in [Some(Command::Save), Some(Command::SaveAs), quit].into_iter().flatten() {
        if command == Command::Quit {
            ui.separator();
        }
        if item(ui, command, true) {
            choice = Some(Choice::Command(command));
        }
    }
    choice
}

fn places(ui: &mut Ui, bookmarks: &[Bookmark]) -> Option<Choice> {
    let mut choice = None;
    for command in [Command::Find, Command::ShowAll, Command::Measure, Command::Bookmark, Command::Bookmarks] {
        if item(ui, command, true) {
            choice = Some(Choice::Command(command));
        }
    }
    ui.separator();
    for (i, bookmark) in bookmarks.iter().enumerate() {
        if ui.button(&bookmark.name).clicked() {
            choice = Some(Choice::GoTo(i));
        }
    }
    ui.add_enabled_ui(!bookmarks.is_empty(), |ui| {
        ui.menu_button(tr("Remove a bookmark"), |ui| {
            for (i, bookmark) in bookmarks.iter().enumerate() {
                if ui.button(fill(tr("Remove {0}"), &[&bookmark.name])).clicked() {
                    choice = Some(Choice::Forget(i));
                }
            }
        });
    });
    choice
}

/// The steps of undo, oldest first. Returns the number of steps to go to.
fn steps(ui: &mut Ui, model: &Model) -> Option<usize> {
    let (names, done) = model.editor.history();
    let mut to = None;
    ui.set_min_width(220.0);
    ScrollArea::vertical().max_height(420.0).stick_to_bottom(true).show(ui, |ui| {
        if ui.selectable_label(done == 0, tr("As it was opened")).clicked() {
            to = Some(0);
        }
        for (i, name) in names.iter().enumerate() {
            let words = format!("{}. {}", i + 1, heard(name));
            let text = if i < done { RichText::new(words) } else { RichText::new(words).weak() };
            if ui.selectable_label(i + 1 == done, text).clicked() {
                to = Some(i + 1);
            }
        }
    });
    to
}

/// The help window.
pub(crate) fn help(ctx: &Context, open: &mut bool) {
    let rows = if *open { keys::help(ctx) } else { Vec::new() };
    Window::new(tr("Keys and pointer")).open(open).resizable(false).show(ctx, |ui| {
        ScrollArea::vertical().max_height(ctx.content_rect().height() - 90.0).show(ui, |ui| {
            Grid::new("keys").num_columns(2).striped(true).show(ui, |ui| {
                for (keys, what) in rows {
                    ui.strong(keys);
                    ui.label(what);
                    ui.end_row();
                }
            });
        });
    });
}
