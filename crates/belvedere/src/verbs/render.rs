//! `render`: pictures with a record of where they come from.

use super::output;
use crate::provenance::{self, InputFile};
use crate::{BelvedereError, Session};
use belvedere_core::{Camera, DVec2, View};
use belvedere_cpu::{CpuRenderer, ExactRenderer};
use belvedere_io::png::{self, Channels};
use belvedere_scene::{Aux, Frame, FrameStats, Heightfield, NodeState, Progress, RenderJob, RenderOptions, Renderer};
use serde::Serialize;
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
    /// Who draws.
    pub renderer: RendererChoice,
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
    /// The renderer itself.
    pub fn renderer(self) -> &'static dyn Renderer {
        match self {
            Self::Cpu => &CpuRenderer,
            Self::Exact => &ExactRenderer,
        }
    }
}

/// A buffer beside the picture, as NPY.
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

/// How far a picture moves what it shows, against the same camera without bends; sampled every few pixels.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize)]
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
    /// How far things were moved; `None` for a straight picture.
    pub displacement: Option<DisplacementReport>,
    /// What of the ground is made up; `None` without terrain.
    pub terrain: Option<TerrainRecord>,
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
    pub(super) view: View,
}

/// Files that [`Picture::write`] makes for `out`.
pub fn outputs(out: &Path, request: &RenderRequest) -> Vec<PathBuf> {
    let sidecar = sibling(out, ".json");
    let aux = request.aux.iter().map(|a| aux_path(out, *a));
    [out.to_owned(), sidecar].into_iter().chain(aux).collect()
}

/// Draws the session's view.
///
/// # Errors
/// [`BelvedereError::Usage`] if the eye is under ground, [`BelvedereError::Render`], [`BelvedereError::Cancelled`].
pub fn render(session: &Session, request: &RenderRequest, progress: &Progress) -> Result<Picture, BelvedereError> {
    super::check::drawable(session)?;
    let started = Instant::now();
    let view = if request.straight { session.view().straightened() } else { session.view().clone() };
    let world = request.aux.iter().any(|a| matches!(a, AuxBuffer::World | AuxBuffer::Displacement));
    let exact = !request.aux.is_empty();
    let options = RenderOptions { aux: Aux { world, exact }, ..request.options.clone() };
    let draw = |view: &View| {
        request.renderer.renderer().render(&RenderJob {
            scene: session.scene(),
            view,
            light: session.light(),
            options: &options,
            progress,
        })
    };
    let frame = draw(&view)?;
    let straight = if request.compare { Some(draw(&view.straightened())?) } else { None };
    let render_ms = started.elapsed().as_secs_f64() * 1e3;
    let displacement = view.is_bent().then(|| measure_displacement(&view, &frame));
    let sidecar = Sidecar {
        program: format!("belvedere {}", crate::VERSION),
        renderer: request.renderer.renderer().name(),
        note: displacement.map(|d| note(&view, &d)),
        stages: view.stages().iter().map(|s| s.name()).collect(),
        displacement,
        terrain: session.scene().terrain().map(TerrainRecord::of),
        view: provenance::ViewRecord::of(&view),
        scene: session.resolved().clone(),
        inputs: provenance::inputs(session.inputs())?,
        warnings: session.warnings().to_vec(),
        stats: frame.stats.clone(),
        render_ms,
    };
    Ok(Picture { frame, straight, sidecar, aux: request.aux.clone(), view })
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
        let (width, height, pixels) = self.pixels();
        let text = self.text()?;
        let text: Vec<(&str, &str)> = text.iter().map(|(k, v)| (*k, v.as_str())).collect();
        png::write(out, overwrite, width, height, Channels::Rgb, pixels.as_flattened(), &text)?;
        let sidecar = sibling(out, ".json");
        output::write_text(&sidecar, &super::check::pretty(&self.sidecar)?, overwrite)?;
        let mut written = vec![out.to_owned(), sidecar];
        for aux in &self.aux {
            let path = aux_path(out, *aux);
            self.write_aux(*aux, &path, overwrite)?;
            written.push(path);
        }
        Ok(written)
    }

    /// Width, height and colours; a pair stands side by side.
    pub fn pixels(&self) -> (usize, usize, Vec<[u8; 3]>) {
        let Some(straight) = &self.straight else {
            return (self.frame.width, self.frame.height, self.frame.color.clone());
        };
        side_by_side(straight, &self.frame)
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
                let moved = world.iter().flat_map(|p| {
                    let p = belvedere_core::DVec3::from_array(*p);
                    let to = if p.is_finite() { self.view.displace(p).ok() } else { None };
                    to.map_or([f64::NAN; 3], |d| (d.point - p).to_array())
                });
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
