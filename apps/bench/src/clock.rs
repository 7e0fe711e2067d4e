//! Processor time of all threads where the system tells it (Linux), wall time elsewhere.

use std::time::Instant;

/// Least processor time reported, milliseconds: the system counts running threads at its ticks, and shorter times may read as 0.
const LEAST_MS: f64 = 1e-3;

/// Measures one piece of work.
pub struct Stopwatch {
    wall: Instant,
    cpu_ms: Option<f64>,
}

impl Stopwatch {
    /// Begins now.
    pub fn start() -> Self {
        Self { cpu_ms: cpu_ms(), wall: Instant::now() }
    }

    /// Wall time since the start, milliseconds.
    pub fn wall_ms(&self) -> f64 {
        self.wall.elapsed().as_secs_f64() * 1e3
    }

    /// Processor time since the start, milliseconds; `None` where the system does not tell.
    pub fn cpu_ms(&self) -> Option<f64> {
        self.cpu_ms.zip(cpu_ms()).map(|(a, b)| (b - a).max(LEAST_MS))
    }
}

/// Name of the clock that [`Stopwatch::cpu_ms`] reads on this machine.
pub(crate) fn name() -> &'static str {
    if cpu_ms().is_some() { "processor time of all threads" } else { "wall time" }
}

/// Processor time of all threads so far, milliseconds; the kernel of Linux counts it in nanoseconds.
fn cpu_ms() -> Option<f64> {
    let of_task = |t: std::fs::DirEntry| {
        let text = std::fs::read_to_string(t.path().join("schedstat")).ok()?;
        text.split(' ').next()?.parse::<f64>().ok()
    };
    Some(std::fs::read_dir("/proc/self/task").ok()?.flatten().filter_map(of_task).sum::<f64>() * 1e-6)
}

/// Processor time of the process so far, that of threads that ended included, milliseconds; Linux counts it in steps of 10 ms. 0 where the
/// system does not tell.
pub(crate) fn process_ms() -> f64 {
    let text = std::fs::read_to_string("/proc/self/stat").unwrap_or_default();
    // Behind the name, which may hold spaces: user and system time are numbers 12 and 13, in hundredths of a second.
    let fields = text.rsplit_once(')').map(|(_, fields)| fields.split_whitespace());
    fields.map_or(0.0, |fields| fields.skip(11).take(2).filter_map(|t| t.parse::<f64>().ok()).sum::<f64>() * 10.0)
}

/// Figures of `/proc/self/status`, MiB; 0 where the system does not tell.
pub fn status_mib(key: &str) -> f64 {
    let text = std::fs::read_to_string("/proc/self/status").unwrap_or_default();
    let line = text.lines().find_map(|l| l.strip_prefix(key)?.strip_prefix(':'));
    line.and_then(|l| l.trim().trim_end_matches(" kB").parse::<f64>().ok()).unwrap_or(0.0) / 1024.0
}

/// Load average of the system over the last minute; `None` where the system does not tell.
pub(crate) fn load() -> Option<f64> {
    std::fs::read_to_string("/proc/loadavg").ok()?.split(' ').next()?.parse().ok()
}

/// Processor, as the system names it.
pub(crate) fn processor() -> String {
    let text = std::fs::read_to_string("/proc/cpuinfo").unwrap_or_default();
    let name = text.lines().find_map(|l| l.strip_prefix("model name")?.split_once(':').map(|(_, name)| name.trim()));
    name.unwrap_or(std::env::consts::ARCH).to_owned()
}

/// The value that `share` of all values do not exceed; 0 without values.
pub fn quantile(mut values: Vec<f64>, share: f64) -> f64 {
    belvedere::core::quantile::quantile(&mut values, share, belvedere::core::quantile::Rank::Upper)
}

/// Middle value; 0 without values.
pub fn median(values: Vec<f64>) -> f64 {
    quantile(values, 0.5)
}
