//! Values of arguments.

use belvedere::places::Place;
use belvedere::request::parse::with_height;
use belvedere::scene_file::HighlightMark;
use belvedere::verbs::animate::Part;
use belvedere::verbs::drafts::MOST_DRAFTS;

/// Most worker threads: far above what helps, far below what a system refuses to start.
const MAX_THREADS: usize = 1024;

/// Eye and target of a picture of the camera; `None`: they are chosen automatically.
pub(crate) type Outside = Option<[Place; 2]>;

/// Parses a number of threads, 0..=1024.
pub(crate) fn parse_threads(text: &str) -> Result<usize, String> {
    text.parse().ok().filter(|n| *n <= MAX_THREADS).ok_or_else(|| format!("give a whole number in 0..={MAX_THREADS}"))
}

/// Parses a time in seconds, > 0.
pub(crate) fn parse_seconds(text: &str) -> Result<f64, String> {
    let seconds = text.trim().parse().ok().filter(|s: &f64| *s > 0.0 && *s <= 1e9);
    seconds.ok_or_else(|| "give seconds greater than 0, such as 20".into())
}

/// Parses a permitted error in pixels, 0..=64.
pub(crate) fn parse_lod(text: &str) -> Result<f64, String> {
    let px = text.parse().ok().filter(|px| (0.0..=64.0).contains(px));
    px.ok_or_else(|| "give an error in pixels in 0..=64; 0 draws every cell".into())
}

/// Parses the name of a mark that shows the displacement.
pub(crate) fn parse_highlight(text: &str) -> Result<HighlightMark, String> {
    match text.trim() {
        "shift" => Ok(HighlightMark::Shift),
        "stages" => Ok(HighlightMark::Stages),
        "revealed" => Ok(HighlightMark::Revealed),
        "ghost-box" | "ghost_box" => Ok(HighlightMark::GhostBox),
        _ => Err("possible: shift or stages, revealed, ghost-box, separated by commas".into()),
    }
}

/// Parses a number of drafts.
pub(crate) fn parse_drafts(text: &str) -> Result<usize, String> {
    let count = text.trim().parse().ok().filter(|n| (1..=MOST_DRAFTS).contains(n));
    count.ok_or_else(|| format!("give a whole number in 1..={MOST_DRAFTS}"))
}

/// Parses `phi`, `phi=25:80` or `phi=25:80:0.5`, degrees; values that are not given are 0.
pub(crate) fn parse_sweep(text: &str) -> Result<[f64; 3], String> {
    let wrong = || "give phi, or phi=FIRST:LAST[:STEP] in degrees, such as phi=25:80".to_owned();
    if text == "phi" {
        return Ok([0.0; 3]);
    }
    let range = text.strip_prefix("phi=").ok_or_else(wrong)?;
    let numbers: Option<Vec<f64>> =
        range.split(':').map(|t| t.trim().parse().ok().filter(|v: &f64| v.is_finite())).collect();
    match numbers.as_deref() {
        Some([first, last]) if first != last => Ok([*first, *last, 0.0]),
        Some([first, last, step]) if first != last && *step > 0.0 => Ok([*first, *last, *step]),
        _ => Err(wrong()),
    }
}

/// Parses the first and the last frame of a part, such as `0:249`.
pub(crate) fn parse_part(text: &str) -> Result<Part, String> {
    let ends: Option<Vec<usize>> = text.split(':').map(|end| end.trim().parse().ok()).collect();
    match ends.as_deref() {
        Some([first, last]) if first <= last => Ok(*first..=*last),
        _ => Err("give FIRST:LAST, frames counted from 0, such as 0:249".into()),
    }
}

/// Parses a factor in 0.1..=1.
pub(crate) fn parse_scale(text: &str) -> Result<f64, String> {
    text.trim().parse().ok().filter(|v| (0.1..=1.0).contains(v)).ok_or("give a factor in 0.1..=1, such as 0.5".into())
}

/// Parses `auto`, or eye and target, each with a height.
pub(crate) fn parse_outside(text: &str) -> Result<Outside, String> {
    if text.trim() == "auto" {
        return Ok(None);
    }
    let at = text.match_indices(',').nth(2).map(|(at, _)| at);
    let (eye, target) = at.map(|at| (&text[..at], &text[at + 1..])).unwrap_or((text, ""));
    match [eye, target].map(with_height) {
        [Ok(eye), Ok(target)] => Ok(Some([eye, target])),
        _ => Err("give auto, or eye and target as X,Y,Z,X,Y,Z".into()),
    }
}

/// Parses a place without a height, such as `1.5,42.5`.
pub(crate) fn parse_position(text: &str) -> Result<Place, String> {
    let place: Place = text.parse()?;
    if place.has_height() { Err("give X,Y without a height".into()) } else { Ok(place) }
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
