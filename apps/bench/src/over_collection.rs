//! `bench --collection`: scenes of the data collection, straight and bent, at rest and moving, as ratios of frames drawn in turn.

use crate::clock::{self, Stopwatch, median};
use crate::collection::SCENES;
use crate::dragging;
use crate::frames::Growth;
use crate::scene;
use crate::vtk;
use anyhow::{Context, Result, ensure};
use belvedere::core::map::curved_rays::{Model, Pencil, Sharpness, TurnSpec};
use belvedere::core::{CurvedRays, Stage, View};
use belvedere::cpu::CpuRenderer;
use belvedere::scene::{Frame, Progress, RenderJob, Renderer};
use belvedere::{PictureOptions, Session};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use std::path::PathBuf;

/// Scenes that are measured, names of [`SCENES`].
const MEASURED: [&str; 12] = [
    "andorra, GR 11, bent",
    "grand canyon",
    "baltoro",
    "gotthard, makes way",
    "swellendam, drape",
    "delft, CityJSON",
    "berlin, CityGML, styled",
    "delft, three sections",
    "molecule, 559 atoms",
    "molecule, 26,430 atoms",
    "volume, engine",
    "volume, chest",
];
/// Nodes along a side of the yardstick's ground.
const YARDSTICK: usize = 1025;
/// Moving pictures per scene.
const MOVING: usize = 20;

/// What to measure.
#[derive(Debug, Clone)]
pub struct CollectionRequest {
    /// Folder of the data collection.
    pub data: PathBuf,
    /// Times that every picture is drawn, one more to warm up.
    pub rounds: usize,
    /// Size of the picture.
    pub image: [u32; 2],
    /// Worker threads; 0 = all cores.
    pub threads: usize,
    /// Scenes whose name contains this text alone.
    pub only: Option<String>,
    /// A Python with the package `vtk`, which draws the same straight scenes.
    pub vtk: Option<PathBuf>,
}

/// The measurements.
#[derive(Debug, Clone, Deserialize, JsonSchema, Serialize)]
pub struct CollectionReport {
    /// Program and version.
    pub program: String,
    /// Processor, as the system names it.
    pub processor: String,
    /// Worker threads used.
    pub threads: usize,
    /// What is measured as `ms`.
    pub clock: String,
    /// Load average of the system over the last minute, before and after; `None` where the system does not tell.
    pub load: [Option<f64>; 2],
    /// Size of the picture.
    pub image: [u32; 2],
    /// Rounds.
    pub rounds: usize,
    /// Version of VTK, if it drew the scenes, too.
    pub vtk: Option<String>,
    /// Costs, scene by scene.
    pub scenes: Vec<SceneCost>,
    /// Ratios that are more than 1.15 times those of an earlier report; empty without one.
    #[serde(default)]
    pub slower: Vec<String>,
}

/// Cost of one scene. Times are medians of processor time of all threads per picture, milliseconds; ratios are medians of ratios within a round.
#[derive(Debug, Clone, Deserialize, JsonSchema, Serialize)]
pub struct SceneCost {
    /// Name of the scene.
    pub scene: String,
    /// Stages that bend it; `curved_rays (added)` where the scene has none of its own.
    pub bend: String,
    /// Triangles of the straight picture.
    pub triangles: u64,
    /// Straight picture at rest.
    pub straight_ms: f64,
    /// The same to a straight picture of generated ground of 1025 x 1025 nodes, drawn in turn.
    pub to_yardstick: f64,
    /// Bent picture at rest.
    pub bent_ms: f64,
    /// The same to the straight picture.
    pub bent_to_straight: f64,
    /// Picture of the least quality while the camera turns, solvers beside it included.
    pub moving_ms: f64,
    /// The same to the straight picture at rest.
    pub moving_to_straight: f64,
    /// Exponent of the bent picture's time against its pixels: a quarter, one and four times as many.
    pub pixels_exponent: f64,
    /// The straight scene drawn by VTK: with four samples by OpenGL, volumes by its mapper for processors.
    pub vtk_ms: Option<f64>,
    /// The straight picture to that of VTK; below 1 Belvedere is faster.
    pub to_vtk: Option<f64>,
}

/// Measures.
///
/// # Errors
/// A folder without the collection's files, a scene that cannot be drawn, a Python without VTK, cancellation.
pub fn bench_collection(request: &CollectionRequest, progress: &Progress) -> Result<CollectionReport> {
    ensure!((1..=1000).contains(&request.rounds), "{} rounds; give 1..=1000", request.rounds);
    let pool = rayon::ThreadPoolBuilder::new().num_threads(request.threads).build()?;
    pool.install(|| report(request, progress))
}

fn report(request: &CollectionRequest, progress: &Progress) -> Result<CollectionReport> {
    let before = clock::load();
    let version = request.vtk.as_deref().map(vtk::version).transpose()?;
    let wanted = |name: &str| request.only.as_deref().is_none_or(|only| name.contains(only));
    let chosen: Vec<_> = SCENES.iter().filter(|(name, _)| MEASURED.contains(name) && wanted(name)).collect();
    ensure!(!chosen.is_empty(), "no scene has this in its name; there are: {}", MEASURED.join("; "));
    let mut scenes = Vec::new();
    for (k, (name, make)) in chosen.iter().enumerate() {
        progress.tick("scenes", k as f64 / chosen.len() as f64)?;
        let editor = make(&request.data).with_context(|| format!("scene {name}"))?;
        scenes.push(cost(name, editor, request, progress).with_context(|| format!("scene {name}"))?);
    }
    Ok(CollectionReport {
        program: format!("belvedere {}", belvedere::VERSION),
        processor: clock::processor(),
        threads: rayon::current_num_threads(),
        clock: clock::name().into(),
        load: [before, clock::load()],
        image: request.image,
        rounds: request.rounds,
        vtk: version,
        scenes,
        slower: Vec::new(),
    })
}

/// A picture that is drawn once per round, with caches of its own.
struct Case {
    session: Session,
    view: View,
    renderer: CpuRenderer,
    frame: Frame,
    times: Vec<f64>,
}

impl Case {
    fn new(session: &Session, view: View) -> Self {
        let (renderer, frame) = (CpuRenderer::default(), Frame::default());
        Self { session: session.clone(), view, renderer, frame, times: Vec::new() }
    }

    /// Draws the picture.
    fn draw(&mut self, progress: &Progress) -> Result<()> {
        let options = PictureOptions::default().quality;
        let (scene, view, light) = (self.session.scene(), &self.view, self.session.light());
        let watch = Stopwatch::start();
        let job = RenderJob { scene, view, light, options: &options, progress };
        self.renderer.render_into(&job, &mut self.frame)?;
        self.times.push(watch.cpu_ms().unwrap_or_else(|| watch.wall_ms()));
        Ok(())
    }

    /// The times but for the first picture, which warms up.
    fn times(&self) -> &[f64] {
        &self.times[1..]
    }

    fn ms(&self) -> f64 {
        median(self.times().to_vec())
    }

    fn ratio(&self, to: &Self) -> f64 {
        median(self.times().iter().zip(to.times()).map(|(a, b)| a / b).collect())
    }
}

fn cost(
    name: &str,
    editor: belvedere_studio::Editor,
    request: &CollectionRequest,
    progress: &Progress,
) -> Result<SceneCost> {
    let mut document = (**editor.document()).clone();
    document.camera.image = request.image;
    let session = editor.place.session(document, progress)?;
    let view = session.view();
    let bend = if view.is_bent() { stages(view) } else { "curved_rays (added)".to_owned() };
    let [_, (_, yardstick), _] = scene::views(request.image)?.map(|(name, view)| (name, view.straightened()));
    let ground = Session::from_parts(scene::ground(YARDSTICK)?, yardstick.clone());
    let scales = [(1, 2), (1, 1), (2, 1)];
    let mut cases = vec![Case::new(&ground, yardstick), Case::new(&session, view.straightened())];
    for (times, by) in scales {
        let sized = session.resized(request.image.map(|side| (side * times / by).max(1)), progress)?;
        let bent = if view.is_bent() { sized.view().clone() } else { with_turn(&sized)? };
        cases.push(Case::new(&sized, bent));
    }
    for round in 0..=request.rounds {
        for k in 0..cases.len() {
            let k = if round % 2 == 0 { k } else { cases.len() - 1 - k };
            cases[k].draw(progress)?;
        }
    }
    let moving = dragging::least(name, editor, request.image, MOVING)?;
    let vtk_ms = request
        .vtk
        .as_deref()
        .map(|python| vtk::straight_ms(python, &session, (request.image, request.rounds)))
        .transpose()?;
    let [yardstick, straight, bents @ ..] = &cases[..] else { unreachable!("five cases") };
    let pixels = request.image.map(f64::from).iter().product::<f64>();
    let sizes = scales.map(|(times, by)| pixels * (f64::from(times) / f64::from(by)).powi(2));
    let growth = Growth::new("pixels", sizes.to_vec(), bents.iter().map(Case::ms).collect());
    Ok(SceneCost {
        scene: name.to_owned(),
        bend,
        triangles: straight.frame.stats.triangles_drawn,
        straight_ms: straight.ms(),
        to_yardstick: straight.ratio(yardstick),
        bent_ms: bents[1].ms(),
        bent_to_straight: bents[1].ratio(straight),
        moving_ms: moving.cpu_ms,
        moving_to_straight: moving.cpu_ms / straight.ms(),
        pixels_exponent: growth.exponent,
        vtk_ms,
        to_vtk: vtk_ms.map(|vtk| straight.ms() / vtk),
    })
}

fn stages(view: &View) -> String {
    view.stages().iter().map(|stage| stage.name()).filter(|name| *name != "earth").collect::<Vec<_>>().join(", ")
}

/// The session's view with one turn through the middle of what it shows, to a viewpoint above.
fn with_turn(session: &Session) -> Result<View> {
    let camera = session.view().pinhole();
    let depths = session.scene().bounds().corners().map(|corner| (corner - camera.eye).dot(camera.forward));
    let [near, far] = depths.iter().fold([f64::MAX, 0.0], |[lo, hi], &d| [lo.min(d), hi.max(d)]);
    let near = near.clamp(camera.near, far);
    let at = |share: f64| camera.eye + camera.forward * (near + share * (far - near));
    let turn = TurnSpec {
        viewpoint: camera.eye - camera.down * (0.25 * (near + far)),
        t0: at(0.25),
        t1: at(0.5),
        t2: at(0.75),
        pencil: Pencil::Parallel { normal: -camera.forward },
        m: Sharpness::Bend,
    };
    let rays = CurvedRays::new(camera, Model::Modified, &[turn])?;
    let stages = session.view().stages().iter().cloned().chain([Stage::CurvedRays(rays)]).collect();
    Ok(View::new(camera.clone(), stages)?)
}

impl std::fmt::Display for CollectionReport {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let [w, h] = self.image;
        let load = self.load.map(|l| l.map_or_else(|| "unknown".into(), |l| format!("{l:.1}")));
        let vtk = self.vtk.as_deref().map_or_else(String::new, |version| format!(", VTK {version}"));
        let (program, processor, threads) = (&self.program, &self.processor, self.threads);
        writeln!(f, "{program}, {processor}, {threads} threads, load {} to {}{vtk}", load[0], load[1])?;
        writeln!(f, "{w} x {h} pixels, {} rounds, {} in milliseconds\n", self.rounds, self.clock)?;
        writeln!(
            f,
            "| scene | bend | triangles | straight | to yardstick | bent | to straight | moving | to straight | pixels^ | VTK | to VTK |"
        )?;
        writeln!(f, "| --- | --- | --- | --- | --- | --- | --- | --- | --- | --- | --- | --- |")?;
        for cost in &self.scenes {
            let SceneCost { scene, bend, triangles, straight_ms, to_yardstick, bent_ms, bent_to_straight, .. } = cost;
            let SceneCost { moving_ms, moving_to_straight, pixels_exponent, vtk_ms, to_vtk, .. } = cost;
            let or_empty =
                |value: &Option<f64>, digits: usize| value.map_or_else(String::new, |v| format!("{v:.digits$}"));
            writeln!(
                f,
                "| {scene} | {bend} | {triangles} | {straight_ms:.0} | {to_yardstick:.2} | {bent_ms:.0} | {bent_to_straight:.2} | \
                 {moving_ms:.0} | {moving_to_straight:.2} | {pixels_exponent:.2} | {} | {} |",
                or_empty(vtk_ms, 0),
                or_empty(to_vtk, 2)
            )?;
        }
        self.slower.iter().try_for_each(|line| writeln!(f, "slower: {line}"))
    }
}
