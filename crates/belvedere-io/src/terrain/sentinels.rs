//! Values that mean "no data" by custom, in files that do not declare them.

use belvedere_core::{Warning, WarningKind};
use rayon::prelude::*;

/// Customary no-data values, in the file's unit of height.
const CUSTOMARY: [f32; 23] = [
    -9999.0, -99999.0, -999.0, -9998.0, -9999.9, -999.9, -32768.0, -32767.0, -32766.0, -10000.0, -9990.0, -8888.0, 0.0,
    -1.0, -99.0, 8888.0, 9999.0, 9999.9, 99999.0, 32767.0, 32768.0, 65535.0, 65534.0,
];
/// Those that may well be heights: they count only where the other heights are the most and differ by as much as this, metres.
pub(super) const MILD: [f32; 3] = [0.0, -1.0, -99.0];
const MILD_RELIEF_M: f32 = 20.0;
/// Heights of the ground and of the floor of the sea, metres: any value beyond that is far from all others is a custom of its own.
const OF_GROUND_M: std::ops::Range<f32> = -11_500.0..9_000.0;
/// Least gap between such a value and all other heights: metres, and share of the relief; with a smaller gap it is a height.
const GAP_M: f32 = 400.0;
const GAP_SHARE: f32 = 0.2;
/// Ground that stands lower beside zeros may be a shore of the sea, metres.
const SHORE_M: f32 = 30.0;

/// Makes customary values void where they are far from all other heights; returns one sentence about it.
///
/// * `heights`: metres, NaN = void.
/// * `unit`: metres per unit of the file's heights.
pub(super) fn void(heights: &mut [f32], unit: f32) -> Option<Warning> {
    let mut said = Vec::new();
    let mut count = 0;
    // One at a time, the outermost first: otherwise one such value could be the near neighbour of another.
    while let Some((value, stored)) = apart(&Outermost::of(heights), heights.len(), |v| count_of(heights, v), unit) {
        count += void_value(heights, value);
        said.push(stored);
    }
    said_of(&said, count)
}

/// Makes a frame of zeros around the heights void; returns one sentence about it. Where every sample of the border is 0 or void, the zeros that
/// are joined with it are such a frame, unless ground beside them is low: the sea has a low shore.
///
/// * `heights`: row by row, metres, NaN = void; `cols`: samples in a row.
pub(super) fn void_frame(heights: &mut [f32], cols: usize) -> Option<Warning> {
    let rows = heights.len() / cols.max(1);
    let on_border =
        |i: usize| i < cols || i >= cols * (rows - 1) || i.is_multiple_of(cols) || (i + 1).is_multiple_of(cols);
    let border = (0..cols).chain((1..rows.max(1)).flat_map(|r| [r * cols, r * cols + cols - 1]));
    let border: Vec<usize> = border.chain((0..cols).map(|c| cols * rows.saturating_sub(1) + c)).collect();
    if rows < 3 || cols < 3 || border.iter().any(|i| heights[*i] != 0.0 && !heights[*i].is_nan()) {
        return None;
    }
    let mut frame = vec![false; heights.len()];
    let mut open: Vec<usize> = border;
    let mut beside = Vec::new();
    while let Some(i) = open.pop() {
        if std::mem::replace(&mut frame[i], true) {
            continue;
        }
        let sides = [i.checked_sub(cols), i.checked_sub(1), Some(i + 1), Some(i + cols)];
        for k in sides.into_iter().flatten().filter(|k| *k < heights.len() && !(on_border(i) && on_border(*k))) {
            match heights[k] {
                h if h == 0.0 || h.is_nan() => open.push(k),
                h => beside.push(h),
            }
        }
    }
    let low = beside.iter().filter(|h| **h < SHORE_M).count();
    if beside.is_empty() || 20 * low > beside.len() {
        return None;
    }
    let mut count = 0;
    for (height, _) in heights.iter_mut().zip(frame).filter(|(height, of_frame)| *of_frame && **height == 0.0) {
        *height = f32::NAN;
        count += 1;
    }
    let what = "samples of 0 in a frame around the data, beside ground of 30 m and more, are taken as voids though the file does not declare them; nodata of its layer says otherwise";
    Warning::counted(WarningKind::Assumed, count, what).map(|said| said.settled_by("nodata"))
}

/// Makes all samples of a value void; returns their number.
pub(super) fn void_value(heights: &mut [f32], value: f32) -> usize {
    let samples = heights.par_iter_mut().with_min_len(1 << 16);
    samples
        .map(|h| {
            let absent = *h == value;
            if absent {
                *h = f32::NAN;
            }
            usize::from(absent)
        })
        .sum()
}

/// The sentence about `count` samples of customary values, as they are stored, that are void now; `None` if there are none.
pub(super) fn said_of(stored: &[f32], count: usize) -> Option<Warning> {
    if count == 0 {
        return None;
    }
    let said: Vec<String> = stored.iter().map(f32::to_string).collect();
    let values = said.join(" and ");
    let what = format!(
        "samples of {values}, far from all other heights, are taken as voids though the file does not declare them; nodata of its layer says otherwise"
    );
    Warning::counted(WarningKind::Assumed, count, &what).map(|said| said.settled_by("nodata"))
}

/// The lowest or the highest height, if it is a customary value far from the next one; in metres and as stored.
/// * `samples`: their number, voids included; `count_of`: the number of those of a value.
pub(super) fn apart(
    ends: &Outermost,
    samples: usize,
    count_of: impl Fn(f32) -> usize,
    unit: f32,
) -> Option<(f32, f32)> {
    let Outermost([low, next_low, next_high, high]) = *ends;
    if !ends.0.iter().all(|h| h.is_finite()) {
        return None;
    }
    let customary = |value: f32| {
        let stored = CUSTOMARY.into_iter().find(|c| c * unit == value);
        stored.or_else(|| (!OF_GROUND_M.contains(&value)).then_some(value / unit))
    };
    let alone = |value: f32, next: f32, inner: f32| {
        let stored = customary(value)?;
        if MILD.contains(&stored) && (inner < MILD_RELIEF_M || 2 * count_of(value) > samples) {
            return None;
        }
        ((value - next).abs() >= GAP_M.max(GAP_SHARE * inner)).then_some((value, stored))
    };
    alone(low, next_low, high - next_low).or_else(|| alone(high, next_high, next_high - low))
}

pub(super) fn count_of(heights: &[f32], value: f32) -> usize {
    heights.par_iter().with_min_len(1 << 16).filter(|h| **h == value).count()
}

/// Lowest, next to lowest, next to highest and highest of different heights; infinite where there are fewer than two.
#[derive(Debug, Clone, Copy)]
pub(super) struct Outermost([f32; 4]);

impl Outermost {
    pub(super) const NONE: Self = Self([f32::INFINITY, f32::INFINITY, f32::NEG_INFINITY, f32::NEG_INFINITY]);

    /// Those of all known heights.
    pub(super) fn of(heights: &[f32]) -> Self {
        let ends = |part: &[f32]| part.iter().filter(|h| h.is_finite()).fold(Self::NONE, |ends, &h| ends.with(h));
        heights.par_chunks(1 << 16).map(ends).reduce(|| Self::NONE, Self::and)
    }

    /// Those of both.
    pub(super) fn and(self, other: Self) -> Self {
        other.0.into_iter().filter(|h| h.is_finite()).fold(self, Self::with)
    }

    fn with(mut self, h: f32) -> Self {
        insert(&mut self.0, h);
        self
    }
}

fn insert(out: &mut [f32; 4], h: f32) {
    if h < out[0] {
        (out[0], out[1]) = (h, out[0]);
    } else if h > out[0] && h < out[1] {
        out[1] = h;
    }
    if h > out[3] {
        (out[3], out[2]) = (h, out[3]);
    } else if h < out[3] && h > out[2] {
        out[2] = h;
    }
}

#[cfg(test)]
mod tests;
