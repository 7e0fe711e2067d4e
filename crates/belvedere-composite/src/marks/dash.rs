//! Strokes along a line, solid or dashed.

use crate::marks::ribbon::{Lane, Stroke};
use crate::marks::visibility::Station;
use belvedere_core::polygon;

/// Share of a period that is inked, and shortest period in widths of the line.
const INK: f64 = 0.55;
const PERIOD: f64 = 4.4;
/// Half the stretch of line over which pixels per scene unit are measured, pixels.
const WINDOW_PX: f64 = 60.0;

/// Joins stations into as few strokes as straightness allows.
pub(crate) fn trace(part: &[Station], half: f64, lane: Lane, out: &mut Vec<Stroke>) {
    if half <= 0.0 {
        return;
    }
    if let [only] = part {
        out.push(Stroke::new(only.pixel, only.pixel, half, lane));
    }
    let mut from = 0;
    while from + 1 < part.len() {
        let mut to = from + 1;
        while to + 1 < part.len() && to - from < 24 {
            let (a, b) = (part[from].pixel, part[to + 1].pixel);
            let straight = part[from + 1..=to].iter().all(|s| polygon::to_segment(s.pixel, a, b).length() < 0.06);
            if !straight {
                break;
            }
            to += 1;
        }
        out.push(Stroke::new(part[from].pixel, part[to].pixel, half, lane));
        from = to;
    }
}

/// Dashes that stay fixed to the ground: they begin at multiples of a period along the line, which is a power of two in scene units
/// and one to two times as long on the image as the width requires.
pub(crate) fn dashes(part: &[Station], width: f64, density: f64, half: f64, out: &mut Vec<Stroke>) {
    let wanted_px = PERIOD * width.max(1.5 * density);
    let periods = periods(part, wanted_px);
    let mut dash: Vec<Station> = Vec::new();
    for (pair, &period) in part.windows(2).zip(&periods) {
        let (a, b) = (pair[0], pair[1]);
        for (on, [s, t]) in pieces([a.on_line.along, b.on_line.along], period) {
            if !on {
                trace(&dash, half, Lane::Hidden, out);
                dash.clear();
                continue;
            }
            if dash.is_empty() {
                dash.push(a.lerp(&b, s));
            }
            dash.push(a.lerp(&b, t));
        }
    }
    trace(&dash, half, Lane::Hidden, out);
}

/// Lengths of ink and of gap in the middle of a part drawn by [`dashes`], pixels; 0 for a part without length.
pub(crate) fn pattern(part: &[Station], width: f64, density: f64) -> [f64; 2] {
    let wanted_px = PERIOD * width.max(1.5 * density);
    let middle = part.len() / 2;
    let (Some(first), Some(last), Some(period)) =
        (part.first(), part.last(), periods(part, wanted_px).get(middle).copied())
    else {
        return [0.0; 2];
    };
    let px_per_unit = (last.arc_px - first.arc_px) / (last.on_line.along - first.on_line.along).max(1e-9);
    let period = (period * px_per_unit).clamp(0.0, 4.0 * wanted_px);
    [INK * period, (1.0 - INK) * period]
}

/// Length of a period along the line at every station, scene units.
fn periods(part: &[Station], wanted_px: f64) -> Vec<f64> {
    let (mut lo, mut hi) = (0, 0);
    part.iter()
        .map(|s| {
            while lo + 1 < part.len() && part[lo].arc_px < s.arc_px - WINDOW_PX {
                lo += 1;
            }
            while hi + 1 < part.len() && part[hi].arc_px < s.arc_px + WINDOW_PX {
                hi += 1;
            }
            let px = (part[hi].arc_px - part[lo].arc_px).max(1e-6);
            let units = (part[hi].on_line.along - part[lo].on_line.along).max(1e-9);
            (wanted_px * units / px).log2().ceil().clamp(-60.0, 60.0).exp2()
        })
        .collect()
}

/// Inked and empty pieces between two lengths along a line, as shares of the length between them.
fn pieces([g0, g1]: [f64; 2], period: f64) -> Vec<(bool, [f64; 2])> {
    let length = g1 - g0;
    if !(length > 0.0) {
        return Vec::new();
    }
    // A period much shorter than the step between two stations is drawn solid.
    if length > 8.0 * period {
        return vec![(true, [0.0, 1.0])];
    }
    let mut out = Vec::new();
    let mut k = (g0 / period).floor();
    loop {
        for (on, from, to) in [(true, k, k + INK), (false, k + INK, k + 1.0)] {
            let [s, t] = [from, to].map(|u| ((u * period - g0) / length).clamp(0.0, 1.0));
            if t > s {
                out.push((on, [s, t]));
            }
        }
        k += 1.0;
        if k * period >= g1 {
            return out;
        }
    }
}

#[cfg(test)]
mod tests;
