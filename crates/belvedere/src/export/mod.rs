//! `export`: the displaced scene and the matching camera as one GLB file, for Blender and other programs with straight cameras.
//!
//! A picture is a pinhole photograph of a displaced world. The file holds that world: every vertex stands where the stages put it, so that
//! the straight camera beside it sees each point at the pixel of the bent picture.

mod glb;
mod ground;
mod marks;
mod sheet;
mod solids;

use crate::guard::guarded;
use crate::record::ViewRecord;
use crate::request::Export;
use crate::{Advice, BelvedereError, Session};
use belvedere_core::{Aabb, DVec3, View, Warning, WarningKind};
use belvedere_scene::{LayerKind, Progress, Unit};
use glb::{Ball, Content};
use schemars::JsonSchema;
use serde::Serialize;
use sheet::Sheet;

/// Most nodes of the ground unless given.
pub const GROUND_NODES: usize = 1_000_000;
/// Most triangles of a file.
const MOST_TRIANGLES: usize = 12_000_000;

/// How a scene is exported.
#[derive(Debug, Clone)]
pub struct ExportOptions {
    /// Most nodes of each ground, at least 4: of finer ground every second, third ... node is taken.
    pub ground_nodes: usize,
    /// The scene without its bends, but with the earth's curvature.
    pub straight: bool,
    /// Progress and cancellation.
    pub progress: Progress,
}

impl ExportOptions {
    /// The options that are asked for.
    pub fn of(asked: &Export) -> Self {
        let usual = Self::default();
        let ground_nodes = asked.nodes.map_or(usual.ground_nodes, |nodes| nodes as usize);
        Self { ground_nodes, straight: asked.straight, ..usual }
    }
}

impl Default for ExportOptions {
    fn default() -> Self {
        Self { ground_nodes: GROUND_NODES, straight: false, progress: Progress::silent() }
    }
}

/// A file and its figures.
#[derive(Debug, Clone)]
pub struct Exported {
    /// Contents of the file.
    pub glb: Vec<u8>,
    /// Its figures.
    pub report: ExportReport,
}

/// Figures of an exported file.
#[derive(Debug, Clone, JsonSchema, Serialize)]
pub struct ExportReport {
    /// Scene coordinates of the file's origin, which are subtracted from all positions.
    pub origin: [f64; 3],
    /// Coordinate system of the scene.
    pub crs: String,
    /// Unit of length.
    pub unit: String,
    /// The camera in numbers, scene coordinates.
    pub view: ViewRecord,
    /// Stages that the vertices have passed, in order of application.
    pub stages: Vec<String>,
    /// What was written of each layer, in file order.
    pub layers: Vec<ExportedLayer>,
    /// Triangles of all layers.
    pub triangles: usize,
    /// Size of the file, bytes.
    pub bytes: usize,
    /// Warnings.
    pub warnings: Vec<Warning>,
}

/// What was written of a layer.
#[derive(Debug, Clone, JsonSchema, Serialize)]
pub struct ExportedLayer {
    /// Id of the layer.
    pub layer: String,
    /// Triangles.
    pub triangles: usize,
    /// Points, as balls.
    pub points: usize,
}

/// Displaces points as the picture shows them.
pub(crate) struct Carrier<'a> {
    view: &'a View,
}

impl Carrier<'_> {
    /// The displaced point; `None` if it has no image.
    fn carry(&self, p: DVec3) -> Option<DVec3> {
        self.view.displace(p).ok().map(|d| d.point).filter(|p| p.is_finite())
    }

    /// How long one pixel is at a displaced point, scene units; `None` behind the eye.
    fn pixel_at(&self, carried: DVec3) -> Option<f64> {
        let pinhole = self.view.pinhole();
        let (_, depth) = pinhole.project(carried).ok()?;
        Some(if pinhole.is_orthographic() { 1.0 } else { depth.max(pinhole.near) } / pinhole.scale_px())
    }
}

/// The displaced scene as a GLB file.
///
/// # Errors
/// [`BelvedereError::Argument`] for a view that no straight camera can show (rays that part along a seam) and for too many triangles;
/// [`BelvedereError::Target`] for a scene of which nothing can be written; [`BelvedereError::UnderGround`], [`BelvedereError::Cancelled`].
pub fn export(session: &Session, options: &ExportOptions) -> Result<Exported, BelvedereError> {
    guarded(|| exported(session, options))
}

fn exported(session: &Session, options: &ExportOptions) -> Result<Exported, BelvedereError> {
    let view = if options.straight { session.view().straightened() } else { session.view().clone() };
    if view.split_rays().is_some() {
        let text = "rays that part along a seam show some points twice, which no straight camera does; export with {}, or remove `split` \
                    from the scene";
        return Err(BelvedereError::Argument(Advice::new(text, &["straight"])));
    }
    session.check_drawable()?;
    let (scene, carrier) = (session.scene(), Carrier { view: &view });
    let mut warnings = session.warnings();
    let (mut sheets, mut balls, mut layers) = (Vec::new(), Vec::new(), Vec::new());
    let count = scene.layers.len().max(1) as f64;
    for (k, layer) in scene.layers.iter().enumerate() {
        options.progress.tick("export", k as f64 / count)?;
        let (before, sheet) = (
            balls.len(),
            match &layer.kind {
                LayerKind::Terrain(terrain) => {
                    Some(ground::sheet(terrain, scene, &carrier, options, &mut warnings, &layer.id)?)
                }
                LayerKind::Boxes(_) | LayerKind::Mesh(_) | LayerKind::Own(_) | LayerKind::Molecule(_) => {
                    Some(solids::sheet(&layer.kind, &carrier, options)?)
                }
                LayerKind::Line(lines) => Some(marks::tubes(lines, &carrier)),
                LayerKind::Point(points) => {
                    balls.extend(marks::balls(points, &carrier, &layer.id));
                    None
                }
                // Fills of areas are colours of the ground.
                LayerKind::Area(_) => None,
                LayerKind::Volume(_) => {
                    let text =
                        format!("layer \"{}\" is a volume, which a GLB file cannot hold; it is left out", layer.id);
                    warnings.push(Warning::new(WarningKind::Ignored, text).about(&layer.id));
                    None
                }
            },
        );
        let sheet = sheet.filter(|sheet: &Sheet| !sheet.triangles.is_empty());
        let triangles = sheet.as_ref().map_or(0, |sheet| sheet.triangles.len());
        layers.push(ExportedLayer { layer: layer.id.clone(), triangles, points: balls.len() - before });
        sheets.extend(sheet.map(|sheet| (layer.id.clone(), sheet)));
    }
    let triangles: usize = layers.iter().map(|layer| layer.triangles).sum();
    if triangles > MOST_TRIANGLES {
        let many = format!("the scene has {triangles} triangles, a file at most {MOST_TRIANGLES}; ");
        let advice = Advice::new("give a smaller {}, or leave layers out", &["ground_nodes"]).before(many);
        return Err(BelvedereError::Argument(advice));
    }
    let origin = origin(&sheets, &balls).ok_or_else(|| {
        BelvedereError::Target(
            "nothing of the scene can be exported: ground, lines, points, boxes, meshes and molecules can".into(),
        )
    })?;
    let report = ExportReport {
        origin: origin.to_array(),
        crs: scene.crs.to_string(),
        unit: unit(scene.unit).into(),
        view: ViewRecord::of(&view),
        stages: view.stages().iter().map(|stage| stage.name().to_owned()).collect(),
        layers,
        triangles,
        bytes: 0,
        warnings,
    };
    options.progress.tick("write", 0.95)?;
    let glb =
        glb::bytes(&Content { sheets: &sheets, balls: &balls, pinhole: view.pinhole(), origin, report: &report })?;
    Ok(Exported { report: ExportReport { bytes: glb.len(), ..report }, glb })
}

/// The middle of everything, in whole units.
fn origin(sheets: &[(String, Sheet)], balls: &[Ball]) -> Option<DVec3> {
    let places = sheets.iter().flat_map(|(_, sheet)| sheet.carried.iter().flatten().copied());
    let bounds = Aabb::of(places.chain(balls.iter().map(|ball| ball.at)));
    (!bounds.is_empty()).then(|| bounds.center().round() + DVec3::ZERO)
}

fn unit(unit: Unit) -> &'static str {
    match unit {
        Unit::Metre => "metre",
        Unit::Angstrom => "angstrom",
        Unit::Voxel => "voxel",
    }
}
