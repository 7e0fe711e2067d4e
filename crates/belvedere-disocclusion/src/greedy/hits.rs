//! The ground over a line of sight, exactly.

use super::super::{Cells, Field, NO_CELL};
use super::Pieces;
use super::scan::{High, UNSURE};
use super::trace::Sight;
use belvedere_sight::{EdgeFamily, SightLine, SightSample};

/// Ground over a line of sight.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Hit {
    /// Cell of the nearer node.
    pub(super) cell: usize,
    /// Distance to the eye in plan.
    pub(super) rho: f64,
    /// Height that the ground must not exceed here.
    pub(super) limit: f64,
    /// Height of the untouched ground.
    pub(super) original: f64,
    /// Height of the ground.
    pub(super) z: f64,
}

/// Finds hits among what may be hits.
pub(super) struct Hits<'a> {
    pub(super) field: &'a Field,
    pub(super) line: &'a SightLine<'a>,
    pub(super) cells: &'a Cells,
    pub(super) pieces: &'a [Pieces],
    pub(super) sight: &'a Sight,
    /// Only ground that is nearer to the eye counts,
    pub(super) below: f64,
    /// and heights that differ by more than this.
    pub(super) slack: f64,
}

impl Hits<'_> {
    /// Those hits, in order, on which it depends what is done to their cells: of each cell the first one, the one that stands
    /// out most, the one whose height must be scaled down most, and possibly others.
    pub(super) fn find(&self, high: &[High], out: &mut Vec<Hit>) {
        out.clear();
        for run in high.chunk_by(|a, b| a.cell == b.cell) {
            match self.pieces.get(run[0].cell as usize) {
                Some(pieces) => self.telling(run, pieces, |h| out.extend(self.hit(h))),
                None => out.extend(run.iter().filter_map(|h| self.hit(h))),
            }
        }
        // Where columns and rows are crossed at once, rounding may have put them the wrong way round.
        out.sort_by(|a, b| b.rho.total_cmp(&a.rho));
    }

    /// Gives out those of one cell, one after the other along the line, that may tell what is done to it.
    fn telling(&self, run: &[High], pieces: &Pieces, mut give: impl FnMut(&High)) {
        let Sight { doubt, rho, .. } = *self.sight;
        // `None` where rounding decides between two rings.
        let excess = |h: &High| {
            let distances = [h.tau + UNSURE, h.tau - UNSURE].map(|t| (1.0 - t) * rho);
            let (affine, exact) = pieces.between(distances);
            exact.then(|| affine.of(h.h) - h.limit)
        };
        let (mut most, mut least) = (f64::NEG_INFINITY, f64::INFINITY);
        for h in run.iter().filter(|h| self.sight.comparable(h)) {
            if let Some(e) = excess(h) {
                most = most.max(e);
                least = least.min(h.limit / (h.limit + e));
            }
        }
        // Heights are larger than `low`.
        let ratios = least * (1.0 + 4.0 * doubt / self.sight.low);
        let mut first = true;
        for h in run {
            let Some(e) = excess(h) else {
                give(h);
                continue;
            };
            if e < -doubt {
                continue;
            }
            let extreme = e + 2.0 * doubt >= most || h.limit <= ratios * (h.limit + e);
            let counts = self.sight.comparable(h);
            if first || extreme || !counts {
                give(h);
                first &= !counts || e <= 2.0 * doubt;
            }
        }
    }

    fn hit(&self, high: &High) -> Option<Hit> {
        let s: SightSample = self.line.crossing(EdgeFamily::ALL[usize::from(high.family)], f64::from(high.line))?;
        let cell = self.cells.labels()[s.nearest()];
        if cell == NO_CELL || s.rho >= self.below {
            return None;
        }
        let (original, limit) = (s.of(self.field.heights()) - self.field.datum(), self.sight.limit(s.tau));
        let z = self.pieces[cell as usize].at(s.rho).of(original);
        // Ground is only ever lowered.
        let over = original > limit + self.slack && z > limit + self.slack;
        over.then_some(Hit { cell: cell as usize, rho: s.rho, limit, original, z })
    }
}
