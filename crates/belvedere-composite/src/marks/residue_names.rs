//! Names of residues of molecules, where they are seen.

use crate::marks::path::LinePoint;
use crate::marks::request::LabelRequest;
use crate::marks::{MarkBuilder, Marker, darker};
use belvedere_core::DVec3;
use belvedere_scene::molecule::Residue;
use belvedere_scene::{Color, Hidden, MoleculeLayer, Symbol};
use std::collections::HashSet;

/// Most residues whose names are tried.
const MOST_RESIDUES: usize = 3000;
/// Ink of names.
const INK: Color = Color::rgb(40, 44, 52);
/// Distance of a name before the surface of its atom, as a share of its radius.
const BEFORE: f64 = 1.15;

impl MarkBuilder<'_> {
    /// A name at the atom that a residue stands at (the alpha carbon, the phosphorus, else its first that is drawn), unless something
    /// hides it. Residues that must be seen come first, then every second of the others, every second of the rest, and so on, so that the
    /// names that find room are spread along the chains.
    pub(super) fn residue_names(&self, layer: &MoleculeLayer) -> Vec<LabelRequest> {
        let Some(size_px) = layer.label_px else { return Vec::new() };
        let molecule = &layer.molecule;
        let wanted = layer.wanted.as_ref().map(|w| layer.mask_of(w));
        let mut first: Vec<Option<usize>> = vec![None; molecule.residues().len()];
        for (i, atom) in molecule.atoms().iter().enumerate().filter(|(i, _)| layer.stand_in(*i).is_some()) {
            let slot = &mut first[atom.residue as usize];
            if slot.is_none() || atom.name == "CA" || atom.name == "P" {
                *slot = layer.stand_in(i);
            }
        }
        let is_wanted = |atom: usize| wanted.as_ref().is_some_and(|w| w[atom]);
        let mut all: Vec<(u32, usize)> = first
            .into_iter()
            .flatten()
            .enumerate()
            .map(|(n, atom)| (if is_wanted(atom) { 0 } else { 33 - (n as u32 + 1).trailing_zeros().min(32) }, atom))
            .collect();
        all.sort_by_key(|(rank, _)| *rank);
        let eye = self.eye;
        let mut told = HashSet::new();
        let mut requests = Vec::new();
        for (_, atom) in all.into_iter().take(MOST_RESIDUES) {
            if !told.insert(molecule.atoms()[atom].residue) {
                continue;
            }
            let center = layer.center(atom);
            let p = center + BEFORE * layer.radius(atom) * (eye - center).normalize_or(DVec3::Z);
            let marker = Marker { symbol: Symbol::Dot, half_px: 0.0, casing: false, hidden: Hidden::Cut };
            let on_line = LinePoint { p, along: 0.0, on_ground: false };
            let seen = self.mark(&on_line, 0.0, marker, &mut Vec::new());
            // Chains number their residues alike.
            let number = molecule.atoms()[atom].residue;
            requests.extend(seen.iter().map(|seen| LabelRequest {
                over: true,
                number,
                ..seen.request(name(molecule.residue_of(atom)), size_px, darker(INK))
            }));
        }
        requests
    }
}

fn name(residue: &Residue) -> String {
    format!("{} {}{}", residue.name, residue.number, residue.insertion.map(String::from).unwrap_or_default())
}
