//! Layers of atoms in the scene document.

use super::common::{TransformDoc, is_false, is_opaque, is_true};
use belvedere_scene::molecule::Representation;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Atoms from a file: PDB, mmCIF or XYZ. The scene is measured in angstrom.
///
/// Selections are written in short words: `chain A,B`, `copy 2-5`, `resi 12-18`, `resn DA`, `name P`, `element FE`, `atom 1234`, `water`, `hetero`,
/// `hydrogen`, `all`, `none`, joined by `and`, `or`, `not` and parentheses.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct MoleculeDoc {
    /// Unique id within the scene.
    pub id: String,
    /// A file (.pdb, .ent, .cif, .mmcif, .xyz, each also .gz), or `builtin:dna?pairs=12&seed=7`.
    pub source: String,
    /// Whether constructors and measures work for it: for the atoms of `select`, or else for all that are drawn.
    #[serde(default)]
    pub must_see: bool,
    /// Atoms that matter: drawn in the highlight colour, and meant by `must_see`.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub select: Option<String>,
    /// Biological assembly by its name in the file, such as `1`: the copies that the file describes are drawn, chain `A` of copy 2 as
    /// `A-2`. By default, and as `asymmetric`, the atoms of the file alone.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub assembly: Option<String>,
    /// Model of the file, from 1, or `all`: all of them side by side, chain `A` of model 2 as `A-2`; by default the first.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub model: Option<ModelsDoc>,
    /// A file of places of the same atoms over time (.xtc, .dcd), whose frames films show one after the other. Pictures show the first.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub trajectory: Option<String>,
    /// Every how manieth frame of the trajectory is shown, from 1; by default every one.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub trajectory_every: Option<usize>,
    /// Shows the models of the file, or the frames of its trajectory, one after the other in films, so many per second; the last one stays.
    /// Pictures show the first. Of a trajectory 25 by default.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub models_per_s: Option<f64>,
    /// CSV of its motion, as of boxes: `t,x,y,z[,yaw_deg]`.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub motion: Option<String>,
    /// How it is drawn.
    #[serde(default)]
    pub style: MoleculeStyleDoc,
    /// Placement.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub transform: Option<TransformDoc>,
}

/// The number of a model, from 1, or `all`.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(untagged, expecting = "the number of a model or \"all\" was expected")]
pub enum ModelsDoc {
    /// A number.
    Number(usize),
    /// The word `all`.
    All(AllWord),
}

/// The word `all`.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum AllWord {
    /// All there are.
    All,
}

impl std::str::FromStr for ModelsDoc {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        match text.trim() {
            "all" => Ok(Self::All(AllWord::All)),
            number => {
                number.parse().map(Self::Number).map_err(|_| "give the number of a model, from 1, or all".to_owned())
            }
        }
    }
}

impl MoleculeDoc {
    /// A file in the usual style.
    pub fn of(id: String, source: &str) -> Self {
        let source = source.to_owned();
        let style = MoleculeStyleDoc::default();
        Self {
            id,
            source,
            must_see: false,
            select: None,
            assembly: None,
            model: None,
            trajectory: None,
            trajectory_every: None,
            models_per_s: None,
            motion: None,
            style,
            transform: None,
        }
    }
}

/// How a molecule is drawn.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct MoleculeStyleDoc {
    /// Small balls joined by rods, balls of van der Waals radius (`spheres`), rods, ribbons (`cartoon`) or a smooth surface.
    pub representation: Representation,
    /// `element`, `chain`, `residue`, `structure` (helices and strands), or one colour for all, `#rrggbb`; `auto`: by element, ribbons and
    /// surfaces by chain.
    pub color: String,
    /// Opacity, 0..=1: below 1 what is behind is seen through, at 0 the layer is not drawn.
    #[serde(skip_serializing_if = "is_opaque")]
    pub opacity: f64,
    /// Atoms that are drawn; by default all but water, unless there is nothing else.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub selection: Option<String>,
    /// Colours for some of them, later ones win.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub paint: Vec<PaintDoc>,
    /// Colour of the atoms of `select`, or `none`.
    pub highlight: String,
    /// How finely balls, ribbons and surfaces are cut, 1..=16: a ball is 20 detail^2 triangles, a surface has the spacing 1.6 /
    /// sqrt(detail) angstrom. By default by the number of atoms.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub detail: Option<u32>,
    /// Atoms that are balls and rods beside a ribbon or through a surface, such as `resi 45,60` or `hetero and not water`.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub sticks: Option<String>,
    /// Whether the names of residues are written, where they are seen and find room: those of `select` first.
    #[serde(skip_serializing_if = "is_false")]
    pub labels: bool,
    /// Height of the letters, pixels, in (0, 200].
    #[serde(skip_serializing_if = "is_usual_size")]
    pub label_px: f64,
    /// Whether double and triple bonds are drawn as two and three rods.
    #[serde(skip_serializing_if = "is_true")]
    pub bond_orders: bool,
}

impl Default for MoleculeStyleDoc {
    fn default() -> Self {
        Self {
            representation: Representation::default(),
            color: "auto".into(),
            opacity: 1.0,
            selection: None,
            paint: Vec::new(),
            highlight: "#ffb000".into(),
            detail: None,
            sticks: None,
            labels: false,
            label_px: LABEL_PX,
            bond_orders: true,
        }
    }
}

/// Usual height of letters, pixels.
const LABEL_PX: f64 = 13.0;

fn is_usual_size(size: &f64) -> bool {
    *size == LABEL_PX
}

/// A colour for some atoms.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct PaintDoc {
    /// Which.
    pub selection: String,
    /// `#rrggbb`.
    pub color: String,
}
