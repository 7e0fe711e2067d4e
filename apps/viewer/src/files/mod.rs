//! Files: chosen by the user, dropped on the window, handed over; the folder of the application's state.

#[cfg(not(target_family = "wasm"))]
mod ask;
#[cfg(target_family = "wasm")]
mod browser;
#[cfg(not(target_family = "wasm"))]
mod native;

#[cfg(target_family = "wasm")]
pub(crate) use browser::{Choosing, choose_input, choose_output, dropped, hand_over};
#[cfg(not(target_family = "wasm"))]
pub(crate) use native::{Choosing, choose_input, choose_output, dropped, hand_over, state_folder};

use std::path::PathBuf;
use std::sync::mpsc::Receiver;

/// Receiver of the files to open; empty if the user cancelled.
pub(crate) type Inputs = Receiver<Result<Vec<PathBuf>, String>>;
