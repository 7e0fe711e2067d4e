//! Values of arguments.

use belvedere::verbs::reveal::MOST_DRAFTS;

/// Most worker threads: far above what helps, far below what a system refuses to start.
const MAX_THREADS: usize = 1024;

/// Parses a number of threads, 0..=1024.
pub(crate) fn parse_threads(text: &str) -> Result<usize, String> {
    text.parse().ok().filter(|n| *n <= MAX_THREADS).ok_or_else(|| format!("give a whole number in 0..={MAX_THREADS}"))
}

/// Parses a time in seconds, > 0.
pub(crate) fn parse_seconds(text: &str) -> Result<f64, String> {
    let seconds = text.trim().parse().ok().filter(|s: &f64| *s > 0.0 && *s <= 1e9);
    seconds.ok_or_else(|| "give seconds greater than 0, such as 20".into())
}

/// Parses a number of drafts.
pub(crate) fn parse_drafts(text: &str) -> Result<usize, String> {
    let count = text.trim().parse().ok().filter(|n| (1..=MOST_DRAFTS).contains(n));
    count.ok_or_else(|| format!("give a whole number in 1..={MOST_DRAFTS}"))
}

/// Parses a factor in 0.1..=1.
pub(crate) fn parse_scale(text: &str) -> Result<f64, String> {
    text.trim().parse().ok().filter(|v| (0.1..=1.0).contains(v)).ok_or("give a factor in 0.1..=1, such as 0.5".into())
}

/// Parses a size in bytes, at least 1 MiB, such as `512MiB`, `2GB` or `100000`.
pub(crate) fn parse_bytes(text: &str) -> Result<u64, String> {
    let split = text.find(|c: char| !c.is_ascii_digit() && c != '.').unwrap_or(text.len());
    let (number, unit) = text.split_at(split);
    let scale = match unit.trim().to_ascii_lowercase().as_str() {
        "" | "b" => 1.0,
        "k" | "kib" => 1024.0,
        "kb" => 1e3,
        "m" | "mib" => 1024.0 * 1024.0,
        "mb" => 1e6,
        "g" | "gib" => 1024.0 * 1024.0 * 1024.0,
        "gb" => 1e9,
        _ => return Err("give a size such as 800MiB or 2GiB".into()),
    };
    match number.parse::<f64>() {
        Ok(n) if n * scale >= 1024.0 * 1024.0 && n * scale <= 1e15 => Ok((n * scale) as u64),
        _ => Err("give a size of at least 1MiB, such as 800MiB or 2GiB".into()),
    }
}
