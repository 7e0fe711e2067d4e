//! `reveal`: draws a picture of terrain in which routes and other features are visible.

use super::appearance::{Appearance, Taller, is_exaggeration, softly_ended};
use super::in_time;
pub use super::reveal_files::RevealFiles;
use super::shares::shares as shares_of;
use super::view_request::spline_stage;
pub use super::view_request::{IMAGE, Technique, Viewpoint};
use crate::data::{Data, DataFiles};
use crate::guard::guarded;
use crate::picture::{self, DisplacementReport, Picture, PictureOptions, TerrainRecord};
use crate::places::{Place, PlaceFinder};
use crate::resolve::ground::{earth_radius, unbent};
use crate::resolve::rays::sidestep_stage;
use crate::resolve::solving::Memory;
use crate::resolve::solving::Solving;
use crate::scene_file::{CameraDoc, EarthDoc, StageDoc, TerrainStageDoc};
use crate::{Advice, BelvedereError, OpenOptions, Session};
use belvedere_construct::measure::{HiddenRun, Shares};
use belvedere_construct::rays::{AroundOptions, Target, bend_around};
use belvedere_construct::{Goal, RevealMemory, RevealOptions, RevealReport, default_spacing, sample_features};
use belvedere_core::{DVec3, Pinhole, Projection, View};
use belvedere_core::{Warning, WarningKind};
use belvedere_disocclusion::TerrainReport;
use belvedere_scene::Instant;
use belvedere_scene::{Progress, Scene, Sky};
use schemars::JsonSchema;
use serde::Serialize;
use std::path::PathBuf;
use std::time::Duration;

/// Full vertical field of view unless given, degrees.
const FOV_Y_DEG: f64 = 45.0;

/// Features to reveal, and the view.
#[derive(Debug, Clone, Default)]
pub struct RevealRequest {
    /// Terrain and features.
    pub data: DataFiles,
    /// Eye and target; chosen automatically if left out.
    pub viewpoint: Option<Viewpoint>,
    /// Eye and target as a user wrote them, instead of `viewpoint`.
    pub places: Option<[Place; 2]>,
    /// Full vertical field of view, degrees.
    pub fov_y_deg: Option<f64>,
    /// Picture size, pixels.
    pub image: Option<[u32; 2]>,
    /// Whether the earth is curved.
    pub curved_earth: bool,
    /// Technique that bends the picture.
    pub technique: Technique,
    /// Lifts the limits of depth and slope of the displaced ground.
    pub no_limits: bool,
    /// Quality of the pictures.
    pub picture: PictureOptions,
    /// The file that the picture is for, if it goes into one and nowhere else: a picture that is too large for one piece is then drawn in bands
    /// while it is written, see [`Session::render_to`], and has no pair beside it.
    pub to_file: Option<PathBuf>,
    /// Light, stylisation, mark and exaggeration.
    pub appearance: Appearance,
}

impl RevealRequest {
    fn earth(&self) -> EarthDoc {
        if self.curved_earth { EarthDoc::Curved } else { EarthDoc::Flat }
    }
}

/// Visible share from which on the ground is not moved.
const ENOUGH: f64 = 0.99;

/// Share of what is in the frame from which on nothing counts as hidden, and nothing is bent.
const NOTHING_HIDDEN: f64 = 0.995;

/// The same where a technique is asked for that shows all.
const ALL_SHOWN: f64 = 0.9999;

/// Share of the whole features that a bend must show in addition, or the straight picture is the answer.
const LEAST_GAIN: f64 = 0.001;

/// Largest number of samples of the features by which curved rays are chosen.
const SAMPLES_TO_BEND_FOR: usize = 150;

/// Time limit for solving the ground of each tried technique, and exaggerated ground, if none is given.
const TRY_FOR: Duration = Duration::from_secs(120);

/// Share of the remaining time for the search of a view and a bend: if only the picture follows, and otherwise.
const SEARCH_ALONE: f64 = 0.5;
const SEARCH: f64 = 0.2;
/// Share of the remaining time for the first of two techniques.
const FIRST_TRY: f64 = 0.6;

/// A technique that was tried.
#[derive(Debug, Clone, Copy, JsonSchema, Serialize)]
pub struct Tried {
    /// The technique.
    pub technique: Technique,
    /// Visible share of the whole features in its picture.
    pub visible: f64,
    /// Share of the whole features inside its picture.
    pub in_frame: f64,
    /// Wall time, seconds.
    pub seconds: f64,
    /// Whether its time limit ended it early.
    pub out_of_time: bool,
}

/// Shares of the whole features in both pictures, by lines of sight through the whole chain of stages.
#[derive(Debug, Clone, Copy, JsonSchema, Serialize)]
pub struct FinalShares {
    /// Technique that bends the picture; `None` if it is straight, because nothing is hidden or no bend makes a better picture.
    pub technique: Option<Technique>,
    /// Visible share in the straight picture, 0..=1.
    pub visible_straight: f64,
    /// Visible share in the bent picture.
    pub visible_bent: f64,
    /// Share inside the straight picture, hidden or not.
    pub in_frame_straight: f64,
    /// Share inside the bent picture, hidden or not.
    pub in_frame_bent: f64,
}

impl FinalShares {
    fn of(technique: Option<Technique>, [straight, bent]: [Shares; 2]) -> Self {
        Self {
            technique,
            visible_straight: straight.visible,
            visible_bent: bent.visible,
            in_frame_straight: straight.in_frame,
            in_frame_bent: bent.in_frame,
        }
    }

    /// Shares in the straight and in the bent picture.
    pub fn both(&self) -> [Shares; 2] {
        [
            Shares { visible: self.visible_straight, in_frame: self.in_frame_straight },
            Shares { visible: self.visible_bent, in_frame: self.in_frame_bent },
        ]
    }
}

/// Result of `reveal`: a session that shows the features, its picture beside the straight one, and reports.
#[derive(Debug, Clone)]
pub struct RevealAnswer {
    /// Scene and bent view.
    pub session: Session,
    /// Both pictures; one if it is straight.
    pub picture: Picture,
    /// Report of the search for a view and a spline.
    pub report: RevealReport,
    /// Shares of the whole features in both pictures.
    pub shares: FinalShares,
    /// Tried techniques, if the choice was automatic.
    pub tried: Vec<Tried>,
    /// Hidden stretches of the features in the picture.
    pub hidden: Vec<HiddenRun>,
    /// Factor of the sample spacing for the shares and `hidden`: 1, or more if time was short.
    pub measured_every: u32,
}

/// Content of the report file and of `--json`.
#[derive(Debug, Clone, JsonSchema, Serialize)]
pub struct RevealDocument<'a> {
    program: String,
    #[serde(flatten)]
    shares: FinalShares,
    /// Report of the search; its shares, gain and goal are those of the finished picture.
    #[serde(flatten)]
    report: RevealReport,
    #[serde(skip_serializing_if = "Option::is_none")]
    disocclusion: Option<&'a TerrainReport>,
    /// Tried techniques.
    #[serde(skip_serializing_if = "<[Tried]>::is_empty")]
    tried: &'a [Tried],
    /// Hidden stretches of the features in the picture.
    hidden: &'a [HiddenRun],
    measured_every: u32,
    displacement: Option<DisplacementReport>,
    view: &'a crate::record::ViewRecord,
    crs: String,
    terrain: Option<TerrainRecord>,
    inputs: &'a [crate::record::InputFile],
    scene_warnings: &'a [Warning],
}

/// Chooses a view (unless given) and a bend, and draws both pictures. Where nothing is hidden, or no bend shows more, the straight one is the
/// answer.
///
/// # Errors
/// [`BelvedereError::FieldOfView`], [`BelvedereError::Position`], [`BelvedereError::Construct`] if no view is possible, else as
/// [`Session::open`] and [`Session::render`].
pub fn reveal(request: &RevealRequest, options: &OpenOptions) -> Result<RevealAnswer, BelvedereError> {
    guarded(|| revealed(request, options))
}

fn revealed(request: &RevealRequest, options: &OpenOptions) -> Result<RevealAnswer, BelvedereError> {
    if !request.data.rivers.is_empty() && matches!(request.technique, Technique::Spline | Technique::CurvedRays) {
        let text = "{} are kept from running uphill where the ground moves, which this technique does not do; ask for {} \
                    terrain, both or auto";
        return Err(BelvedereError::Argument(Advice::new(text, &["rivers", "technique"])));
    }
    check_fov(request)?;
    let mut data = request.data.load(false, &softly_ended(options))?;
    let rivers = std::mem::take(&mut data.rivers);
    request.appearance.check(data.scene.crs)?;
    let taller = taller(request, &data)?;
    let searched_scene = taller.as_ref().map_or(&data.scene, |taller| &taller.scene).clone();
    let (base, said) = base_view(request, &searched_scene)?;
    data.warnings.extend(said);
    let search = search_options(request, &mut data)?;
    let mut memory = RevealMemory::default();
    let searched = Instant::now();
    let searching = options.progress.part(if request.technique == Technique::Spline { SEARCH_ALONE } else { SEARCH });
    let found = belvedere_construct::reveal(&searched_scene, base.as_ref(), &search, &mut memory, &searching)?;
    let pinhole = found.straight.pinhole();
    let middle = found.bend.as_ref().map_or_else(|| middle(&searched_scene), |bend| bend.pivot);
    let ahead = (middle - pinhole.eye).length().max(1.0);
    let camera = CameraDoc::of(pinhole, pinhole.eye + ahead * pinhole.forward);
    let mut spline =
        data.session(found.view.clone(), camera, spline_stage(&found).into_iter().collect(), request.earth());
    if let Some(document) = spline.resolved().filter(|_| request.curved_earth).cloned() {
        // Eyes are chosen with one radius of the earth; a scene is drawn with that at its eye.
        spline = spline.with_document(document, None)?;
    }
    spline.loaded.warnings.extend(found.report.warnings.iter().cloned());
    let spline = request.appearance.put_on(spline, taller.as_ref())?;
    let candidates: &[Technique] = match request.technique {
        Technique::Spline => &[],
        Technique::CurvedRays => &[Technique::CurvedRays],
        Technique::Auto => &[Technique::Both, Technique::Terrain],
        Technique::Both => &[Technique::Both],
        Technique::Terrain => &[Technique::Terrain],
    };
    let is_auto = request.technique == Technique::Auto;
    let progress = &options.progress.clone().limited_unless_stated(TRY_FOR);
    let by_spline = found.bend.is_some() && (candidates.is_empty() || is_auto);
    let first = if by_spline { spline.clone() } else { straightened(&spline)? };
    let mut best = Answer::of(first, by_spline.then_some(Technique::Spline), &options.progress)?;
    // Exaggeration hides more: a bend is measured by the picture without bends, but with the same heights.
    let straight = match &taller {
        Some(_) => Answer::of(straightened(&spline)?, None, &options.progress)?.shares.both()[1],
        None => best.shares.both()[0],
    };
    let mut tried = vec![best.tried(Technique::Spline, searched.elapsed())];
    if best.shares.visible_bent < straight.visible + LEAST_GAIN && best.shares.technique.is_some() {
        best = Answer::of(straightened(&spline)?, None, &options.progress)?;
    }
    for &technique in candidates {
        // Where nothing is hidden nothing is bent.
        let shown = if is_auto { NOTHING_HIDDEN } else { ALL_SHOWN };
        if straight.visible >= shown * straight.in_frame || is_auto && best.shares.visible_bent >= ENOUGH {
            break;
        }
        let began = Instant::now();
        let next = match technique {
            Technique::CurvedRays => around_what_hides(&spline, (&searched_scene, &found.straight), &options.progress)?,
            _ => disoccluded(
                &spline,
                (technique, request.no_limits, &rivers),
                &match (is_auto, &taller) {
                    (true, _) => progress.part(FIRST_TRY),
                    // Rays that exaggeration bends are many more to solve for.
                    (false, Some(_)) => progress.clone(),
                    (false, None) => options.progress.clone(),
                },
            )?,
        };
        let next = Answer::of(next, Some(technique), &options.progress)?;
        tried.push(next.tried(technique, began.elapsed()));
        if next.shares.visible_bent >= best.shares.visible_bent + LEAST_GAIN {
            best = next;
        }
    }
    if !is_auto {
        tried.clear();
    }
    let Answer { mut session, shares, hidden, every, warnings } = best;
    session.loaded.warnings.extend(warnings);
    let report = judged_report(found.report, &shares, (&search, request.technique));
    let pair = PictureOptions {
        compare: session.view().is_bent() && session.light().sky != Sky::Transparent,
        straight: false,
        progress: options.progress.clone(),
        ..request.picture.clone()
    };
    let alone = PictureOptions { compare: false, ..pair.clone() };
    let picture = match picture::later(&session, &alone, request.to_file.as_deref())? {
        Some(later) if pair.compare => {
            let text = "the picture is drawn in bands, and no pair of pictures is written beside it";
            session.loaded.warnings.push(Warning::new(WarningKind::Fallback, text));
            later
        }
        Some(later) => later,
        None => session.render(&pair)?,
    };
    Ok(RevealAnswer { session, picture, report, shares, tried, hidden, measured_every: every })
}

/// The full vertical field of view, degrees.
fn check_fov(request: &RevealRequest) -> Result<f64, BelvedereError> {
    let deg = request.fov_y_deg.unwrap_or(FOV_Y_DEG);
    if deg > 0.0 && deg < 180.0 { Ok(deg) } else { Err(BelvedereError::FieldOfView { deg }) }
}

/// Options of the search that a request asks for.
pub(super) fn search_options(request: &RevealRequest, data: &mut Data) -> Result<RevealOptions, BelvedereError> {
    Ok(RevealOptions {
        image: request.image.unwrap_or(IMAGE),
        fov_y: check_fov(request)?.to_radians(),
        earth_radius: request.curved_earth.then(|| earth_radius(&data.scene, &mut data.warnings)),
        ..RevealOptions::default()
    })
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
        _ => RevealOptions { goal_share: ENOUGH, goal_gain: 0.0, ..*search },
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

/// The session with terrain disocclusion, with the spline or in its place.
fn disoccluded(
    session: &Session,
    (technique, no_limits, rivers): (Technique, bool, &[String]),
    progress: &Progress,
) -> Result<Session, BelvedereError> {
    let Some(mut document) = session.resolved().cloned() else { return Ok(session.clone()) };
    if technique == Technique::Terrain {
        document.stage.retain(is_exaggeration);
    }
    let limits = no_limits.then_some(false);
    let stage = TerrainStageDoc { limits, rivers: rivers.to_vec(), ..TerrainStageDoc::default() };
    document.stage.insert(0, StageDoc::TerrainDisocclusion(stage));
    let mut memory = Memory::default();
    session.with_document(document, Some(&mut Solving { memory: &mut memory, time_step_s: None, progress }))
}

/// The session with rays of a single turn in place of the spline, chosen to show most of the features.
fn around_what_hides(
    session: &Session,
    (scene, straight): (&Scene, &View),
    progress: &Progress,
) -> Result<Session, BelvedereError> {
    let Some(mut document) = session.resolved().cloned() else { return Ok(session.clone()) };
    let features = sample_features(scene, default_spacing(scene));
    let samples: Vec<DVec3> = features.iter().flat_map(|f| f.samples.iter().map(|s| s.p_world)).collect();
    let in_frame = |p: &DVec3| straight.project(*p).is_ok_and(|image| straight.pinhole().contains(image.pixel));
    let seen: Vec<DVec3> = samples.into_iter().filter(in_frame).collect();
    let every = seen.len().div_ceil(SAMPLES_TO_BEND_FOR).max(1);
    let target = Target::points(seen.into_iter().step_by(every));
    let around = AroundOptions { grow_px: 0.0, ..AroundOptions::default() };
    let found = bend_around(scene, straight, &target, &around, progress)?;
    let turns = found.bent.map(|(_, sidestep)| StageDoc::CurvedRays(sidestep_stage(&sidestep, straight.pinhole())));
    document.stage.retain(is_exaggeration);
    document.stage.extend(turns);
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

impl RevealAnswer {
    /// Goals that were missed, one sentence each.
    pub fn missed(&self) -> &[String] {
        match &self.report.goal {
            Goal::Reached => &[],
            Goal::Missed(reasons) => reasons,
        }
    }

    /// One sentence: shares of the whole features that are visible, and that lie in the frame, straight and bent.
    pub fn summary(&self) -> String {
        let [straight, bent] = self.shares.both();
        if self.shares.technique.is_some() {
            return format!("visible in the straight picture: {straight}, in the bent one: {bent}");
        }
        let taller =
            if self.session.view().is_bent() { format!(", with exaggerated heights: {bent}") } else { String::new() };
        let reason = if bent.visible >= NOTHING_HIDDEN * bent.in_frame {
            "what is in the frame is not hidden, so nothing is bent"
        } else {
            "no bend that was tried makes a better picture"
        };
        format!("visible in the straight picture: {straight}{taller}; {reason}, and there is no pair of pictures")
    }

    /// Content of the report file and of `--json`.
    pub fn document(&self) -> RevealDocument<'_> {
        let sidecar = self.picture.record();
        RevealDocument {
            program: sidecar.program.clone(),
            shares: self.shares,
            report: RevealReport { warnings: sidecar.warnings.clone(), ..self.report.clone() },
            disocclusion: self.session.terrain_report(),
            tried: &self.tried,
            hidden: &self.hidden,
            measured_every: self.measured_every,
            displacement: sidecar.displacement,
            view: &sidecar.view,
            crs: self.session.scene().crs.to_string(),
            terrain: sidecar.terrain,
            inputs: &sidecar.inputs,
            scene_warnings: &sidecar.warnings,
        }
    }

    /// Writes the picture with its record, the pair (`OUT.pair.png`) if it is bent, and the other files asked for.
    ///
    /// # Errors
    /// [`BelvedereError::Io`].
    pub fn write(&self, files: &RevealFiles, overwrite: bool) -> Result<Vec<PathBuf>, BelvedereError> {
        files.write(&self.picture, &self.session, &|| self.document(), overwrite)
    }
}

/// The scene with exaggerated heights, if that is asked for.
pub(super) fn taller(request: &RevealRequest, data: &Data) -> Result<Option<Taller>, BelvedereError> {
    request.appearance.exaggeration.map_or(Ok(None), |factor| Taller::of(&data.scene, factor))
}

/// The view of the given camera, if there is one, and warnings about its places.
fn base_view(request: &RevealRequest, scene: &Scene) -> Result<(Option<View>, Vec<Warning>), BelvedereError> {
    let Some([eye, target]) = request.places.or(request.viewpoint.map(Into::into)) else {
        return Ok((None, Vec::new()));
    };
    let finder = PlaceFinder::of(scene);
    let ((eye, of_eye), (target, of_target)) = (finder.find(&eye, "eye")?, finder.find(&target, "target")?);
    let lens = Projection::Perspective { fov_y: request.fov_y_deg.unwrap_or(FOV_Y_DEG).to_radians() };
    let image = request.image.unwrap_or(IMAGE);
    let pinhole = Pinhole::look_at(eye, target, DVec3::Z, lens, image, 1.0, None)?;
    let mut said: Vec<Warning> = of_eye.into_iter().chain(of_target).collect();
    let view = unbent(pinhole, request.earth(), scene, &mut said)?;
    Ok((Some(view), said))
}
