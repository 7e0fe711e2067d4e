//! Layers of atoms in the scene document.

use super::common::{TransformDoc, is_opaque};
use belvedere_scene::molecule::Representation;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Atoms from a file: PDB or mmCIF. The scene is measured in angstrom.
///
/// Selections are written in short words: `chain A,B`, `resi 12-18`, `resn DA`, `name P`, `element FE`, `atom 1234`, `water`, `hetero`,
/// `hydrogen`, `all`, `none`, joined by `and`, `or`, `not` and parentheses.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct MoleculeDoc {
    /// Unique id within the scene.
    pub id: String,
    /// A file (.pdb, .ent, .cif, .mmcif, each also .gz), or `builtin:dna?pairs=12&seed=7`.
    pub source: String,
    /// Whether constructors and measures work for it: for the atoms of `select`, or else for all that are drawn.
    #[serde(default)]
    pub must_see: bool,
    /// Atoms that matter: drawn in the highlight colour, and meant by `must_see`.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub select: Option<String>,
    /// How it is drawn.
    #[serde(default)]
    pub style: MoleculeStyleDoc,
    /// Placement.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub transform: Option<TransformDoc>,
}

impl MoleculeDoc {
    /// A file in the usual style.
    pub(crate) fn of(id: String, source: &str) -> Self {
        let source = source.to_owned();
        Self { id, source, must_see: false, select: None, style: MoleculeStyleDoc::default(), transform: None }
    }
}

/// How a molecule is drawn.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct MoleculeStyleDoc {
    /// Small balls joined by rods, or balls of van der Waals radius.
    pub representation: Representation,
    /// `element`, `chain`, `residue`, or one colour for all, `#rrggbb`.
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
    /// How finely balls are cut, 1..=16: each is 20 detail^2 triangles. By default by the number of atoms.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub detail: Option<u32>,
}

impl Default for MoleculeStyleDoc {
    fn default() -> Self {
        Self {
            representation: Representation::default(),
            color: "element".into(),
            opacity: 1.0,
            selection: None,
            paint: Vec::new(),
            highlight: "#ffb000".into(),
            detail: None,
        }
    }
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
