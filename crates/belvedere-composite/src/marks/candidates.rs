//! Where a name may stand: beside its point, above it with a leader, in rows over the skyline, or along a line.

use crate::canvas::along;
use crate::marks::occupied::Rect;
use crate::marks::request::{Candidate, LabelRequest, Lines, Page};
use belvedere_core::DVec2;

/// Lengths of leaders tried, units.
const LEADERS: [f64; 14] = [0.0, 10.0, 18.0, 26.0, 36.0, 48.0, 60.0, 74.0, 90.0, 108.0, 128.0, 150.0, 175.0, 200.0];
/// Gap between texts, units.
const ROOM: f64 = 2.0;
/// Rows over the skyline.
const ROWS: usize = 7;
/// From the skyline to the lowest row, units.
const OVER_SKYLINE: f64 = 14.0;

/// Places to try, best first.
pub(crate) fn candidates(request: &LabelRequest, lines: &Lines, page: &Page<'_>) -> Vec<Candidate> {
    let density = page.density;
    let mut out: Vec<Candidate> = request.along.iter().filter_map(|line| curved(line, lines, density)).collect();
    let block = |leader: Option<[DVec2; 2]>, baseline: DVec2| Candidate {
        boxes: vec![rect(lines, baseline, density)],
        leader,
        baseline,
        along: Vec::new(),
    };
    let [side, above] = request.marker;
    // The middle of the block stands at the height of the point.
    let level = request.at.y + 0.36 * request.size_px - 0.5 * (lines.descent - 0.24 * request.size_px);
    if request.over {
        out.push(block(None, DVec2::new(request.at.x - 0.5 * lines.width, level)));
        return out;
    }
    if !request.line.0.is_empty() {
        out.extend(aside(request, lines, density).map(|baseline| block(None, baseline)));
    }
    let foot = request.at - DVec2::Y * above;
    let over = |length: f64, shift: f64| {
        let top = foot - DVec2::Y * (length + 2.0 * density);
        let baseline = DVec2::new(top.x - shift * lines.width, top.y - lines.descent - density);
        block((length > 0.0).then_some([foot, top]), baseline)
    };
    if let Some(ground) = request.skyline {
        out.extend(rows(ground, foot.y, lines, density).flat_map(|length| [0.5, 0.15, 0.85].map(|s| over(length, s))));
    }
    for length in LEADERS.into_iter().take(if request.leader { LEADERS.len() } else { 1 }) {
        let length = length * density;
        out.extend([0.5, 0.15, 0.85].map(|shift| over(length, shift)));
        if length == 0.0 {
            let beside = [
                DVec2::new(request.at.x + side + 4.0 * density, level),
                DVec2::new(request.at.x - side - 4.0 * density - lines.width, level),
                DVec2::new(request.at.x - 0.5 * lines.width, request.at.y + side + 3.0 * density + lines.ascent),
            ];
            out.extend(beside.map(|baseline| block(None, baseline)));
        }
    }
    out
}

/// Baselines on both sides of the line at the point, so far off that a straight line is not touched; the upper one first.
fn aside(request: &LabelRequest, lines: &Lines, density: f64) -> impl Iterator<Item = DVec2> {
    let (line, half) = &request.line;
    let far = |pair: &[DVec2]| (0.5 * (pair[0] + pair[1])).distance(request.at);
    let nearest = line.windows(2).min_by(|a, b| far(a).total_cmp(&far(b)));
    let direction = nearest.map_or(DVec2::X, |pair| (pair[1] - pair[0]).normalize_or(DVec2::X));
    let up = if direction.x < 0.0 { direction.perp() } else { -direction.perp() };
    let size = DVec2::new(lines.width, lines.ascent + lines.descent) + 2.0 * ROOM * density;
    let off = density + 0.5 * up.abs().dot(size + 2.0 * half);
    let at = request.at;
    let corner = DVec2::new(-0.5 * lines.width, 0.5 * (lines.ascent - lines.descent));
    [1.0, -1.0].into_iter().map(move |side| at + side * off * up + corner)
}

/// Lengths of leaders to rows over the skyline; the rows of all names of one size are the same.
fn rows(ground: f64, foot: f64, lines: &Lines, density: f64) -> impl Iterator<Item = f64> {
    let row = lines.ascent + lines.descent + 2.0 * (ROOM + 1.0) * density;
    let lowest = ((ground - OVER_SKYLINE * density) / row).floor();
    (0..ROWS).map(move |k| foot - (lowest - k as f64) * row).filter(|length| *length > 0.0)
}

fn rect(lines: &Lines, baseline: DVec2, density: f64) -> Rect {
    let (lo, hi) = (DVec2::new(0.0, -lines.ascent), DVec2::new(lines.width, lines.descent));
    [baseline + lo - ROOM * density, baseline + hi + ROOM * density]
}

/// A text along the middle of a baseline; `None` where it is longer than the line.
fn curved(line: &[DVec2], lines: &Lines, density: f64) -> Option<Candidate> {
    let length: f64 = line.windows(2).map(|pair| pair[0].distance(pair[1])).sum();
    let start = 0.5 * (length - lines.width);
    if !(start >= 0.0) {
        return None;
    }
    let height = lines.ascent + lines.descent;
    let steps = (lines.width / (0.5 * height).max(1.0)).ceil().clamp(1.0, 400.0) as usize;
    let step = lines.width / steps as f64;
    let boxed = |i: usize| {
        let ends = [i, i + 1].map(|k| along(line, start + k as f64 * step));
        let corners = ends.map(|(at, direction)| {
            let down = DVec2::new(-direction.y, direction.x);
            [at - lines.ascent * down, at + lines.descent * down]
        });
        let [[a, b], [c, d]] = corners;
        [a.min(b).min(c).min(d) - 0.5 * ROOM * density, a.max(b).max(c).max(d) + 0.5 * ROOM * density]
    };
    let path: Vec<DVec2> = {
        // From the beginning of the text on.
        let (first, _) = along(line, start);
        let mut walked = 0.0;
        let rest = line.windows(2).filter_map(|pair| {
            walked += pair[0].distance(pair[1]);
            (walked > start).then_some(pair[1])
        });
        std::iter::once(first).chain(rest).collect()
    };
    Some(Candidate { boxes: (0..steps).map(boxed).collect(), leader: None, baseline: *path.first()?, along: path })
}
