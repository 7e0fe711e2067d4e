//! Watches the cases that run: ends the process with one line if one takes too long or too much memory.

use std::sync::{Mutex, PoisonError};
use std::time::{Duration, Instant};

/// Limits of one case.
#[derive(Debug, Clone, Copy)]
pub struct Limits {
    /// Longest time.
    pub time: Duration,
    /// Most resident memory of the process beyond that at the start, bytes.
    pub memory: u64,
}

/// The cases that run, one per worker.
#[derive(Debug)]
pub struct Watch {
    cases: Mutex<Vec<Option<(String, Instant)>>>,
    /// Resident memory at the start, bytes.
    base: u64,
    limits: Limits,
}

impl Watch {
    /// A watch over some workers.
    pub fn new(workers: usize, limits: Limits) -> Self {
        Self { cases: Mutex::new(vec![None; workers]), base: resident(), limits }
    }

    /// A worker begins a case.
    pub fn begin(&self, worker: usize, case: String) {
        self.cases.lock().unwrap_or_else(PoisonError::into_inner)[worker] = Some((case, Instant::now()));
    }

    /// A worker has ended its case.
    pub fn end(&self, worker: usize) {
        self.cases.lock().unwrap_or_else(PoisonError::into_inner)[worker] = None;
    }

    /// The first limit that is passed now, as a sentence that names the cases.
    pub fn broken(&self) -> Option<String> {
        let cases = self.cases.lock().unwrap_or_else(PoisonError::into_inner);
        let late = cases.iter().flatten().find(|(_, begun)| begun.elapsed() > self.limits.time);
        if let Some((case, _)) = late {
            return Some(format!("HANG: more than {:?}: {case}", self.limits.time));
        }
        let grown = resident().saturating_sub(self.base);
        let names = || cases.iter().flatten().map(|(case, _)| case.as_str()).collect::<Vec<_>>().join(", ");
        (grown > self.limits.memory).then(|| format!("MEMORY: {} MiB more than at the start: {}", grown >> 20, names()))
    }

    /// Looks every few milliseconds until `done`, and ends the process if a limit is passed.
    #[allow(clippy::print_stderr, reason = "the process ends here, because a thread cannot be stopped")]
    pub fn look(&self, done: impl Fn() -> bool) {
        while !done() {
            if let Some(broken) = self.broken() {
                eprintln!("{broken}");
                std::process::exit(3);
            }
            std::thread::sleep(Duration::from_millis(4));
        }
    }
}

/// Resident memory of the process, bytes; 0 where the system does not tell.
fn resident() -> u64 {
    let text = std::fs::read_to_string("/proc/self/statm").unwrap_or_default();
    let pages = text.split_whitespace().nth(1).and_then(|n| n.parse::<u64>().ok());
    pages.unwrap_or(0) * 4096
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn late_and_large_cases_are_named() {
        let limits = Limits { time: Duration::from_millis(20), memory: 64 << 20 };
        let watch = Watch::new(2, limits);
        watch.begin(1, "gpx 7 12".into());
        assert_eq!(watch.broken(), None);
        std::thread::sleep(Duration::from_millis(30));
        assert!(watch.broken().is_some_and(|text| text.starts_with("HANG") && text.contains("gpx 7 12")));
        watch.end(1);
        assert_eq!(watch.broken(), None);
        let watch = Watch::new(1, Limits { time: Duration::from_secs(600), ..limits });
        watch.begin(0, "png 7 3".into());
        if resident() > 0 {
            let large = std::hint::black_box(vec![1u8; 128 << 20]);
            let broken = watch.broken();
            assert!(broken.is_some_and(|text| text.starts_with("MEMORY") && text.contains("png 7 3")) && large[9] == 1);
        }
    }
}
