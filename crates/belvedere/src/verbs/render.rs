//! `render`: pictures with a record of where they come from.

use super::buffers;
use super::output;
use crate::overlays::{badge, camera, ghost, grid, heat, thin};
use crate::provenance::{self, InputFile};
use crate::scene_file::{StageDoc, SwitchOrLength};
use crate::{BelvedereError, CameraPicture, Session};
use belvedere_core::{Camera, DVec2, Stage, View};
use belvedere_cpu::ExactRenderer;
use belvedere_cpu::canvas::Canvas;
use belvedere_disocclusion::TerrainReport;
use belvedere_io::png::{self, Channels};
use belvedere_scene::{
    Aux, Crs, Frame, FrameStats, Heightfield, NodeState, Progress, RenderJob, RenderOptions, Renderer,
};
use serde::{Deserialize, Serialize};
use std::path::{Path, PathBuf};
use std::time::Instant;

/// Width of the white gap between two pictures side by side, pixels.
const GAP: usize = 8;

/// What to draw.
#[derive(Debug, Clone, Default)]
pub struct RenderRequest {
    /// Quality, threads and memory.
    pub options: RenderOptions,
    /// Without the bends.
    pub straight: bool,
    /// Straight beside bent.
    pub compare: bool,
    /// Buffers to write beside the picture.
    pub aux: Vec<AuxBuffer>,
    /// Format of the buffers.
    pub aux_format: AuxFormat,
    /// Who draws.
    pub renderer: RendererChoice,
    /// Grid on the ground, whatever the scene says: spacing in scene units, or `Some(None)` for a round one.
    pub grid: Option<Option<f64>>,
    /// Colours for how far the bend moves what is seen, also if the scene does not ask for them.
    pub heatmap: bool,
    /// The straight picture faintly over the bent one, also if the scene does not ask for it.
    pub ghost: bool,
    /// No mark on bent pictures, also if the scene does not say so.
    pub no_mark: bool,
    /// A picture of the camera instead of one by it.
    pub camera: Option<CameraPicture>,
}

/// Format of buffers beside a picture.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub enum AuxFormat {
    /// One NPY file per buffer, `OUT.NAME.npy`.
    #[default]
    Npy,
    /// One OpenEXR file of all buffers, `OUT.exr`.
    Exr,
}

/// Who draws.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub enum RendererChoice {
    /// The rasteriser.
    #[default]
    Cpu,
    /// The tracer of curved rays: slower, without subdivision.
    Exact,
}

impl RendererChoice {
    /// Name for records.
    pub fn name(self) -> &'static str {
        match self {
            Self::Cpu => "cpu",
            Self::Exact => "exact",
        }
    }

    /// The renderer itself, the same for all frames of a session.
    pub(crate) fn renderer(self, session: &Session) -> &dyn Renderer {
        match self {
            Self::Cpu => &*session.rasteriser,
            Self::Exact => &ExactRenderer,
        }
    }
}

/// A buffer beside the picture.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum AuxBuffer {
    /// Depth, f32, infinite where sky.
    Depth,
    /// 1 + index of the layer, u32, 0 where sky.
    Id,
    /// World position, 3 x f64, NaN where sky.
    World,
    /// Displaced minus world position, 3 x f64, NaN where sky.
    Displacement,
}

impl AuxBuffer {
    /// Name in options and file names.
    pub fn name(self) -> &'static str {
        match self {
            Self::Depth => "depth",
            Self::Id => "id",
            Self::World => "world",
            Self::Displacement => "displacement",
        }
    }
}

/// How far a picture moves what it shows, against the same camera without bends; sampled every few pixels. Ground that it does not
/// show may have moved farther.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize, Deserialize)]
pub struct DisplacementReport {
    /// Largest, scene units.
    pub max_m: f64,
    /// Root mean square, scene units.
    pub rms_m: f64,
    /// Largest distance between the bent and the straight image of a point, pixels.
    pub max_px: f64,
    /// Root mean square of that distance, pixels.
    pub rms_px: f64,
    /// Share of samples where the picture folds over, 0..=1.
    pub folded_share: f64,
    /// Pixels sampled.
    pub samples: usize,
}

/// What of the ground is measured, and what is not.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct TerrainRecord {
    /// Nodes of the grid.
    pub nodes: usize,
    /// Nodes without a height: holes, and the rim outside the data.
    pub void_nodes: usize,
    /// Nodes whose height was made up to close a hole.
    pub filled_nodes: usize,
    /// Share of made-up nodes, 0..=1.
    pub filled_share: f64,
}

impl TerrainRecord {
    fn of(terrain: &Heightfield) -> Self {
        let count = |state| terrain.states().iter().filter(|s| **s == state).count();
        let filled_share = terrain.share_of(NodeState::Filled);
        let [void_nodes, filled_nodes] = [NodeState::Void, NodeState::Filled].map(count);
        Self { nodes: terrain.states().len(), void_nodes, filled_nodes, filled_share }
    }
}

/// What was drawn over the layers of a picture.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize)]
pub struct OverlayRecord {
    /// Whether the words "bent view" stand in the picture.
    pub mark: bool,
    /// Spacing of the grid, scene units.
    pub grid: Option<f64>,
    /// Displacement at the upper end of the colours, scene units.
    pub heatmap_max: Option<f64>,
    /// Whether the straight picture shows through.
    pub ghost: bool,
    /// If this is a picture of the camera: from where.
    pub camera: Option<&'static str>,
}

/// The record beside a picture.
#[derive(Debug, Clone, Serialize)]
pub struct Sidecar {
    /// Program and version.
    pub program: String,
    /// Renderer that drew it.
    pub renderer: &'static str,
    /// What is special about the picture, if it is bent.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub note: Option<String>,
    /// Stages in order of application.
    pub stages: Vec<&'static str>,
    /// What was drawn over the layers.
    pub overlay: OverlayRecord,
    /// How far things were moved; `None` for a straight picture.
    pub displacement: Option<DisplacementReport>,
    /// What of the ground is made up; `None` without terrain.
    pub terrain: Option<TerrainRecord>,
    /// What the solver of terrain disocclusion came to; `None` if none ran.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub disocclusion: Option<TerrainReport>,
    /// The camera in numbers.
    pub view: provenance::ViewRecord,
    /// The resolved scene: opens to the same view.
    pub scene: crate::scene_file::Document,
    /// Files that were read.
    pub inputs: Vec<InputFile>,
    /// What was odd.
    pub warnings: Vec<String>,
    /// Counts of the renderer.
    pub stats: FrameStats,
    /// Wall time of drawing, milliseconds.
    pub render_ms: f64,
}

/// A finished picture and its record.
#[derive(Debug, Clone)]
pub struct Picture {
    /// The picture asked for (the bent one of a pair).
    pub frame: Frame,
    /// The straight one of a pair.
    pub straight: Option<Frame>,
    /// The record.
    pub sidecar: Sidecar,
    pub(super) aux: Vec<AuxBuffer>,
    pub(super) aux_format: AuxFormat,
    pub(super) view: View,
    pub(super) crs: Crs,
}

/// File of the solved displacement of the ground, written beside a picture whose scene asks for it by an intent.
pub fn delta_path(out: &Path) -> PathBuf {
    out.with_extension("delta.tif")
}

/// Files that [`Picture::write`] makes for `out`.
///
/// * `solves`: whether the scene asks for terrain disocclusion by an intent, see [`Document::solves_terrain`](crate::scene_file::Document::solves_terrain).
pub fn outputs(out: &Path, request: &RenderRequest, solves: bool) -> Vec<PathBuf> {
    let sidecar = sibling(out, ".json");
    let aux: Vec<PathBuf> = match request.aux_format {
        AuxFormat::Npy => request.aux.iter().map(|a| aux_path(out, *a)).collect(),
        AuxFormat::Exr => request.aux.first().map(|_| out.with_extension("exr")).into_iter().collect(),
    };
    let delta = (solves && !request.straight && request.camera.is_none()).then(|| delta_path(out));
    [out.to_owned(), sidecar].into_iter().chain(delta).chain(aux).collect()
}

/// Draws the session's view, or its camera.
///
/// # Errors
/// [`BelvedereError::Usage`] if the eye is under ground, [`BelvedereError::Render`], [`BelvedereError::Cancelled`].
pub fn render(session: &Session, request: &RenderRequest, progress: &Progress) -> Result<Picture, BelvedereError> {
    draw(session, request, provenance::inputs(session.inputs())?, progress)
}

/// As [`render`], with the record of the inputs at hand.
pub(super) fn draw(
    session: &Session,
    request: &RenderRequest,
    inputs: Vec<InputFile>,
    progress: &Progress,
) -> Result<Picture, BelvedereError> {
    super::check::drawable(session)?;
    let started = Instant::now();
    let drawn = match request.camera {
        Some(picture) => draw_camera(session, request, picture, progress)?,
        None => draw_view(session, request, progress)?,
    };
    let Drawn { view, frame, straight, overlay } = drawn;
    let render_ms = started.elapsed().as_secs_f64() * 1e3;
    let displacement = view.is_bent().then(|| measure_displacement(&view, &frame));
    let sidecar = Sidecar {
        program: format!("belvedere {}", crate::VERSION),
        renderer: request.renderer.name(),
        note: displacement.map(|d| note(&view, &d)),
        stages: view.stages().iter().map(|s| s.name()).collect(),
        overlay,
        displacement,
        terrain: session.scene().terrain().map(TerrainRecord::of),
        disocclusion: session.terrain_report().filter(|_| !request.straight).cloned(),
        view: provenance::ViewRecord::of(&view),
        scene: session.resolved().clone(),
        inputs,
        warnings: session.warnings().to_vec(),
        stats: frame.stats.clone(),
        render_ms,
    };
    let (aux, aux_format, crs) = (request.aux.clone(), request.aux_format, session.scene().crs);
    Ok(Picture { frame, straight, sidecar, aux, aux_format, view, crs })
}

/// Pictures with everything over them.
struct Drawn {
    view: View,
    frame: Frame,
    straight: Option<Frame>,
    overlay: OverlayRecord,
}

fn draw_view(session: &Session, request: &RenderRequest, progress: &Progress) -> Result<Drawn, BelvedereError> {
    let scene = session.scene();
    let view = if request.straight { session.view().straightened() } else { session.view().clone() };
    let wanted = session.resolved().overlay.clone().unwrap_or_default();
    let (heatmap, ghost) = (request.heatmap || wanted.heatmap, (request.ghost || wanted.ghost) && view.is_bent());
    let asked = request.grid.or(match wanted.grid {
        Some(SwitchOrLength::Length(spacing)) => Some(Some(spacing)),
        Some(SwitchOrLength::Switch(true)) => Some(None),
        Some(SwitchOrLength::Switch(false)) | None => None,
    });
    let grid_spacing = asked.and_then(|spacing| grid::spacing(scene, spacing));
    let world = request.aux.iter().any(|a| matches!(a, AuxBuffer::World | AuxBuffer::Displacement));
    let exact = !request.aux.is_empty();
    let mut options = RenderOptions { aux: Aux { world, exact }, ..request.options.clone() };
    options.overlay.under.extend(grid_spacing.map(|spacing| grid::lines(scene, spacing)).into_iter().flatten());
    let draw = |view: &View| {
        let job = RenderJob { scene, view, light: session.light(), options: &options, progress };
        request.renderer.renderer(session).render(&job)
    };
    let mut frame = draw(&view)?;
    if let Some(covered) =
        session.terrain_report().map(|r| &r.covered[..]).filter(|c| !c.is_empty() && !request.straight)
        && let Some(cut) = thin::cut(scene, &view, covered)?
    {
        let job = RenderJob { scene: &cut, view: &view, light: session.light(), options: &options, progress };
        let behind = request.renderer.renderer(session).render(&job)?;
        thin::draw(&mut frame, &behind, scene, &view, covered);
    }
    let straight = if request.compare || ghost { Some(draw(&view.straightened())?) } else { None };
    let mut heatmap_max = None;
    if heatmap {
        // Names and lines are read on the colours, not through them.
        let aux = Aux { world: true, exact: false };
        let options = RenderOptions { marks: false, aux, ..request.options.clone() };
        let job = RenderJob { scene, view: &view, light: session.light(), options: &options, progress };
        let bare = request.renderer.renderer(session).render(&job)?;
        heatmap_max = Some(heat::paint(&mut frame, &bare, &view));
    }
    if let Some(straight) = straight.as_ref().filter(|_| ghost) {
        ghost::draw(&mut frame, straight, scene);
    }
    let mark = view.is_bent() && wanted.mark && !request.no_mark && badge::fits(frame.width, frame.height);
    let mut canvas = Canvas::new(&mut frame.color, frame.width);
    if let Some(most) = heatmap_max {
        heat::legend(&mut canvas, most);
    }
    if mark {
        badge::draw(&mut canvas);
    }
    let overlay = OverlayRecord { mark, grid: grid_spacing, heatmap_max, ghost, camera: None };
    Ok(Drawn { view, frame, straight: straight.filter(|_| request.compare), overlay })
}

fn draw_camera(
    session: &Session,
    request: &RenderRequest,
    picture: CameraPicture,
    progress: &Progress,
) -> Result<Drawn, BelvedereError> {
    let figure = camera::figure(session, picture)?;
    let options = RenderOptions { overlay: figure.overlay.clone(), ..request.options.clone() };
    let (scene, view, light) = (session.scene(), &figure.view, session.light());
    let job = RenderJob { scene, view, light, options: &options, progress };
    let mut frame = request.renderer.renderer(session).render(&job)?;
    let title = if scene.title.is_empty() { "The camera" } else { &scene.title };
    camera::draw_legend(&mut Canvas::new(&mut frame.color, frame.width), &figure, title);
    let overlay = OverlayRecord { camera: Some(picture.name()), ..OverlayRecord::default() };
    Ok(Drawn { view: figure.view, frame, straight: None, overlay })
}

fn note(view: &View, d: &DisplacementReport) -> String {
    let names: Vec<&str> = view.stages().iter().map(|s| s.name()).filter(|n| *n != "earth").collect();
    format!(
        "bent view ({}): what is shown is displaced by up to {:.1} scene units ({:.0} px); not to scale, not for navigation",
        names.join(", "),
        d.max_m,
        d.max_px
    )
}

impl Picture {
    /// Writes the picture, its record and its buffers, each in one piece.
    ///
    /// # Errors
    /// [`BelvedereError::Io`].
    pub fn write(&self, out: &Path, overwrite: bool) -> Result<Vec<PathBuf>, BelvedereError> {
        let mut written = vec![out.to_owned(), sibling(out, ".json")];
        let solved = self.with_delta(out, overwrite, &mut written)?;
        let this = solved.as_ref().unwrap_or(self);
        this.write_png(out, overwrite)?;
        output::write_text(&written[1], &super::check::pretty(&this.sidecar)?, overwrite)?;
        if self.aux_format == AuxFormat::Exr && !self.aux.is_empty() {
            let path = out.with_extension("exr");
            buffers::write(&self.frame, &self.view, &self.aux, &path, overwrite)?;
            written.push(path);
            return Ok(written);
        }
        for aux in &self.aux {
            let path = aux_path(out, *aux);
            self.write_aux(*aux, &path, overwrite)?;
            written.push(path);
        }
        Ok(written)
    }

    /// Writes the solved displacement of the ground beside the picture; the record then names it in place of the intent.
    fn with_delta(
        &self,
        out: &Path,
        overwrite: bool,
        written: &mut Vec<PathBuf>,
    ) -> Result<Option<Self>, BelvedereError> {
        let solved = self.view.stages().iter().find_map(|s| match s {
            Stage::TerrainDisocclusion(terrain) => Some(terrain),
            _ => None,
        });
        let (Some(solved), Some(_)) = (solved, &self.sidecar.disocclusion) else { return Ok(None) };
        let path = delta_path(out);
        crate::resolve::delta::write(&path, solved.grid(), self.crs, overwrite)?;
        let mut this = self.clone();
        for stage in &mut this.sidecar.scene.stage {
            if let StageDoc::TerrainDisocclusion(doc) = stage {
                doc.delta = path.file_name().and_then(|n| n.to_str()).map(str::to_owned);
                doc.delta_sha256 = Some(provenance::sha256(&path)?);
            }
        }
        written.push(path);
        Ok(Some(this))
    }

    /// Writes the picture alone. Its bytes depend on scene, request and inputs only, not on threads or time.
    ///
    /// # Errors
    /// [`BelvedereError::Io`].
    pub fn write_png(&self, out: &Path, overwrite: bool) -> Result<(), BelvedereError> {
        let (width, height, pixels) = self.pixels();
        let text = self.text()?;
        let text: Vec<(&str, &str)> = text.iter().map(|(k, v)| (*k, v.as_str())).collect();
        Ok(png::write(out, overwrite, width, height, Channels::Rgb, pixels.as_flattened(), &text)?)
    }

    /// Width, height and colours; a pair stands side by side.
    pub fn pixels(&self) -> (usize, usize, Vec<[u8; 3]>) {
        let Some(straight) = &self.straight else {
            return (self.frame.width, self.frame.height, self.frame.color.clone());
        };
        let titles = ["straight".to_owned(), self.bent_title()];
        let right = straight.width + GAP;
        badge::titled(side_by_side(straight, &self.frame), &[(&titles[0], 0), (&titles[1], right)])
    }

    fn bent_title(&self) -> String {
        match self.sidecar.displacement {
            Some(d) => format!("bent: what is seen moved by up to {:.0} m, {:.0} px", d.max_m, d.max_px),
            None => "the same camera".into(),
        }
    }

    /// Keywords and texts that go into the picture: the record without what differs from run to run.
    fn text(&self) -> Result<Vec<(&'static str, String)>, BelvedereError> {
        let mut text = vec![("Software", self.sidecar.program.clone())];
        if !self.sidecar.scene.title.is_empty() {
            text.push(("Title", self.sidecar.scene.title.clone()));
        }
        if let Some(note) = &self.sidecar.note {
            text.push(("Comment", note.clone()));
        }
        text.push(("belvedere:scene", output::json(&self.sidecar.scene)?));
        text.push(("belvedere:inputs", output::json(&self.sidecar.inputs)?));
        text.push(("belvedere:displacement", output::json(&self.sidecar.displacement)?));
        Ok(text)
    }

    fn write_aux(&self, aux: AuxBuffer, path: &Path, overwrite: bool) -> Result<(), BelvedereError> {
        let (w, h) = (self.frame.width, self.frame.height);
        let world = self.frame.world.as_deref().unwrap_or_default();
        match aux {
            AuxBuffer::Depth => npy(path, overwrite, "<f4", &[h, w], self.frame.depth.iter().map(|v| v.to_le_bytes())),
            AuxBuffer::Id => npy(path, overwrite, "<u4", &[h, w], self.frame.id.iter().map(|v| v.to_le_bytes())),
            AuxBuffer::World => {
                npy(path, overwrite, "<f8", &[h, w, 3], world.iter().flatten().map(|v| v.to_le_bytes()))
            }
            AuxBuffer::Displacement => {
                let moved = world.iter().flat_map(|p| buffers::displacement(&self.view, *p));
                npy(path, overwrite, "<f8", &[h, w, 3], moved.map(|v| v.to_le_bytes()))
            }
        }
    }
}

/// `left` beside `right`, of the same height.
pub fn side_by_side(left: &Frame, right: &Frame) -> (usize, usize, Vec<[u8; 3]>) {
    let width = left.width + GAP + right.width;
    let height = left.height.min(right.height);
    let mut pixels = Vec::with_capacity(width * height);
    for row in 0..height {
        pixels.extend_from_slice(&left.color[row * left.width..(row + 1) * left.width]);
        pixels.extend(std::iter::repeat_n([255; 3], GAP));
        pixels.extend_from_slice(&right.color[row * right.width..(row + 1) * right.width]);
    }
    (width, height, pixels)
}

fn sibling(out: &Path, ending: &str) -> PathBuf {
    let mut name = out.as_os_str().to_owned();
    name.push(ending);
    PathBuf::from(name)
}

fn aux_path(out: &Path, aux: AuxBuffer) -> PathBuf {
    out.with_extension(format!("{}.npy", aux.name()))
}

/// Writes an array in NPY format 1.0, little endian, row-major.
fn npy<const B: usize>(
    path: &Path,
    overwrite: bool,
    kind: &str,
    shape: &[usize],
    values: impl Iterator<Item = [u8; B]>,
) -> Result<(), BelvedereError> {
    let shape: Vec<String> = shape.iter().map(usize::to_string).collect();
    let mut header = format!("{{'descr': '{kind}', 'fortran_order': False, 'shape': ({}), }}", shape.join(", "));
    // Data starts at a multiple of 64 bytes: 10 bytes before the header, its newline at the end.
    while (10 + header.len() + 1) % 64 != 0 {
        header.push(' ');
    }
    header.push('\n');
    Ok(belvedere_io::atomic::write_atomic(path, overwrite, |out| {
        out.write_all(b"\x93NUMPY\x01\x00")?;
        out.write_all(&(header.len() as u16).to_le_bytes())?;
        out.write_all(header.as_bytes())?;
        for value in values {
            out.write_all(&value)?;
        }
        Ok(())
    })?)
}

/// Samples the ground in view: where it would be without bends, in space and on the image.
fn measure_displacement(view: &View, frame: &Frame) -> DisplacementReport {
    let straight = view.straightened();
    let step = (frame.width.max(frame.height) / 128).max(1);
    let mut report = DisplacementReport::default();
    let (mut sum_m, mut sum_px, mut in_both, mut folded) = (0.0, 0.0, 0usize, 0usize);
    for row in (step / 2..frame.height).step_by(step) {
        for col in (step / 2..frame.width).step_by(step) {
            let depth = f64::from(frame.depth[row * frame.width + col]);
            let pixel = DVec2::new(col as f64 + 0.5, row as f64 + 0.5);
            let Ok(seen) = view.ray(pixel).at(if depth.is_finite() { depth } else { -1.0 }) else { continue };
            let (Ok(bent), Ok(plain)) = (view.displace(seen.point), straight.displace(seen.point)) else { continue };
            let moved = bent.point.distance(plain.point);
            report.samples += 1;
            report.max_m = report.max_m.max(moved);
            sum_m += moved * moved;
            folded += usize::from(bent.folded);
            if let Ok(image) = straight.project(seen.point) {
                let moved_px = image.pixel.distance(pixel);
                in_both += 1;
                report.max_px = report.max_px.max(moved_px);
                sum_px += moved_px * moved_px;
            }
        }
    }
    let mean = |sum: f64, count: usize| if count == 0 { 0.0 } else { sum / count as f64 };
    report.rms_m = mean(sum_m, report.samples).sqrt();
    report.rms_px = mean(sum_px, in_both).sqrt();
    report.folded_share = mean(folded as f64, report.samples);
    report
}
