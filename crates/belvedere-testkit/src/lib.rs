//! Law suites, data helpers and synthetic scenes for the tests of the workspace.

pub mod font;
pub mod laws;
pub mod rays;
pub mod synthetic;

pub use belvedere_core::random::Random;

use std::path::{Path, PathBuf};

/// Root of the workspace.
pub fn workspace_root() -> PathBuf {
    let here = Path::new(env!("CARGO_MANIFEST_DIR"));
    here.ancestors().nth(2).expect("a crate lies two folders below the root").to_path_buf()
}

/// Path of a file of the real-data collection, or `None` (with a printed message) if the collection does not exist.
///
/// The collection is expected in `$BELVEDERE_DATA`, otherwise in `../shared/data` next to the workspace.
///
/// # Panics
/// If the file is missing and `BELVEDERE_REQUIRE_DATA=1`, as in continuous integration.
#[allow(clippy::print_stderr)]
pub fn data(relative: &str) -> Option<PathBuf> {
    let root =
        std::env::var_os("BELVEDERE_DATA").map_or_else(|| workspace_root().join("../shared/data"), PathBuf::from);
    let path = root.join(relative);
    if path.exists() {
        return Some(path);
    }
    let required = std::env::var("BELVEDERE_REQUIRE_DATA").is_ok_and(|v| v == "1");
    assert!(!required, "test data {} is missing and BELVEDERE_REQUIRE_DATA=1", path.display());
    eprintln!("SKIPPED: test data {} is missing; set BELVEDERE_DATA", path.display());
    None
}
