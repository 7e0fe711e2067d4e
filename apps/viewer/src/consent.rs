//! Asks whether a scene may read files outside its folder.

use crate::language::{fill, tr};
use belvedere::Trust;
use belvedere::core::plain;
use eframe::egui::{Context, ScrollArea, Window};
use std::path::{Path, PathBuf};

/// Height of the list of files, points; longer lists scroll.
const LIST: f32 = 220.0;

/// A scene that waits for the user's consent.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) struct Consent {
    pub(crate) scene: PathBuf,
    /// The files, canonical paths.
    pub(crate) files: Vec<PathBuf>,
}

/// What the user decided.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Decision {
    /// The scene may read the files.
    Allowed,
    /// It is not opened.
    Refused,
}

impl Consent {
    /// The question for files to open; `None` if there is nothing to ask. In a browser all files are given by the user.
    pub(crate) fn needed(paths: &[PathBuf], allowed: &[PathBuf], trust: &Trust) -> Option<Self> {
        let [scene] = paths else { return None };
        let ending = scene.extension()?.to_str()?.to_ascii_lowercase();
        if cfg!(target_family = "wasm") || !["toml", "json"].contains(&ending.as_str()) {
            return None;
        }
        // What is wrong with the scene is said when it is opened.
        let files = trust.lacking(scene, allowed).ok().filter(|files| !files.is_empty())?;
        Some(Self { scene: scene.clone(), files })
    }

    /// Shows the question.
    pub(crate) fn show(&self, ctx: &Context) -> Option<Decision> {
        let mut decision = None;
        let room = ctx.content_rect();
        Window::new(tr("Files outside the folder of the scene"))
            .collapsible(false)
            .default_pos(room.center() - eframe::egui::vec2(240.0, 120.0))
            .show(ctx, |ui| {
                ui.set_width(480.0);
                let name = self.scene.file_name().unwrap_or_default().to_string_lossy();
                ui.label(fill(tr("{0} names files that do not lie in its folder:"), &[&name]));
                ScrollArea::vertical().max_height(LIST).auto_shrink([false, true]).show(ui, |ui| {
                    for file in &self.files {
                        // Names come from files.
                        ui.label(plain::escaped(&file.display().to_string()));
                    }
                });
                ui.label(tr("Allow this if you know where the scene comes from. It is remembered for this scene and these files."));
                ui.horizontal(|ui| {
                    let allow = tr(if self.files.len() == 1 { "Allow this file" } else { "Allow these files" });
                    if ui.button(allow).clicked() {
                        decision = Some(Decision::Allowed);
                    }
                    if ui.button(tr("Do not open")).clicked() {
                        decision = Some(Decision::Refused);
                    }
                });
            });
        decision
    }

    /// Gives and remembers the consent.
    ///
    /// # Errors
    /// One sentence, if it cannot be remembered; it is given nevertheless.
    pub(crate) fn give(&self, trust: &mut Trust) -> Result<(), String> {
        let files = [self.files.clone(), trust.files_of(&self.scene)].concat();
        remember(trust, &self.scene, &files).map(drop)
    }
}

/// Lets a scene read these files outside its folder from now on, and no others. Returns whether other programs know of it.
///
/// # Errors
/// One sentence, if it cannot be remembered; the consent holds in this window.
pub(crate) fn remember(trust: &mut Trust, scene: &Path, files: &[PathBuf]) -> Result<bool, String> {
    let said = |e: belvedere::BelvedereError| fill(tr("the consent is not remembered: {0}"), &[&e]);
    trust.give(scene, files).map_err(said)?;
    trust.remember(scene, files).map_err(said)
}
