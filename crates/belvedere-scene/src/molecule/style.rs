//! Style and placement of molecules.

use super::{Atom, Element, Molecule, Selection};
use crate::Color;
use crate::Placement;
use glam::{DMat3, DVec3};
use serde::{Deserialize, Serialize};

/// How atoms are shown.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "snake_case")]
pub enum Representation {
    /// Small balls joined by rods.
    #[default]
    BallAndStick,
    /// Balls of van der Waals radius, as close as atoms come without a bond.
    #[serde(alias = "spheres")]
    SpaceFilling,
    /// Rods alone.
    Sticks,
    /// Bands along the chains of proteins, with arrows along strands, and along nucleic acids, with slabs for bases; the rest as balls
    /// and rods.
    #[serde(alias = "cartoon")]
    Ribbon,
    /// The smooth surface around all atoms: where the sum of their Gaussian densities is 1.
    Surface,
    /// Ribbons if chains of proteins and nucleic acids have 100 residues and more together, else small balls joined by rods.
    Auto,
}

impl Representation {
    /// Residues of chains from which on balls and rods hide each other.
    const MANY_RESIDUES: usize = 100;

    /// The representation of a molecule: what [`Representation::Auto`] means for it, and all others as they are.
    pub fn of(self, molecule: &Molecule) -> Self {
        if self != Self::Auto {
            return self;
        }
        // Every amino acid has one alpha carbon, every nucleotide but the first of a chain one phosphorus atom.
        let stands_for_residue = |a: &&Atom| matches!((&*a.name, a.element), ("CA", Element::C) | ("P", Element::P));
        let many = molecule.atoms().iter().filter(stands_for_residue).nth(Self::MANY_RESIDUES - 1).is_some();
        if many { Self::Ribbon } else { Self::BallAndStick }
    }
}

/// What an atom is drawn as.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Shown {
    /// Not at all.
    #[default]
    Not,
    /// A ball of its own, and rods.
    Ball,
    /// A piece of a ribbon, whose triangles have the index of this atom.
    Ribbon(u32),
    /// A part of a smooth surface, if it lies at it.
    Surface,
}

/// Source of the colours of atoms.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum MoleculeColor {
    /// The element; of ribbons and surfaces the chain.
    #[default]
    Auto,
    /// The element, by the convention of Corey, Pauling and Koltun.
    Element,
    /// Helices, strands, and all else, as the file states them or as the places of the alpha carbons tell.
    Structure,
    /// The chain, in the order of the file; copies have the colour of what they are copies of.
    Chain,
    /// The name of the residue, in the order of first appearance.
    Residue,
    /// One for all.
    One(Color),
}

/// A colour of its own for some atoms.
#[derive(Debug, Clone, PartialEq)]
pub struct Paint {
    /// The atoms.
    pub selection: Selection,
    /// Their colour.
    pub color: Color,
}

/// How a molecule is drawn.
#[derive(Debug, Clone, PartialEq)]
pub struct MoleculeStyle {
    /// What atoms are shown as.
    pub representation: Representation,
    /// Colours.
    pub color: MoleculeColor,
    /// Colours of selected atoms; later ones win.
    pub paint: Vec<Paint>,
    /// Atoms that are drawn.
    pub selection: Selection,
    /// Fineness, 1..=16: cuts along the edge of the icosahedron that a ball is made from, steps of ribbons and surfaces; `None` = by the
    /// number of atoms.
    pub detail: Option<u32>,
    /// Atoms that are drawn as balls and rods beside a ribbon or through a surface.
    pub sticks: Option<Selection>,
    /// Double and triple bonds as two and three rods.
    pub orders: bool,
}

impl Default for MoleculeStyle {
    fn default() -> Self {
        Self {
            representation: Representation::default(),
            color: MoleculeColor::default(),
            paint: Vec::new(),
            selection: Selection::all(),
            detail: None,
            sticks: None,
            orders: true,
        }
    }
}

/// Placement of a molecule: scaled, then turned, then moved.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ModelTransform {
    /// Scene units per angstrom, > 0.
    pub scale: f64,
    /// Rotation.
    pub turn: DMat3,
    /// Added last, scene units.
    pub to: DVec3,
}

impl Default for ModelTransform {
    fn default() -> Self {
        Self { scale: 1.0, turn: DMat3::IDENTITY, to: DVec3::ZERO }
    }
}

impl ModelTransform {
    /// Scene position of a point given in angstrom.
    pub fn apply(&self, p: DVec3) -> DVec3 {
        self.turn * (self.scale * p) + self.to
    }

    /// The same, moved as a whole.
    pub fn placed(&self, at: &Placement) -> Self {
        Self { turn: DMat3::from_rotation_z(at.yaw) * self.turn, to: at.apply(self.to), ..*self }
    }
}
