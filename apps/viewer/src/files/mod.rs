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

use std::path::{Path, PathBuf};
use std::sync::mpsc::Receiver;

/// Receiver of the files to open; empty if the user cancelled.
pub(crate) type Inputs = Receiver<Result<Vec<PathBuf>, String>>;

/// A name in `folder` that no file has: `stem.ending`, or with a number where that is taken.
pub(crate) fn free_name(folder: &Path, stem: &str, ending: &str) -> PathBuf {
    let plain = folder.join(format!("{stem}.{ending}"));
    if !plain.exists() {
        return plain;
    }
    let numbered = (2..1000).map(|number| folder.join(format!("{stem}-{number}.{ending}")));
    numbered.into_iter().find(|path| !path.exists()).unwrap_or(plain)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_of_earlier_files_are_not_taken_again() {
        let folder = tempfile::tempdir().expect("folder");
        for name in ["recovered.toml", "recovered-2.toml", "recovered-3.toml"] {
            let path = free_name(folder.path(), "recovered", "toml");
            assert_eq!(path.file_name().and_then(|n| n.to_str()), Some(name));
            std::fs::write(path, "kept").expect("written");
        }
    }
}
