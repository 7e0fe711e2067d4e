//! A molecule as a layer: which atoms are drawn, how, and which must be seen.

use super::surface::{self, Look};
use super::{Element, ModelTransform, Molecule, MoleculeColor, MoleculeStyle, Representation, Selection};
use crate::{Color, MeshError, MeshLayer};
use glam::DVec3;

/// A molecule and its surface. The surface is made once; it is bent, drawn and picked, and hides points, like any mesh.
#[derive(Debug, Clone)]
pub struct MoleculeLayer {
    /// All atoms of the file, drawn or not, angstrom.
    pub molecule: Molecule,
    /// Placement in the scene.
    pub placement: ModelTransform,
    /// Triangles of the drawn atoms and bonds, scene coordinates. A triangle's part ([`crate::Mesh::part`]) is the index of its atom.
    pub surface: MeshLayer,
    /// Atoms that are drawn.
    pub atoms: usize,
    /// Bonds that are drawn: those whose atoms both are, none where atoms fill space.
    pub bonds: usize,
    /// Balls and rods, or balls alone.
    pub representation: Representation,
    /// The atoms that `must_see` means; `None` = all that are drawn.
    pub wanted: Option<Selection>,
}

/// Colours of chains and of residues, distinct from each other and from the colours of marks.
const SERIES: [Color; 10] = [
    Color::rgb(92, 136, 196),
    Color::rgb(224, 148, 84),
    Color::rgb(112, 172, 116),
    Color::rgb(196, 104, 112),
    Color::rgb(148, 124, 192),
    Color::rgb(206, 186, 96),
    Color::rgb(96, 172, 178),
    Color::rgb(204, 140, 180),
    Color::rgb(158, 132, 110),
    Color::rgb(150, 158, 168),
];

impl MoleculeLayer {
    /// The layer of the atoms that the style selects, in time linear in their number.
    ///
    /// # Errors
    /// [`MeshError`] if the triangles do not make a mesh: if positions exceed single precision.
    pub fn new(molecule: Molecule, style: &MoleculeStyle, placement: ModelTransform) -> Result<Self, MeshError> {
        let drawn = style.selection.mask(&molecule);
        let colors = colors(&molecule, style);
        let look = Look { representation: style.representation, detail: style.detail };
        let made = surface::build(&molecule, &drawn, &colors, look, &placement)?;
        let surface = MeshLayer::new(made.mesh, Element::C.color());
        let representation = style.representation;
        Ok(Self { molecule, placement, surface, atoms: made.atoms, bonds: made.bonds, representation, wanted: None })
    }

    /// The same where `must_see` means some of the atoms only.
    pub fn wanting(self, wanted: Selection) -> Self {
        Self { wanted: Some(wanted), ..self }
    }

    /// Readable name of the atom that a triangle of the surface belongs to.
    pub fn name_of(&self, triangle: usize) -> Option<String> {
        let atom = self.surface.mesh.part(triangle)? as usize;
        (atom < self.molecule.atoms().len()).then(|| self.molecule.name_of(atom))
    }

    /// Radius of the ball that an atom is drawn as, scene units.
    pub fn radius(&self, atom: usize) -> f64 {
        self.placement.scale * surface::ball_radius(self.molecule.atoms()[atom].element, self.representation)
    }

    /// Centre of an atom, scene coordinates.
    pub fn center(&self, atom: usize) -> DVec3 {
        self.placement.apply(self.molecule.atoms()[atom].position)
    }
}

/// A colour per atom.
fn colors(molecule: &Molecule, style: &MoleculeStyle) -> Vec<Color> {
    let series = |names: Vec<&str>| {
        let mut known: Vec<&str> = Vec::new();
        let number = names.into_iter().map(|name| {
            known.iter().position(|k| *k == name).unwrap_or_else(|| {
                known.push(name);
                known.len() - 1
            })
        });
        number.map(|i| SERIES[i % SERIES.len()]).collect::<Vec<_>>()
    };
    let residues = molecule.residues();
    let of_residue = match style.color {
        MoleculeColor::Chain => series(residues.iter().map(|r| r.chain.as_str()).collect()),
        MoleculeColor::Residue => series(residues.iter().map(|r| r.name.as_str()).collect()),
        MoleculeColor::Element | MoleculeColor::One(_) => Vec::new(),
    };
    let color = |i: usize| {
        let atom = &molecule.atoms()[i];
        if let Some(paint) = style.paint.iter().rev().find(|p| p.selection.holds(molecule, i)) {
            return paint.color;
        }
        match style.color {
            MoleculeColor::Element => atom.element.color(),
            MoleculeColor::One(color) => color,
            MoleculeColor::Chain | MoleculeColor::Residue => of_residue[atom.residue as usize],
        }
    };
    (0..molecule.atoms().len()).map(color).collect()
}
