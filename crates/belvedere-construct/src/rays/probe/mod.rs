//! Auto-probing: turns of the rays that nobody placed, into what the straight picture does not show.
//!
//! Ours, beyond the paper (Cui et al. 2010 leave the construction to the user). Space is divided into cells with their clearance. The
//! cheapest paths (Dijkstra) lead from the cells that the eye sees to others, and those from whose ends most unseen surface is seen
//! become chains of turns, by the builder of the path preview. The best few are improved coordinate by coordinate; the chain that
//! shows most new surface, for its distortion and losses, is taken if it is better than no turn at all.

mod chain;
mod goals;
mod judge;
mod polish;
mod region;
mod surfaces;
mod voxels;
mod ways;

use crate::ConstructError;
use belvedere_core::{DVec3, View};
use belvedere_scene::{Progress, Scene};
use chain::Chain;
use goals::ProbeFrustum;
use judge::Judge;
use rayon::prelude::*;
use region::Region;
use serde::{Deserialize, Serialize};
use surfaces::surface_points;
use voxels::Voxels;
use ways::{Price, Ways};

/// Number of surface points by which views are judged, and the stride at which the search takes them.
const POINTS: usize = 3000;
const SEARCH_STRIDE: usize = 6;
/// Clearances of paths that are tried one after the other, shares of the picture's half height.
const CLEARANCES: [f64; 4] = [1.0, 0.5, 0.25, 0.12];
/// Length that a turn of a radian costs, cells; and clearance at which a unit of length costs twice as much, cells.
const TURN_CELLS: f64 = 4.0;
const TIGHT_CELLS: f64 = 1.0;
/// Greatest length of a path, share of the reach.
const LONGEST: f64 = 1.3;
/// Least distance from the eye at which rays turn, share of the reach: nearer turns would carry the whole picture along.
const FIRST_LEG: f64 = 0.08;
/// Chains that are improved.
const POLISHED: usize = 8;
/// Score that every turn must gain, share of the surface that the straight picture shows.
const TURN_WORTH: f64 = 0.02;
/// In a film, share of its first score below which a chain is given up, and time until another is sought, seconds.
const KEPT_WORTH: f64 = 0.4;
const PAUSE_S: f64 = 1.0;

/// Parameters; the defaults are those of the scene file.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ProbeOptions {
    /// Turns at most, 1..=6.
    pub turns: usize,
    /// Distance from the eye within which surfaces count, scene units, > 0; by default three times the median distance of what the
    /// straight picture shows.
    pub reach: Option<f64>,
    /// Turns that come in or go per second of a film, > 0.
    pub cap_per_s: f64,
}

impl Default for ProbeOptions {
    fn default() -> Self {
        Self { turns: 3, reach: None, cap_per_s: 0.5 }
    }
}

impl ProbeOptions {
    fn check(&self) -> Result<(), ConstructError> {
        for (name, value) in [("reach_m", self.reach.unwrap_or(1.0)), ("cap_per_s", self.cap_per_s)] {
            if !(value > 0.0 && value.is_finite()) {
                return Err(ConstructError::Parameter { name, value, must: "be a number greater than 0" });
            }
        }
        if !(1..=6).contains(&self.turns) {
            let (name, value) = ("turns", self.turns as f64);
            return Err(ConstructError::Parameter { name, value, must: "be a whole number in 1..=6" });
        }
        Ok(())
    }
}

/// Memory between frames. The same inputs and memory give the same result.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct ProbeMemory {
    chain: Option<Kept>,
    /// Number of its turns that have come in.
    entered: f64,
    /// Whether its turns are being withdrawn.
    leaving: bool,
    /// Time until another chain is sought, seconds.
    pause_s: f64,
}

/// A chain in use.
#[derive(Debug, Clone, PartialEq)]
struct Kept {
    chain: Chain,
    /// Its score when it was found.
    score: f64,
    /// Distance of its first corner from the eye when it was found, scene units.
    first: f64,
    gained_by_turn: Vec<f64>,
    found: Found,
}

/// The camera of one frame.
#[derive(Debug, Clone)]
pub struct Probed {
    /// The bent view; `base` itself where no turn shows more.
    pub view: View,
    /// Figures.
    pub report: ProbeReport,
}

/// How the search went.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize, Deserialize)]
pub struct Found {
    /// Cells along x, y, z that space was divided into.
    pub cells: [usize; 3],
    /// Their edge, scene units.
    pub cell_m: f64,
    /// Distance from the eye within which surfaces count, scene units.
    pub reach_m: f64,
    /// Cameras that were tried.
    pub tried: usize,
}

/// Report of a probe. Shares are of the surface within reach.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct ProbeReport {
    /// Turns of the rays that were found.
    pub turns: usize,
    /// Number of turns that have come in; in a film they do so one after the other.
    pub entered: f64,
    /// Share of the surface that the straight picture shows.
    pub seen_straight: f64,
    /// Share that this picture shows.
    pub seen: f64,
    /// Share that it shows and the straight one does not.
    pub gained: f64,
    /// Share that only the straight one shows.
    pub lost: f64,
    /// Share that was gained with the first turn alone, the first two, and so on, when they were found.
    pub gained_by_turn: Vec<f64>,
    /// Mean of 1 minus the ratio of the smallest to the largest scale at a place, over what is seen; 0 = none.
    pub distortion: f64,
    /// Mean distortion of the straight picture.
    pub distortion_straight: f64,
    /// Mean angle by which the camera's up is turned in the picture, over what is seen, degrees.
    pub roll_deg: f64,
    /// Share of what is seen that is drawn at less than half the scale of its surroundings.
    pub undersampled: f64,
    /// Clearance that the path of the probe keeps, shares of half the picture's height there.
    pub clearance: f64,
    /// Length of the path, scene units.
    pub length_m: f64,
    /// Corners of the path, and its end; scene coordinates.
    pub way: Vec<[f64; 3]>,
    /// How the search went.
    pub search: Found,
}

/// The camera of a frame whose rays turn into what the straight picture does not show.
///
/// * `base`: the camera, with other stages but curved rays if need be: perspective;
/// * `time_step_s`: seconds since the frame before, in which turns come in one after the other; `None` for a picture of its own, which
///   has all of them at once.
///
/// # Errors
/// [`ConstructError::Parameter`], [`ConstructError::Cancelled`], [`ConstructError::Rays`] for an orthographic camera.
pub fn auto_probe(
    scene: &Scene,
    base: &View,
    options: &ProbeOptions,
    time_step_s: Option<f64>,
    memory: &mut ProbeMemory,
    progress: &Progress,
) -> Result<Probed, ConstructError> {
    options.check()?;
    let pinhole = base.pinhole();
    if pinhole.is_orthographic() {
        return Err(belvedere_core::map::curved_rays::CurvedRaysError::Orthographic.into());
    }
    let Some(region) = Region::new(scene, base, options.reach) else { return Ok(nothing(base)) };
    let extent = (region.bounds.max - region.bounds.min).length();
    let judge = Judge::new(scene, base, surface_points(scene, &region.bounds, POINTS), extent);
    memory.pause_s -= time_step_s.unwrap_or(0.0);
    memory.review(base, &judge, options, time_step_s);
    if memory.chain.is_none() && (time_step_s.is_none() || memory.pause_s <= 0.0) {
        memory.chain = search(scene, base, options, &region, &judge, progress)?;
        (memory.entered, memory.leaving, memory.pause_s) = (0.0, false, PAUSE_S);
        memory.move_on(base, options, time_step_s.map(|_| 0.0));
    } else {
        memory.move_on(base, options, time_step_s);
    }
    let Some(Kept { chain, found, gained_by_turn, .. }) = &memory.chain else { return Ok(straight(base, &judge)) };
    let view = chain.view(base, memory.entered).unwrap_or_else(|| base.clone());
    let verdict = judge.verdict(&view, 1);
    let turns = chain.turns(pinhole.eye);
    let half_height = half_height(pinhole);
    let report = ProbeReport {
        turns,
        entered: memory.entered,
        seen_straight: judge.seen_straight(),
        seen: verdict.seen,
        gained: verdict.gained,
        lost: verdict.lost,
        gained_by_turn: gained_by_turn.clone(),
        distortion: verdict.marks.distortion,
        distortion_straight: judge.verdict(base, 1).marks.distortion,
        roll_deg: verdict.marks.roll.to_degrees(),
        undersampled: verdict.marks.undersampled,
        clearance: chain.clearance_per_length / half_height,
        length_m: chain.length(pinhole.eye),
        way: chain.points.iter().map(|p| p.to_array()).collect(),
        search: *found,
    };
    Ok(Probed { view, report })
}

/// Half the picture's height at a distance of 1.
fn half_height(pinhole: &belvedere_core::Pinhole) -> f64 {
    0.5 * f64::from(pinhole.image[1]) / pinhole.scale_px()
}

fn nothing(base: &View) -> Probed {
    let report = ProbeReport {
        turns: 0,
        entered: 0.0,
        seen_straight: 0.0,
        seen: 0.0,
        gained: 0.0,
        lost: 0.0,
        gained_by_turn: Vec::new(),
        distortion: 0.0,
        distortion_straight: 0.0,
        roll_deg: 0.0,
        undersampled: 0.0,
        clearance: 0.0,
        length_m: 0.0,
        way: Vec::new(),
        search: Found::default(),
    };
    Probed { view: base.clone(), report }
}

fn straight(base: &View, judge: &Judge<'_>) -> Probed {
    let Probed { view, report } = nothing(base);
    let (seen, marks) = (judge.seen_straight(), judge.verdict(base, 1).marks);
    let (distortion, roll_deg, undersampled) = (marks.distortion, marks.roll.to_degrees(), marks.undersampled);
    let report = ProbeReport {
        seen_straight: seen,
        seen,
        distortion,
        distortion_straight: distortion,
        roll_deg,
        undersampled,
        ..report
    };
    Probed { view, report }
}

impl ProbeMemory {
    /// Decides whether the chain in use stays.
    fn review(&mut self, base: &View, judge: &Judge<'_>, options: &ProbeOptions, time_step_s: Option<f64>) {
        let Some(kept) = &self.chain else { return };
        let eye = base.pinhole().eye;
        let turns = kept.chain.turns(eye);
        let view = kept.chain.view(base, f64::INFINITY);
        let score = view.map_or(f64::NEG_INFINITY, |view| judge.verdict(&view, SEARCH_STRIDE).score);
        let near = kept.chain.points[0].distance(eye) < 0.4 * kept.first;
        let is_good = turns >= 1 && turns <= options.turns && score > KEPT_WORTH * kept.score && !near;
        self.leaving |= !is_good;
        if self.leaving && (time_step_s.is_none() || self.entered <= 0.0) {
            (self.chain, self.leaving) = (None, false);
        }
    }

    /// Lets turns come in at the set speed, or withdraws them.
    fn move_on(&mut self, base: &View, options: &ProbeOptions, time_step_s: Option<f64>) {
        let Some(kept) = &self.chain else {
            self.entered = 0.0;
            return;
        };
        let turns = kept.chain.turns(base.pinhole().eye) as f64;
        self.entered = match time_step_s {
            None => turns,
            Some(dt) if self.leaving => (self.entered - options.cap_per_s * dt).max(0.0),
            Some(dt) => (self.entered + options.cap_per_s * dt).min(turns),
        };
    }
}

/// The best chain there is; `None` if none is better than straight rays.
fn search(
    scene: &Scene,
    base: &View,
    options: &ProbeOptions,
    region: &Region,
    judge: &Judge<'_>,
    progress: &Progress,
) -> Result<Option<Kept>, ConstructError> {
    let pinhole = base.pinhole();
    progress.tick("dividing space into cells", 0.0)?;
    let voxels = Voxels::new(scene, &region.bounds);
    let is_seen = region::cells_seen(&voxels, base, judge.obstacles());
    let far_enough = |c: &usize| voxels.center(*c).distance(pinhole.eye) > FIRST_LEG * region.reach;
    let seen: Vec<usize> = (0..voxels.len()).filter(|c| is_seen[*c]).filter(far_enough).collect();
    let unseen = judge.unseen();
    let half_height = half_height(pinhole);
    let mut tried = 0;
    let mut scored: Vec<(f64, Chain)> = Vec::new();
    for (i, share) in CLEARANCES.into_iter().enumerate() {
        progress.tick("looking for ways round what hides", 0.1 + 0.15 * i as f64)?;
        let price = Price {
            clearance_per_length: share * half_height,
            per_radian: TURN_CELLS * voxels.cell(),
            tight: TIGHT_CELLS * voxels.cell(),
            longest: LONGEST * region.reach,
        };
        let ways = Ways::new(&voxels, pinhole.eye, &seen, &price, &progress.unheard())?;
        let frustum = ProbeFrustum {
            eye: pinhole.eye,
            up: -pinhole.down,
            cosine: half_height.atan().cos(),
            reach: region.reach,
            turns: options.turns,
            clearance_per_length: price.clearance_per_length,
        };
        let chains = goals::best_ways(&ways, &voxels, &unseen, &frustum);
        progress.tick("looking for ways round what hides", 0.2 + 0.15 * i as f64)?;
        tried += chains.len();
        let judged = chains.into_par_iter().filter_map(|chain| {
            let view = chain.view(base, f64::INFINITY)?;
            Some((judge.verdict(&view, SEARCH_STRIDE).score - price_of(&chain, pinhole.eye), chain))
        });
        scored.extend(judged.collect::<Vec<_>>());
    }
    scored.sort_by(|a, b| b.0.total_cmp(&a.0));
    scored.dedup_by(|b, a| a.1.points == b.1.points);
    scored.truncate(POLISHED);
    let mut best: Option<(f64, Chain)> = None;
    for (i, (score, chain)) in scored.into_iter().enumerate() {
        progress.tick("improving the best ways", 0.7 + 0.035 * i as f64)?;
        let (score, chain, more) = polish::polished(chain, score, base, &voxels, judge, &progress.unheard())?;
        tried += more;
        if best.as_ref().is_none_or(|(s, _)| score > *s) {
            best = Some((score, chain));
        }
    }
    let Some((_, chain)) = best else { return Ok(None) };
    let found = Found { cells: voxels.size(), cell_m: voxels.cell(), reach_m: region.reach, tried };
    Ok(kept(chain, base, judge, found))
}

/// A chain judged by all points, which decide whether it is better than no turn at all.
fn kept(chain: Chain, base: &View, judge: &Judge<'_>, found: Found) -> Option<Kept> {
    let (view, eye) = (chain.view(base, f64::INFINITY)?, base.pinhole().eye);
    let verdict = judge.verdict(&view, 1);
    let score = verdict.score - price_of(&chain, eye);
    if !(score > 0.0 && verdict.gained > verdict.lost) {
        return None;
    }
    let first = chain.points[0].distance(eye);
    let gained = |k: usize| chain.view(base, k as f64).map_or(0.0, |view| judge.verdict(&view, 1).gained);
    let gained_by_turn = (1..=chain.turns(eye)).map(gained).collect();
    Some(Kept { chain, score, first, gained_by_turn, found })
}

fn price_of(chain: &Chain, eye: DVec3) -> f64 {
    TURN_WORTH * chain.turns(eye) as f64
}
