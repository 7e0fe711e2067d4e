//! `disocclude`: an elevation model in, one in which features can be seen from an eye out.

use super::check::pretty;
use super::output;
use super::render::{self, RenderRequest};
use super::reveal::{self, RevealRequest};
use crate::provenance::{self, InputFile};
use crate::resolve::terrain::{self as intent, Solving};
use crate::scene_file::{self, StageDoc, TerrainStageDoc};
use crate::{BelvedereError, OpenOptions, Session};
use belvedere_core::{DVec2, DVec3, EarthCurvature, Pinhole, Projection, Stage, TerrainDisocclusion, View};
use belvedere_disocclusion::{Solved, TerrainMemory, TerrainReport, TerrainSettings, TerrainSolver};
use belvedere_io::crs::{CoordinateSystem, Transform};
use belvedere_io::geotiff::write_geotiff;
use belvedere_io::terrain::{OriginalTerrain, TerrainRequest, load_original};
use belvedere_scene::{Crs, Layer, LayerKind, Progress};
use serde::Serialize;
use serde_json::{Value, json};
use std::path::{Path, PathBuf};

/// Sides of the picture that the field of view belongs to, pixels.
const IMAGE: [u32; 2] = [1280, 720];
/// Share of the length in view that is wanted visible.
const VISIBLE_LENGTH: f64 = 0.99;

/// What to show, and from where.
#[derive(Debug, Clone, Default)]
pub struct DisoccludeRequest {
    /// Elevation model: one file.
    pub dem: PathBuf,
    /// Files of routes, areas or points.
    pub features: Vec<PathBuf>,
    /// Eye: x, y in the system of the elevation model (degrees if geographic), z metres over its datum.
    pub eye: [f64; 3],
    /// Place looked at, x, y likewise.
    pub look: [f64; 2],
    /// Full horizontal field of view, degrees, in (0, 180).
    pub fov_x_deg: f64,
    /// Parameters of the solver.
    pub parameters: TerrainStageDoc,
    /// Lets the ground fall away with the distance.
    pub curved_earth: bool,
    /// Coordinate system to solve in; automatic if left out.
    pub crs: Option<String>,
}

/// Parameters of the solver from `key=value` texts, keys and values as in scene files.
///
/// # Errors
/// [`BelvedereError::Usage`] with the nearest key that exists.
pub fn parameters(texts: &[String]) -> Result<TerrainStageDoc, BelvedereError> {
    let mut toml = String::new();
    for text in texts {
        let Some((key, value)) = text.split_once('=') else {
            return Err(BelvedereError::Usage(format!("--set {text} has no value; give key=value, such as w=0.6")));
        };
        let (key, value) = (key.trim(), value.trim());
        let plain = value.parse::<f64>().is_ok() && !value.eq_ignore_ascii_case("infinity");
        let value = if plain || value.starts_with('"') { value.to_owned() } else { format!("{value:?}") };
        toml += &format!("{key} = {value}\n");
    }
    let fail = |e: scene_file::DocError| BelvedereError::Usage(format!("--set: {e}"));
    let tree = scene_file::tree(Path::new("set.toml"), &toml).map_err(fail)?;
    let document: TerrainStageDoc = scene_file::decode(&tree).map_err(fail)?;
    match (&document.delta, &document.delta_sha256) {
        (None, None) => Ok(document),
        _ => Err(BelvedereError::Usage("--set: delta is what is solved for; leave it out".into())),
    }
}

/// What was found.
pub struct Disoccluded {
    /// Terrain and features.
    pub session: Session,
    /// Displacement and figures.
    pub solved: Solved,
    original: OriginalTerrain,
    record: Record,
}

/// The report file.
#[derive(Debug, Clone, Serialize)]
struct Record {
    program: String,
    crs: String,
    eye: [f64; 3],
    look: [f64; 2],
    fov_x_deg: f64,
    earth: &'static str,
    layers: Vec<String>,
    inputs: Vec<InputFile>,
    warnings: Vec<String>,
}

/// Where the results go.
#[derive(Debug, Clone, Default)]
pub struct DisoccludeFiles {
    /// Displaced elevation model, GeoTIFF on the grid of the input.
    pub out: PathBuf,
    /// Figures, JSON.
    pub report: Option<PathBuf>,
    /// Displacement, GeoTIFF on the grid of the input.
    pub displacement: Option<PathBuf>,
    /// Features on the displaced ground, GeoJSON.
    pub features: Option<PathBuf>,
    /// The ground before and after from the eye, PNG, with its record and displacement beside it.
    pub picture: Option<PathBuf>,
}

impl DisoccludeFiles {
    /// Every file that will be written.
    pub fn all(&self) -> Vec<PathBuf> {
        let asked = [&self.report, &self.displacement, &self.features].into_iter().flatten().cloned();
        let pictures = self.picture.iter().flat_map(|p| render::outputs(p, &RenderRequest::default(), true));
        std::iter::once(self.out.clone()).chain(asked).chain(pictures).collect()
    }
}

/// Solves for the features in a level picture from the eye.
///
/// # Errors
/// [`BelvedereError::Usage`] for an impossible eye, look or field of view; [`BelvedereError::Construct`]; those of the loaders.
pub fn disocclude(request: &DisoccludeRequest, options: &OpenOptions) -> Result<Disoccluded, BelvedereError> {
    let settings = intent::settings(&request.parameters).map_err(|(_, reason)| BelvedereError::Usage(reason))?;
    let solver = TerrainSolver::new(settings)?;
    let progress = &options.progress;
    let original = load_original(&request.dem, &TerrainRequest::default(), progress)?;
    let mut session = open(request, options)?;
    session.warnings.extend(original.value.georeference_note());
    let asked = Asked::new(request, &original.value, &session)?;
    let view = asked.view(asked.target.extend(asked.eye.z), None)?;
    let mut memory = TerrainMemory::default();
    let solving = Solving { memory: &mut memory, time_step_s: None, progress };
    let solved = solver.solve(&session.scene, &view, solving.memory, solving.progress)?;
    session.warnings.extend(intent::remarks(&solved));
    show(&mut session, &asked, &solved, solver.settings())?;
    let record = Record {
        program: format!("belvedere {}", crate::VERSION),
        crs: session.scene.crs.to_string(),
        eye: request.eye,
        look: request.look,
        fov_x_deg: request.fov_x_deg,
        earth: if request.curved_earth { "curved" } else { "flat" },
        layers: session.scene.layers.iter().map(|l| l.id.clone()).collect(),
        inputs: provenance::inputs(session.inputs())?,
        warnings: session.warnings.clone(),
    };
    Ok(Disoccluded { session, solved, original: original.value, record })
}

/// Puts the solution into the session: its picture looks down on the place looked at.
fn show(
    session: &mut Session,
    asked: &Asked,
    solved: &Solved,
    settings: &TerrainSettings,
) -> Result<(), BelvedereError> {
    let ground = session.scene.terrain().and_then(|t| t.surface_at(asked.target));
    let look_at = asked.target.extend(ground.unwrap_or(asked.eye.z));
    let stage = Stage::TerrainDisocclusion(solved.stage.clone());
    session.view = asked.view(look_at, Some(stage))?;
    session.document.camera = reveal::camera_document(session.view.pinhole(), look_at);
    session.document.stage = vec![StageDoc::TerrainDisocclusion(intent::document(settings, &session.scene))];
    session.terrain = Some(solved.report.clone());
    Ok(())
}

/// Terrain and features; holes stay holes.
fn open(request: &DisoccludeRequest, options: &OpenOptions) -> Result<Session, BelvedereError> {
    let name = |p: &PathBuf| p.to_string_lossy().into_owned();
    let request = RevealRequest {
        dem: name(&request.dem),
        features: request.features.iter().map(name).collect(),
        curved_earth: request.curved_earth,
        crs: request.crs.clone(),
        keep_voids: true,
        ..RevealRequest::default()
    };
    reveal::load(&request, options)
}

/// Eye and place looked at in the scene.
struct Asked {
    eye: DVec3,
    target: DVec2,
    fov_x: f64,
    earth: Option<Stage>,
}

impl Asked {
    fn new(request: &DisoccludeRequest, original: &OriginalTerrain, session: &Session) -> Result<Self, BelvedereError> {
        let fov = request.fov_x_deg;
        if !(fov > 0.0 && fov < 180.0) {
            return Err(BelvedereError::Usage(format!(
                "--fov is {fov}, it must lie strictly between 0 and 180 degrees"
            )));
        }
        let place = |what: &str, [x, y]: [f64; 2]| {
            original.scene_from_model(session.scene.crs, DVec2::new(x, y)).ok_or_else(|| {
                BelvedereError::Usage(format!(
                    "--{what} {x},{y} is no place in the system of the elevation model ({}); give x,y in that system",
                    original.system_name()
                ))
            })
        };
        let [x, y, z] = request.eye;
        let eye = place("eye", [x, y])?.extend(z);
        let target = place("look", request.look)?;
        if eye.truncate().distance(target) < 1e-6 {
            return Err(BelvedereError::Usage("--eye and --look are the same place; look somewhere else".into()));
        }
        let earth = request.curved_earth.then(|| {
            let radius = crate::resolve::earth_radius(&session.scene);
            Stage::EarthCurvature(EarthCurvature { eye, radius, refraction: EarthCurvature::REFRACTION })
        });
        Ok(Self { eye, target, fov_x: fov.to_radians(), earth })
    }

    /// What the eye sees towards `look_at`. Level, it asks for what lies above or below the picture as well, for the ground
    /// moves up and down.
    fn view(&self, look_at: DVec3, ground: Option<Stage>) -> Result<View, BelvedereError> {
        let usage = |e: &dyn std::fmt::Display| BelvedereError::Usage(e.to_string());
        let [width, height] = IMAGE.map(f64::from);
        let fov_y = 2.0 * ((0.5 * self.fov_x).tan() * height / width).atan();
        let lens = Projection::Perspective { fov_y };
        let pinhole = Pinhole::look_at(self.eye, look_at, DVec3::Z, lens, IMAGE, 1.0, None).map_err(|e| usage(&e))?;
        View::new(pinhole, self.earth.iter().cloned().chain(ground).collect()).map_err(|e| usage(&e))
    }
}

impl Disoccluded {
    /// Figures of the solution.
    pub fn report(&self) -> &TerrainReport {
        &self.solved.report
    }

    /// Goals that were missed, one sentence each.
    pub fn missed(&self) -> Vec<String> {
        let r = self.report();
        let mut out = Vec::new();
        if r.metrics.visible < 1.0 {
            out.push(format!(
                "{:.2} % of the {} points in view are visible, all were wanted",
                100.0 * r.metrics.visible,
                r.points
            ));
        }
        let length = r.metrics.visible_dense - r.metrics.hidden_in_guard;
        if length < VISIBLE_LENGTH {
            out.push(format!(
                "{:.2} % of the length in view is visible, {:.0} % were wanted",
                100.0 * length,
                100.0 * VISIBLE_LENGTH
            ));
        }
        out
    }

    /// One sentence: what is visible before and after, and what that takes.
    pub fn summary(&self) -> String {
        let r = self.report();
        format!(
            "visible of the features in view: {:.1} % before, {:.1} % after; all the ground, in the picture or not, moved by {:.1} m rms, {:.1} m at most",
            100.0 * r.visible_dense_before,
            100.0 * r.metrics.visible_dense,
            r.metrics.rms_m,
            r.metrics.max_m
        )
    }

    /// Writes the displaced elevation model and whatever else is asked for.
    ///
    /// # Errors
    /// [`BelvedereError::Io`]; those of [`render::render`] for the picture.
    pub fn write(
        &self,
        files: &DisoccludeFiles,
        overwrite: bool,
        progress: &Progress,
    ) -> Result<Vec<PathBuf>, BelvedereError> {
        let stage = &self.solved.stage;
        let [dem, delta] = self.original.moved(self.session.scene.crs, |p| stage.delta_at(p.extend(0.0)))?;
        write_geotiff(&files.out, &dem, overwrite)?;
        let mut written = vec![files.out.clone()];
        if let Some(path) = &files.displacement {
            write_geotiff(path, &delta, overwrite)?;
            written.push(path.clone());
        }
        if let Some(path) = &files.features {
            output::write_text(path, &output::json(&moved_features(&self.session, stage)?)?, overwrite)?;
            written.push(path.clone());
        }
        if let Some(path) = &files.picture {
            let request = RenderRequest { compare: true, ..RenderRequest::default() };
            written.extend(render::render(&self.session, &request, progress)?.write(path, overwrite)?);
        }
        if let Some(path) = &files.report {
            let mut report = serde_json::to_value(self.report()).unwrap_or_default();
            if let (Value::Object(report), Ok(Value::Object(record))) =
                (&mut report, serde_json::to_value(&self.record))
            {
                report.extend(record);
            }
            output::write_text(path, &pretty(&report)?, overwrite)?;
            written.push(path.clone());
        }
        Ok(written)
    }
}

/// Features on the displaced ground: GeoJSON in WGS 84 (scene coordinates without georeference), heights those of the displaced
/// ground, the true places as the property `true_coordinates`.
fn moved_features(session: &Session, stage: &TerrainDisocclusion) -> Result<Value, BelvedereError> {
    let scene = &session.scene;
    let to_wgs84 = match scene.crs {
        Crs::Local => None,
        crs => {
            let system = CoordinateSystem::from_scene(crs).map_err(|e| BelvedereError::Usage(e.to_string()))?;
            let wgs84 = CoordinateSystem::wgs84().map_err(|e| BelvedereError::Usage(e.to_string()))?;
            Some(Transform::new(&system, &wgs84).map_err(|e| BelvedereError::Usage(e.to_string()))?)
        }
    };
    let geographic = |p: DVec3| {
        let xy = to_wgs84.as_ref().map_or(Some(p.truncate()), |t| t.forward_one(p.truncate()))?;
        Some([xy.x, xy.y, p.z])
    };
    let moved = |p: DVec3| p + stage.delta_at(p) * DVec3::Z;
    // A place outside the domain of the system is left out, from both lists alike.
    let both = |points: &[DVec3]| -> (Vec<[f64; 3]>, Vec<[f64; 3]>) {
        points.iter().filter_map(|p| Some((geographic(moved(*p))?, geographic(*p)?))).unzip()
    };
    let on_ground = |xy: DVec2| xy.extend(scene.terrain().and_then(|t| t.surface_at(xy)).unwrap_or(0.0));
    let mut features = Vec::new();
    for layer in scene.layers.iter().filter(|l| l.must_see) {
        match &layer.kind {
            LayerKind::Line(l) => {
                for f in &l.features {
                    let (now, before) = both(&f.points);
                    features.push(feature(layer, &f.name, "LineString", json!(now), json!(before)));
                }
            }
            LayerKind::Area(a) => {
                for f in &a.features {
                    let closed = |ring: &Vec<DVec2>| -> Vec<DVec3> {
                        ring.iter().chain(ring.first()).map(|p| on_ground(*p)).collect()
                    };
                    let (now, before): (Vec<_>, Vec<_>) = f.rings.iter().map(|r| both(&closed(r))).unzip();
                    features.push(feature(layer, &f.name, "Polygon", json!(now), json!(before)));
                }
            }
            LayerKind::Point(p) => {
                for f in &p.features {
                    if let (Some(now), Some(before)) = (geographic(moved(f.position)), geographic(f.position)) {
                        features.push(feature(layer, &f.name, "Point", json!(now), json!(before)));
                    }
                }
            }
            LayerKind::Terrain(_) | LayerKind::Boxes(_) | LayerKind::Mesh(_) => {}
        }
    }
    Ok(json!({ "type": "FeatureCollection", "features": features }))
}

fn feature(layer: &Layer, name: &str, kind: &str, now: Value, before: Value) -> Value {
    json!({
        "type": "Feature",
        "geometry": { "type": kind, "coordinates": now },
        "properties": { "name": name, "layer": layer.id, "true_coordinates": before },
    })
}
