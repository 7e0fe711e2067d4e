//! Language and theme of the window: chosen in its menu, remembered.

use crate::language::{self, LANGUAGES, tr};
use eframe::egui::{Context, ThemePreference, Ui};
use serde::{Deserialize, Serialize};
use std::path::PathBuf;

/// Name of the kept settings.
const NAME: &str = "settings.json";

/// The settings, and where they are kept.
#[derive(Debug)]
pub(crate) struct Settings {
    chosen: Chosen,
    /// Tag of the system's language.
    system: String,
    folder: Option<PathBuf>,
}

#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
#[serde(default)]
struct Chosen {
    /// Tag of the language; `None`: that of the system.
    language: Option<String>,
    theme: Theme,
}

/// Colours of the window.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize)]
enum Theme {
    #[default]
    System,
    Light,
    Dark,
}

impl From<Theme> for ThemePreference {
    fn from(theme: Theme) -> Self {
        match theme {
            Theme::System => Self::System,
            Theme::Light => Self::Light,
            Theme::Dark => Self::Dark,
        }
    }
}

impl Settings {
    /// The kept settings, in force from now on.
    ///
    /// * `folder`: where they are kept; a browser keeps them itself. `system`: tag of the system's language.
    pub(crate) fn new(ctx: &Context, folder: Option<PathBuf>, system: String) -> Self {
        #[cfg(target_family = "wasm")]
        let text = storage().and_then(|storage| storage.get_item(NAME).ok().flatten());
        #[cfg(not(target_family = "wasm"))]
        let text = folder.as_ref().and_then(|folder| std::fs::read_to_string(folder.join(NAME)).ok());
        let chosen = text.and_then(|text| serde_json::from_str(&text).ok()).unwrap_or_default();
        let settings = Self { chosen, system, folder };
        ctx.set_theme(ThemePreference::from(settings.chosen.theme));
        settings.speak();
        settings
    }

    /// Lets this thread speak the chosen language.
    pub(crate) fn speak(&self) {
        language::speak(self.chosen.language.as_deref().unwrap_or(&self.system));
    }

    /// The entries of the menu.
    pub(crate) fn menu(&mut self, ui: &mut Ui) {
        let mut next = self.chosen.clone();
        ui.weak(tr("Language"));
        ui.radio_value(&mut next.language, None, tr("Language of the system"));
        for (tag, name) in [("en", "English")].into_iter().chain(LANGUAGES.map(|(tag, name, _)| (tag, name))) {
            ui.radio_value(&mut next.language, Some(tag.to_owned()), name);
        }
        ui.separator();
        ui.weak(tr("Colours"));
        for (theme, name) in
            [(Theme::System, tr("Light or dark as the system")), (Theme::Light, tr("Light")), (Theme::Dark, tr("Dark"))]
        {
            ui.radio_value(&mut next.theme, theme, name);
        }
        if next != self.chosen {
            self.chosen = next;
            self.speak();
            ui.ctx().set_theme(ThemePreference::from(self.chosen.theme));
            ui.ctx().request_repaint();
            self.keep();
        }
    }

    /// Errors are ignored: nothing depends on the settings.
    fn keep(&self) {
        let text = serde_json::to_string(&self.chosen).unwrap_or_default();
        #[cfg(target_family = "wasm")]
        if let Some(storage) = storage() {
            let _ = storage.set_item(NAME, &text);
        }
        if let Some(folder) = &self.folder {
            let _ = std::fs::create_dir_all(folder);
            let _ = belvedere::output::write_text(&folder.join(NAME), &text, true);
        }
    }
}

/// What the browser keeps for the page.
#[cfg(target_family = "wasm")]
fn storage() -> Option<web_sys::Storage> {
    web_sys::window()?.local_storage().ok().flatten()
}
