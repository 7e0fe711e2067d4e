//! `reveal` of terrain: routes and other features, by a spline, by ground that makes way, or by curved rays.

use super::Technique;
use super::answer::{FinalShares, Found, RevealAnswer, Tried};
use super::appearance::{Taller, is_exaggeration, softly_ended};
use super::request::Request;
use crate::data::Data;
use crate::picture::{self, Picture, PictureOptions};
use crate::places::PlaceFinder;
use crate::scene_file::{CameraDoc, EarthDoc, StageDoc, TerrainStageDoc};
use crate::verbs::found_view::{IMAGE, spline_stage};
use crate::verbs::in_time;
use crate::verbs::shares::shares as shares_of;
use crate::{Advice, BelvedereError, Session};
use belvedere_construct::measure::HiddenRun;
use belvedere_construct::rays::{AroundOptions, Target, bend_around};
use belvedere_construct::reveal::{Choice, thresholds};
use belvedere_construct::{
    ConstructError, Goal, RevealMemory, RevealOptions, RevealReport, Revealed, default_spacing, sample_features,
};
use belvedere_core::{DVec3, Pinhole, Projection, View};
use belvedere_core::{Warning, WarningKind};
use belvedere_resolve::ground::{earth_radius, unbent};
use belvedere_resolve::rays::sidestep_stage;
use belvedere_resolve::solving::{Memory, Solving};
use belvedere_scene::Instant;
use belvedere_scene::{Progress, Scene, Sky};
use std::sync::Arc;
use std::time::Duration;

/// Full vertical field of view unless given, degrees.
const FOV_Y_DEG: f64 = 45.0;
/// The widest where a view is chosen, unless one is given.
const WIDEST_FOV_Y_DEG: f64 = 55.0;

/// Time limit for solving the ground of each tried technique, and exaggerated ground, if none is given.
const TRY_FOR: Duration = Duration::from_secs(120);

/// Share of the remaining time for the search of a view and a bend: if only the picture follows, and otherwise.
const SEARCH_ALONE: f64 = 0.5;
const SEARCH: f64 = 0.2;
/// Share of the remaining time for the first of two techniques.
const FIRST_TRY: f64 = 0.6;

/// Draws the features of a request.
pub(super) fn reveal(request: &Request<'_>) -> Result<RevealAnswer, BelvedereError> {
    let technique = request.technique();
    if !request.asked.rivers.is_empty() && matches!(technique, Technique::Spline | Technique::CurvedRays) {
        let text = "{} are kept from running uphill where the ground moves, which this technique does not do; ask for {} \
                    terrain, both or auto";
        return Err(BelvedereError::Argument(Advice::new(text, &["rivers", "technique"])));
    }
    let began = Instant::now();
    let searched = Searched::of(request)?;
    let mut tried = Vec::new();
    let best = searched.best(request, began.elapsed(), &mut tried)?;
    let Answer { mut session, shares, hidden, every, warnings } = best;
    session.loaded.warnings.extend(warnings);
    let report = judged_report(searched.found.report, &shares, (&searched.options, technique));
    let picture = drawn(&mut session, request)?;
    let found = Found::Features { report, tried, hidden, measured_every: every };
    Ok(RevealAnswer { session, picture, shares, found })
}

/// A view of the features and the spline that was found for it.
struct Searched {
    /// With the spline, if one shows more.
    session: Session,
    found: Revealed,
    options: RevealOptions,
    /// In which views and bends are searched.
    scene: Arc<Scene>,
    /// The same, where it has exaggerated heights.
    taller: Option<Taller>,
    rivers: Vec<String>,
}

impl Searched {
    fn of(request: &Request<'_>) -> Result<Self, BelvedereError> {
        request.fov_y(FOV_Y_DEG)?;
        let earth = if request.asked.curved_earth { EarthDoc::Curved } else { EarthDoc::Flat };
        let mut data = request.data().load(false, &softly_ended(&request.open))?;
        let rivers = std::mem::take(&mut data.rivers);
        request.appearance.check(data.scene.crs)?;
        let taller = request.taller(&data)?;
        let scene = taller.as_ref().map_or(&data.scene, |taller| &taller.scene).clone();
        let base = base_view(request, earth, &scene, &mut data.warnings)?;
        let options = request.search_options(&mut data)?;
        let share = if request.technique() == Technique::Spline { SEARCH_ALONE } else { SEARCH };
        let (mut memory, progress) = (RevealMemory::default(), request.open.progress.part(share));
        let found = belvedere_construct::reveal(&scene, base.as_ref(), &options, &mut memory, &progress)
            .map_err(|error| request.with_reason(error))?;
        let pinhole = found.straight.pinhole();
        let middle = found.bend.as_ref().map_or_else(|| middle(&scene), |bend| bend.pivot);
        let camera = CameraDoc::of(pinhole, pinhole.eye + (middle - pinhole.eye).length().max(1.0) * pinhole.forward);
        let stages = spline_stage(&found).into_iter().collect();
        let mut session = data.session(found.view.clone(), camera, stages, earth);
        if let Some(document) = session.resolved().filter(|_| earth == EarthDoc::Curved).cloned() {
            // Eyes are chosen with one radius of the earth; a scene is drawn with that at its eye.
            session = session.with_document(document, None)?;
        }
        session.loaded.warnings.extend(found.report.warnings.iter().cloned());
        let session = request.appearance.put_on(session, taller.as_ref())?;
        Ok(Self { session, found, options, scene, taller, rivers })
    }

    /// The picture that shows most, by the techniques that are asked for.
    ///
    /// * `took`: time of the search; `tried`: the techniques that were tried, if the choice is automatic.
    fn best(&self, request: &Request<'_>, took: Duration, tried: &mut Vec<Tried>) -> Result<Answer, BelvedereError> {
        let (technique, progress) = (request.technique(), &request.open.progress);
        let candidates: &[Technique] = match technique {
            Technique::Spline => &[],
            Technique::CurvedRays => &[Technique::CurvedRays],
            Technique::Auto => &[Technique::Both, Technique::Terrain],
            Technique::Both => &[Technique::Both],
            Technique::Terrain => &[Technique::Terrain],
        };
        let is_auto = technique == Technique::Auto;
        let by_spline = self.found.bend.is_some() && (candidates.is_empty() || is_auto);
        let unbent = || Answer::of(straightened(&self.session)?, None, progress);
        let mut first = match by_spline {
            true => Answer::of(self.session.clone(), Some(Technique::Spline), progress)?,
            false => unbent()?,
        };
        // Exaggeration hides more: a bend is measured by the picture without bends, but with the same heights.
        let straight = match &self.taller {
            Some(_) => unbent()?.shares.both()[1],
            None => first.shares.both()[0],
        };
        let mut all = vec![first.tried(Technique::Spline, took)];
        let gain = first.shares.visible_bent - straight.visible;
        if gain < thresholds::LEAST_GAIN && first.shares.technique.is_some() {
            first = unbent()?;
        }
        // Where nothing is hidden nothing is bent.
        let shown = if is_auto { thresholds::NOTHING_HIDDEN } else { thresholds::ALL_SHOWN };
        let is_seen = straight.visible >= shown * straight.in_frame;
        let choice = Choice {
            score: &|answer: &Answer| answer.shares.visible_bent,
            least_gain: thresholds::LEAST_GAIN,
            enough: &|best: &Answer, _| is_seen || is_auto && best.shares.visible_bent >= thresholds::ENOUGH,
        };
        let limited = progress.clone().limited_unless_stated(TRY_FOR);
        let solving = || match (is_auto, &self.taller) {
            (true, _) => limited.part(FIRST_TRY),
            // Rays that exaggeration bends are many more to solve for.
            (false, Some(_)) => limited.clone(),
            (false, None) => progress.clone(),
        };
        let best = choice.best(Some(first), candidates, |&technique| {
            let began = Instant::now();
            let next = match technique {
                Technique::CurvedRays => self.around_what_hides(progress)?,
                _ => self.disoccluded((technique, request.asked.no_limits), &solving())?,
            };
            let next = Answer::of(next, Some(technique), progress)?;
            all.push(next.tried(technique, began.elapsed()));
            Ok::<_, BelvedereError>(next)
        })?;
        tried.extend(all.into_iter().filter(|_| is_auto));
        best.map_or_else(unbent, Ok)
    }

    /// The session with terrain disocclusion, with the spline or in its place.
    fn disoccluded(
        &self,
        (technique, no_limits): (Technique, bool),
        progress: &Progress,
    ) -> Result<Session, BelvedereError> {
        let session = &self.session;
        let Some(mut document) = session.resolved().cloned() else { return Ok(session.clone()) };
        if technique == Technique::Terrain {
            document.stage.retain(is_exaggeration);
        }
        let limits = no_limits.then_some(false);
        let stage = TerrainStageDoc { limits, rivers: self.rivers.clone(), ..TerrainStageDoc::default() };
        document.stage.insert(0, StageDoc::TerrainDisocclusion(stage));
        let mut memory = Memory::default();
        session.with_document(document, Some(&mut Solving { memory: &mut memory, time_step_s: None, progress }))
    }

    /// The session with rays of a single turn in place of the spline, chosen to show most of the features.
    fn around_what_hides(&self, progress: &Progress) -> Result<Session, BelvedereError> {
        let (session, scene, straight) = (&self.session, &*self.scene, &self.found.straight);
        let Some(mut document) = session.resolved().cloned() else { return Ok(session.clone()) };
        let features = sample_features(scene, default_spacing(scene));
        let samples = features.iter().flat_map(|f| f.samples.iter().map(|s| s.p_world));
        let in_frame = |p: &DVec3| straight.project(*p).is_ok_and(|image| straight.pinhole().contains(image.pixel));
        let seen: Vec<DVec3> = samples.filter(in_frame).collect();
        let every = seen.len().div_ceil(thresholds::SAMPLES_TO_BEND_FOR).max(1);
        let target = Target::points(seen.into_iter().step_by(every));
        let around = AroundOptions { grow_px: 0.0, ..AroundOptions::default() };
        let found = bend_around(scene, straight, &target, &around, progress)?;
        let turns = found.bent.map(|(_, sidestep)| StageDoc::CurvedRays(sidestep_stage(&sidestep, straight.pinhole())));
        document.stage.retain(is_exaggeration);
        document.stage.extend(turns);
        session.with_document(document, None)
    }
}

/// Draws both pictures; one that is too large for one piece while it is written, and alone.
fn drawn(session: &mut Session, request: &Request<'_>) -> Result<Picture, BelvedereError> {
    let pair = PictureOptions {
        compare: session.view().is_bent() && session.light().sky != Sky::Transparent,
        straight: false,
        progress: request.open.progress.clone(),
        ..request.picture.clone()
    };
    let alone = PictureOptions { compare: false, ..pair.clone() };
    let Some(later) = picture::later(session, &alone, request.to_file.as_deref())? else {
        return session.render(&pair);
    };
    if pair.compare {
        let text = "the picture is drawn in bands, and no pair of pictures is written beside it";
        session.loaded.warnings.push(Warning::new(WarningKind::Fallback, text));
    }
    Ok(later)
}

/// Fields of view through which views can be chosen, degrees.
const USUAL_FOV_DEG: [f64; 2] = [10.0, 90.0];

impl Request<'_> {
    /// The error of a search that an unusual field of view left without a view.
    fn with_reason(&self, error: ConstructError) -> BelvedereError {
        let [least, most] = USUAL_FOV_DEG;
        match (&error, self.fov_y_deg) {
            (ConstructError::NoView { .. }, Some(deg)) if !(least..=most).contains(&deg) => {
                BelvedereError::UnusualFieldOfView { deg }
            }
            _ => error.into(),
        }
    }

    /// Options of the search that a request asks for.
    pub(super) fn search_options(&self, data: &mut Data) -> Result<RevealOptions, BelvedereError> {
        Ok(RevealOptions {
            image: self.image.unwrap_or(IMAGE),
            aspect: self.aspect,
            fov_y: self.fov_y(WIDEST_FOV_Y_DEG)?,
            earth_radius: self.asked.curved_earth.then(|| earth_radius(&data.scene, &mut data.warnings)),
            ..RevealOptions::default()
        })
    }

    /// The scene with exaggerated heights, if that is asked for.
    pub(super) fn taller(&self, data: &Data) -> Result<Option<Taller>, BelvedereError> {
        self.appearance.exaggeration.map_or(Ok(None), |factor| Taller::of(&data.scene, factor))
    }
}

/// The report of the search with the shares, gain and goal of the finished picture.
fn judged_report(
    report: RevealReport,
    shares: &FinalShares,
    (search, asked): (&RevealOptions, Technique),
) -> RevealReport {
    let [straight, bent] = shares.both();
    let goals = match shares.technique.unwrap_or(asked) {
        Technique::Spline => *search,
        _ => RevealOptions { goal_share: thresholds::ENOUGH, goal_gain: 0.0, ..*search },
    };
    RevealReport {
        straight: report.straight.judged(straight),
        bent: report.bent.judged(bent),
        gain: belvedere_construct::reveal::gain([straight, bent]),
        goal: Goal::of([straight, bent], &goals),
        ..report
    }
}

/// The middle of the features that must be seen.
fn middle(scene: &Scene) -> DVec3 {
    let bounds = scene.must_see().map(|(_, layer)| layer.bounds()).filter(|b| !b.is_empty());
    bounds.reduce(|a, b| a.union(b)).unwrap_or_else(|| scene.bounds()).center()
}

/// The session without stages that bend; exaggeration stays.
fn straightened(session: &Session) -> Result<Session, BelvedereError> {
    let Some(mut document) = session.resolved().cloned() else { return Ok(session.clone()) };
    document.stage.retain(is_exaggeration);
    session.with_document(document, None)
}

/// A finished picture, judged.
struct Answer {
    session: Session,
    shares: FinalShares,
    hidden: Vec<HiddenRun>,
    every: u32,
    warnings: Vec<Warning>,
}

impl Answer {
    /// Measures the whole chain of stages.
    fn of(session: Session, technique: Option<Technique>, progress: &Progress) -> Result<Self, BelvedereError> {
        let in_time::Judged { measures, hidden, every } = in_time::judged(session.scene(), session.view(), progress)?;
        let shares = shares_of(&measures, session.terrain_report()).unwrap_or_default();
        let technique = technique.filter(|_| session.view().is_bent());
        Ok(Self { session, shares: FinalShares::of(technique, shares), hidden, every, warnings: measures.warnings })
    }

    fn tried(&self, technique: Technique, took: Duration) -> Tried {
        let FinalShares { visible_bent: visible, in_frame_bent: in_frame, .. } = self.shares;
        let out_of_time = self.session.terrain_report().is_some_and(|r| r.out_of_time);
        Tried { technique, visible, in_frame, seconds: took.as_secs_f64(), out_of_time }
    }
}

/// The view of the given camera, if there is one.
///
/// * `said`: takes warnings about its places.
fn base_view(
    request: &Request<'_>,
    earth: EarthDoc,
    scene: &Scene,
    said: &mut Vec<Warning>,
) -> Result<Option<View>, BelvedereError> {
    let Some([eye, target]) = &request.places else { return Ok(None) };
    let finder = PlaceFinder::of(scene);
    let ((eye, of_eye), (target, of_target)) = (finder.find(eye, "eye")?, finder.find(target, "target")?);
    let lens = Projection::Perspective { fov_y: request.fov_y(FOV_Y_DEG)? };
    let pinhole = Pinhole::look_at(eye, target, DVec3::Z, lens, request.image.unwrap_or(IMAGE), 1.0, None)?;
    said.extend(of_eye.into_iter().chain(of_target));
    Ok(Some(unbent(pinhole, earth, scene, said)?))
}
