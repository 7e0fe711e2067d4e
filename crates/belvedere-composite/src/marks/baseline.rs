//! Baselines of names along lines: beside the line, smoother than it, and so that no letter stands on it or upside down.

use belvedere_core::{DVec2, polygon::to_segment};

/// Middles of the stretches that are tried, shares of the line.
const MIDDLES: [f64; 9] = [0.5, 0.4, 0.6, 0.3, 0.7, 0.2, 0.8, 0.1, 0.9];
/// Most turn of the baseline within the height of a letter, radians.
const MOST_TURN: f64 = 0.45;
/// Least share of a letter's direction that points to the right.
const LEAST_RIGHT: f64 = 0.25;
/// Samples to each side that a baseline is smoothed over: the height of a letter.
const REACH: i64 = 4;
/// Most baselines of a line.
const BASELINES: usize = 6;
/// Room along the line in widths of the text.
const ROOM: f64 = 1.06;
/// Above and below the baseline in heights of the letters.
const ASCENT: f64 = 0.76;
const DESCENT: f64 = 0.24;

/// A text that is to run along a line, pixels.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Letters {
    pub(crate) width: f64,
    pub(crate) size_px: f64,
    /// From the middle of the line to the letters.
    pub(crate) gap: f64,
}

/// A baseline along a line.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Along {
    /// Pixels, from left to right.
    pub(crate) points: Vec<DVec2>,
    /// Share of the line's length at the middle of the text, 0..=1.
    pub(crate) middle: f64,
    /// Whether it lies above the line.
    pub(crate) upper: bool,
    /// Whether it is the one that was asked for.
    pub(crate) held: bool,
}

/// Baselines along a line, the flattest first, above the line before below it.
/// * `held`: the middle and the side that are tried before all others.
pub(crate) fn baselines(line: &[DVec2], letters: Letters, held: Option<(f64, bool)>) -> Vec<Along> {
    let step = (0.25 * letters.size_px).max(1.0);
    let count = ((ROOM * letters.width + 2.0) / step).ceil();
    let length: f64 = line.windows(2).map(|pair| pair[0].distance(pair[1])).sum();
    // What is held does not follow the steps, whose beginning moves with that of the line.
    let held = held.and_then(|(middle, upper)| {
        let room = (length - count * step - 1e-6).max(0.0);
        let start = (middle * length - 0.5 * count * step).clamp(0.0, room);
        let line = samples(line, step, start.rem_euclid(step));
        along(&line, ((start / step) as usize, count as usize), (letters, upper))
    });
    let line = samples(line, step, 0.0);
    if !(count >= 1.0 && count < line.len() as f64) {
        return Vec::new();
    }
    let count = count as usize;
    let room = line.len() - 1 - count;
    let mut found: Vec<(f64, Along)> = Vec::new();
    for middle in MIDDLES {
        let start = ((middle * (line.len() - 1) as f64 - 0.5 * count as f64).max(0.0) as usize).min(room);
        for (side, upper) in [(0.0, true), (0.4, false)] {
            let along = along(&line, (start, count), (letters, upper));
            found.extend(along.map(|(turn, found)| (turn + side + (middle - 0.5).abs(), found)));
        }
    }
    found.sort_by(|a, b| a.0.total_cmp(&b.0));
    let held = held.map(|(_, along)| Along { held: true, ..along });
    let found = held.into_iter().chain(found.into_iter().map(|(_, along)| along));
    found.filter(|along| stays_off(&along.points, &line, letters)).take(BASELINES).collect()
}

/// The baseline beside `count` steps of samples from one on, and its whole turn.
fn along(line: &[DVec2], (start, count): (usize, usize), (letters, upper): (Letters, bool)) -> Option<(f64, Along)> {
    let (above, below) = (letters.gap + DESCENT * letters.size_px, -letters.gap - ASCENT * letters.size_px);
    let stretch = Some(start..start + count + 1).filter(|stretch| stretch.end <= line.len())?;
    let (turn, points) = beside(line, stretch, if upper { above } else { below })?;
    let middle = (start as f64 + 0.5 * count as f64) / (line.len() - 1) as f64;
    Some((turn, Along { points, middle, upper, held: false }))
}

/// Points at equal steps along a line, the first `from` behind its beginning, pixels.
fn samples(line: &[DVec2], step: f64, from: f64) -> Vec<DVec2> {
    let mut out = Vec::new();
    let mut left = from;
    for pair in line.windows(2) {
        let long = pair[0].distance(pair[1]);
        let mut at = left;
        while at <= long {
            out.push(pair[0].lerp(pair[1], at / long.max(1e-12)));
            at += step;
        }
        left = at - long;
    }
    out
}

/// A smooth curve `off` pixels above a stretch of samples, and its whole turn; `None` where it turns too much.
fn beside(line: &[DVec2], stretch: std::ops::Range<usize>, off: f64) -> Option<(f64, Vec<DVec2>)> {
    let last = line.len() as i64 - 1;
    let smooth = |i: usize| {
        let weights = (-REACH..=REACH).map(|k| (i as i64 + k, (REACH + 1 - k.abs()) as f64));
        let weights = weights.filter(|(i, _)| (0..=last).contains(i));
        let (sum, total) =
            weights.fold((DVec2::ZERO, 0.0), |(sum, total), (i, w)| (sum + w * line[i as usize], total + w));
        sum / total
    };
    let mut points: Vec<DVec2> = stretch.map(smooth).collect();
    if points.last()?.x < points.first()?.x {
        points.reverse();
    }
    let directions: Vec<DVec2> = points.windows(2).map(|pair| (pair[1] - pair[0]).normalize_or_zero()).collect();
    if directions.iter().any(|d| !(d.x >= LEAST_RIGHT)) {
        return None;
    }
    let turns: Vec<f64> = directions.windows(2).map(|pair| pair[0].angle_to(pair[1])).collect();
    if turns.windows(4).any(|four| four.iter().sum::<f64>().abs() > MOST_TURN) {
        return None;
    }
    let up = |i: usize| {
        let d = directions[i.saturating_sub(1)] + directions[i.min(directions.len() - 1)];
        DVec2::new(d.y, -d.x).normalize_or_zero()
    };
    let lifted = points.iter().enumerate().map(|(i, p)| *p + off * up(i)).collect();
    Some((turns.iter().map(|turn| turn.abs()).sum(), lifted))
}

/// Whether no part of the letters comes nearer to the line than its half width.
fn stays_off(baseline: &[DVec2], line: &[DVec2], letters: Letters) -> bool {
    let least = letters.gap - 0.5;
    let (lo, hi) = baseline.iter().fold((baseline[0], baseline[0]), |(lo, hi), p| (lo.min(*p), hi.max(*p)));
    let reach = letters.gap + letters.size_px;
    let near: Vec<[DVec2; 2]> = line
        .windows(2)
        .filter(|pair| pair[0].cmpge(lo - reach).all() && pair[0].cmple(hi + reach).all())
        .map(|pair| [pair[0], pair[1]])
        .collect();
    baseline.windows(2).all(|pair| {
        let direction = (pair[1] - pair[0]).normalize_or_zero();
        let up = DVec2::new(direction.y, -direction.x);
        [-DESCENT, 0.2, 0.5, ASCENT].iter().all(|share| {
            let p = pair[0] + *share * letters.size_px * up;
            near.iter().all(|[a, b]| to_segment(p, *a, *b).length() >= least)
        })
    })
}

#[cfg(test)]
mod tests;
