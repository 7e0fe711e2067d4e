//! `reveal`: terrain and routes in, a picture in which the routes are visible out.

use super::check::{document_toml, pretty};
use super::output;
use super::render::{self, Picture, RenderRequest};
use crate::resolve::terrain::Solving;
use crate::resolve::vectors::{FeatureKind, kind_of};
use crate::scene_file::TerrainStageDoc;
use crate::scene_file::paths::Roots;
use crate::scene_file::{
    AreaDoc, AreaStyleDoc, CameraDoc, Document, EarthDoc, LayerDoc, LineDoc, LineStyleDoc, PaletteDoc, Paths, PlaneDoc,
    PointDoc, PointLayerDoc, PointStyleDoc, PresetsDoc, ProjectionDoc, SourceDocument, SplineStageDoc, StageDoc,
    TerrainDoc, TerrainStyleDoc, UnitDoc,
};
use crate::{BelvedereError, OpenOptions, Session};
use belvedere_construct::{Goal, MeasureOptions, RevealMemory, RevealOptions, RevealReport, Revealed};
use belvedere_core::{DVec2, DVec3, Pinhole, Projection, View};
use belvedere_disocclusion::{TerrainMemory, TerrainReport};
use belvedere_io::png::{self, Channels};
use belvedere_scene::{Crs, Progress};
use serde::Serialize;
use std::path::{Path, PathBuf};

/// What to reveal, and from where.
#[derive(Debug, Clone, Default)]
pub struct RevealRequest {
    /// Terrain: a file, or `builtin:massif?seed=7`.
    pub dem: String,
    /// Routes, areas or points: files, or `builtin:massif?seed=7`.
    pub features: Vec<String>,
    /// Eye: x, y in the scene's system or degrees if small enough for a georeferenced scene, z metres.
    pub eye: Option<[f64; 3]>,
    /// Point to look at: x, y as for the eye; z metres, else the ground.
    pub look: Option<Vec<f64>>,
    /// Full vertical field of view, degrees.
    pub fov_y_deg: Option<f64>,
    /// Picture size, pixels.
    pub image: Option<[u32; 2]>,
    /// Earth shape.
    pub curved_earth: bool,
    /// Coordinate system of the scene; automatic if left out.
    pub crs: Option<String>,
    /// Leaves holes of the terrain open.
    pub keep_voids: bool,
    /// Tint of the terrain by height.
    pub palette: PaletteDoc,
    /// What bends the picture.
    pub technique: Technique,
    /// Quality of the pictures.
    pub render: RenderRequest,
}

/// What bends the picture.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Technique {
    /// A spline, and terrain that makes way as well where that leaves something hidden.
    Auto,
    /// A spline.
    #[default]
    Spline,
    /// Terrain that makes way.
    Terrain,
    /// Both.
    Both,
}

/// Visible share from which nothing is worth moving the ground for.
const ENOUGH: f64 = 0.99;

/// What the finished picture shows, by lines of sight through its whole chain of stages.
#[derive(Debug, Clone, Copy, Serialize)]
pub struct FinalShares {
    /// What bends the picture in the end.
    pub technique: Technique,
    /// Visible share of the in-frame amount in the straight picture.
    pub visible_straight: Option<f64>,
    /// The same in the bent one.
    pub visible_bent: Option<f64>,
}

/// What was found: a session that shows it, its picture beside the straight one, and the figures.
#[derive(Debug, Clone)]
pub struct RevealAnswer {
    /// Scene and bent view.
    pub session: Session,
    /// Both pictures.
    pub picture: Picture,
    /// Figures of the search for a view and a spline.
    pub report: RevealReport,
    /// What the picture shows where the ground makes way.
    pub shares: Option<FinalShares>,
    missed: Vec<String>,
}

/// The report file.
#[derive(Debug, Clone, Serialize)]
struct ReportFile<'a> {
    program: String,
    /// The spline; left out where only the ground makes way.
    #[serde(flatten)]
    report: Option<&'a RevealReport>,
    #[serde(flatten)]
    shares: Option<FinalShares>,
    #[serde(skip_serializing_if = "Option::is_none")]
    disocclusion: Option<&'a TerrainReport>,
    displacement: Option<render::DisplacementReport>,
    view: &'a crate::provenance::ViewRecord,
    crs: String,
    terrain: Option<render::TerrainRecord>,
    inputs: &'a [crate::provenance::InputFile],
    scene_warnings: &'a [String],
}

/// Chooses a view (unless given) and a bend, and draws both pictures.
///
/// # Errors
/// [`BelvedereError::Construct`] if no view is possible, else as [`Session::open`] and [`render::render`].
pub fn reveal(request: &RevealRequest, options: &OpenOptions) -> Result<RevealAnswer, BelvedereError> {
    if let Some(fov) = request.fov_y_deg.filter(|fov| !(*fov > 0.0 && *fov < 180.0)) {
        return Err(BelvedereError::Usage(format!("--fov is {fov}, it must lie strictly between 0 and 180 degrees")));
    }
    let mut session = load(request, options)?;
    let base = base_view(request, &session)?;
    let image = request.image.unwrap_or([1280, 720]);
    let search = RevealOptions {
        image,
        fov_y: request.fov_y_deg.unwrap_or(45.0).to_radians(),
        earth_radius: request.curved_earth.then(|| crate::resolve::earth_radius(&session.scene)),
        ..RevealOptions::default()
    };
    let mut memory = RevealMemory::default();
    let found = belvedere_construct::reveal(&session.scene, base.as_ref(), &search, &mut memory, &options.progress)?;
    adopt(&mut session, &found)?;
    let with_terrain = match request.technique {
        Technique::Spline => None,
        Technique::Auto if found.report.bent.visible >= ENOUGH => None,
        Technique::Auto | Technique::Both => Some(Technique::Both),
        Technique::Terrain => Some(Technique::Terrain),
    };
    let mut missed = match &found.report.goal {
        Goal::Reached => Vec::new(),
        Goal::Missed(reasons) => reasons.clone(),
    };
    let mut shares = None;
    if let Some(technique) = with_terrain {
        let found = make_way(&mut session, technique, &options.progress)?;
        missed = found.visible_bent.filter(|v| *v < ENOUGH).map(shortfall).into_iter().collect();
        shares = Some(found);
    }
    let picture = draw(&session, request, &options.progress)?;
    Ok(RevealAnswer { session, picture, report: found.report, shares, missed })
}

fn shortfall(visible: f64) -> String {
    format!("{:.1} % of what is in the picture is visible, {:.0} % were wanted", 100.0 * visible, 100.0 * ENOUGH)
}

/// Lets the ground make way in the picture that was found, and judges the whole.
fn make_way(session: &mut Session, technique: Technique, progress: &Progress) -> Result<FinalShares, BelvedereError> {
    let mut document = session.document.clone();
    if technique == Technique::Terrain {
        document.stage.clear();
    }
    document.stage.insert(0, StageDoc::TerrainDisocclusion(TerrainStageDoc::default()));
    let mut memory = TerrainMemory::default();
    let mut solving = Solving { memory: &mut memory, time_step_s: None, progress };
    crate::resolve::look_again(session, document, Some(&mut solving))?;
    let measures =
        belvedere_construct::measure(&session.scene, &session.view, None, &MeasureOptions::default(), progress)?;
    let all = measures.lines.as_ref().or(measures.areas.as_ref()).or(measures.points.as_ref());
    Ok(FinalShares {
        technique,
        visible_straight: all.and_then(|m| m.straight.sight.share),
        visible_bent: all.and_then(|m| m.bent.sight.share),
    })
}

/// Largest hole that is filled, share of the ground: what would be made up in a larger one is no ground.
pub const LARGEST_HOLE: f64 = 0.03;

/// The terrain and the features as a session; holes are filled unless they are large or to be kept.
pub(super) fn load(request: &RevealRequest, options: &OpenOptions) -> Result<Session, BelvedereError> {
    let (document, roots) = document(request)?;
    let source = SourceDocument::made(PathBuf::from("reveal.toml"), document);
    let mut session = crate::resolve::session(source, &roots, options)?;
    session.inputs.remove(0);
    Ok(session)
}

impl RevealAnswer {
    /// Goals that were missed, one sentence each.
    pub fn missed(&self) -> &[String] {
        &self.missed
    }

    /// One sentence: visible share straight and bent.
    pub fn summary(&self) -> String {
        if let Some(FinalShares { visible_straight: Some(straight), visible_bent: Some(bent), .. }) = self.shares {
            return format!(
                "visible in the straight picture: {:.1} %, in the bent one: {:.1} %",
                100.0 * straight,
                100.0 * bent
            );
        }
        let percent = |a: &belvedere_construct::reveal::Appraisal| 100.0 * a.visible;
        format!(
            "visible in the straight picture: {:.1} %, in the bent one: {:.1} %",
            percent(&self.report.straight),
            percent(&self.report.bent)
        )
    }

    /// Writes the bent picture with its record, the pair (`OUT.pair.png`), and whatever else is asked for.
    ///
    /// # Errors
    /// [`BelvedereError::Io`].
    pub fn write(&self, files: &RevealFiles, overwrite: bool) -> Result<Vec<PathBuf>, BelvedereError> {
        let single = Picture { straight: None, ..self.picture.clone() };
        let mut written = single.write(&files.out, overwrite)?;
        let (width, height, pixels) = self.picture.pixels();
        let title = [("Software", self.picture.sidecar.program.as_str()), ("Comment", "straight | bent")];
        png::write(&files.pair(), overwrite, width, height, Channels::Rgb, pixels.as_flattened(), &title)?;
        written.push(files.pair());
        if let (Some(path), Some(frame)) = (&files.before, &self.picture.straight) {
            png::write(
                path,
                overwrite,
                frame.width,
                frame.height,
                Channels::Rgb,
                frame.color.as_flattened(),
                &title[..1],
            )?;
            written.push(path.clone());
        }
        if let Some(path) = &files.report {
            let sidecar = &self.picture.sidecar;
            let report = ReportFile {
                program: sidecar.program.clone(),
                report: Some(&self.report).filter(|_| !self.shares.is_some_and(|s| s.technique == Technique::Terrain)),
                shares: self.shares,
                disocclusion: self.session.terrain_report(),
                displacement: sidecar.displacement,
                view: &sidecar.view,
                crs: self.session.scene.crs.to_string(),
                terrain: sidecar.terrain,
                inputs: &sidecar.inputs,
                scene_warnings: self.session.warnings(),
            };
            output::write_text(path, &pretty(&report)?, overwrite)?;
            written.push(path.clone());
        }
        if let Some(path) = &files.scene {
            let document = beside(self.session.resolved(), path);
            output::write_text(path, &document_toml(&document)?, overwrite)?;
            written.push(path.clone());
        }
        Ok(written)
    }
}

/// Where the results go.
#[derive(Debug, Clone, Default)]
pub struct RevealFiles {
    /// The bent picture.
    pub out: PathBuf,
    /// The straight picture.
    pub before: Option<PathBuf>,
    /// Figures, JSON.
    pub report: Option<PathBuf>,
    /// Scene file that shows the same.
    pub scene: Option<PathBuf>,
}

impl RevealFiles {
    /// File of the two pictures side by side.
    pub fn pair(&self) -> PathBuf {
        self.out.with_extension("pair.png")
    }

    /// Every file that will be written.
    pub fn all(&self) -> Vec<PathBuf> {
        let mut record = self.out.as_os_str().to_owned();
        record.push(".json");
        let asked = [&self.before, &self.report, &self.scene].into_iter().flatten().cloned();
        [self.out.clone(), PathBuf::from(record), self.pair()].into_iter().chain(asked).collect()
    }
}

fn draw(session: &Session, request: &RevealRequest, progress: &Progress) -> Result<Picture, BelvedereError> {
    render::render(session, &RenderRequest { compare: true, straight: false, ..request.render.clone() }, progress)
}

/// Puts what was found into the session and its document.
fn adopt(session: &mut Session, found: &Revealed) -> Result<(), BelvedereError> {
    let pinhole = found.straight.pinhole();
    let document = &mut session.document;
    let ahead = (found.pivot - pinhole.eye).length().max(1.0);
    document.camera = camera_document(pinhole, pinhole.eye + ahead * pinhole.forward);
    document.stage = vec![StageDoc::SplineBend(SplineStageDoc {
        presets: PresetsDoc::Inline(Box::new(found.document.clone())),
        pivot: Some(found.pivot.to_array()),
        plane: Some(PlaneDoc { normal: [0.0, 0.0, 1.0], height_m: Some(found.plane_height) }),
    })];
    session.view = found.view.clone();
    session.warnings.extend(found.report.warnings.iter().cloned());
    Ok(())
}

pub(super) fn camera_document(pinhole: &Pinhole, look_at: DVec3) -> CameraDoc {
    let (projection, fov_y_deg, ortho_height_m) = match pinhole.projection {
        Projection::Perspective { fov_y } => (ProjectionDoc::Perspective, fov_y.to_degrees(), None),
        Projection::Orthographic { height } => (ProjectionDoc::Orthographic, 45.0, Some(height)),
    };
    CameraDoc {
        eye: PointDoc::Scene(pinhole.eye.to_array()),
        look_at: Some(PointDoc::Scene(look_at.to_array())),
        heading_deg: None,
        pitch_deg: None,
        up: [0.0, 0.0, 1.0],
        projection,
        fov_y_deg,
        ortho_height_m,
        image: pinhole.image,
        near: pinhole.near,
        far: pinhole.far,
    }
}

/// The camera asked for.
fn base_view(request: &RevealRequest, session: &Session) -> Result<Option<View>, BelvedereError> {
    let (eye, look) = match (request.eye, &request.look) {
        (None, None) => return Ok(None),
        (Some(eye), Some(look)) => (eye, look),
        _ => return Err(BelvedereError::Usage("--eye and --look belong together; give both, or neither".into())),
    };
    let ground = crate::resolve::Ground { crs: session.scene.crs, terrain: session.scene.terrain() };
    let place = |x: f64, y: f64| {
        let degrees = matches!(session.scene.crs, Crs::Epsg(_)) && x.abs() <= 360.0 && y.abs() <= 90.0;
        if degrees { ground.place_of(x, y).map_err(BelvedereError::Usage) } else { Ok(DVec2::new(x, y)) }
    };
    let eye = place(eye[0], eye[1])?.extend(eye[2]);
    let target = match look[..] {
        [x, y] => {
            let xy = place(x, y)?;
            xy.extend(ground.height_at(xy).map_err(|e| BelvedereError::Usage(format!("--look: {e}")))?)
        }
        [x, y, z] => place(x, y)?.extend(z),
        _ => return Err(BelvedereError::Usage(format!("--look has {} numbers; give X,Y or X,Y,Z", look.len()))),
    };
    let lens = Projection::Perspective { fov_y: request.fov_y_deg.unwrap_or(45.0).to_radians() };
    let pinhole = Pinhole::look_at(eye, target, DVec3::Z, lens, request.image.unwrap_or([1280, 720]), 1.0, None)
        .map_err(|e| BelvedereError::Usage(e.to_string()))?;
    Ok(Some(View::straight(pinhole)))
}

/// A document of the terrain and the features, and the folders they lie in.
fn document(request: &RevealRequest) -> Result<(Document, Roots), BelvedereError> {
    let mut roots = Roots::default();
    let dem = locate(&request.dem, &mut roots)?;
    let palette = crate::session::located(&request.palette, &mut roots.allowed)?;
    let mut layer = vec![LayerDoc::Terrain(TerrainDoc {
        id: "ground".into(),
        source: Paths::One(dem),
        fill_voids: !request.keep_voids,
        largest_hole: (!request.keep_voids).then_some(LARGEST_HOLE),
        source_crs: None,
        nodata: None,
        drape: None,
        style: TerrainStyleDoc { palette, ..TerrainStyleDoc::default() },
    })];
    if request.features.is_empty() {
        return Err(BelvedereError::Usage(
            "no features are given; name at least one file of routes, areas or points".into(),
        ));
    }
    for (i, name) in request.features.iter().enumerate() {
        let source = locate(name, &mut roots)?;
        layer.push(feature_layer(format!("features{}", i + 1), source)?);
    }
    let camera = PointDoc::Scene([0.0; 3]);
    let ahead = PointDoc::Scene([0.0, 1.0, 0.0]);
    let camera = CameraDoc { eye: camera, look_at: Some(ahead), ..camera_default() };
    let title = "Revealed".to_owned();
    let document = Document {
        format: 1,
        title,
        crs: request.crs.clone().unwrap_or_else(|| "auto".into()),
        unit: UnitDoc::Metre,
        earth: if request.curved_earth { EarthDoc::Curved } else { EarthDoc::Flat },
        camera,
        overlay: None,
        light: None,
        layer,
        stage: Vec::new(),
        constructor: None,
        animation: None,
    };
    Ok((document, roots))
}

fn camera_default() -> CameraDoc {
    CameraDoc {
        eye: PointDoc::Scene([0.0; 3]),
        look_at: None,
        heading_deg: None,
        pitch_deg: None,
        up: [0.0, 0.0, 1.0],
        projection: ProjectionDoc::Perspective,
        fov_y_deg: 45.0,
        ortho_height_m: None,
        image: [1280, 720],
        near: 1.0,
        far: None,
    }
}

/// The absolute path of a file that the user named, whose folder is then allowed; built-in names stay.
fn locate(name: &str, roots: &mut Roots) -> Result<String, BelvedereError> {
    if name.starts_with("builtin:") {
        return Ok(name.to_owned());
    }
    let path = Path::new(name).canonicalize().map_err(|e| belvedere_io::IoError::os(name, e))?;
    if let Some(folder) = path.parent() {
        roots.allowed.push(folder.to_owned());
    }
    path.to_str()
        .map(str::to_owned)
        .ok_or_else(|| BelvedereError::Path { name: name.to_owned(), reason: "is not UTF-8; rename it".into() })
}

/// Lines if the file has any, else areas, else points.
fn feature_layer(id: String, source: String) -> Result<LayerDoc, BelvedereError> {
    let paths = Paths::One(source.clone());
    let line = || LineDoc {
        id: id.clone(),
        source: Some(paths.clone()),
        route: None,
        must_see: true,
        style: LineStyleDoc::default(),
    };
    if source.starts_with("builtin:") {
        return Ok(LayerDoc::Line(line()));
    }
    Ok(match kind_of(Path::new(&source))? {
        FeatureKind::Lines => LayerDoc::Line(line()),
        FeatureKind::Areas => {
            LayerDoc::Area(AreaDoc { id, source: paths, must_see: true, style: AreaStyleDoc::default() })
        }
        FeatureKind::Points => {
            LayerDoc::Point(PointLayerDoc { id, source: paths, must_see: true, style: PointStyleDoc::default() })
        }
    })
}

/// The document with sources relative to the folder of `path` where they lie below it.
fn beside(document: &Document, path: &Path) -> Document {
    let folder = path.parent().filter(|p| !p.as_os_str().is_empty()).unwrap_or(Path::new("."));
    let folder = folder.canonicalize().unwrap_or_else(|_| folder.to_owned());
    let below = |name: &mut String| {
        if let Some(below) = Path::new(name.as_str()).strip_prefix(&folder).ok().and_then(Path::to_str) {
            *name = below.to_owned();
        }
    };
    let short = |source: &mut Paths| {
        if let Paths::One(name) = source {
            below(name);
        }
    };
    let mut document = document.clone();
    for layer in &mut document.layer {
        match layer {
            LayerDoc::Terrain(l) => {
                short(&mut l.source);
                if let PaletteDoc::File(name) = &mut l.style.palette {
                    below(name);
                }
            }
            LayerDoc::Line(l) => l.source.iter_mut().for_each(short),
            LayerDoc::Area(l) => short(&mut l.source),
            LayerDoc::Point(l) => short(&mut l.source),
            _ => {}
        }
    }
    document
}
