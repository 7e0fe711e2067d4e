//! `disocclude`: writes an elevation model on which features are visible from an eye.

use super::certificate::{Certificate, Evidence};
use super::moved::MovedFeatures;
use super::written_ground::{HeightsToWrite, ToWrite};
use crate::answers;
use crate::data::DataFiles;
use crate::guard::guarded;
use crate::output;
use crate::picture::{self, PictureOptions};
use crate::places::{Place, PlaceFinder};
use crate::record::{self, InputFile};
use crate::request::{Disocclude, WrittenGrid};
use crate::scene_file::{self, CameraDoc, EarthDoc, StageDoc, TerrainStageDoc};
use crate::{Advice, BelvedereError, OpenOptions, Session};
use belvedere_construct::measure::{Shares, percent};
use belvedere_construct::reveal::shortfall;
use belvedere_core::{DVec2, DVec3, EarthCurvature, Pinhole, Projection, Stage, View};
use belvedere_core::{Warning, WarningKind};
use belvedere_disocclusion::report::{RiverReport, TrimReport};
use belvedere_disocclusion::{Solved, SolverMode, TerrainReport, TerrainSettings, TerrainSolver, ViewpointOptions};
use belvedere_io::IoError;
use belvedere_io::geotiff::write_cloud_geotiff;
use belvedere_io::raster::Raster;
use belvedere_io::terrain::OriginalTerrain;
use belvedere_resolve::ground::earth_radius;
use belvedere_resolve::terrain as intent;
use belvedere_scene::{Progress, Scene, Sea};
use schemars::JsonSchema;
use serde::{Serialize, Serializer};
use serde_json::{Map, Value};
use std::path::PathBuf;

/// Size of the picture to which the field of view refers, pixels.
const IMAGE: [u32; 2] = [1280, 720];
/// Share from which on a guarantee counts as kept on resampled heights.
const KEPT_SHARE: f64 = 0.9999;
/// Share of what is in view whose loss is worth a word.
const LOST_ELSEWHERE: f64 = 0.005;
/// Share of the remaining time for adjusting the eye.
const ADJUSTING: f64 = 0.4;
/// Time for judging and writing the ground, as a multiple of the time for reading it.
const WRITING: f64 = 1.5;
/// Visible share of the features in view that is the goal.
const VISIBLE_LENGTH: f64 = 0.995;

/// Parameters of the solver from `key=value` texts, keys and values as in scene files.
///
/// # Errors
/// [`BelvedereError::Setting`] with the nearest key that exists.
pub fn parameters(texts: &[String]) -> Result<TerrainStageDoc, BelvedereError> {
    let mut toml = String::new();
    for text in texts {
        let Some((key, value)) = text.split_once('=') else {
            return Err(BelvedereError::Setting(format!("{text} has no value; give key=value, such as w=0.6")));
        };
        let (key, value) = (key.trim(), value.trim());
        let plain = matches!(value, "true" | "false")
            || value.parse::<f64>().is_ok() && !value.eq_ignore_ascii_case("infinity");
        let value = if plain || value.starts_with('"') { value.to_owned() } else { format!("{value:?}") };
        toml += &format!("{key} = {value}\n");
    }
    let fail = |e: scene_file::DocError| BelvedereError::Setting(e.to_string());
    let tree = scene_file::tree(std::path::Path::new("settings.toml"), &toml).map_err(|e| {
        let given = e.line.and_then(|line| texts.get(line - 1)).map_or_else(String::new, |text| format!("{text}: "));
        BelvedereError::Setting(format!("{given}{e}"))
    })?;
    let document: TerrainStageDoc = scene_file::decode(&tree).map_err(fail)?;
    match (&document.delta, &document.delta_sha256) {
        (None, None) => Ok(document),
        _ => Err(BelvedereError::Setting("delta is what is solved for; leave it out".into())),
    }
}

/// The stage that a request asks for: its keys, then its options.
fn stage_of(request: &Disocclude) -> Result<TerrainStageDoc, BelvedereError> {
    let mut stage = parameters(&request.set)?;
    stage.mode = request.mode.or(stage.mode);
    stage.show = request.show.or(stage.show);
    stage.move_at_most_m = request.move_at_most.or(stage.move_at_most_m);
    if request.no_limits {
        stage.limits = Some(false);
    }
    Ok(stage)
}

fn places(request: &Disocclude) -> Result<[Place; 2], BelvedereError> {
    let missing = || BelvedereError::Argument(Advice::new("{} and {} are needed; give both", &["eye", "look"]));
    let [eye, look] = [request.eye, request.look];
    Ok([eye.ok_or_else(missing)?, look.ok_or_else(missing)?])
}

fn files(request: &Disocclude) -> DataFiles {
    DataFiles {
        dem: request.data.clone(),
        features: request.features.clone(),
        first_is_subject: false,
        rivers: request.rivers.clone(),
        crs: request.crs.clone(),
        keep_voids: !request.fill_voids,
        fill_all_voids: request.fill_voids,
        area_style: request.area_style,
        line_class: Vec::new(),
        stated: request.stated.clone(),
        ..DataFiles::default()
    }
}

/// A solution.
pub struct Disoccluded {
    /// Terrain and features.
    pub session: Session,
    /// Displacement and report.
    pub solved: Solved,
    /// Written heights and displacement.
    rasters: [Raster; 2],
    record: Record,
    evidence: Evidence,
}

/// Content of the report file and of `--json`: the report of the solver, and what is said of the written heights.
#[derive(Debug, Clone, Copy, JsonSchema)]
pub struct DisoccludeDocument<'a> {
    #[serde(flatten)]
    report: &'a TerrainReport,
    #[serde(flatten)]
    record: &'a Record,
}

impl Serialize for DisoccludeDocument<'_> {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let value = |text: Result<String, BelvedereError>| text.ok().and_then(|text| serde_json::from_str(&text).ok());
        let mut report: Map<String, Value> = value(output::json(self.report)).unwrap_or_default();
        // The written heights have the last word.
        report.extend::<Map<String, Value>>(value(output::json(self.record)).unwrap_or_default());
        report.serialize(serializer)
    }
}

/// What is said of the written heights, and what they were made from.
#[derive(Debug, Clone, JsonSchema, Serialize)]
struct Record {
    program: String,
    /// Visible share of the whole features before, 0..=1.
    visible_straight: f64,
    /// Visible share of the whole features on the written heights, as `visible_whole`.
    visible_bent: f64,
    /// Share of the whole features in view, before and after.
    in_frame_straight: f64,
    in_frame_bent: f64,
    crs: String,
    /// Eye: x, y as given, z in metres.
    eye: [f64; 3],
    /// The same in `crs`.
    scene_eye: [f64; 3],
    /// Eye after adjust_viewpoint, in `crs`.
    #[serde(skip_serializing_if = "Option::is_none")]
    adjusted_eye: Option<[f64; 3]>,
    look: [f64; 2],
    fov_x_deg: f64,
    earth: &'static str,
    grid: WrittenGrid,
    /// Visible share of the features in view on the written heights, if they are resampled.
    #[serde(skip_serializing_if = "Option::is_none")]
    visible_written: Option<f64>,
    /// Visible share of the features in view on the written heights where a program cuts cells from north-east to south-west instead of
    /// from north-west to south-east, 0..=1; a bilinear surface lies between the two.
    visible_other_diagonal: f64,
    /// Samples of the written heights that were lowered because small bumps right in front of a point hid it.
    #[serde(skip_serializing_if = "Option::is_none")]
    trimmed: Option<TrimReport>,
    /// Reports of rivers on the written heights, if they are resampled.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    rivers_written: Vec<RiverReport>,
    layers: Vec<String>,
    inputs: Vec<InputFile>,
    warnings: Vec<Warning>,
}

/// Output files.
#[derive(Debug, Clone, Default)]
pub struct DisoccludeFiles {
    /// Displaced elevation model, cloud-optimised GeoTIFF on the grid of the input.
    pub out: PathBuf,
    /// Figures, JSON.
    pub report: Option<PathBuf>,
    /// Displacement, likewise.
    pub displacement: Option<PathBuf>,
    /// Features on the displaced ground, GeoJSON, or GeoPackage where the name ends in `.gpkg`.
    pub features: Option<PathBuf>,
    /// The ground before and after from the eye, PNG, with its record and displacement beside it.
    pub picture: Option<PathBuf>,
    /// Lines of sight by which the share that is shown can be checked against `out` alone, JSON.
    pub certificate: Option<PathBuf>,
}

impl DisoccludeFiles {
    /// Every file that will be written.
    pub fn all(&self) -> Vec<PathBuf> {
        let others =
            [&self.report, &self.displacement, &self.features, &self.certificate].into_iter().flatten().cloned();
        let pictures = self.picture.iter().flat_map(|p| picture::outputs(p, &PictureOptions::default(), true));
        std::iter::once(self.out.clone()).chain(others).chain(pictures).collect()
    }
}

/// Solves for the features in a level picture from the eye.
///
/// # Errors
/// [`BelvedereError::FieldOfView`], [`BelvedereError::Position`], [`BelvedereError::EyeIsTarget`], [`BelvedereError::Setting`],
/// [`BelvedereError::Disocclusion`]; those of the loaders.
pub fn disocclude(request: &Disocclude, options: &OpenOptions) -> Result<Disoccluded, BelvedereError> {
    guarded(|| disoccluded(request, options))
}

fn disoccluded(request: &Disocclude, options: &OpenOptions) -> Result<Disoccluded, BelvedereError> {
    let parameters = stage_of(request)?;
    intent::check(&parameters).map_err(|(_, reason)| BelvedereError::Setting(reason))?;
    let mut settings = intent::settings(&parameters).map_err(|(_, reason)| BelvedereError::Setting(reason))?;
    let (grid, places) = (request.grid.unwrap_or_default(), places(request)?);
    let mut data = files(request).load(true, options)?;
    settings.rivers.append(&mut data.rivers);
    let solver = TerrainSolver::new(settings)?.in_plan();
    let dem = &request.data;
    let original = data.original.take().ok_or_else(|| IoError::format(dem, "is no file; give an elevation model"))?;
    let radius = request.curved_earth.then(|| earth_radius(&data.scene, &mut data.warnings));
    data.warnings.extend(original.georeference_note());
    let (mut camera, said) = LevelCamera::new((request, &places), &original, &data.scene, radius)?;
    data.warnings.extend(said);
    let scene_eye = camera.eye.to_array();
    let [eye, look] = places;
    let [eye_x, eye_y] = eye.numbers();
    let adjusting = options.progress.part(ADJUSTING);
    let moved_eye = camera.adjust(parameters.adjust_viewpoint, &solver, &data.scene, &adjusting)?;
    data.warnings.extend(moved_eye.as_ref().map(|(_, said)| said.clone()));
    let view = camera.view(camera.target.extend(camera.eye.z), None)?;
    let solving = options.progress.before(WRITING);
    belvedere_resolve::terrain::ask(&data.scene)?;
    let to_write = HeightsToWrite {
        original: &original,
        scene: &data.scene,
        grid,
        fill_voids: request.fill_voids,
        rivers: &solver.settings().rivers,
        robust: request.robust.unwrap_or_default(),
        sea_m: sea(&data.scene, solver.settings()),
    };
    let mut solved = to_write.solved(&solver, &view, &solving)?;
    let (written, trimmed) = to_write.trimmed(&solver, &view, &mut solved, &options.progress)?;
    let ToWrite { rasters, rivers: rivers_written } = written;
    let written_on = to_write.grid()?;
    let seen_by = (&*data.scene, &view);
    let judged = written_on.judged(&solver, seen_by, &rasters, &solved.report, &options.progress)?;
    let visible_written = (!written_on.solved_on).then_some(judged.after.visible_dense);
    let visible_other_diagonal = judged.other_diagonal.visible_dense;
    judged.after.put(&judged.before, written_on.solved_on, &mut solved.report);
    drop(written_on);
    data.warnings.extend(intent::remarks(&solved, &data.scene));
    data.warnings.extend(visible_written.and_then(|share| resampled_away(share, &solved)));
    data.warnings.extend(cut_otherwise(judged.after.visible_dense, visible_other_diagonal));
    let ground = data.scene.terrain().and_then(|t| t.surface_at(camera.target));
    let look_at = camera.target.extend(ground.unwrap_or(camera.eye.z));
    let level = view;
    let view = camera.view(look_at, Some(Stage::TerrainDisocclusion(solved.stage.clone())))?;
    let stage = StageDoc::TerrainDisocclusion(intent::document(solver.settings(), &data.scene));
    let earth = if request.curved_earth { EarthDoc::Curved } else { EarthDoc::Flat };
    let camera = CameraDoc::of(view.pinhole(), look_at);
    let mut session = data.session(view, camera, vec![stage], earth);
    session.resolved.terrain = Some(solved.report.clone());
    let names = session.public_names();
    let record = Record {
        visible_straight: solved.report.visible_whole_before,
        visible_bent: solved.report.visible_whole,
        in_frame_straight: solved.report.in_view,
        in_frame_bent: solved.report.in_view,
        program: format!("belvedere {}", crate::VERSION),
        crs: session.scene().crs.to_string(),
        eye: [eye_x, eye_y, scene_eye[2]],
        scene_eye,
        adjusted_eye: moved_eye.map(|(eye, _)| eye.to_array()),
        look: look.numbers(),
        fov_x_deg: request.fov.unwrap_or(Disocclude::FOV_X_DEG),
        earth: if request.curved_earth { "curved" } else { "flat" },
        grid,
        visible_written,
        visible_other_diagonal,
        trimmed,
        rivers_written,
        layers: session.scene().layers.iter().map(|l| l.id.clone()).collect(),
        inputs: names.inputs(&record::inputs(&session.inputs())?),
        warnings: session.warnings(),
    };
    let evidence = Evidence { original, solver, view: level };
    Ok(Disoccluded { session, solved, rasters, record, evidence })
}

/// Height of the sea where the solver leaves it as it is: the limits do, which mode `paper` has not.
fn sea(scene: &Scene, settings: &TerrainSettings) -> Option<f64> {
    let stays = settings.limits && settings.mode != SolverMode::Paper;
    scene.terrain().filter(|_| stays).and_then(Sea::nodes).map(|(level, _)| level)
}

/// Warning that resampling hides features that the solution shows.
fn resampled_away(share: f64, solved: &Solved) -> Option<Warning> {
    let lost = solved.report.metrics.visible_dense - share;
    (lost > 1.0 - KEPT_SHARE).then(|| {
        let text = format!(
            "written on the grid of the input, the heights show {:.2} % of what is in view, {:.2} % less than the ground that was solved \
             on, for its samples are others; the grid of the scene writes the latter",
            100.0 * share,
            100.0 * lost
        );
        let warning = Warning::new(WarningKind::Hidden, text).about("terrain_disocclusion");
        warning.with("visible_share", share).with("lost_share", lost).settled_by("grid")
    })
}

/// Warning that programs that cut cells by the other diagonal hide features that the written heights show.
fn cut_otherwise(share: f64, other: f64) -> Option<Warning> {
    (share - other > LOST_ELSEWHERE).then(|| {
        let text = format!(
            "a program that cuts the cells of the written heights from north-east to south-west, as some do, shows {:.2} % of what is in \
             view, {:.2} % less; a larger margin_m shows more there",
            100.0 * other,
            100.0 * (share - other)
        );
        Warning::new(WarningKind::Hidden, text).about("terrain_disocclusion").with("visible_other_diagonal", other)
    })
}

/// A level camera: eye and target in the scene.
struct LevelCamera {
    eye: DVec3,
    target: DVec2,
    fov_x: f64,
    earth: Option<Stage>,
}

impl LevelCamera {
    fn new(
        (request, [eye, look]): (&Disocclude, &[Place; 2]),
        original: &OriginalTerrain,
        scene: &Scene,
        earth_radius: Option<f64>,
    ) -> Result<(Self, Vec<Warning>), BelvedereError> {
        let deg = request.fov.unwrap_or(Disocclude::FOV_X_DEG);
        if !(deg > 0.0 && deg < 180.0) {
            return Err(BelvedereError::FieldOfView { deg });
        }
        let finder = PlaceFinder::of(scene).in_model(original);
        let ((eye, of_eye), (target, of_target)) = (finder.find(eye, "eye")?, finder.on_map(look, "target")?);
        if eye.truncate().distance(target) < 1e-6 {
            return Err(BelvedereError::EyeIsTarget);
        }
        let refraction = EarthCurvature::REFRACTION;
        let earth = earth_radius.map(|radius| Stage::EarthCurvature(EarthCurvature { eye, radius, refraction }));
        let said = of_eye.into_iter().chain(of_target).collect();
        Ok((Self { eye, target, fov_x: deg.to_radians(), earth }, said))
    }

    /// Moves the eye if `slider` allows it and less ground then moves; returns the new eye and a sentence about it.
    fn adjust(
        &mut self,
        slider: Option<f64>,
        solver: &TerrainSolver,
        scene: &Scene,
        progress: &Progress,
    ) -> Result<Option<(DVec3, Warning)>, BelvedereError> {
        // At 1 the eye stays where it is.
        let Some(slider) = slider.filter(|slider| *slider < 1.0) else { return Ok(None) };
        let target = self.target.extend(self.eye.z);
        let options = ViewpointOptions { slider, ..ViewpointOptions::default() };
        let found = solver.adjust(scene, &self.view(target, None)?, target, &options, progress)?;
        Ok(found.filter(|found| found.moved_m > 0.0).map(|found| {
            self.eye = found.eye;
            if let Some(Stage::EarthCurvature(earth)) = &mut self.earth {
                earth.eye = found.eye;
            }
            let [x, y, z] = found.eye.to_array();
            let said = format!(
                "adjust_viewpoint moved the eye by {:.0} m, to {x:.1},{y:.1},{z:.1} in {}: from there less ground has to move",
                found.moved_m, scene.crs
            );
            let warning = Warning::new(WarningKind::Moved, said).about("camera");
            (found.eye, warning.with("moved_m", found.moved_m))
        }))
    }

    /// The view towards `look_at`. A level one judges ground above and below the picture as well, since the ground moves vertically.
    fn view(&self, look_at: DVec3, ground: Option<Stage>) -> Result<View, BelvedereError> {
        let [width, height] = IMAGE.map(f64::from);
        let fov_y = 2.0 * ((0.5 * self.fov_x).tan() * height / width).atan();
        let lens = Projection::Perspective { fov_y };
        let pinhole = Pinhole::look_at(self.eye, look_at, DVec3::Z, lens, IMAGE, 1.0, None)?;
        Ok(View::new(pinhole, self.earth.iter().cloned().chain(ground).collect())?)
    }
}

impl Disoccluded {
    /// Report of the solution.
    pub fn report(&self) -> &TerrainReport {
        &self.solved.report
    }

    /// Displaced heights and displacement, on the written grid.
    pub fn rasters(&self) -> &[Raster; 2] {
        &self.rasters
    }

    /// Content of the report file and of `--json`.
    pub fn document(&self) -> DisoccludeDocument<'_> {
        DisoccludeDocument { report: self.report(), record: &self.record }
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
        let [_, after] = self.shares();
        if after.visible < VISIBLE_LENGTH {
            out.push(shortfall(after, VISIBLE_LENGTH));
        }
        out
    }

    /// Shares of the whole features before, and after on the heights as they are written.
    pub fn shares(&self) -> [Shares; 2] {
        let r = self.report();
        [r.visible_whole_before, r.visible_whole].map(|visible| Shares { visible, in_frame: r.in_view })
    }

    /// One sentence: visible shares of the whole features before and after, the share in view, and the displacement.
    pub fn summary(&self) -> String {
        let (r, [before, after]) = (self.report(), self.shares());
        format!(
            "visible of the features: {} before, {} after, {} of them in view; all the ground, in the picture or not, moved by {:.1} m rms, {:.1} m at most",
            percent(before.visible),
            percent(after.visible),
            percent(after.in_frame),
            r.metrics.rms_m,
            r.metrics.max_m
        )
    }

    /// Writes the displaced elevation model and the other files.
    ///
    /// # Errors
    /// [`BelvedereError::Io`]; those of [`Session::render`] for the picture.
    pub fn write(
        &self,
        files: &DisoccludeFiles,
        overwrite: bool,
        progress: &Progress,
    ) -> Result<Vec<PathBuf>, BelvedereError> {
        belvedere_io::atomic::together(|| self.write_each(files, overwrite, progress))
    }

    fn write_each(
        &self,
        files: &DisoccludeFiles,
        overwrite: bool,
        progress: &Progress,
    ) -> Result<Vec<PathBuf>, BelvedereError> {
        let stage = &self.solved.stage;
        let [dem, delta] = &self.rasters;
        write_cloud_geotiff(&files.out, dem, overwrite)?;
        let mut written = vec![files.out.clone()];
        if let Some(path) = &files.displacement {
            write_cloud_geotiff(path, delta, overwrite)?;
            written.push(path.clone());
        }
        if let Some(path) = &files.features {
            let moved = |p: DVec3| Some(p + stage.delta_at(p) * DVec3::Z);
            MovedFeatures::new(self.session.scene(), &|layer| layer.must_see, &moved, false).write(path, overwrite)?;
            written.push(path.clone());
        }
        if let Some(path) = &files.picture {
            let pair = PictureOptions { compare: true, progress: progress.clone(), ..PictureOptions::default() };
            written.extend(self.session.render(&pair)?.write(path, overwrite)?);
        }
        if let Some(path) = &files.certificate {
            let Record { grid, visible_written, .. } = self.record;
            let visible = visible_written.unwrap_or(self.report().metrics.visible_dense);
            let (scene, original) = (self.session.scene(), &self.evidence.original);
            let to_write = HeightsToWrite::as_written(original, scene, grid);
            let certificate = Certificate::of((scene, dem), &to_write, &self.evidence, (&files.out, visible))?;
            output::write_text(path, &output::json(&certificate)?, overwrite)?;
            written.push(path.clone());
        }
        if let Some(path) = &files.report {
            written.push(path.clone());
            output::write_text(path, &answers::in_file("disocclude", &written, &self.document())?, overwrite)?;
        }
        Ok(written)
    }
}
