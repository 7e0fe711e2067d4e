//! Ten thousand mutated files through every reader: no panic, no hang, bounded memory. The same files in every run.

use belvedere_fuzz::campaign;
use belvedere_fuzz::readers::READERS;
use std::time::Duration;

/// Files of a run.
const INPUTS: usize = 10_000;
/// Longest time of a core for one file; the slowest needs two seconds (the check of odd presets at 361 angles).
const TIME: Duration = Duration::from_secs(10);

/// Readers of parts that are left out with a warning where they are damaged. Damaged gzip, on the other hand, fails its checksum.
const WITH_A_WARNING: [&str; 5] = ["mtl", "texture_png", "texture_jpeg", "shapefile_table", "trust_record"];

#[test]
fn every_seed_is_read() {
    let mut refused = Vec::new();
    for reader in READERS {
        let folder = tempfile::tempdir().expect("a folder");
        reader.prepare(folder.path()).expect("files");
        for (k, bytes) in (reader.seeds)().iter().enumerate() {
            let read = reader.read(bytes, folder.path());
            refused.extend(read.err().map(|e| format!("seed {k} of {}: {e}", reader.name)));
        }
    }
    assert!(refused.is_empty(), "{}", refused.join("\n"));
}

#[test]
fn no_mutated_file_is_a_panic_or_a_hang() {
    let readers: Vec<_> = READERS.iter().collect();
    let outcome = campaign::run(&readers, INPUTS, 20_261_126, 2, TIME);
    assert!(outcome.panics.is_empty(), "{} panics:\n{}", outcome.panics.len(), outcome.panics.join("\n"));
    let all: usize = outcome.counts.values().flatten().sum();
    assert_eq!((all, outcome.counts.len()), (INPUTS, READERS.len()));
    // Damage that a reader always refuses would try nothing, damage that it never refuses is none.
    for (name, [accepted, refused]) in outcome.counts {
        assert!(accepted > 0 || name == "gzip", "{name}: {refused} refused, none accepted");
        assert!(refused > 0 || WITH_A_WARNING.contains(&name), "{name}: {accepted} accepted, none refused");
    }
}
