//! Files: chosen in the system's own windows; where the application keeps what it remembers.

use std::path::PathBuf;
use std::sync::mpsc::{self, Receiver};

/// Lets the user choose where to write; the answer comes later.
pub(crate) fn choose_output(name: &str) -> Receiver<Option<PathBuf>> {
    let name = name.to_owned();
    elsewhere(move || rfd::FileDialog::new().set_file_name(name).save_file())
}

/// Lets the user choose a scene, or data.
pub(crate) fn choose_input() -> Receiver<Option<Vec<PathBuf>>> {
    elsewhere(|| rfd::FileDialog::new().pick_files())
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
