//! Chooses a view and a bend that show more of the features than a straight picture can.
//!
//! The view: eyes all around the features, judged by their pictures: the whole features in the frame and large, on ground that the grid can
//! carry, under a horizon. Where a straight picture hides nothing, nothing is bent. The bend: a B-spline over the mean ground
//! that turns the ground with the features towards the eye and lets the background sink back to a horizon
//! (Pasewaldt et al. 2011; their presets are drawn by hand, the choice by visible length is ours).

mod choice;
mod choose;
mod evaluate;
mod eyes;
mod goal;
mod options;
mod polish;
mod score;
mod search;
mod shape;
pub mod thresholds;

pub use choice::Choice;
pub use evaluate::Evaluation;
pub use goal::{Goal, gain, shortfall};
pub use options::{REFERENCE_HEIGHT_PX, RevealOptions};
pub use shape::BendShape;

use crate::ConstructError;
use crate::sample::{Amount, SampledFeature};
use crate::samples::{default_spacing, sample_features};
use belvedere_core::presets::PresetDocument;
use belvedere_core::{DVec2, DVec3, View, Warning, WarningKind};
use belvedere_scene::{Heightfield, Progress, Scene, Unit};
use choose::Base;
use evaluate::Evaluator;
use options::{at_reference, sized};
use search::Candidate;
use serde::Serialize;

/// Memory of an earlier call, from whose result the next search for the same scene starts. The same inputs and memory give the same result.
#[derive(Debug, Clone, Default)]
pub struct RevealMemory {
    start: Option<search::SearchStart>,
}

/// A view and a bend, and what they achieve.
#[derive(Debug, Clone)]
pub struct Revealed {
    /// The view: bent, or straight if no bend pays.
    pub view: View,
    /// The same camera without the bend.
    pub straight: View,
    /// The bend; `None` if the straight picture is the answer, because it hides nothing or no bend shows more.
    pub bend: Option<RevealedBend>,
    /// Height of the reference plane (median of the terrain), scene units.
    pub plane_height: f64,
    /// Figures.
    pub report: RevealReport,
}

impl Revealed {
    /// The same in a picture of another size, pixels.
    fn sized(self, image: [u32; 2]) -> Self {
        Self { view: sized(&self.view, image), straight: sized(&self.straight, image), ..self }
    }
}

/// The bend of a [`Revealed`].
#[derive(Debug, Clone)]
pub struct RevealedBend {
    /// The bend as a preset document, for scene files.
    pub document: PresetDocument,
    /// Pivot of the bend, scene coordinates, on the reference plane.
    pub pivot: DVec3,
}

/// Figures of a [`Revealed`], ready for JSON.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct RevealReport {
    /// Length of all lines; of areas alone their area, of points alone their number.
    pub total: f64,
    /// The picture without the bend.
    pub straight: Evaluation,
    /// The picture with it.
    pub bent: Evaluation,
    /// Visible share of the whole features bent over that straight; `None` if the straight picture shows nothing.
    pub gain: Option<f64>,
    /// Whether the goals were reached.
    pub goal: Goal,
    /// The bend, by its angles; `None` if the picture is straight.
    pub shape: Option<BendShape>,
    /// Smallest sine of the angle at which the ground plane is seen; > 0 = from above everywhere.
    pub facing: f64,
    /// Smallest factor by which the bend squeezes lengths over the terrain in the picture; 0 = fold.
    pub squeeze: f64,
    /// Eyes evaluated; 0 if the view was given.
    pub eyes_tried: usize,
    /// Bends evaluated.
    pub bends_tried: usize,
    /// Oddities, one sentence each.
    pub warnings: Vec<Warning>,
}

/// Chooses a view (unless one is given) and a spline bend that show more of the layers that must be seen.
///
/// * `scene`: with terrain; or a city without it, for which a camera is given: it stands on level ground.
/// * `given`: a camera, with earth curvature at most; its other stages are left out.
/// * `memory`: where the search of an earlier frame ended;
/// * `progress`: when its time is up, the best view so far is taken.
///
/// Views and bends are chosen in a picture of the same shape that is [`REFERENCE_HEIGHT_PX`] high, so that they are those of every size of it.
/// Everything is evaluated by line of sight along the rays, so no renderer is needed; [`crate::measure()`] with a renderer
/// is the independent check. Deterministic, whatever the number of threads.
///
/// # Errors
/// [`ConstructError::NoTerrain`], [`ConstructError::NothingToSee`], [`ConstructError::NoSamples`],
/// [`ConstructError::EyeUnderGround`], [`ConstructError::OutOfFrame`], [`ConstructError::NoView`], [`ConstructError::Cancelled`].
pub fn reveal(
    scene: &Scene,
    given: Option<&View>,
    options: &RevealOptions,
    memory: &mut RevealMemory,
    progress: &Progress,
) -> Result<Revealed, ConstructError> {
    let flat;
    let heightfield = match scene.terrain() {
        Some(terrain) => terrain,
        None => {
            flat = given.and_then(|_| flat_ground(scene)).ok_or(ConstructError::NoTerrain)?;
            &flat
        }
    };
    let features = usable_features(scene, heightfield)?;
    progress.tick("preparing lines of sight", 0.0)?;
    let evaluator = Evaluator::new(scene, heightfield, &features, 4 * options.samples_per_try);
    let (mut eyes_tried, free) = (0, given.is_none());
    let bases = match given {
        Some(view) => vec![given_view(&evaluator, &at_reference(view))?],
        None => {
            let eyes = eyes::candidates(&evaluator, options);
            eyes_tried = eyes.len();
            choose::promising(&evaluator, eyes, options, choose::VIEWS_KEPT, progress)?
        }
    };
    let (chosen, mut bends_tried) = choose::best_of_all(&evaluator, &bases, options, memory.start.as_ref(), progress)?;
    progress.tick("refining the picture", 0.8)?;
    let mut base = bases[chosen.base].clone();
    let mut start = chosen.bend;
    if free && let Some(framed) = polish::polished(&evaluator, &base, start.as_ref(), options, progress) {
        bends_tried += framed.tried;
        (base, start) = (framed.base, framed.bend.map(|(start, _)| start));
    }
    let mut bend = None;
    if let Some(start) = start {
        let (found, tried) = choose::candidate(&evaluator, &base, &start, 8, options, progress);
        bends_tried += tried;
        bend = found;
    }
    if free {
        (base, bend) = polish::widened(&evaluator, base, bend, options, progress);
    }
    memory.start = bend.as_ref().map_or(memory.start, |(start, _)| Some(*start));
    let best = bend.map(|(_, found)| found);
    progress.tick("refining the picture", 1.0)?;
    let total = KINDS.into_iter().map(|kind| total(&features, kind)).find(|total| *total > 0.0).unwrap_or(0.0);
    let found = finish(&evaluator, &base.view, best, options, &Counts { total, eyes_tried, bends_tried, free });
    Ok(found.sized(given.map_or(options.image, |view| view.pinhole().image)))
}

/// Grid cells along the longer side of level ground.
const FLAT_CELLS: f64 = 256.0;

/// Level ground under a city without terrain, at the median height of its lines and points that must be seen; `None` if there is no such
/// scene.
fn flat_ground(scene: &Scene) -> Option<Heightfield> {
    let has_mesh = scene.layers.iter().any(|l| l.kind.mesh().is_some());
    let bounds = scene.bounds();
    if scene.unit != Unit::Metre || !has_mesh || bounds.is_empty() {
        return None;
    }
    let features = sample_features(scene, default_spacing(scene));
    let mut heights: Vec<f64> = features.iter().flat_map(|f| &f.samples).map(|s| s.p_world.z - s.lift).collect();
    heights.sort_by(f64::total_cmp);
    let height = heights.get(heights.len() / 2).copied()?;
    let size = (bounds.max - bounds.min).truncate();
    let step = (size.max_element() / FLAT_CELLS).max(1e-3);
    let [cols, rows] = [size.x, size.y].map(|side| (side / step).ceil() as usize + 1);
    let north_west = DVec2::new(bounds.min.x, bounds.min.y + step * (rows - 1) as f64);
    Heightfield::measured(
        north_west,
        DVec2::splat(step),
        cols.max(2),
        rows.max(2),
        vec![height as f32; cols.max(2) * rows.max(2)],
    )
    .ok()
}

/// Angle between the headings of two drafts, degrees.
const DRAFTS_APART_DEG: f64 = 28.0;

/// Straight views from different directions that are worth choosing from, at most `count`: that of [`reveal`] first.
///
/// # Errors
/// Those of [`reveal`].
pub fn views(
    scene: &Scene,
    count: usize,
    options: &RevealOptions,
    progress: &Progress,
) -> Result<Vec<View>, ConstructError> {
    let first = reveal(scene, None, options, &mut RevealMemory::default(), progress)?.straight;
    let heightfield = scene.terrain().ok_or(ConstructError::NoTerrain)?;
    let features = usable_features(scene, heightfield)?;
    let evaluator = Evaluator::new(scene, heightfield, &features, 4 * options.samples_per_try);
    let eyes = eyes::candidates(&evaluator, options);
    let mut out = vec![first];
    let image = options.image;
    for base in choose::promising(&evaluator, eyes, options, MOST_DRAFTS, progress)? {
        let apart = |view: &View| {
            let [a, b] = [view, &base.view].map(|v| v.pinhole().forward.truncate());
            a.angle_to(b).abs().to_degrees() >= DRAFTS_APART_DEG
        };
        if out.len() < count && out.iter().all(apart) {
            out.push(sized(&base.view, image));
        }
    }
    out.truncate(count);
    Ok(out)
}

/// Views from which drafts are taken.
const MOST_DRAFTS: usize = 48;

struct Counts {
    total: f64,
    eyes_tried: usize,
    bends_tried: usize,
    /// Whether the camera was chosen.
    free: bool,
}

fn usable_features(scene: &Scene, hf: &Heightfield) -> Result<Vec<SampledFeature>, ConstructError> {
    if scene.must_see().next().is_none() {
        return Err(ConstructError::NothingToSee { layers: scene.layers.len() });
    }
    let mut features = sample_features(scene, default_spacing(scene));
    for f in &mut features {
        f.samples.retain(|s| s.amount > 0.0 && hf.surface_at(s.p_world.truncate()).is_some());
    }
    features.retain(|f| KINDS.contains(&f.amount) && !f.samples.is_empty());
    if features.is_empty() {
        let layers: Vec<&str> = scene.must_see().map(|(_, l)| l.id.as_str()).collect();
        return Err(ConstructError::NoSamples { layers: layers.join(", ") });
    }
    Ok(weighed(features))
}

/// Kinds of amounts that a view is chosen for.
const KINDS: [Amount; 3] = [Amount::Length, Amount::Area, Amount::Count];

/// Lengths, areas and numbers cannot be added up: the amounts of every kind are scaled to the total of the first kind that is there, so that
/// every kind counts alike in a share.
fn weighed(mut features: Vec<SampledFeature>) -> Vec<SampledFeature> {
    let totals = KINDS.map(|kind| total(&features, kind));
    let Some(first) = totals.into_iter().find(|total| *total > 0.0) else { return features };
    for f in &mut features {
        let own = KINDS.into_iter().zip(totals).find(|(kind, _)| *kind == f.amount).map_or(first, |(_, total)| total);
        for s in &mut f.samples {
            s.amount *= first / own;
        }
    }
    features
}

/// Total amount of the features of one kind.
fn total(features: &[SampledFeature], kind: Amount) -> f64 {
    features.iter().filter(|f| f.amount == kind).flat_map(|f| &f.samples).map(|s| s.amount).sum()
}

fn given_view(evaluator: &Evaluator<'_>, view: &View) -> Result<Base, ConstructError> {
    let base = view.straightened();
    if let Some(height) = evaluator.obstacles.above_ground(base.pinhole().eye)
        && height <= 0.0
    {
        return Err(ConstructError::EyeUnderGround { below_m: -height, raise_m: 1.0 - height });
    }
    let straight = evaluator.evaluate(&base, 1);
    if straight.in_frame < 0.02 {
        return Err(ConstructError::OutOfFrame { in_frame_share: 100.0 * straight.in_frame, needed: 2.0 });
    }
    Ok(Base { view: base, straight, heading_deg: 0.0, taste: 0.0 })
}

fn finish(
    evaluator: &Evaluator<'_>,
    base: &View,
    best: Option<Candidate>,
    options: &RevealOptions,
    counts: &Counts,
) -> Revealed {
    let straight = evaluator.evaluate(base, 1);
    // Judged by all samples, a bend that shows no more than the straight picture is no answer.
    let bent = best.map(|best| (evaluator.evaluate(&best.built.view, 1), best));
    let bent = bent.filter(|(bent, _)| choose::pays(&straight, bent));
    let picture = bent.as_ref().map_or(straight, |(bent, _)| *bent);
    let mut warnings = remarks(&picture, counts.free);
    warnings.extend(coarse_cells(evaluator, base, &picture).filter(|_| counts.free));
    let of = |f: fn(&Candidate) -> f64| bent.as_ref().map_or(1.0, |(_, best)| f(best));
    let report = RevealReport {
        total: counts.total,
        straight,
        bent: picture,
        gain: gain([straight.shares(), picture.shares()]),
        goal: Goal::of([straight.shares(), picture.shares()], options),
        shape: bent.as_ref().map(|(_, best)| best.shape),
        facing: of(|best| best.facing),
        squeeze: of(|best| best.squeeze),
        eyes_tried: counts.eyes_tried,
        bends_tried: counts.bends_tried,
        warnings,
    };
    let view = bent.as_ref().map_or_else(|| base.clone(), |(_, best)| best.built.view.clone());
    let bend = bent.map(|(_, best)| RevealedBend { document: best.built.document, pivot: best.built.pivot });
    Revealed { view, straight: base.clone(), bend, plane_height: evaluator.plane.height(), report }
}

/// Share of the features that a chosen view is to hold.
const WHOLE: f64 = 0.9;

/// Pixels of a grid cell at the lower border of the picture above which near ground looks smeared, however it is interpolated.
const SMEARED_PX: f64 = 140.0;
/// Share of the most pixels that a cell may take up among the features from which on cells keep the eye far.
const KEPT_FAR: f64 = 0.6;

/// What is said where the cells of the ground are coarse for the picture: that the eye stands far away for them, or that they show.
fn coarse_cells(evaluator: &Evaluator<'_>, view: &View, picture: &Evaluation) -> Option<Warning> {
    let (distance, cell_px) = evaluator.cells_among_features(view)?;
    let cell = evaluator.cell;
    let of = |text: String| {
        Warning::new(WarningKind::Suspect, text)
            .with("cell", cell)
            .with("distance", distance)
            .with("share", picture.width)
    };
    if picture.width < score::WIDTH[0] && cell_px > KEPT_FAR * eyes::MOST_PER_CELL_PX {
        return Some(of(format!(
            "the eye stands {:.1} km away because cells are {cell:.0} m: nearer, one would be more than {:.0} pixels of a picture \
             {REFERENCE_HEIGHT_PX} high, so the features fill {:.0} % of the width; take a finer elevation model, or give a view (eye and \
             look_at)",
            1e-3 * distance,
            eyes::MOST_PER_CELL_PX,
            100.0 * picture.width
        )));
    }
    (picture.coarse_px > SMEARED_PX).then(|| {
        of(format!(
            "cells of {cell:.0} m are {:.0} pixels wide at the lower border of a picture {REFERENCE_HEIGHT_PX} high, and look smeared above \
             {SMEARED_PX}; take a finer elevation model, or give a view (eye and look_at)",
            picture.coarse_px
        ))
    })
}

/// Oddities of a picture.
/// * `free`: whether its camera was chosen.
fn remarks(picture: &Evaluation, free: bool) -> Vec<Warning> {
    let mut out = Vec::new();
    if free && picture.in_frame < WHOLE {
        let text = format!(
            "{:.0} % of the features lie in the frame, for no eye that was tried near the terrain gives a better picture with more of \
             them; take data that reach farther around them, or give a view (eye and look_at)",
            100.0 * picture.in_frame
        );
        out.push(Warning::new(WarningKind::Hidden, text).with("share", picture.in_frame));
    }
    if picture.covered < 0.8 {
        let text =
            format!("the ground of the data fills {:.0} % of the picture below the skyline", 100.0 * picture.covered);
        out.push(Warning::new(WarningKind::Suspect, text).with("share", picture.covered));
    }
    out
}
