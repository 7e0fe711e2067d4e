//! One reader under libFuzzer: the one that the environment variable `BELVEDERE_READER` names.
#![no_main]

use belvedere_fuzz::campaign::named;
use belvedere_fuzz::readers::{MAX_BYTES, Reader};
use libfuzzer_sys::fuzz_target;
use std::sync::LazyLock;

/// The reader, and a folder with the files beside its own.
static READER: LazyLock<(&'static Reader, tempfile::TempDir)> = LazyLock::new(|| {
    let name = std::env::var("BELVEDERE_READER").unwrap_or_default();
    let reader = named(&name).expect("BELVEDERE_READER names a reader; `cargo run -p belvedere-fuzz -- list` lists them");
    belvedere::io::budget::set(2 * MAX_BYTES);
    let folder = tempfile::tempdir().expect("a folder for temporary files");
    reader.prepare(folder.path()).expect("files beside the mutated one");
    (reader, folder)
});

fuzz_target!(|bytes: &[u8]| {
    let (reader, folder) = &*READER;
    if let Err(text) = reader.read(bytes, folder.path()) {
        assert!(!text.starts_with("internal error"), "{text}");
    }
});
