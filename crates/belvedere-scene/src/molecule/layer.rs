//! A molecule as a layer: which atoms are drawn, how, and which must be seen.

use super::secondary::Secondary;
use super::surface::{self, Look};
use super::trace::{ByResidue, traces};
use super::{Element, ModelTransform, Molecule, MoleculeColor, MoleculeStyle, Representation, Selection, Shown};
use crate::{Color, MeshError, MeshLayer};
use glam::DVec3;
use std::collections::HashMap;
use std::sync::Arc;

/// A molecule and its surface. The surface is made once; it is bent, drawn and picked, and hides points, like any mesh.
#[derive(Debug, Clone)]
pub struct MoleculeLayer {
    /// All atoms of the file, drawn or not, angstrom.
    pub molecule: Arc<Molecule>,
    /// Placement in the scene.
    pub placement: ModelTransform,
    /// Triangles of the drawn atoms and bonds, scene coordinates. A triangle's part ([`crate::Mesh::part`]) is the index of its atom.
    pub surface: MeshLayer,
    /// Atoms that are drawn.
    pub atoms: usize,
    /// Bonds that are drawn as rods: those whose atoms both are balls, none where atoms fill space.
    pub bonds: usize,
    /// What atoms are shown as.
    pub representation: Representation,
    /// What each atom is drawn as.
    pub shown: Arc<Vec<Shown>>,
    /// Places of the atoms in the models of a film; `None` = they stay where they are.
    pub film: Option<Arc<MoleculeFilm>>,
    /// Height of the names of residues; `None` = none are written.
    pub label_px: Option<f64>,
    /// The atoms that `must_see` means; `None` = all that are drawn.
    pub wanted: Option<Selection>,
}

/// Models of a molecule that are shown one after the other; the last one stays.
#[derive(Debug, Clone, PartialEq)]
pub struct MoleculeFilm {
    /// Places of the atoms in each model, angstrom.
    pub models: Vec<Vec<DVec3>>,
    /// Models per second of the film, > 0.
    pub models_per_s: f64,
    /// How each is drawn.
    pub style: MoleculeStyle,
}

impl MoleculeFilm {
    /// Number of the model at a time, seconds; `None` without models.
    fn model_at(&self, t: f64) -> Option<usize> {
        Some(((t * self.models_per_s + 1e-9).max(0.0) as usize).min(self.models.len().checked_sub(1)?))
    }

    /// Time at which the last model comes, seconds.
    pub fn end(&self) -> f64 {
        self.models.len().saturating_sub(1) as f64 / self.models_per_s
    }
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
    pub fn new(
        molecule: impl Into<Arc<Molecule>>,
        style: &MoleculeStyle,
        placement: ModelTransform,
    ) -> Result<Self, MeshError> {
        let molecule: Arc<Molecule> = molecule.into();
        let representation = style.representation.of(&molecule);
        let style = &MoleculeStyle { representation, ..style.clone() };
        let drawn = style.selection.mask(&molecule);
        let sticks = style.sticks.as_ref().map(|s| s.mask(&molecule)).unwrap_or_default();
        let colors = colors(&molecule, style, &drawn);
        let look = Look { representation, detail: style.detail, orders: style.orders };
        let made = surface::build(&molecule, (&drawn, &sticks), &colors, look, &placement)?;
        let surface = MeshLayer::new(made.mesh, Element::C.color());
        let (atoms, bonds, shown) = (made.atoms, made.bonds, Arc::new(made.shown));
        Ok(Self {
            molecule,
            placement,
            surface,
            atoms,
            bonds,
            representation,
            shown,
            film: None,
            label_px: None,
            wanted: None,
        })
    }

    /// The same whose atoms move, at the first model.
    pub fn filmed(self, film: MoleculeFilm) -> Self {
        Self { film: Some(Arc::new(film)), ..self }
    }

    /// The layer at a time of its film, seconds; `None` if it has none.
    ///
    /// # Errors
    /// As [`MoleculeLayer::new`].
    pub fn at(&self, t: f64) -> Option<Result<Self, MeshError>> {
        let film = self.film.as_ref()?;
        let molecule = self.molecule.at(&film.models[film.model_at(t)?]);
        let made = Self::new(molecule, &film.style, self.placement);
        let keep = |mut made: Self| {
            made.surface.opacity = self.surface.opacity;
            Self { film: self.film.clone(), label_px: self.label_px, wanted: self.wanted.clone(), ..made }
        };
        Some(made.map(keep))
    }

    /// The middle of the atoms that must be seen, or else of all that are drawn, at a time of its film, seconds; scene coordinates. `None`
    /// without any.
    pub fn middle(&self, t: f64) -> Option<DVec3> {
        let places = self.film.as_ref().and_then(|film| film.models.get(film.model_at(t)?));
        let wanted = self.wanted.as_ref().map(|wanted| wanted.mask(&self.molecule));
        let is_meant = |i: usize| match &wanted {
            Some(mask) => mask[i],
            None => self.stand_in(i).is_some(),
        };
        let place = |i: usize| places.map_or(self.molecule.atoms()[i].position, |places| places[i]);
        let meant = (0..self.molecule.atoms().len()).filter(|&i| is_meant(i));
        let (sum, count) = meant.fold((DVec3::ZERO, 0), |(sum, count), i| (sum + place(i), count + 1));
        (count > 0).then(|| self.placement.apply(sum / f64::from(count)))
    }

    /// The same where `must_see` means some of the atoms only.
    pub fn wanting(self, wanted: Selection) -> Self {
        Self { wanted: Some(wanted), ..self }
    }

    /// Readable name of the atom that a triangle of the surface belongs to; of ribbons that of the residue.
    pub fn name_of(&self, triangle: usize) -> Option<String> {
        let atom = self.surface.mesh.part(triangle)? as usize;
        let is_ribbon = matches!(self.shown.get(atom), Some(Shown::Ribbon(_)));
        let name = |atom| match is_ribbon {
            true => self.molecule.residue_of(atom).to_string(),
            false => self.molecule.name_of(atom),
        };
        (atom < self.molecule.atoms().len()).then(|| name(atom))
    }

    /// The atom whose triangles show an atom: itself, or the one at which the ribbon of its residue stands; `None` if it is not drawn.
    pub fn stand_in(&self, atom: usize) -> Option<usize> {
        match self.shown.get(atom)? {
            Shown::Not => None,
            Shown::Ball | Shown::Surface => Some(atom),
            Shown::Ribbon(other) => Some(*other as usize),
        }
    }

    /// Whether an atom is drawn as a ball, alone or with rods; ribbons and smooth surfaces are none.
    pub fn is_ball(&self, atom: usize) -> bool {
        matches!(self.shown.get(atom), Some(Shown::Ball))
    }

    /// Whether the triangles of each atom show one that a selection means.
    pub fn mask_of(&self, selection: &Selection) -> Vec<bool> {
        let mut out = vec![false; self.molecule.atoms().len()];
        for i in (0..out.len()).filter(|&i| selection.holds(&self.molecule, i)) {
            if let Some(stand_in) = self.stand_in(i) {
                out[stand_in] = true;
            }
        }
        out
    }

    /// Radius of the ball that an atom is drawn as, scene units; of ribbons half their thickness.
    pub fn radius(&self, atom: usize) -> f64 {
        let shown = self.shown.get(atom).copied().unwrap_or_default();
        self.placement.scale * surface::radius(self.molecule.atoms()[atom].element, shown, self.representation)
    }

    /// Centre of an atom, scene coordinates.
    pub fn center(&self, atom: usize) -> DVec3 {
        self.placement.apply(self.molecule.atoms()[atom].position)
    }
}

/// Colours of helices, strands and all else.
const STRUCTURE: [Color; 3] = [Color::rgb(206, 206, 202), Color::rgb(214, 88, 108), Color::rgb(226, 184, 74)];

/// A colour per atom.
fn colors(molecule: &Molecule, style: &MoleculeStyle, drawn: &[bool]) -> Vec<Color> {
    let series = |names: Vec<&str>| {
        let mut known: HashMap<&str, usize> = HashMap::new();
        let number = names.into_iter().map(|name| {
            let next = known.len();
            *known.entry(name).or_insert(next)
        });
        number.map(|i| SERIES[i % SERIES.len()]).collect::<Vec<_>>()
    };
    let residues = molecule.residues();
    let auto = match style.representation {
        Representation::Ribbon | Representation::Surface => MoleculeColor::Chain,
        _ => MoleculeColor::Element,
    };
    let by = if style.color == MoleculeColor::Auto { auto } else { style.color };
    let of_residue = match by {
        MoleculeColor::Chain => series((0..residues.len()).map(|r| molecule.chain_in_file(r)).collect()),
        MoleculeColor::Residue => series(residues.iter().map(|r| r.name.as_str()).collect()),
        MoleculeColor::Structure => {
            let mut out = vec![STRUCTURE[0]; residues.len()];
            for link in traces(molecule, drawn, &ByResidue::of(molecule)).iter().flat_map(|t| &t.links) {
                out[link.residue as usize] = match link.structure {
                    Secondary::Coil => STRUCTURE[0],
                    Secondary::Helix => STRUCTURE[1],
                    Secondary::Strand => STRUCTURE[2],
                };
            }
            out
        }
        MoleculeColor::Auto | MoleculeColor::Element | MoleculeColor::One(_) => Vec::new(),
    };
    let color = |i: usize| {
        let atom = &molecule.atoms()[i];
        if let Some(paint) = style.paint.iter().rev().find(|p| p.selection.holds(molecule, i)) {
            return paint.color;
        }
        // Balls and rods beside ribbons are told by their elements, all but carbon.
        let beside = style.color == MoleculeColor::Auto
            && by == MoleculeColor::Chain
            && atom.element != Element::C
            && (residues[atom.residue as usize].hetero || style.sticks.as_ref().is_some_and(|s| s.holds(molecule, i)))
            && style.representation == Representation::Ribbon;
        match by {
            MoleculeColor::One(color) => color,
            MoleculeColor::Auto | MoleculeColor::Element => atom.element.color(),
            _ if beside => atom.element.color(),
            MoleculeColor::Chain | MoleculeColor::Residue | MoleculeColor::Structure => {
                of_residue[atom.residue as usize]
            }
        }
    };
    (0..molecule.atoms().len()).map(color).collect()
}

#[cfg(test)]
mod tests;
