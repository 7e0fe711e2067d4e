//! Files of the system, chosen in its own windows.

use super::Inputs;
use eframe::egui::DroppedFileHandle;
use std::path::{Path, PathBuf};
use std::sync::mpsc::{self, Receiver};

/// Lets the user choose where to write; the answer comes later.
///
/// * `folder`: where to look first.
pub(crate) fn choose_output(folder: &Path, name: &str) -> Receiver<Option<PathBuf>> {
    let dialog = rfd::FileDialog::new().set_file_name(name);
    let dialog = if folder.as_os_str().is_empty() { dialog } else { dialog.set_directory(folder) };
    elsewhere(move || dialog.save_file())
}

/// Lets the user choose a scene, or data.
pub(crate) fn choose_input() -> Inputs {
    elsewhere(|| Ok(rfd::FileDialog::new().pick_files().unwrap_or_default()))
}

/// Files that were dropped on the window.
pub(crate) fn dropped(files: &[DroppedFileHandle]) -> Inputs {
    let (outbox, inbox) = mpsc::channel();
    let _ = outbox.send(Ok(files.iter().map(|file| file.path().to_owned()).collect()));
    inbox
}

/// A file that was written is where the user wanted it.
pub(crate) fn hand_over(_: &Path) -> Result<(), String> {
    Ok(())
}

fn elsewhere<T: Send + 'static>(ask: impl FnOnce() -> T + Send + 'static) -> Receiver<T> {
    let (outbox, inbox) = mpsc::channel();
    std::thread::spawn(move || {
        let _ = outbox.send(ask());
    });
    inbox
}

/// Where the application keeps what it remembers; `None` where the system has no such place.
pub(crate) fn state_folder() -> Option<PathBuf> {
    let var = |name: &str| std::env::var_os(name).filter(|value| !value.is_empty()).map(PathBuf::from);
    let base = if cfg!(target_os = "windows") {
        var("LOCALAPPDATA")
    } else if cfg!(target_os = "macos") {
        var("HOME").map(|home| home.join("Library/Application Support"))
    } else {
        var("XDG_STATE_HOME").or_else(|| var("HOME").map(|home| home.join(".local/state")))
    };
    Some(base?.join("belvedere"))
}
