//! `reveal --see`: draws a picture in which one target in models or in a city is visible, by rays that bend around its occluders, or by a
//! spline where it lies on the ground.

use super::appearance::{Appearance, check_background};
pub use super::refit::RefitRecord;
use super::refit::{Content, Refit, refit as refit_to};
use super::reveal_files::RevealFiles;
use super::target_bend::PictureJudge;
pub use super::target_request::TargetRequest;
use super::target_scene::{self, Meant, Targets};
use super::view_request::{IMAGE, MODELS_FOV_Y_DEG, Technique, spline_stage};
use super::{city_views, target_views};
use crate::fallback::{FallbackRecord, has_volumes};
use crate::guard::guarded;
use crate::picture::{Picture, PictureOptions, TargetPlace};
use crate::places::{Place, PlaceHeight};
use crate::resolve::ground::unbent;
use crate::resolve::rays::sidestep_stage;
use crate::scene_file::{CameraDoc, ConstructorDoc, ConstructorKind, Document, EarthDoc, StageDoc};
use crate::targets;
use crate::{Advice, BelvedereError, OpenOptions, Session};
use belvedere_construct::rays::{BendReport, Sidestep, Target, TargetSight};
use belvedere_construct::{ConstructError, RevealMemory, RevealOptions, Revealed};
use belvedere_core::{DVec3, Pinhole, Projection, View, Warning};
use belvedere_scene::Unit;
use schemars::JsonSchema;
use serde::Serialize;
use std::path::PathBuf;

/// Visible share from which on a view is good enough; and after so many views.
const ENOUGH: f64 = 0.99;
const VIEWS_AT_LEAST: usize = 3;
const MUCH: f64 = 0.8;
/// Visible share that a spline must show in addition to curved rays: it moves the whole picture.
const SPLINE_GAIN: f64 = 0.03;

/// Result: a session that shows the target, its picture beside the straight one, and the report.
#[derive(Debug, Clone)]
pub struct TargetAnswer {
    /// Scene and bent view.
    pub session: Session,
    /// Both pictures.
    pub picture: Picture,
    /// Report of the search.
    pub report: BendReport,
    /// Name of the target.
    pub see: String,
    /// Position of the target, if it is a point.
    pub place: Option<TargetPlace>,
    /// Technique that bends the picture; `None` if it is straight.
    pub technique: Option<Technique>,
    /// Kind of the target's mark in the pictures.
    pub mark: &'static str,
    /// Change of the frame after the bend was known; `None` where the camera was given, a spline bends, or the frame stayed.
    pub refit: Option<RefitRecord>,
}

/// A bend that was found.
enum Bend {
    /// A turn behind the planes of a camera, which may look elsewhere than that of the picture.
    Rays(Sidestep, Box<Pinhole>),
    Spline(Box<Revealed>),
}

impl Bend {
    fn sidestep(&self) -> Option<&Sidestep> {
        match self {
            Self::Rays(sidestep, _) => Some(sidestep),
            Self::Spline(_) => None,
        }
    }
}

/// A scene that was opened, and what must be seen in it.
pub(super) struct Opened {
    pub(super) session: Session,
    pub(super) meant: Meant,
    /// The target by its name; of a place its scene coordinates.
    pub(super) see: String,
    pub(super) targets: Targets,
    pub(super) up: DVec3,
    pub(super) lens: ([u32; 2], f64),
    /// Whether the field of view is that of the request.
    states_fov: bool,
}

impl Opened {
    pub(super) fn of(request: &TargetRequest, options: &OpenOptions) -> Result<Self, BelvedereError> {
        let fov_y_deg = request.fov_y_deg.unwrap_or(MODELS_FOV_Y_DEG);
        if !(fov_y_deg > 0.0 && fov_y_deg < 180.0) {
            return Err(BelvedereError::FieldOfView { deg: fov_y_deg });
        }
        let (mut session, mut meant) = target_scene::open(request, options)?;
        request.appearance.check(session.scene().crs)?;
        check_background(&session, &request.appearance)?;
        let (see, said) = written_point(&session, &request.see)?;
        session.loaded.warnings.extend(said);
        if let Some(p) = targets::point(&see) {
            TargetPlace::check(session.scene(), p)?;
            meant = Meant::Named(see.clone());
        }
        let targets = meant.targets(session.scene())?;
        if request.technique == Some(Technique::Spline) && !meant.is_features() {
            let text = "a spline bends the ground under routes, streets and areas; for this target give {} curved_rays";
            return Err(BelvedereError::Argument(Advice::new(text, &["technique"])));
        }
        let lens = (request.image.unwrap_or(IMAGE), fov_y_deg.to_radians());
        let (up, states_fov) = (request.up.unwrap_or(DVec3::Z), request.fov_y_deg.is_some());
        Ok(Self { session, meant, see, targets, up, lens, states_fov })
    }

    /// Whether views are chosen as those of a city.
    fn is_city(&self) -> bool {
        let scene = self.session.scene();
        let from_files = self.session.path().is_none();
        let city = || self.session.resolved().is_some_and(|d| d.layer.iter().any(|l| l.kind() == "city"));
        from_files && scene.unit == Unit::Metre && city()
    }

    /// Lines of sight to the target that is searched for. Its tree over the scene takes seconds for millions of triangles: build it once.
    pub(super) fn sight(&self) -> TargetSight<'_> {
        TargetSight::new(self.session.scene(), &self.targets.search)
    }

    /// The views that are worth a search for bends; at most `most`, or as many as are usual.
    pub(super) fn views(&self, sight: &TargetSight<'_>, most: Option<usize>) -> Result<Vec<View>, BelvedereError> {
        let target = &self.targets.search;
        let scene = (self.session.scene(), sight);
        match self.is_city() {
            true => city_views::around(scene, target, self.lens, most.unwrap_or(city_views::KEPT)),
            false => target_views::around(scene, target, self.up, self.lens, most.unwrap_or(target_views::KEPT)),
        }
    }

    /// The camera in the frame that holds what is drawn, as the bend moves it.
    pub(super) fn refitted(&self, sight: &TargetSight<'_>, view: &View, sidestep: Option<&Sidestep>) -> Option<Refit> {
        let (scene, target) = (self.session.scene(), &self.targets.search);
        let is_city = self.is_city();
        let points =
            if is_city { city_views::region(target) } else { target_views::outline(scene, target_views::MANY, &[]) };
        let content = Content { points: &points, up: self.up, may_zoom: !self.states_fov };
        refit_to(sight, view, sidestep, &content)
    }

    /// The spline that shows more of the features in a view, if there is one.
    fn spline(&self, view: &View, options: &OpenOptions) -> Result<Option<Revealed>, BelvedereError> {
        let search = RevealOptions { image: self.lens.0, fov_y: self.lens.1, ..RevealOptions::default() };
        let (scene, progress) = (self.session.scene(), &options.progress);
        match belvedere_construct::reveal(scene, Some(view), &search, &mut RevealMemory::default(), progress) {
            Ok(found) => Ok(found.bend.is_some().then_some(found)),
            Err(e @ ConstructError::Cancelled(_)) => Err(e.into()),
            // Views for which no spline can be made keep their curved rays.
            Err(_) => Ok(None),
        }
    }
}

/// Chooses a view (unless given) and the smallest bend that shows the target, and draws both pictures.
///
/// # Errors
/// [`BelvedereError::Target`] if there is no such target, else as [`Session::open`] and [`Session::render`].
pub fn reveal_target(request: &TargetRequest, options: &OpenOptions) -> Result<TargetAnswer, BelvedereError> {
    guarded(|| revealed(request, options))
}

fn revealed(request: &TargetRequest, options: &OpenOptions) -> Result<TargetAnswer, BelvedereError> {
    let mut opened = Opened::of(request, options)?;
    let (view, said) = given(&opened.session, request, opened.lens, opened.up)?;
    opened.session.loaded.warnings.extend(said);
    let Opened { session, meant, targets, see, .. } = &opened;
    let scene = session.scene();
    let target = &targets.search;
    let place = targets::point(see).map(|p| TargetPlace::of(scene, p));
    let searching = opened.sight();
    let (views, free) = match view {
        Some(view) => (vec![view], false),
        None => (opened.views(&searching, None)?, true),
    };
    let judge = PictureJudge::new(session, targets, (&request.picture, &options.progress));
    let mut best: Option<(View, Option<Sidestep>, BendReport)> = None;
    let (mut tried, mut light_best) = (0, 0.0f64);
    for (k, view) in views.into_iter().enumerate() {
        let (sidestep, found) = judge.bend(&searching, &view, &options.progress)?;
        (tried, light_best) = (tried + found.tried, light_best.max(found.light_best));
        let score = |r: &BendReport| r.visible - 0.1 * r.motion;
        if best.as_ref().is_none_or(|(.., b)| score(&found) > score(b) + 0.02) {
            best = Some((view, sidestep, found));
        }
        // Where much is seen, later views, which show less without a bend, seldom show more with one.
        let enough = if k + 1 < VIEWS_AT_LEAST || opened.is_city() { ENOUGH } else { MUCH };
        if best.as_ref().is_some_and(|(.., b)| b.visible >= enough) {
            break;
        }
    }
    let Some((mut view, sidestep, report)) = best else {
        return Err(BelvedereError::Target("there is no view to look from".into()));
    };
    let only_spline = request.technique == Some(Technique::Spline);
    let root = Box::new(view.pinhole().clone());
    let mut bend = sidestep.filter(|_| !only_spline).map(|sidestep| Bend::Rays(sidestep, root));
    let mut refit = None;
    if free {
        let sidestep = bend.as_ref().and_then(Bend::sidestep);
        if let Some(found) = opened.refitted(&searching, &view, sidestep) {
            (view, refit) = (found.straight, Some(found.record));
        }
    }
    let other = (targets.judge != targets.search).then(|| TargetSight::new(scene, &targets.judge));
    let sight = other.as_ref().unwrap_or(&searching);
    let mut bent = match &bend {
        Some(Bend::Rays(sidestep, root)) => sidestep.seen_by(root, &view)?,
        _ => view.clone(),
    };
    // The refitted view may show as much without a bend.
    if refit.is_some() && bend.is_some() && !judge.gains(sight, &view, &bent)? {
        (bend, bent) = (None, view.clone());
    }
    // The finished pictures tell the shares of targets with a surface, unless a fallback has to be decided on before.
    let report = match judge.is_by_pictures() && request.fallback.is_empty() {
        true => BendReport { in_frame: sight.in_frame(&bent), in_frame_straight: sight.in_frame(&view), ..report },
        false => judged((&judge, sight), &view, &bent, report)?,
    };
    let mut report = BendReport { tried, light_best, ..report };
    if meant.is_features()
        && request.technique != Some(Technique::CurvedRays)
        && (only_spline || report.visible < ENOUGH)
        && let Some(found) = opened.spline(&view, options)?
    {
        let by_spline = judged((&judge, sight), &view, &found.view, report)?;
        let gain = if only_spline { 0.0 } else { SPLINE_GAIN };
        if by_spline.visible > report.visible + gain {
            (report, bend, refit) = (by_spline, Some(Bend::Spline(Box::new(found))), None);
        }
    }
    let mut document = document(session, &view, bend.as_ref(), target)?;
    if report.visible < ENOUGH && !request.fallback.is_empty() {
        let Some(name) = meant.name() else {
            let text = "{} is for buildings and models, not for features on the ground";
            return Err(BelvedereError::Argument(Advice::new(text, &["fallback"])));
        };
        let (target, fallback) = (Some(name.to_owned()), request.fallback.clone());
        document.constructor = Some(ConstructorDoc { target, fallback, ..ConstructorDoc::of(ConstructorKind::Manual) });
    }
    let technique = bend.as_ref().map(|bend| match bend {
        Bend::Rays(..) => Technique::CurvedRays,
        Bend::Spline(_) => Technique::Spline,
    });
    // Scene files say themselves whether they have shadows.
    if session.path().is_none() {
        request.appearance.shade_molecules(&mut document);
    }
    request.appearance.describe(&mut document);
    let session = match request.appearance.is_usual() {
        true => session.with_document(document, None)?,
        false => Appearance::of_document(session, document)?,
    };
    let pair = PictureOptions {
        compare: true,
        straight: false,
        progress: options.progress.clone(),
        ..request.picture.clone()
    };
    let mut picture = session.render(&pair)?;
    let mut mark = "lines and points in colour, dashed where they are hidden";
    if let Some(place) = &place {
        picture.mark_target(place, &report, pair.density);
        mark = place.mark;
    } else if let Some(shares) = picture.mark_shape(&session, (&targets.shape, &targets.judge), &pair)? {
        mark = "an outline around it, of dashes where it is hidden";
        // Volumes let light through, which ids do not tell, and fallbacks have a report of their own.
        if !has_volumes(session.scene()) && picture.sidecar.fallback.is_none() {
            let [straight, bent] = shares;
            report.visible_straight = straight * report.in_frame_straight;
            report.visible = bent * report.in_frame;
        }
    }
    let see = see.clone();
    Ok(TargetAnswer { session, picture, report, see, place, technique, mark, refit })
}

/// A report with the shares of a straight and of a bent view.
fn judged(
    (judge, sight): (&PictureJudge<'_>, &TargetSight<'_>),
    straight: &View,
    bent: &View,
    report: BendReport,
) -> Result<BendReport, BelvedereError> {
    let visible_straight = judge.share(sight, straight)?;
    let visible = if bent.is_bent() || straight.is_bent() { judge.share(sight, bent)? } else { visible_straight };
    let (in_frame, in_frame_straight) = (sight.in_frame(bent), sight.in_frame(straight));
    Ok(BendReport { visible, in_frame, visible_straight, in_frame_straight, ..report })
}

/// The view that is given by the request or the scene file.
fn given(
    session: &Session,
    request: &TargetRequest,
    (_, fov_y): ([u32; 2], f64),
    up: DVec3,
) -> Result<(Option<View>, Vec<Warning>), BelvedereError> {
    let is_scene_file = session.path().is_some();
    let own = session.view().pinhole();
    let image = request.image.unwrap_or(if is_scene_file { own.image } else { IMAGE });
    let lens = Projection::Perspective { fov_y };
    if let Some([eye, target]) = request.places.or(request.viewpoint.map(Into::into)) {
        let ((eye, of_eye), (look, of_look)) =
            (session.find_place(&eye, "eye")?, session.find_place(&target, "target")?);
        let near = 1e-3 * (look - eye).length();
        let pinhole = Pinhole::look_at(eye, look, up, lens, image, near, None)?;
        let mut said: Vec<Warning> = of_eye.into_iter().chain(of_look).collect();
        let earth = session.resolved().map_or(EarthDoc::Flat, |document| document.earth);
        let view = unbent(pinhole, earth, session.scene(), &mut said)?;
        return Ok((Some(view), said));
    }
    if is_scene_file && request.up.is_some() {
        let text = "a scene file states what is up in camera.up; leave {} out";
        return Err(BelvedereError::Argument(Advice::new(text, &["up"])));
    }
    Ok((is_scene_file.then(|| session.view().straightened()), Vec::new()))
}

/// A target as `x,y,z` in scene coordinates where a place with a height is written in another way, else as it is; and a warning about
/// the place.
fn written_point(session: &Session, see: &str) -> Result<(String, Option<Warning>), BelvedereError> {
    match see.parse::<Place>() {
        Ok(place) if place.has_height() => {
            let (p, said) = session.find_place(&place, "see")?;
            let is_scene = p.truncate().to_array() == place.numbers() && matches!(place.height, PlaceHeight::Metres(_));
            let text = if is_scene { see.to_owned() } else { format!("{:.3},{:.3},{:.3}", p.x, p.y, p.z) };
            Ok((text, said))
        }
        _ => Ok((see.to_owned(), None)),
    }
}

/// The document of the session with the found view.
fn document(session: &Session, view: &View, bend: Option<&Bend>, target: &Target) -> Result<Document, BelvedereError> {
    let Some(resolved) = session.resolved() else {
        return Err(BelvedereError::Target("the scene has no document".into()));
    };
    let pinhole = view.pinhole();
    let ahead = (target.center() - pinhole.eye).dot(pinhole.forward).max(pinhole.near);
    let level = pinhole.right.z.abs() < 1e-9 && pinhole.down.z < -1e-3;
    let up = if level { [0.0, 0.0, 1.0] } else { (-pinhole.down).to_array() };
    let mut document = resolved.clone();
    document.camera = CameraDoc { up, ..CameraDoc::of(pinhole, pinhole.eye + ahead * pinhole.forward) };
    document.constructor = None;
    document.stage.retain(|stage| !matches!(stage, StageDoc::CurvedRays(_)));
    match bend {
        Some(Bend::Rays(s, root)) => document.stage.push(StageDoc::CurvedRays(sidestep_stage(s, root))),
        Some(Bend::Spline(found)) => document.stage.extend(spline_stage(found)),
        None => {}
    }
    Ok(document)
}

/// Content of the report file and of `--json`.
#[derive(Debug, JsonSchema, Serialize)]
pub struct TargetDocument<'a> {
    program: &'a str,
    see: &'a str,
    #[serde(skip_serializing_if = "Option::is_none")]
    target: &'a Option<TargetPlace>,
    /// Visible share in the bent picture, as `visible`.
    visible_bent: f64,
    /// Share inside the bent picture, hidden or not, as `in_frame`.
    in_frame_bent: f64,
    #[serde(flatten)]
    report: BendReport,
    technique: Option<Technique>,
    /// Change of the frame after the bend was known, so that all of the bent model lies inside; left out where the frame stayed, as it does
    /// where the camera is given.
    #[serde(skip_serializing_if = "Option::is_none")]
    refit: Option<RefitRecord>,
    /// Report of the fallback; left out if none was asked for.
    #[serde(skip_serializing_if = "Option::is_none")]
    fallback: &'a Option<FallbackRecord>,
    mark: &'static str,
    view: &'a crate::record::ViewRecord,
    inputs: &'a [crate::record::InputFile],
    warnings: Vec<Warning>,
}

impl TargetAnswer {
    /// One sentence: visible share straight and bent, and the place of a point.
    pub fn summary(&self) -> String {
        let place = self.place.as_ref().map_or_else(String::new, |p| format!("; {p}"));
        let fallback = self.picture.sidecar.fallback.as_ref().map_or_else(String::new, |f| format!("; {f}"));
        self.shares() + &place + &fallback
    }

    fn shares(&self) -> String {
        let BendReport { visible_straight, visible, light_straight, light_best, tried, .. } = self.report;
        let of = |visible: f64, in_frame: f64| match in_frame < 1.0 {
            true => format!("{:.0} % ({:.0} % in the frame)", 100.0 * visible, 100.0 * in_frame),
            false => format!("{:.0} %", 100.0 * visible),
        };
        let straight = of(visible_straight, self.report.in_frame_straight);
        if tried > 0 && visible < ENOUGH && visible <= visible_straight {
            let percent = |share: f64| format!("{:.0} %", 100.0 * share);
            let light = match has_volumes(self.session.scene()) {
                true => format!(
                    "; {} of its light comes through straight, {} at best by a bend, half is needed",
                    percent(light_straight),
                    percent(light_best)
                ),
                false => String::new(),
            };
            return format!("no bend of {tried} shows more than the straight picture, {straight}{light}");
        }
        if tried == 0 || visible <= visible_straight {
            return format!("visible without any bend: {straight}");
        }
        format!("visible in the straight picture: {straight}, in the bent one: {}", of(visible, self.report.in_frame))
    }

    /// Warnings.
    pub fn warnings(&self) -> Vec<Warning> {
        let of_picture = self.picture.sidecar.of_picture.iter().cloned();
        let of_place = self.place.as_ref().and_then(TargetPlace::warning);
        self.session.warnings().into_iter().chain(of_picture).chain(of_place).collect()
    }

    /// Goals that were missed, one sentence each.
    pub fn missed(&self) -> Vec<String> {
        let visible = self.picture.sidecar.fallback.as_ref().map_or(self.report.visible, |f| f.visible);
        let missed = visible < ENOUGH;
        let text = || format!("{:.0} % of what was looked for is visible, 99 % were wanted", 100.0 * visible);
        missed.then(text).into_iter().chain(self.place.iter().filter(|_| missed).filter_map(TargetPlace::why)).collect()
    }

    /// Content of the report file and of `--json`.
    pub fn document(&self) -> TargetDocument<'_> {
        let sidecar = &self.picture.sidecar;
        TargetDocument {
            program: &sidecar.program,
            see: target_scene::shown_name(&self.see),
            target: &self.place,
            visible_bent: self.report.visible,
            in_frame_bent: self.report.in_frame,
            report: self.report,
            technique: self.technique,
            refit: self.refit,
            fallback: &sidecar.fallback,
            mark: self.mark,
            view: &sidecar.view,
            inputs: &sidecar.inputs,
            warnings: sidecar
                .warnings
                .iter()
                .cloned()
                .chain(self.place.as_ref().and_then(TargetPlace::warning))
                .collect(),
        }
    }

    /// Writes the picture with its record, the pair (`OUT.pair.png`) if it differs from the straight one, and the other files asked for.
    ///
    /// # Errors
    /// [`BelvedereError::Io`].
    pub fn write(&self, files: &RevealFiles, overwrite: bool) -> Result<Vec<PathBuf>, BelvedereError> {
        files.write(&self.picture, &self.session, &|| self.document(), overwrite)
    }
}
