//! Processor time and memory of a piece of work, as Linux counts them.

use std::fs;

/// What was spent when the work began.
pub(crate) struct Cost(f64);

impl Cost {
    pub(crate) fn begin() -> Self {
        // Begins the peak anew.
        let _ = fs::write("/proc/self/clear_refs", "5");
        Self(processor_seconds())
    }

    /// Seconds of all threads since, and the peak of resident memory, MiB.
    pub(crate) fn end(self) -> (f64, f64) {
        let status = fs::read_to_string("/proc/self/status").unwrap_or_default();
        let peak = status.lines().find_map(|l| l.strip_prefix("VmHWM:")?.split_whitespace().next()?.parse().ok());
        (processor_seconds() - self.0, peak.unwrap_or(f64::NAN) / 1024.0)
    }
}

fn processor_seconds() -> f64 {
    let stat = fs::read_to_string("/proc/self/stat").unwrap_or_default();
    let after = stat.rsplit(')').next().unwrap_or_default();
    let ticks = |k: usize| after.split_whitespace().nth(k).and_then(|t| t.parse().ok()).unwrap_or(f64::NAN);
    (ticks(11) + ticks(12)) / 100.0
}
