//! `reveal --see`: draws a picture in which one target in models is visible, by rays that bend around its occluders.

use super::appearance::Appearance;
use super::model_layers::{layer, set_transfer, unit_of};
use super::target_views;
use crate::picture::{Picture, PictureOptions, TargetPlace};
use crate::places::{Place, PlaceHeight};
use crate::resolve::rays::sidestep_stage;
use crate::scene_file::{
    CameraDoc, ConstructorDoc, ConstructorKind, Document, LayerDoc, PointDoc, SourceDocument, StageDoc,
};
use crate::targets::{self, target};
use crate::verbs::reveal::{IMAGE, RevealFiles, Viewpoint};
use crate::{BelvedereError, OpenOptions, Session};
use belvedere_construct::rays::{AroundOptions, BendReport, Sidestep, Target, TargetSight, bend_around};
use belvedere_core::{DVec3, Pinhole, Projection, View, Warning};
use belvedere_scene::LayerKind;
use belvedere_scene::molecule::Selection;
use serde::Serialize;
use std::path::{Path, PathBuf};

/// Full vertical field of view unless given, degrees.
const FOV_Y_DEG: f64 = 30.0;
/// Visible share from which on a view is good enough; and after so many views.
const ENOUGH: f64 = 0.99;
const VIEWS_AT_LEAST: usize = 3;
const MUCH: f64 = 0.8;

/// Target to show, and the view.
#[derive(Debug, Clone, Default)]
pub struct TargetRequest {
    /// Models (meshes, molecules, volumes) or one scene file.
    pub files: Vec<PathBuf>,
    /// The target: id of a layer (that of a file is its name without the ending), atoms such as `chain B`, or a point `x,y,z`, scene
    /// coordinates.
    pub see: String,
    /// Transfer function of volume files: a name or a file; `auto` if left out.
    pub transfer: Option<String>,
    /// Eye and target of the view; if left out, the camera of the scene file, or one chosen automatically.
    pub viewpoint: Option<Viewpoint>,
    /// Eye and target as a user wrote them, instead of `viewpoint`.
    pub places: Option<[Place; 2]>,
    /// Full vertical field of view, degrees.
    pub fov_y_deg: Option<f64>,
    /// Direction that is up in the picture, a unit vector; z if left out. Not for scene files, which state their own.
    pub up: Option<DVec3>,
    /// Picture size, pixels.
    pub image: Option<[u32; 2]>,
    /// Fallbacks if no bend shows the target: `transparency`, `cutaway` or `explosion`, alone or as `LAYER:KIND`.
    pub fallback: Vec<String>,
    /// Quality of the pictures.
    pub picture: PictureOptions,
    /// Light, stylisation and mark; models have no exaggeration.
    pub appearance: Appearance,
}

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
}

/// Chooses a view (unless given) and the smallest bend that shows the target, and draws both pictures.
///
/// # Errors
/// [`BelvedereError::Target`] if there is no such target, else as [`Session::open`] and [`Session::render`].
pub fn reveal_target(request: &TargetRequest, options: &OpenOptions) -> Result<TargetAnswer, BelvedereError> {
    let fov_y_deg = request.fov_y_deg.unwrap_or(FOV_Y_DEG);
    if !(fov_y_deg > 0.0 && fov_y_deg < 180.0) {
        return Err(BelvedereError::FieldOfView { deg: fov_y_deg });
    }
    let mut session = open(request, options)?;
    request.appearance.check(session.scene().crs)?;
    let (see, said) = written_point(&session, &request.see)?;
    session.loaded.warnings.extend(said);
    let target = target(session.scene(), &see)?;
    let place = targets::point(&see).map(|p| TargetPlace::of(session.scene(), p));
    let up = request.up.unwrap_or(DVec3::Z);
    let (view, said) = given(&session, request, fov_y_deg, up)?;
    session.loaded.warnings.extend(said);
    let (views, free) = match view {
        Some(view) => (vec![view], false),
        None => {
            let image = request.image.unwrap_or(IMAGE);
            (target_views::around(session.scene(), &target, up, (image, fov_y_deg.to_radians()))?, true)
        }
    };
    let around = AroundOptions::default();
    let mut best: Option<(View, Option<Sidestep>, BendReport)> = None;
    let (mut tried, mut light_best) = (0, 0.0f64);
    for (k, view) in views.into_iter().enumerate() {
        let found = bend_around(session.scene(), &view, &target, &around, &options.progress)?;
        (tried, light_best) = (tried + found.report.tried, light_best.max(found.report.light_best));
        let score = |r: &BendReport| r.visible - 0.1 * r.motion;
        if best.as_ref().is_none_or(|(.., b)| score(&found.report) > score(b) + 0.02) {
            best = Some((view, found.bent.map(|(_, sidestep)| sidestep), found.report));
        }
        // Where much is seen, later views, which show less without a bend, seldom show more with one.
        let enough = if k + 1 < VIEWS_AT_LEAST { ENOUGH } else { MUCH };
        if best.as_ref().is_some_and(|(.., b)| b.visible >= enough) {
            break;
        }
    }
    let Some((mut view, sidestep, mut report)) = best else {
        return Err(BelvedereError::Target("there is no view to look from".into()));
    };
    if let Some(sidestep) = sidestep.as_ref().filter(|_| free)
        && let Some(moved) = target_views::reframed(session.scene(), &view, sidestep, &target)
    {
        let sight = TargetSight::new(session.scene(), &target);
        let bent = sidestep.view(&moved)?;
        report.visible = sight.share(&bent, 0.0);
        report.in_frame = sight.in_frame(&bent);
        report.visible_straight = sight.share(&moved, 0.0);
        report.in_frame_straight = sight.in_frame(&moved);
        view = moved;
    }
    let report = BendReport { tried, light_best, ..report };
    let mut document = document(&session, &view, sidestep.as_ref(), &target)?;
    if report.visible < ENOUGH && !request.fallback.is_empty() {
        let (target, fallback) = (Some(see.clone()), request.fallback.clone());
        document.constructor = Some(ConstructorDoc { target, fallback, ..ConstructorDoc::of(ConstructorKind::Manual) });
    }
    request.appearance.describe(&mut document);
    let session = match request.appearance.is_usual() {
        true => session.with_document(document, None)?,
        false => Appearance::of_document(&session, document)?,
    };
    let pair = PictureOptions {
        compare: true,
        straight: false,
        progress: options.progress.clone(),
        ..request.picture.clone()
    };
    let mut picture = session.render(&pair)?;
    if let Some(place) = &place {
        picture.mark_target(place, &report);
    }
    Ok(TargetAnswer { session, picture, report, see, place })
}

/// Opens the layers with a provisional camera.
fn open(request: &TargetRequest, options: &OpenOptions) -> Result<Session, BelvedereError> {
    let is_scene = |p: &PathBuf| p.extension().is_some_and(|e| e == "toml" || e == "json");
    if let [file] = &request.files[..]
        && is_scene(file)
    {
        if request.transfer.is_some() {
            return Err(BelvedereError::Target(
                "a scene file states its transfer functions itself; leave --transfer out".into(),
            ));
        }
        return Session::open(file, options);
    }
    let mut options = options.clone();
    let mut layers = Vec::new();
    for file in &request.files {
        if file.to_str().is_some_and(|name| name.starts_with("builtin:")) {
            layers.push(layer(file, &layers)?);
            continue;
        }
        let path = belvedere_io::fs::canonicalize(file).map_err(|e| belvedere_io::IoError::os(file, e))?;
        options.allow_roots.extend(path.parent().map(Path::to_owned));
        layers.push(layer(&path, &layers)?);
    }
    if let Some(transfer) = &request.transfer {
        set_transfer(&mut layers, transfer, &mut options)?;
    }
    for layer in &mut layers {
        if let LayerDoc::Molecule(molecule) = layer
            && Selection::parse(&request.see).is_ok()
        {
            molecule.select = Some(request.see.clone());
        }
    }
    let unit = unit_of(&layers);
    let camera = CameraDoc::looking(DVec3::new(0.0, -1.0, 0.0), DVec3::ZERO);
    let title = format!("{} revealed", request.see);
    let document = Document { title, crs: "local".into(), unit, layer: layers, ..Document::seen_by(camera) };
    Session::from_document(SourceDocument::new(document), &options)
}

/// The view that is given by the request or the scene file.
fn given(
    session: &Session,
    request: &TargetRequest,
    fov_y_deg: f64,
    up: DVec3,
) -> Result<(Option<View>, Vec<Warning>), BelvedereError> {
    let is_scene_file = session.path().is_some();
    let own = session.view().pinhole();
    let image = request.image.unwrap_or(if is_scene_file { own.image } else { IMAGE });
    let lens = Projection::Perspective { fov_y: fov_y_deg.to_radians() };
    if let Some([eye, target]) = request.places.or(request.viewpoint.map(Into::into)) {
        let ((eye, of_eye), (look, of_look)) =
            (session.find_place(&eye, "eye")?, session.find_place(&target, "target")?);
        let near = 1e-3 * (look - eye).length();
        let view = View::straight(Pinhole::look_at(eye, look, up, lens, image, near, None)?);
        return Ok((Some(view), of_eye.into_iter().chain(of_look).collect()));
    }
    if is_scene_file && request.up.is_some() {
        return Err(BelvedereError::Target("a scene file states what is up in camera.up; leave --up out".into()));
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
fn document(
    session: &Session,
    view: &View,
    sidestep: Option<&Sidestep>,
    target: &Target,
) -> Result<Document, BelvedereError> {
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
    document.stage.extend(sidestep.map(|s| StageDoc::CurvedRays(sidestep_stage(s, pinhole))));
    Ok(document)
}

/// Contents of the report file.
#[derive(Debug, Serialize)]
struct TargetReport<'a> {
    program: &'a str,
    see: &'a str,
    #[serde(skip_serializing_if = "Option::is_none")]
    target: &'a Option<TargetPlace>,
    #[serde(flatten)]
    report: BendReport,
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
            let light = match self.has_volumes() {
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

    fn has_volumes(&self) -> bool {
        self.session.scene().layers.iter().any(|l| matches!(l.kind, LayerKind::Volume(_)))
    }

    /// Warnings.
    pub fn warnings(&self) -> Vec<Warning> {
        self.session.warnings().into_iter().chain(self.place.as_ref().and_then(TargetPlace::warning)).collect()
    }

    /// Goals that were missed, one sentence each.
    pub fn missed(&self) -> Vec<String> {
        let visible = self.picture.sidecar.fallback.as_ref().map_or(self.report.visible, |f| f.visible);
        let missed = visible < ENOUGH;
        let text = || format!("{:.0} % of what was looked for is visible, 99 % were wanted", 100.0 * visible);
        missed.then(text).into_iter().chain(self.place.iter().filter(|_| missed).filter_map(TargetPlace::why)).collect()
    }

    /// Writes the bent picture with its record, the pair (`OUT.pair.png`), and the other files asked for.
    ///
    /// # Errors
    /// [`BelvedereError::Io`].
    pub fn write(&self, files: &RevealFiles, overwrite: bool) -> Result<Vec<PathBuf>, BelvedereError> {
        let sidecar = &self.picture.sidecar;
        let report = TargetReport {
            program: &sidecar.program,
            see: &self.see,
            target: &self.place,
            report: self.report,
            view: &sidecar.view,
            inputs: &sidecar.inputs,
            warnings: self.warnings(),
        };
        files.write(&self.picture, &self.session, &report, overwrite)
    }
}

impl CameraDoc {
    /// A camera at `eye` that looks at `look_at`.
    pub(crate) fn looking(eye: DVec3, look_at: DVec3) -> Self {
        let lens = Projection::Perspective { fov_y: FOV_Y_DEG.to_radians() };
        let axes = (DVec3::X, -DVec3::Z, DVec3::Y);
        let (right, down, forward) = axes;
        let pinhole = Pinhole { eye, right, down, forward, projection: lens, image: IMAGE, near: 1e-3, far: None };
        Self { look_at: Some(PointDoc::Scene(look_at.to_array())), ..Self::of(&pinhole, look_at) }
    }
}
