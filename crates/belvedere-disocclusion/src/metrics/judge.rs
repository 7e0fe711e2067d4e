//! The judge: points that the displaced ground hides, by lines of sight over it.

use super::super::visibility_qp::LinesOfSight;
use super::super::{Field, KINDS, ReferencePoint};
use belvedere_core::DVec2;
use belvedere_core::grid::Grid;
use belvedere_sight::{DisplacedGround, SightVertex};
use rayon::prelude::*;

/// Depth under the ground down to which a line of sight still counts as clear, scene units: rounding.
const TOUCH: f64 = 1e-6;
/// Cells that lines of sight cross, per node of the ground, from which on it is worth preparing the grounds.
const WORTH_PREPARING: usize = 2;

/// The kind of ground that hides a point.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum Hides {
    /// Ground that rises over its line of sight by this height, scene units; infinite if the point has no line.
    Ground(f64),
    /// Only ground nearer to it than the guard, which rises by this height.
    InGuard(f64),
}

impl Hides {
    /// Height by which that ground rises over the line of sight, scene units.
    pub(crate) fn over(self) -> f64 {
        match self {
            Self::Ground(over) | Self::InGuard(over) => over,
        }
    }
}

/// The judgement of a point.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum Verdict {
    /// It lies beside the ground or in a hole.
    NoGround,
    Seen,
    Hidden(Hides),
}

impl Verdict {
    /// The ground that hides the point; `None` if it is seen, or lies on no ground.
    pub(crate) fn hides(self) -> Option<Hides> {
        match self {
            Self::Hidden(hides) => Some(hides),
            Self::NoGround | Self::Seen => None,
        }
    }
}

/// Visible share of the features that the points stand for, 0..=1; 1 without points. Lines count by length, areas by area in plan,
/// point features by number; the least of the three is returned.
pub(crate) fn share_seen(points: &[ReferencePoint], verdicts: &[Verdict]) -> f64 {
    shares(points, verdicts)[0]
}

/// Amounts of lines, areas and points that points stand for.
pub(crate) fn amounts(points: &[ReferencePoint]) -> [f64; KINDS] {
    let mut sums = [0.0; KINDS];
    points.iter().for_each(|point| sums[point.kind.of_feature()] += point.amount);
    sums
}

/// Sums by kind.
pub(crate) fn sums(a: [f64; KINDS], b: [f64; KINDS]) -> [f64; KINDS] {
    std::array::from_fn(|k| a[k] + b[k])
}

/// Shares of the whole features that `points` show and stand for: visible, and in view; the least of lines, areas and points. 0 where
/// nothing is in view, 1 without features.
///
/// * `points`: those in view; each stands for itself and, in sums, for all of `in_view`.
/// * `judged`: amounts of the points from which `points` were taken; `in_view`, `whole`: amounts of all points in view, and of all points.
pub(crate) fn shares_of_whole(
    (points, verdicts): (&[ReferencePoint], &[Verdict]),
    [judged, in_view, whole]: [[f64; KINDS]; 3],
) -> [f64; 2] {
    let mut sums = [[0.0; 2]; KINDS];
    for (point, verdict) in points.iter().zip(verdicts).filter(|(_, v)| **v != Verdict::NoGround) {
        let [seen, all] = &mut sums[point.kind.of_feature()];
        *all += point.amount;
        *seen += if verdict.hides().is_none() { point.amount } else { 0.0 };
    }
    let kinds = (0..KINDS).filter(|k| whole[*k] > 0.0);
    let of = |k: usize| {
        let stands_for = if judged[k] > 0.0 { in_view[k] / judged[k] } else { 0.0 };
        sums[k].map(|amount| (stands_for * amount / whole[k]).clamp(0.0, 1.0))
    };
    kinds.map(of).fold([1.0; 2], |least, kind| [least[0].min(kind[0]), least[1].min(kind[1])])
}

/// See [`share_seen`]; also the share of the same kind that only ground inside the guard hides.
pub(crate) fn shares(points: &[ReferencePoint], verdicts: &[Verdict]) -> [f64; 2] {
    let mut sums = [[0.0; 3]; KINDS];
    for (point, verdict) in points.iter().zip(verdicts).filter(|(_, v)| **v != Verdict::NoGround) {
        let [all, hidden, in_guard] = &mut sums[point.kind.of_feature()];
        *all += point.amount;
        *hidden += if verdict.hides().is_some() { point.amount } else { 0.0 };
        *in_guard += if matches!(verdict, Verdict::Hidden(Hides::InGuard(_))) { point.amount } else { 0.0 };
    }
    let kinds = sums.into_iter().filter(|[all, ..]| *all > 0.0);
    kinds
        .map(|[all, hidden, in_guard]| [1.0 - hidden / all, in_guard / all])
        .fold([1.0, 0.0], |least, kind| if kind[0] < least[0] { kind } else { least })
}

/// Judges points over a ground: a point that it hides is hidden, however near the ground is.
pub(crate) struct Judge<'a> {
    ground: DisplacedGround<'a>,
    sight: &'a dyn LinesOfSight,
}

impl<'a> Judge<'a> {
    /// Judge over displaced ground.
    pub(crate) fn new(field: &'a Field, delta: &'a Grid, sight: &'a dyn LinesOfSight) -> Self {
        Self { ground: DisplacedGround::new(field, delta), sight }
    }

    /// Judge over undisplaced ground.
    pub(crate) fn still(field: &'a Field, sight: &'a dyn LinesOfSight) -> Self {
        Self { ground: DisplacedGround::still(field), sight }
    }

    /// Prepares the ground if there are enough points for that to pay.
    pub(crate) fn prepared(self, points: usize) -> Self {
        let [cols, rows] = self.ground.nodes();
        if points * (cols + rows) > WORTH_PREPARING * cols * rows {
            Self { ground: self.ground.prepared(), ..self }
        } else {
            self
        }
    }

    /// The line of sight of a point at grid coordinates, `lift` above the ground; `None` beside the ground.
    fn line(&self, g: DVec2, lift: f64) -> Option<Vec<SightVertex>> {
        let z = self.ground.height_at(g)? + lift;
        let mut line = Vec::new();
        self.sight.trace(g, z, &mut line);
        Some(line)
    }

    /// The largest rise of the ground over the line of sight of a point at grid coordinates, `lift` above the ground; `None` beside
    /// the ground.
    ///
    /// * `guard`: ground nearer than this does not count, cells.
    #[cfg(test)]
    pub(super) fn excess(&self, g: DVec2, lift: f64, guard: f64) -> Option<belvedere_sight::Excess> {
        Some(self.ground.excess(&self.line(g, lift)?, guard))
    }

    /// For each point the position at which the ground hides it most, and its rise over the line; `None` where the point is seen, has
    /// no line, or lies on no ground.
    ///
    /// * `guard`: ground nearer than this does not count, grid cells.
    pub(crate) fn hiding(self, points: &[(DVec2, f64)], guard: f64) -> Vec<Option<(DVec2, f64)>> {
        let judge = self.prepared(points.len());
        let of = |&(g, lift): &(DVec2, f64)| {
            let worst = judge.ground.excess(&judge.line(g, lift)?, guard);
            (worst.over > TOUCH && worst.over.is_finite()).then_some((worst.at, worst.over))
        };
        points.par_iter().map(of).collect()
    }

    /// Judges each point.
    ///
    /// * `guard`: points that only ground nearer than this hides, grid cells, are told apart.
    pub(crate) fn judge(&self, points: &[ReferencePoint], guard: f64) -> Vec<Verdict> {
        let of = |p: &ReferencePoint| {
            let Some(line) = self.line(p.grid, p.lift) else { return Verdict::NoGround };
            let near = self.ground.excess(&line, 0.0).over;
            if !(near > TOUCH) {
                return Verdict::Seen;
            }
            let far = self.ground.excess(&line, guard).over;
            Verdict::Hidden(if far > TOUCH { Hides::Ground(far) } else { Hides::InGuard(near) })
        };
        points.par_iter().map(of).collect()
    }
}
