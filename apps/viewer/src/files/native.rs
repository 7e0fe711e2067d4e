//! Files of the system, chosen in its own windows, or in ours where it has none.

use super::Inputs;
use super::ask::Ask;
use eframe::egui::{Context, DroppedFileHandle};
use std::path::{Path, PathBuf};
use std::sync::mpsc::{self, Receiver, TryRecvError};
use std::time::{Duration, Instant};

/// An empty answer sooner than this means that the system showed no window.
const TOO_SOON: Duration = Duration::from_millis(400);

/// A pending question for files.
#[derive(Debug)]
pub(crate) struct Choosing {
    /// Receives `None` where the system has no window for files.
    inbox: Receiver<Option<Vec<PathBuf>>>,
    own: Ask,
    is_own: bool,
}

impl Choosing {
    fn new(system: bool, own: Ask, ask: impl FnOnce() -> Option<Vec<PathBuf>> + Send + 'static) -> Self {
        let (outbox, inbox) = mpsc::channel();
        if system {
            std::thread::spawn(move || {
                let began = Instant::now();
                let answer = ask().or_else(|| (began.elapsed() > TOO_SOON).then(Vec::new));
                let _ = outbox.send(answer);
            });
        }
        Self { inbox, own, is_own: !system }
    }

    /// The answer, if it has arrived; empty if the user cancelled.
    ///
    /// # Errors
    /// None.
    pub(crate) fn answer(&mut self, ctx: &Context) -> Option<Result<Vec<PathBuf>, String>> {
        if self.is_own {
            return self.own.show(ctx).map(Ok);
        }
        match self.inbox.try_recv() {
            Ok(Some(files)) => return Some(Ok(files)),
            Ok(None) | Err(TryRecvError::Disconnected) => self.is_own = true,
            Err(TryRecvError::Empty) => {}
        }
        ctx.request_repaint_after_secs(0.1);
        None
    }
}

/// Asks the user for a file to write; the answer comes later.
///
/// * `folder`: where the window opens. `system`: whether to use a window of the system, if it has one.
pub(crate) fn choose_output(folder: &Path, name: &str, system: bool) -> Choosing {
    let dialog = rfd::FileDialog::new().set_file_name(name);
    let dialog = if folder.as_os_str().is_empty() { dialog } else { dialog.set_directory(folder) };
    Choosing::new(system, Ask::output(folder, name), move || dialog.save_file().map(|path| vec![path]))
}

/// Lets the user choose a scene, or data.
///
/// * `system`: whether to use a window of the system, if it has one.
pub(crate) fn choose_input(system: bool) -> Choosing {
    Choosing::new(system, Ask::input(), || rfd::FileDialog::new().pick_files())
}

/// Files that were dropped on the window.
pub(crate) fn dropped(files: &[DroppedFileHandle]) -> Inputs {
    let (outbox, inbox) = mpsc::channel();
    let _ = outbox.send(Ok(files.iter().map(|file| file.path().to_owned()).collect()));
    inbox
}

/// Does nothing: the file is already at the path that the user chose.
pub(crate) fn hand_over(_: &Path) -> Result<(), String> {
    Ok(())
}

/// Folder of the application's state; `None` where the system defines no such folder.
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
