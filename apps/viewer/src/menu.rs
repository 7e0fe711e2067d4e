//! The menu bar: files, undo steps, bookmarks.

use crate::builtin::BUILTIN;
use crate::keys::{Command, KEYS};
use crate::language::{fill, heard, tr};
use crate::model::Model;
use crate::settings::Settings;
use belvedere::scene_file::CameraDoc;
use eframe::egui::{Context, Grid, Label, MenuBar, RichText, ScrollArea, Ui, Window};
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
    /// Undoes or redoes to that number of steps.
    Step(usize),
    Welcome,
    /// The browser forgets the files that it keeps.
    #[cfg(target_family = "wasm")]
    ForgetFiles,
    Quit,
}

/// A camera kept under a name.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub(crate) struct Bookmark {
    pub(crate) name: String,
    pub(crate) camera: CameraDoc,
}

/// Shows the bar.
pub(crate) fn bar(
    ui: &mut Ui,
    model: &mut Model,
    settings: &mut Settings,
    recent: &[PathBuf],
    bookmarks: &[Bookmark],
) -> Option<Choice> {
    let mut choice = None;
    MenuBar::new().ui(ui, |ui| {
        ui.menu_button(tr("File"), |ui| {
            if ui.button(tr("Open…")).clicked() {
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
            if ui.button(tr("Save")).clicked() {
                choice = Some(Choice::Command(Command::Save));
            }
            if ui.button(tr("Save as…")).clicked() {
                choice = Some(Choice::Command(Command::SaveAs));
            }
            #[cfg(target_family = "wasm")]
            {
                ui.separator();
                let forget = ui.button(tr("Forget my files"));
                let why = tr("The browser keeps the files that you open until another scene is opened.");
                if forget.on_hover_text(why).clicked() {
                    choice = Some(Choice::ForgetFiles);
                }
            }
            // A page is closed by its browser, which asks the same question.
            if cfg!(not(target_family = "wasm")) {
                ui.separator();
                if ui.button(tr("Quit")).clicked() {
                    choice = Some(Choice::Quit);
                }
            }
        });
        ui.menu_button(tr("Edit"), |ui| {
            let undo = eframe::egui::Button::new(tr("Undo"));
            if ui.add_enabled(model.editor.can_undo(), undo).clicked() {
                choice = Some(Choice::Command(Command::Undo));
            }
            let redo = eframe::egui::Button::new(tr("Redo"));
            if ui.add_enabled(model.editor.can_redo(), redo).clicked() {
                choice = Some(Choice::Command(Command::Redo));
            }
            ui.menu_button(tr("Steps"), |ui| {
                if let Some(steps) = steps(ui, model) {
                    choice = Some(Choice::Step(steps));
                }
            });
        });
        ui.menu_button(tr("Places"), |ui| {
            if ui.button(tr("Show all")).clicked() {
                choice = Some(Choice::Command(Command::ShowAll));
            }
            if ui.button(tr("Bookmark this view")).clicked() {
                choice = Some(Choice::Command(Command::Bookmark));
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
        });
        ui.menu_button(tr("View"), |ui| settings.menu(ui));
        ui.menu_button(tr("Help"), |ui| {
            if ui.button(tr("Keys and pointer")).clicked() {
                choice = Some(Choice::Command(Command::Help));
            }
            if ui.button(tr("Welcome and examples")).clicked() {
                choice = Some(Choice::Welcome);
            }
        });
        if ui.ctx().content_rect().width() >= 600.0 {
            ui.toggle_value(&mut model.look.panel, tr("Panel")).on_hover_text("P");
        }
        let title = &model.document().title;
        let state = if model.editor.is_changed() { tr("changed") } else { "" };
        ui.add(Label::new(RichText::new(format!("{title}  {state}")).weak()).truncate());
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
    Window::new(tr("Keys and pointer")).open(open).resizable(false).show(ctx, |ui| {
        Grid::new("keys").num_columns(2).striped(true).show(ui, |ui| {
            for (keys, what) in KEYS {
                ui.strong(tr(keys));
                ui.label(tr(what));
                ui.end_row();
            }
        });
    });
}
