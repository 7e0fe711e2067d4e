//! Many mutated files through many readers.

use crate::mutate::mutated;
use crate::readers::{READERS, Reader};
use crate::watch::{Limits, Watch};
use belvedere::core::random::{Random, mix};
use std::collections::BTreeMap;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::Path;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering::Relaxed};
use std::sync::{Mutex, PoisonError};
use std::time::Duration;

/// One mutated file; the same numbers give the same bytes.
#[derive(Debug, Clone, Copy)]
pub struct Case {
    /// Its reader.
    pub reader: &'static Reader,
    /// Seed of the campaign.
    pub seed: u64,
    /// Number of the file among those of the reader.
    pub number: u64,
}

impl std::fmt::Display for Case {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let Self { reader, seed, number } = self;
        write!(f, "cargo run --release -p belvedere-fuzz -- replay {} {seed} {number}", reader.name)
    }
}

impl Case {
    /// Content of the file.
    pub fn bytes(&self, seeds: &[Vec<u8>]) -> Vec<u8> {
        let name = self.reader.name.bytes().fold(0u64, |h, b| mix(h ^ u64::from(b)));
        mutated(seeds, &mut Random::new(mix(self.seed ^ mix(name)) ^ mix(self.number)))
    }

    /// Whether the reader accepts the file.
    ///
    /// # Errors
    /// Message and place of a panic.
    pub fn run(&self, seeds: &[Vec<u8>], folder: &Path) -> Result<bool, String> {
        let bytes = self.bytes(seeds);
        match catch_unwind(AssertUnwindSafe(|| self.reader.read(&bytes, folder))) {
            Ok(Ok(())) => Ok(true),
            Ok(Err(text)) if text.starts_with("internal error") => Err(format!("{text}, {}", last_panic())),
            Ok(Err(_)) => Ok(false),
            Err(_) => Err(last_panic()),
        }
    }
}

static LAST: Mutex<String> = Mutex::new(String::new());

fn last_panic() -> String {
    LAST.lock().unwrap_or_else(PoisonError::into_inner).clone()
}

/// Keeps message and place of panics; those of threads without a name, which run the cases, are not printed.
fn note_panics() {
    static ONCE: std::sync::Once = std::sync::Once::new();
    ONCE.call_once(|| {
        let usual = std::panic::take_hook();
        std::panic::set_hook(Box::new(move |info| {
            *LAST.lock().unwrap_or_else(PoisonError::into_inner) = info.to_string().replace('\n', " ");
            if std::thread::current().name().is_some() {
                usual(info);
            }
        }));
    });
}

/// Results of a campaign.
#[derive(Debug, Clone, Default)]
pub struct Outcome {
    /// For each reader, how many files it accepted and refused.
    pub counts: BTreeMap<&'static str, [usize; 2]>,
    /// Panics: command that repeats it, message and place.
    pub panics: Vec<String>,
    /// Longest time of one file, seconds, and its command.
    pub slowest: (f64, String),
}

/// Largest resident memory beyond that at the start, bytes: the budget of each worker's file, copies, and what allocators keep.
const MEMORY: u64 = 512 << 20;

/// Runs `inputs` mutated files, divided among `readers`, on `workers` threads. A hang or too much memory ends the process with one line.
///
/// * `time`: longest time of a core for one file.
pub fn run(readers: &[&'static Reader], inputs: usize, seed: u64, workers: usize, time: Duration) -> Outcome {
    belvedere::io::budget::set(2 * crate::readers::MAX_BYTES);
    note_panics();
    let watch = Watch::new(workers, Limits { time, memory: MEMORY });
    let (next, done, outcome) = (AtomicUsize::new(0), AtomicBool::new(false), Mutex::new(Outcome::default()));
    let work = |worker: usize| {
        // Readers in turn, each in a folder of its own with the files beside it.
        loop {
            let turn = next.fetch_add(1, Relaxed);
            let Some(reader) = readers.get(turn) else { return };
            let mine = (inputs + readers.len() - 1 - turn) / readers.len();
            let folder = tempfile::tempdir().expect("a folder for temporary files");
            reader.prepare(folder.path()).expect("files beside the mutated one");
            let seeds = (reader.seeds)();
            for number in 0..mine as u64 {
                let case = Case { reader, seed, number };
                watch.begin(worker, case.to_string());
                let begun = std::time::Instant::now();
                let result = case.run(&seeds, folder.path());
                watch.end(worker);
                let seconds = begun.elapsed().as_secs_f64();
                let mut outcome = outcome.lock().unwrap_or_else(PoisonError::into_inner);
                if seconds > outcome.slowest.0 {
                    outcome.slowest = (seconds, case.to_string());
                }
                let counts = outcome.counts.entry(reader.name).or_default();
                match result {
                    Ok(accepted) => counts[usize::from(!accepted)] += 1,
                    Err(panic) => outcome.panics.push(format!("{case}: {panic}")),
                }
            }
        }
    };
    std::thread::scope(|scope| {
        let watching = scope.spawn(|| watch.look(|| done.load(Relaxed)));
        let threads: Vec<_> = (0..workers).map(|worker| scope.spawn(move || work(worker))).collect();
        for thread in threads {
            thread.join().expect("workers catch panics");
        }
        done.store(true, Relaxed);
        watching.join().expect("the watch ends");
    });
    outcome.into_inner().unwrap_or_else(PoisonError::into_inner)
}

/// The reader of a name.
pub fn named(name: &str) -> Option<&'static Reader> {
    READERS.iter().find(|reader| reader.name == name)
}
