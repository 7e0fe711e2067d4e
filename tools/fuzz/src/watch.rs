//! Watches the cases that run: ends the process with one line if one takes too long or too much memory.

use std::sync::{Mutex, PoisonError};
use std::time::{Duration, Instant};

/// Limits of one case.
#[derive(Debug, Clone, Copy)]
pub struct Limits {
    /// Longest time of a core. On a busy machine the clock may show up to twenty times as much.
    pub time: Duration,
    /// Most resident memory of the process beyond that at the start, bytes.
    pub memory: u64,
}

/// Time by the clock that is allowed per time of a core.
const BUSY: u32 = 20;

/// A case that runs.
#[derive(Debug, Clone)]
struct Running {
    name: String,
    begun: Instant,
    /// Time of all cores that the process had taken by then.
    spent: Option<Duration>,
}

/// The cases that run, one per worker.
#[derive(Debug)]
pub struct Watch {
    cases: Mutex<Vec<Option<Running>>>,
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
        let case = Running { name: case, begun: Instant::now(), spent: spent() };
        self.cases.lock().unwrap_or_else(PoisonError::into_inner)[worker] = Some(case);
    }

    /// A worker has ended its case.
    pub fn end(&self, worker: usize) {
        self.cases.lock().unwrap_or_else(PoisonError::into_inner)[worker] = None;
    }

    /// The first limit that is passed now, as a sentence that names the cases.
    pub fn broken(&self) -> Option<String> {
        let cases = self.cases.lock().unwrap_or_else(PoisonError::into_inner);
        // The workers take the time of cores together.
        let share = |all: Duration| all / u32::try_from(cases.len()).unwrap_or(u32::MAX);
        let is_late = |case: &&Running| {
            let taken = spent().zip(case.spent).map(|(now, then)| share(now.saturating_sub(then)));
            taken.is_some_and(|t| t > self.limits.time) || case.begun.elapsed() > BUSY * self.limits.time
        };
        if let Some(late) = cases.iter().flatten().find(is_late) {
            return Some(format!("HANG: more than {:?}: {}", self.limits.time, late.name));
        }
        let grown = resident().saturating_sub(self.base);
        let names = || cases.iter().flatten().map(|case| case.name.as_str()).collect::<Vec<_>>().join(", ");
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

/// Time of all cores that the process has taken; `None` where the system does not tell.
fn spent() -> Option<Duration> {
    let text = std::fs::read_to_string("/proc/self/stat").ok()?;
    // Behind the name, which may hold blanks, the 12th and 13th words are ticks of a hundredth second.
    let words: Vec<&str> = text.rsplit(')').next()?.split_whitespace().collect();
    let ticks = words.get(11)?.parse::<u64>().ok()? + words.get(12)?.parse::<u64>().ok()?;
    Some(Duration::from_millis(10 * ticks))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn late_and_large_cases_are_named() {
        let limits = Limits { time: Duration::from_millis(50), memory: 64 << 20 };
        let watch = Watch::new(2, Limits { time: Duration::from_secs(600), ..limits });
        watch.begin(1, "gpx 7 12".into());
        assert_eq!(watch.broken(), None);
        let watch = Watch::new(2, limits);
        watch.begin(1, "gpx 7 12".into());
        std::thread::sleep(21 * limits.time);
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
