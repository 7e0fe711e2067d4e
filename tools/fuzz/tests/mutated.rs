//! Ten thousand mutated files through every reader: no panic, no hang, bounded memory. The same files in every run.

use belvedere_fuzz::campaign;
use belvedere_fuzz::readers::READERS;
use std::time::Duration;

/// Files of a run.
const INPUTS: usize = 10_000;
/// Longest time of one file. Debug builds on busy machines are slow; a release build needs a tenth.
const TIME: Duration = Duration::from_secs(20);

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
    // Damage that every reader refuses at once would try nothing, damage that it never refuses is none.
    for (name, [accepted, refused]) in outcome.counts {
        assert!(
            accepted >= 5 && (refused >= 5 || name == "trust_record"),
            "{name}: {accepted} accepted, {refused} refused"
        );
    }
}
