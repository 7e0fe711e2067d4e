//! The price of a bend: stretches of features are given up, the dearest first, until the ground moves no more than is allowed.
//!
//! At the optimum the energy of the displacement is the sum of -1/2 multiplier x bound over the rows, so what each stretch costs is known
//! without a further solution. A price per metre would spread the loss over all points and save little; whole stretches that are left
//! out give most of the displacement back. Ours.

use super::super::visibility_qp::{Candidate, QpOptions, QpProblem, QpResult, QpSolver};
use super::super::{Hierarchy, KINDS, PointKind, ReferencePoint, TerrainSettings};
use super::likeness::Likeness;
use super::memory::Prepared;
use crate::DisocclusionError;
use belvedere_core::DVec2;
use belvedere_scene::Progress;
use serde::Serialize;
use std::collections::{BTreeMap, BTreeSet};

/// Stretches that all lines, and all areas, are divided into, about.
const PARTS: f64 = 40.0;
/// Shortest stretch, and side of the smallest tile of an area, grid cells.
const SHORTEST: f64 = 2.0;
/// Stretches are given up together until they hold this share of the energy, or that which takes the strain to this multiple of the aim.
const AT_ONCE: f64 = 0.08;
const SHORT_OF: f64 = 1.3;
/// Share of the features that a stretch counts for at least, so that those without length or area come first.
const LEAST_PART: f64 = 1e-9;
/// Most solutions in which stretches are given up, and in which they are taken back: where all are met, and where they are compared roughly.
const GIVEN_UP: usize = 60;
const TAKEN_BACK: [usize; 2] = [5, 3];
/// Roughly compared solutions miss clearances by no more than this share of the relief.
const ROUGH: f64 = 0.005;
/// Share of the stated move that the program aims at: agreement with the judge moves the ground a little more.
const AIM: f64 = 0.97;
/// Share of the aim below which stretches are taken back although the judge asked for more than is allowed.
const ROOM: f64 = 0.8;
/// Least share by which the aim is lowered at a time, and how often the judge may make the ground move more than is allowed.
const LOWER: f64 = 0.8;
const ROUNDS: usize = 6;

/// A stretch of a line, a tile of an area, or a point feature: layer, feature, and number along the line or column and row.
type Stretch = (usize, usize, i64, i64);

/// How features are divided into stretches.
#[derive(Debug, Clone, Copy, Default)]
struct Division {
    /// Length of stretches, and side of tiles, scene units.
    length: f64,
    side: f64,
    /// Of the ground.
    spacing: DVec2,
}

impl Division {
    fn of(&self, p: &ReferencePoint) -> Stretch {
        let (x, y) = match p.kind {
            PointKind::Line => ((p.along_m / self.length).floor() as i64, 0),
            PointKind::Rim | PointKind::Inside => {
                let tile = (p.grid * self.spacing / self.side).floor();
                (tile.x as i64, tile.y as i64)
            }
            PointKind::Landmark => (0, 0),
        };
        (p.layer, p.feature, x, y)
    }
}

/// What is shown for how much displacement, and what was given up.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct PriceReport {
    /// The solution that was taken, before the judge asked for more.
    pub taken: PricePoint,
    /// Solutions, the first of which shows all: one for each time that stretches were given up or taken back.
    pub curve: Vec<PricePoint>,
    /// Stretches given up, the dearest first.
    pub given_up: Vec<PricedStretch>,
    /// Stretches that are shown and took the largest shares of the energy of the solution taken, the dearest first.
    pub dearest: Vec<PricedStretch>,
}

/// A solution on the way to the price that was stated.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct PricePoint {
    /// Share of the features in view that the ground makes way for, 0..=1; the least of lines, areas and points.
    pub asked: f64,
    /// Root mean square displacement over the nodes of the solver's grid, scene units.
    pub rms_m: f64,
    /// Largest displacement there, up or down.
    pub max_m: f64,
    /// How much of what is allowed it uses, more than 1 where it exceeds that: of the largest displacement or of the bounds of the landscape;
    /// absent where only a share is stated.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub strain: Option<f64>,
}

/// A stretch of the features and its price.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct PricedStretch {
    /// Index of the layer in the scene.
    pub layer: usize,
    /// Index of the feature in its layer.
    pub feature: usize,
    /// Length along the line where the stretch begins, and its length; 0 of areas and points.
    pub from_m: f64,
    /// See `from_m`.
    pub length_m: f64,
    /// Scene x, y of its first point.
    pub at: [f64; 2],
    /// Share of the energy that it took, in the end or when it was given up, 0..=1.
    pub share: f64,
}

impl PricedStretch {
    /// Whether a point of the same features, on whatever grid, lies on it; every point of an area or of a point feature does.
    pub(super) fn holds(&self, p: &ReferencePoint) -> bool {
        let is_along = p.kind != PointKind::Line || (0.0..self.length_m).contains(&(p.along_m - self.from_m));
        (self.layer, self.feature) == (p.layer, p.feature) && is_along
    }
}

/// A stretch is dear if it takes this share of the energy.
const DEAR: f64 = 0.02;

/// The stretches of the features in view, and which of them are given up.
pub(super) struct Price<'a> {
    prepared: &'a Prepared,
    /// Share that must be shown at least, and largest displacement.
    show: f64,
    most_m: Option<f64>,
    /// The picture that must stay like itself.
    likeness: Option<Likeness<'a>>,
    /// How solutions are compared where there are many candidates: met only roughly.
    rough: Option<QpOptions>,
    /// Share of the largest displacement that the program aims at.
    aim: f64,
    /// Times that the judge made the ground move more than is allowed.
    exceeded: usize,
    division: Division,
    stretches: BTreeMap<Stretch, Amount>,
    /// Amounts of all stretches, and of those that are still asked for.
    all: [f64; KINDS],
    kept: [f64; KINDS],
    /// In the order in which they were given up, and as a set.
    given_up: Vec<(Stretch, PricedStretch)>,
    gone: BTreeSet<Stretch>,
    curve: Vec<PricePoint>,
    taken: Option<(PricePoint, Vec<PricedStretch>)>,
}

/// What a stretch stands for.
#[derive(Debug, Clone, Copy)]
struct Amount {
    kind: usize,
    amount: f64,
    first: ReferencePoint,
}

impl<'a> Price<'a> {
    /// `None` where no price is stated.
    ///
    /// * `asked`: the candidates; `in_view`: points that stand for equal parts of the features in view.
    pub(super) fn new(
        settings: &TerrainSettings,
        prepared: &'a Prepared,
        likeness: Option<Likeness<'a>>,
        [asked, in_view]: [&[Candidate]; 2],
    ) -> Option<Self> {
        let (show, most_m) = (settings.show, settings.move_at_most_m);
        if show.is_none() && most_m.is_none() && likeness.is_none() {
            return None;
        }
        let [asked, points] = [asked, in_view].map(|candidates| -> Vec<ReferencePoint> {
            candidates.iter().filter_map(|c| prepared.candidate(c.id)).copied().collect()
        });
        let mut all = [0.0; KINDS];
        points.iter().for_each(|p| all[p.kind.of_feature()] += p.amount);
        let spacing = prepared.level.spacing();
        let shortest = SHORTEST * spacing.max_element();
        let (length, side) = ((all[0] / PARTS).max(shortest), (all[1] / PARTS).sqrt().max(shortest));
        let division = Division { length, side, spacing };
        let mut stretches = BTreeMap::new();
        // A candidate may lie on a tile that has no part of the area.
        for (p, amount) in points.into_iter().map(|p| (p, p.amount)).chain(asked.into_iter().map(|p| (p, 0.0))) {
            let new = Amount { kind: p.kind.of_feature(), amount: 0.0, first: p };
            stretches.entry(division.of(&p)).or_insert(new).amount += amount;
        }
        let show = show.unwrap_or(0.0);
        Some(Self {
            prepared,
            show,
            most_m,
            likeness,
            rough: None,
            aim: AIM,
            exceeded: 0,
            division,
            stretches,
            all,
            kept: all,
            given_up: Vec::new(),
            gone: BTreeSet::new(),
            curve: Vec::new(),
            taken: None,
        })
    }

    /// Gives up a stretch, as the `k`-th.
    fn give(&mut self, k: usize, (stretch, given): (Stretch, PricedStretch)) {
        let Amount { kind, amount, .. } = self.stretches[&stretch];
        self.kept[kind] -= amount;
        self.gone.insert(stretch);
        self.given_up.insert(k, (stretch, given));
    }

    /// Asks for the `k`-th stretch that was given up again.
    fn ask(&mut self, k: usize) -> (Stretch, PricedStretch) {
        let (stretch, given) = self.given_up.remove(k);
        let Amount { kind, amount, .. } = self.stretches[&stretch];
        self.kept[kind] += amount;
        self.gone.remove(&stretch);
        (stretch, given)
    }

    /// Whether the stretch of a point was given up.
    pub(super) fn gave_up(&self, p: &ReferencePoint) -> bool {
        self.gone.contains(&self.division.of(p))
    }

    /// The candidates that are still asked for.
    pub(super) fn kept(&self, candidates: &[Candidate]) -> Vec<Candidate> {
        let is_gone = |c: &Candidate| self.prepared.candidate(c.id).is_some_and(|p| self.gave_up(p));
        candidates.iter().filter(|c| !is_gone(c)).copied().collect()
    }

    /// Share of the features that is still asked for: the least of lines, areas and points.
    fn asked(&self) -> f64 {
        if self.gone.is_empty() {
            return 1.0;
        }
        let kinds = (0..KINDS).filter(|k| self.all[*k] > 0.0);
        kinds.map(|k| (self.kept[k] / self.all[k]).max(0.0)).fold(1.0, f64::min)
    }

    /// From now on solutions are compared that are met only roughly; the one that is taken is met as `exact` says.
    pub(super) fn compare_roughly(&mut self, exact: QpOptions) -> QpOptions {
        let rough = QpOptions { enough: ROUGH * self.prepared.level.relief(), ..exact };
        *self.rough.insert(rough)
    }

    /// Solves until the ground moves no more than is allowed, or gives up as much as is allowed.
    ///
    /// * `result`: a solution for the candidates that are asked for; `exact`: how the one that is taken is met.
    pub(super) fn settle(
        &mut self,
        qp: &mut QpSolver,
        problem: &QpProblem<'_>,
        mut result: QpResult,
        exact: QpOptions,
        progress: &Progress,
    ) -> Result<QpResult, DisocclusionError> {
        if self.curve.is_empty() {
            self.note(&result);
        }
        // Stretches that were given up for the judge would make it ask for more again, unless that left much room.
        let room = if self.exceeded == 0 { 1.0 } else { ROOM };
        let (mut takes_back, mut is_exact) = (true, false);
        for _ in 0..GIVEN_UP {
            qp.set_options(self.rough.unwrap_or(exact));
            let strain = self.strain_of(&result);
            if strain > self.aim && !progress.should_end() && self.give_up(&result, strain) {
                progress.tick("the price of the displacement", 0.7)?;
                (result, is_exact) = (self.solved(qp, problem, progress)?, false);
                continue;
            }
            if is_exact {
                break;
            }
            if strain <= room * self.aim && std::mem::take(&mut takes_back) {
                result = self.take_back(qp, problem, result, progress)?;
            }
            qp.set_options(exact);
            if self.rough.is_none() {
                break;
            }
            (result, is_exact) = (self.solved(qp, problem, progress)?, true);
            if self.strain_of(&result) <= 1.0 || progress.should_end() {
                break;
            }
        }
        self.taken = Some((self.point(&result), self.dearest(&result)));
        Ok(result)
    }

    /// Energy of the rows of each stretch.
    fn energy(&self, result: &QpResult) -> BTreeMap<Stretch, f64> {
        let mut energy = BTreeMap::new();
        for row in &result.active {
            let Some(point) = row.candidate.and_then(|id| self.prepared.candidate(id)) else { continue };
            *energy.entry(self.division.of(point)).or_default() += row.multiplier * (-row.bound).max(0.0);
        }
        energy
    }

    /// The stretches that took most of a solution.
    fn dearest(&self, result: &QpResult) -> Vec<PricedStretch> {
        let energy = self.energy(result);
        let all: f64 = energy.values().sum();
        let shares = energy.into_iter().map(|(stretch, energy)| (stretch, energy / all));
        let known = |(stretch, share): &(Stretch, f64)| *share >= DEAR && self.stretches.contains_key(stretch);
        let mut dearest: Vec<PricedStretch> =
            shares.filter(known).map(|(stretch, share)| self.given(stretch, share)).collect();
        dearest.sort_by(|a, b| b.share.total_cmp(&a.share));
        dearest
    }

    /// Part of the features of its kind that a stretch stands for.
    fn part(&self, stretch: &Stretch) -> f64 {
        let of = self.stretches.get(stretch).filter(|of| self.all[of.kind] > 0.0);
        of.map_or(0.0, |of| of.amount / self.all[of.kind]).max(LEAST_PART)
    }

    fn strain_of(&self, result: &QpResult) -> f64 {
        self.strain(&self.prepared.grid, &result.u)
    }

    /// How much of what is allowed a displacement uses, > 1 if it exceeds that; infinite where nothing is, for then as little as possible is
    /// wanted.
    ///
    /// * `u`: displacement of the nodes of `grid`.
    fn strain(&self, grid: &Hierarchy, u: &[f64]) -> f64 {
        let moved = self.most_m.map(|most| largest(u) / most);
        let changed = self.likeness.as_ref().map(|likeness| likeness.strain(grid, u));
        [moved, changed].into_iter().flatten().reduce(f64::max).unwrap_or(f64::INFINITY)
    }

    /// Whether a displacement exceeds what is allowed although the program met it, and more can be given up. The judge asks for more than
    /// the program did, so the program aims lower than it came then, and at last gives up what is left.
    ///
    /// * `u`: displacement of the nodes of `grid`.
    pub(super) fn is_exceeded(&mut self, grid: &Hierarchy, u: &[f64]) -> bool {
        let strain = self.strain(grid, u);
        if !(strain.is_finite() && strain > 1.0) {
            return false;
        }
        let came = self.taken.as_ref().and_then(|(taken, _)| taken.strain).unwrap_or(self.aim);
        self.aim = came * (AIM / strain).max(LOWER);
        self.exceeded += 1;
        if self.exceeded >= ROUNDS && self.show == 0.0 {
            let left: Vec<Stretch> = self.stretches.keys().filter(|s| !self.gone.contains(s)).copied().collect();
            left.into_iter().for_each(|stretch| self.give(self.given_up.len(), (stretch, self.given(stretch, 0.0))));
        }
        self.exceeded <= ROUNDS
    }

    fn solved(
        &mut self,
        qp: &mut QpSolver,
        problem: &QpProblem<'_>,
        progress: &Progress,
    ) -> Result<QpResult, DisocclusionError> {
        let candidates = self.kept(problem.candidates);
        let result = qp.solve_with(&QpProblem { candidates: &candidates, ..*problem }, progress)?;
        self.note(&result);
        Ok(result)
    }

    fn note(&mut self, result: &QpResult) {
        let point = self.point(result);
        self.curve.push(point);
    }

    fn point(&self, result: &QpResult) -> PricePoint {
        let squares: f64 = result.u.iter().map(|u| u * u).sum();
        let rms_m = (squares / result.u.len().max(1) as f64).sqrt();
        let strain = Some(self.strain(&self.prepared.grid, &result.u)).filter(|strain| strain.is_finite());
        PricePoint { asked: self.asked(), rms_m, max_m: largest(&result.u), strain }
    }

    /// Gives up the dearest stretches per share of the features, at least one; `false` if none may be.
    ///
    /// * `strain`: of the solution: far beyond what is allowed more are given up at once.
    fn give_up(&mut self, result: &QpResult, strain: f64) -> bool {
        // The energy is a square of the displacement.
        let beyond = if strain.is_finite() { 1.0 - (SHORT_OF * self.aim / strain).powi(2) } else { 0.0 };
        let at_once = beyond.max(AT_ONCE);
        let energy = self.energy(result);
        let all: f64 = energy.values().sum();
        let known = |(stretch, energy): &(Stretch, f64)| {
            *energy > 0.0 && self.stretches.contains_key(stretch) && !self.gone.contains(stretch)
        };
        let mut dearest: Vec<(Stretch, f64)> = energy.into_iter().filter(known).collect();
        dearest.sort_by(|a, b| (b.1 / self.part(&b.0)).total_cmp(&(a.1 / self.part(&a.0))));
        let mut gone = 0.0;
        for (stretch, energy) in dearest {
            let last = self.given_up.len();
            self.give(last, (stretch, self.given(stretch, energy / all)));
            if self.asked() < self.show {
                self.ask(last);
                continue;
            }
            gone += energy;
            if gone >= at_once * all {
                break;
            }
        }
        gone > 0.0
    }

    /// Takes back stretches that turn out to be free, those that were given up last first.
    fn take_back(
        &mut self,
        qp: &mut QpSolver,
        problem: &QpProblem<'_>,
        mut best: QpResult,
        progress: &Progress,
    ) -> Result<QpResult, DisocclusionError> {
        let most = TAKEN_BACK[usize::from(self.rough.is_some())];
        for k in (0..self.given_up.len()).rev().take(most) {
            if progress.should_end() {
                break;
            }
            let given = self.ask(k);
            let result = self.solved(qp, problem, progress)?;
            if self.strain_of(&result) <= self.aim && !result.stopped {
                best = result;
            } else {
                self.give(k, given);
            }
        }
        Ok(best)
    }

    fn given(&self, stretch: Stretch, share: f64) -> PricedStretch {
        let Amount { first, .. } = self.stretches[&stretch];
        let is_line = first.kind == PointKind::Line;
        PricedStretch {
            layer: stretch.0,
            feature: stretch.1,
            from_m: if is_line { stretch.2 as f64 * self.division.length } else { 0.0 },
            length_m: if is_line { self.division.length } else { 0.0 },
            at: self.prepared.level.scene_from_grid(first.grid).to_array(),
            share,
        }
    }

    /// What was paid in the end.
    pub(super) fn paid(self) -> Paid {
        let given_up = self.given_up.into_iter().map(|(_, given)| given).collect();
        let report = self.taken.map(|(taken, dearest)| PriceReport { taken, curve: self.curve, given_up, dearest });
        Paid { division: self.division, gone: self.gone, report }
    }
}

/// What was shown for what price.
#[derive(Debug, Clone, Default)]
pub(super) struct Paid {
    division: Division,
    gone: BTreeSet<Stretch>,
    pub(super) report: Option<PriceReport>,
}

impl Paid {
    pub(super) fn gave_up_any(&self) -> bool {
        !self.gone.is_empty()
    }

    /// Whether the stretch of a point was given up.
    pub(super) fn gave_up(&self, p: &ReferencePoint) -> bool {
        !self.gone.is_empty() && self.gone.contains(&self.division.of(p))
    }
}

fn largest(u: &[f64]) -> f64 {
    u.iter().fold(0.0, |most, u| u.abs().max(most))
}
