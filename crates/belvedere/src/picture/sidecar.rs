//! A finished picture and the record beside it.

use super::displacement::DisplacementReport;
use super::options::{AuxBuffer, AuxFormat};
use super::target_place::TargetPlace;
use super::volume_record::VolumeRecord;
use crate::bodies::RigidLayers;
use crate::fallback::FallbackRecord;
use crate::overlays::highlight::HighlightRecord;
use crate::record::{AreaRecord, InputFile, ViewRecord};
use crate::resolve::StripReport;
use crate::resolve::constructor::ConstructorReport;
use crate::scene_file::{Document, Inset};
use belvedere_core::View;
use belvedere_disocclusion::TerrainReport;
use belvedere_scene::{Crs, Frame, FrameStats, Heightfield, Layer, LayerKind, NodeState, Scene, Unit};
use serde::Serialize;

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
    pub(super) fn of(terrain: &Heightfield) -> Self {
        let count = |state| terrain.states().iter().filter(|s| **s == state).count();
        let filled_share = terrain.share_of(NodeState::Filled);
        let [void_nodes, filled_nodes] = [NodeState::Void, NodeState::Filled].map(count);
        Self { nodes: terrain.states().len(), void_nodes, filled_nodes, filled_share }
    }
}

/// What of a molecule was drawn.
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
    /// Triangles that they were drawn as.
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

/// What was drawn over the layers of a picture.
#[derive(Debug, Clone, Default, PartialEq, Serialize)]
pub struct OverlayRecord {
    /// Whether the picture bears the mark of bent ones.
    pub mark: bool,
    /// What that says: how far at most what is seen was moved.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub mark_words: Option<String>,
    /// What the figure in the corner shows.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub inset: Option<Inset>,
    /// Strength of dark edges.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub edges: Option<f32>,
    /// Strength of the shade behind what stands out.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub unsharp: Option<f32>,
    /// Spacing of the grid, scene units.
    pub grid: Option<f64>,
    /// Displacement at the upper end of the colours, scene units.
    pub heatmap_max: Option<f64>,
    /// Whether the straight picture shows through.
    pub ghost: bool,
    /// What shows what the bend did; null if nothing does.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub highlight: Option<HighlightRecord>,
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
    /// What of each molecule was drawn.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub molecules: Vec<MoleculeRecord>,
    /// How volumes were drawn.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub volumes: Vec<VolumeRecord>,
    /// Ids of the layers whose parts were carried as rigid bodies.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub rigid: Vec<String>,
    /// What areas were drawn as, and why.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub areas: Vec<AreaRecord>,
    /// Report of the solver of terrain disocclusion; `None` if it did not run.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub disocclusion: Option<TerrainReport>,
    /// Report of the strip along a route; `None` if the scene has no strip.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub strip: Option<StripReport>,
    /// Report of the constructor of curved rays; `None` if the scene has no constructor.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub constructor: Option<ConstructorReport>,
    /// The point that the picture was made to show.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub target: Option<TargetPlace>,
    /// What gave way so that a target is seen; `None` if nothing was asked to.
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
    /// The picture (the bent one of a pair).
    pub frame: Frame,
    /// The straight one of a pair.
    pub straight: Option<Frame>,
    /// The record.
    pub sidecar: Sidecar,
    pub(crate) aux: Vec<AuxBuffer>,
    pub(crate) aux_format: AuxFormat,
    pub(crate) view: View,
    pub(crate) rigid: RigidLayers,
    pub(crate) crs: Crs,
    pub(crate) unit: Unit,
}
