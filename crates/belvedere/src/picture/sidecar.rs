//! A finished picture and the record beside it.

use super::displacement::DisplacementReport;
use super::look::LookScore;
use super::target_place::TargetPlace;
use super::volume_record::VolumeRecord;
use super::{AuxBuffer, AuxFormat, PictureOptions};
use crate::fallback::FallbackRecord;
use crate::print::Sheet;
use crate::record::{AreaRecord, InputFile, ViewRecord};
use crate::scene_file::{Document, Inset};
use crate::vectors::VectorPicture;
use belvedere_composite::tint::GroundTint;
use belvedere_core::View;
use belvedere_core::Warning;
use belvedere_disocclusion::TerrainReport;
use belvedere_overlay::furniture::FurnitureRecord;
use belvedere_overlay::highlight::HighlightRecord;
use belvedere_resolve::constructor::ConstructorReport;
use belvedere_resolve::{GroundMovesReport, StripReport, TubeReport};
use belvedere_scene::{Cover, Crs, Frame, FrameStats, Layer, LayerKind, NodeState, Palette, Scene, TerrainLayer, Unit};
use belvedere_sight::RigidLayers;
use serde::ser::Error as _;
use serde::{Serialize, Serializer};
use std::collections::BTreeMap;
use std::sync::{Arc, OnceLock};

/// Measured and made-up parts of the ground.
#[derive(Debug, Clone, PartialEq, schemars::JsonSchema, Serialize)]
pub struct TerrainRecord {
    /// Nodes of the grid.
    pub nodes: usize,
    /// Nodes without a height: holes, and the rim outside the data.
    pub void_nodes: usize,
    /// Nodes without data whose height was filled in to close a hole.
    pub filled_nodes: usize,
    /// Share of these nodes, 0..=1.
    pub filled_share: f64,
    /// What is drawn by rule and is no data; nothing in tints by height.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub made: Option<MadeRecord>,
}

/// Materials that are drawn by rule.
#[derive(Debug, Clone, PartialEq, schemars::JsonSchema, Serialize)]
pub struct MadeRecord {
    /// Height over the sea above which no forest is drawn, metres.
    pub tree_line_m: f64,
    /// Height over the sea above which gentle slopes have snow in summer, metres.
    pub snow_line_m: f64,
    /// Dryness of the climate: 0 = humid, 1 = desert.
    pub dryness: f64,
    /// Whether the climate is that of the place; else it is guessed from the heights.
    pub climate_of_place: bool,
    /// Spacing of the data, scene units: finer relief is made.
    pub data_spacing: f64,
    /// What covers the ground by data; nothing where all of it is drawn by rule.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub land_cover: Option<LandCoverRecord>,
}

/// Land cover by data.
#[derive(Debug, Clone, PartialEq, schemars::JsonSchema, Serialize)]
pub struct LandCoverRecord {
    /// What its classes are called.
    pub legend: String,
    /// Distance of its cells, scene units.
    pub spacing: f64,
    /// Shares of the classes over the ground, 0..=1; what is unknown is drawn by rule.
    pub shares: BTreeMap<String, f64>,
}

impl LandCoverRecord {
    fn of(terrain: &TerrainLayer) -> Option<Self> {
        let Palette::Placed(_, _, Some(land)) = &terrain.palette else { return None };
        let name = |cover: Cover| Cover::ALL[cover as usize].0.to_owned();
        Some(Self {
            legend: land.legend.to_owned(),
            spacing: land.spacing.into_iter().fold(0.0, f32::max).into(),
            shares: land.shares().into_iter().map(|(cover, share)| (name(cover), share)).collect(),
        })
    }
}

impl MadeRecord {
    fn of(terrain: &TerrainLayer) -> Option<Self> {
        let climate = GroundTint::new(&terrain.palette, terrain.heightfield.z_range()).climate()?;
        Some(Self {
            tree_line_m: climate.tree_line_m,
            snow_line_m: climate.snow_line_m,
            dryness: climate.dryness,
            climate_of_place: climate.of_place,
            data_spacing: terrain.heightfield.spacing().max_element(),
            land_cover: LandCoverRecord::of(terrain),
        })
    }
}

impl TerrainRecord {
    pub(super) fn of(layer: &TerrainLayer) -> Self {
        let terrain = &layer.heightfield;
        let count = |state| terrain.states().iter().filter(|s| **s == state).count();
        let filled_share = terrain.share_of(NodeState::Filled);
        let [void_nodes, filled_nodes] = [NodeState::Void, NodeState::Filled].map(count);
        let made = MadeRecord::of(layer);
        Self { nodes: terrain.states().len(), void_nodes, filled_nodes, filled_share, made }
    }
}

/// Drawn parts of a molecule.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct MoleculeRecord {
    /// Id of the layer.
    pub layer: String,
    /// Atoms of the file.
    pub atoms: usize,
    /// Atoms that were drawn.
    pub drawn_atoms: usize,
    /// Bonds that were drawn.
    pub drawn_bonds: usize,
    /// Triangles of the drawn surface.
    pub triangles: usize,
}

impl MoleculeRecord {
    pub(super) fn all_of(scene: &Scene) -> Vec<Self> {
        let record = |layer: &Layer| match &layer.kind {
            LayerKind::Molecule(m) => Some(Self {
                layer: layer.id.clone(),
                atoms: m.molecule.atoms().len(),
                drawn_atoms: m.atoms,
                drawn_bonds: m.bonds,
                triangles: m.surface.mesh.triangles().len(),
            }),
            _ => None,
        };
        scene.layers.iter().filter_map(record).collect()
    }
}

/// A layer that something shines through.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct SeeThroughRecord {
    /// Id of the layer.
    pub layer: String,
    /// Its opacity, at least 0 and below 1.
    pub opacity: f32,
}

impl SeeThroughRecord {
    pub(super) fn all_of(scene: &Scene) -> Vec<Self> {
        let layers = scene.layers.iter().filter(|layer| layer.kind.is_see_through());
        layers.map(|layer| Self { layer: layer.id.clone(), opacity: layer.kind.opacity() }).collect()
    }
}

/// Marks over the layers of a picture.
#[derive(Debug, Clone, Default, PartialEq, Serialize)]
pub struct OverlayRecord {
    /// Whether the picture has the mark of bent pictures.
    pub mark: bool,
    /// Words of that mark: the largest displacement in the picture.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub mark_words: Option<String>,
    /// Contents of the inset in the corner.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub inset: Option<Inset>,
    /// Strength of dark edges.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub edges: Option<f32>,
    /// Strength of depth unsharp masking.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub unsharp: Option<f32>,
    /// Spacing of the grid, scene units.
    pub grid: Option<f64>,
    /// Displacement at the upper end of the colours, scene units.
    pub heatmap_max: Option<f64>,
    /// Whether the straight picture was drawn faintly over it.
    pub ghost: bool,
    /// Figures of the highlights; null if there are none.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub highlight: Option<HighlightRecord>,
    /// For a picture of the camera: the position from which it was drawn.
    pub camera: Option<&'static str>,
}

/// The record beside a picture.
#[derive(Debug, Clone, Serialize)]
pub struct Sidecar {
    /// Program and version.
    pub program: String,
    /// Name of the renderer.
    pub renderer: &'static str,
    /// sha256 of the picture file, where the record is written beside one.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub picture_sha256: Option<String>,
    /// Note that the picture is bent, if it is.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub note: Option<String>,
    /// Place on paper: its size, margin and pixels per inch.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub print: Option<Sheet>,
    /// Stages in order of application.
    pub stages: Vec<&'static str>,
    /// Marks over the layers.
    pub overlay: OverlayRecord,
    /// Whom the data ask to be named, whether the picture does or not.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub attribution: Vec<String>,
    /// Title, legend, attribution, compass and scale.
    #[serde(skip_serializing_if = "FurnitureRecord::is_empty")]
    pub furniture: FurnitureRecord,
    /// Displacement of the points in the picture; `None` for a straight picture.
    pub displacement: Option<DisplacementReport>,
    /// Measured and made-up parts of the ground; `None` without terrain.
    pub terrain: Option<TerrainRecord>,
    /// Score of the look of a terrain picture that was written.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub look: Option<LookScore>,
    /// Drawn parts of each molecule.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub molecules: Vec<MoleculeRecord>,
    /// How volumes were drawn.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub volumes: Vec<VolumeRecord>,
    /// Ids of the layers whose parts were carried as rigid bodies.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub rigid: Vec<String>,
    /// Layers that something shines through; they hide nothing from measures.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub see_through: Vec<SeeThroughRecord>,
    /// Surfaces that areas were drawn as, and the sources of this choice.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub areas: Vec<AreaRecord>,
    /// Report of the solver of terrain disocclusion; `None` if it did not run. Its times are not written.
    #[serde(skip_serializing_if = "Option::is_none", serialize_with = "without_times")]
    pub disocclusion: Option<TerrainReport>,
    /// Report of ground that an author moved; `None` if the scene moves none.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub moved: Option<GroundMovesReport>,
    /// Report of the strip along a route; `None` if the scene has no strip.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub strip: Option<StripReport>,
    /// Report of the tube along a centreline; `None` if the scene has no tube.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub tube: Option<TubeReport>,
    /// Report of the constructor of curved rays; `None` if the scene has no constructor.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub constructor: Option<ConstructorReport>,
    /// The target point of the picture.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub target: Option<TargetPlace>,
    /// Report of the fallback; `None` if none was asked for.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub fallback: Option<FallbackRecord>,
    /// The camera in numbers.
    pub view: ViewRecord,
    /// The resolved scene: opens to the same view; `None` for one that was made in memory.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub scene: Option<Document>,
    /// Title of the scene.
    #[serde(skip)]
    pub title: String,
    /// Files that were read: names relative to the scene, or bare names, and hashes.
    pub inputs: Vec<InputFile>,
    /// Warnings.
    pub warnings: Vec<Warning>,
    /// Those of them that are about this picture and not about the scene.
    #[serde(skip)]
    pub of_picture: Vec<Warning>,
    /// Counts of the renderer. Its time is not written.
    #[serde(serialize_with = "counts")]
    pub stats: FrameStats,
    /// Wall time of drawing, milliseconds. It is not written: the record is the same in every run.
    #[serde(skip)]
    pub render_ms: f64,
}

/// The report without the times that the solver took.
fn without_times<S: Serializer>(report: &Option<TerrainReport>, serializer: S) -> Result<S::Ok, S::Error> {
    let mut value = serde_json::to_value(report).map_err(S::Error::custom)?;
    if let Some(entries) = value.as_object_mut() {
        entries.remove("times");
    }
    value.serialize(serializer)
}

/// The counts without the time that drawing took.
fn counts<S: Serializer>(stats: &FrameStats, serializer: S) -> Result<S::Ok, S::Error> {
    let mut value = serde_json::to_value(stats).map_err(S::Error::custom)?;
    if let Some(entries) = value.as_object_mut() {
        entries.remove("milliseconds");
    }
    value.serialize(serializer)
}

/// A finished picture and its record.
#[derive(Debug, Clone)]
pub struct Picture {
    /// The picture (the bent one of a pair).
    pub frame: Frame,
    /// How much each pixel covers what is laid behind the picture, where the sky is transparent: 0 = not, 255 = wholly.
    pub alpha: Option<Vec<u8>>,
    /// The straight one of a pair.
    pub straight: Option<Frame>,
    /// The record.
    pub sidecar: Sidecar,
    /// Lines, areas, points, names and legends, where they were asked for as shapes; then the picture has no pixels of them.
    pub vectors: Option<VectorPicture>,
    pub(crate) aux: Vec<AuxBuffer>,
    pub(crate) aux_format: AuxFormat,
    pub(crate) view: View,
    pub(crate) scene: Arc<Scene>,
    pub(crate) rigid: RigidLayers,
    pub(crate) crs: Crs,
    pub(crate) unit: Unit,
    /// How the picture is drawn when it is written, where that waits.
    pub(crate) later: Option<Later>,
}

/// A picture that is drawn while it is written.
#[derive(Debug, Clone)]
pub(crate) struct Later {
    pub(crate) options: Box<PictureOptions>,
    /// Its record, once it is written.
    pub(crate) record: Arc<OnceLock<Sidecar>>,
}

impl Picture {
    /// The record; of a picture that is drawn while it is written what is known before that, until then.
    pub fn record(&self) -> &Sidecar {
        self.later.as_ref().and_then(|later| later.record.get()).unwrap_or(&self.sidecar)
    }

    /// Score of its look; `None` where it shows no terrain, or is drawn while it is written.
    pub fn look(&self) -> Option<LookScore> {
        LookScore::of(&self.frame, &self.scene, &self.view)
    }

    /// The same picture, which writes these buffers beside itself; those that it was not drawn with are empty.
    pub fn with_buffers(self, aux: Vec<AuxBuffer>, aux_format: AuxFormat) -> Self {
        Self { aux, aux_format, ..self }
    }
}
