//! Where a name may stand: beside its point, above it with a leader, in rows over the skyline, or along a line.

use crate::canvas::along;
use crate::marks::occupied::Rect;
use crate::marks::request::{Baseline, Candidate, LabelRequest, Lines, Page};
use belvedere_core::DVec2;
use belvedere_scene::{NamePlace, NameSide};

/// Lengths of leaders tried, units.
const LEADERS: [f64; 14] = [0.0, 10.0, 18.0, 26.0, 36.0, 48.0, 60.0, 74.0, 90.0, 108.0, 128.0, 150.0, 175.0, 200.0];
/// Gap between texts, units.
const ROOM: f64 = 2.0;
/// Rows over the skyline.
const ROWS: usize = 7;
/// From the skyline to the lowest row, units.
const OVER_SKYLINE: f64 = 14.0;
/// How much farther from its point than the rows that are tried a name keeps its row, units.
const HELD_FARTHER: f64 = 100.0;

/// Shares of a text that stand to the left of its point.
const SHIFTS: [f64; 3] = [0.5, 0.15, 0.85];

/// Places to try, best first.
pub(crate) fn candidates(request: &LabelRequest, lines: &Lines, page: &Page<'_>) -> Vec<Candidate> {
    Places { request, lines, density: page.density }.all()
}

/// The place that a name held in the frame before; `None` where the picture does not offer it any more.
pub(crate) fn held(request: &LabelRequest, lines: &Lines, page: &Page<'_>, place: NamePlace) -> Option<Candidate> {
    let places = Places { request, lines, density: page.density };
    places.held_row(place).or_else(|| places.all().into_iter().find(|candidate| candidate.place == place))
}

struct Places<'a> {
    request: &'a LabelRequest,
    lines: &'a Lines,
    density: f64,
}

impl Places<'_> {
    fn all(&self) -> Vec<Candidate> {
        let Self { request, lines, density } = *self;
        let mut out: Vec<Candidate> = request.along.iter().filter_map(|line| curved(line, lines, density)).collect();
        let [side, _] = request.marker;
        // The middle of the block stands at the height of the point.
        let level = request.at.y + 0.36 * request.size_px - 0.5 * (lines.descent - 0.24 * request.size_px);
        if request.over {
            let baseline = DVec2::new(request.at.x - 0.5 * lines.width, level);
            out.push(self.block(NameSide::Over, None, baseline));
            return out;
        }
        if !request.line.0.is_empty() {
            let beside = aside(request, lines, density).map(|(upper, at)| (NameSide::Beside { upper }, at));
            out.extend(beside.map(|(side, baseline)| self.block(side, None, baseline)));
        }
        if let Some(ground) = request.skyline {
            let lowest = ((ground - OVER_SKYLINE * density) / self.row_height()).floor();
            let rows = (0..ROWS).map(|k| lowest - k as f64).filter(|row| *row >= 0.0).map(|row| row as u32);
            out.extend(rows.flat_map(|row| (0..SHIFTS.len()).filter_map(move |shift| self.in_row(row, shift))));
        }
        for (leader, length) in LEADERS.into_iter().take(if request.leader { LEADERS.len() } else { 1 }).enumerate() {
            let above = |shift: usize| {
                let side = NameSide::Above { leader: leader as u32, shift: shift as u32 };
                self.above(side, length * density, SHIFTS[shift])
            };
            out.extend((0..SHIFTS.len()).map(above));
            if leader == 0 {
                let gap = side + 4.0 * density;
                let below = request.at.y + side + 3.0 * density + lines.ascent;
                let beside = [
                    (NameSide::Right, DVec2::new(request.at.x + gap, level)),
                    (NameSide::Left, DVec2::new(request.at.x - gap - lines.width, level)),
                    (NameSide::Below, DVec2::new(request.at.x - 0.5 * lines.width, below)),
                ];
                out.extend(beside.map(|(side, baseline)| self.block(side, None, baseline)));
            }
        }
        out
    }

    fn block(&self, side: NameSide, leader: Option<[DVec2; 2]>, baseline: DVec2) -> Candidate {
        Candidate {
            boxes: vec![rect(self.lines, baseline, self.density)],
            leader,
            baseline,
            along: Vec::new(),
            place: NamePlace { side, anchor: self.request.anchor },
        }
    }

    /// Where leaders begin.
    fn foot(&self) -> DVec2 {
        self.request.at - DVec2::Y * self.request.marker[1]
    }

    /// A block above the point.
    /// * `length`: of the leader, pixels; `shift`: share of the text to the left of the point.
    fn above(&self, side: NameSide, length: f64, shift: f64) -> Candidate {
        let (foot, density) = (self.foot(), self.density);
        let top = foot - DVec2::Y * (length + 2.0 * density);
        let baseline = DVec2::new(top.x - shift * self.lines.width, top.y - self.lines.descent - density);
        self.block(side, (length > 0.0).then_some([foot, top]), baseline)
    }

    /// Height of a row; the rows of all names of one size are the same.
    fn row_height(&self) -> f64 {
        self.lines.ascent + self.lines.descent + 2.0 * (ROOM + 1.0) * self.density
    }

    /// A block in a row of the picture; `None` where the row lies below the point.
    fn in_row(&self, row: u32, shift: usize) -> Option<Candidate> {
        let length = self.foot().y - f64::from(row) * self.row_height();
        let side = NameSide::Row { row, shift: shift as u32 };
        (length > 0.0).then_some(self.above(side, length, *SHIFTS.get(shift)?))
    }

    /// The row that a name holds, while it lies over the ground and no farther from the point than rows are tried.
    fn held_row(&self, held: NamePlace) -> Option<Candidate> {
        let NameSide::Row { row, shift } = held.side else { return None };
        let (at, height) = (f64::from(row) * self.row_height(), self.row_height());
        let over = self.request.skyline.is_none_or(|ground| at <= ground - self.density);
        let near = self.foot().y - at <= (ROWS + 1) as f64 * height + HELD_FARTHER * self.density;
        (over && near).then(|| self.in_row(row, shift as usize)).flatten()
    }
}

/// Baselines on both sides of the line at the point, so far off that a straight line is not touched; the upper one first.
fn aside(request: &LabelRequest, lines: &Lines, density: f64) -> impl Iterator<Item = (bool, DVec2)> {
    let (line, half) = &request.line;
    let far = |pair: &[DVec2]| (0.5 * (pair[0] + pair[1])).distance(request.at);
    let nearest = line.windows(2).min_by(|a, b| far(a).total_cmp(&far(b)));
    let direction = nearest.map_or(DVec2::X, |pair| (pair[1] - pair[0]).normalize_or(DVec2::X));
    let up = if direction.x < 0.0 { direction.perp() } else { -direction.perp() };
    let size = DVec2::new(lines.width, lines.ascent + lines.descent) + 2.0 * ROOM * density;
    let off = density + 0.5 * up.abs().dot(size + 2.0 * half);
    let at = request.at;
    let corner = DVec2::new(-0.5 * lines.width, 0.5 * (lines.ascent - lines.descent));
    [(true, 1.0), (false, -1.0)].into_iter().map(move |(upper, side)| (upper, at + side * off * up + corner))
}

fn rect(lines: &Lines, baseline: DVec2, density: f64) -> Rect {
    let (lo, hi) = (DVec2::new(0.0, -lines.ascent), DVec2::new(lines.width, lines.descent));
    [baseline + lo - ROOM * density, baseline + hi + ROOM * density]
}

/// A text along the middle of a baseline; `None` where it is longer than the line.
fn curved(baseline: &Baseline, lines: &Lines, density: f64) -> Option<Candidate> {
    let line = &baseline.points;
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
    let place = NamePlace { side: NameSide::Along { upper: baseline.upper }, anchor: baseline.anchor };
    Some(Candidate {
        boxes: (0..steps).map(boxed).collect(),
        leader: None,
        baseline: *path.first()?,
        along: path,
        place,
    })
}
