//! Helices and strands as files state them: ranges of residues.

use belvedere_scene::molecule::{Residue, Secondary};
use std::collections::HashMap;

/// A residue by chain, number and insertion letter.
pub(super) type Place = (String, i32, Option<char>);

/// A helix or a strand, from one residue to another.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Stretch {
    pub(super) kind: Secondary,
    pub(super) from: Place,
    pub(super) to: Place,
}

/// The structure of each residue; empty if nothing is stated. Stretches whose ends are not there are passed over.
pub(super) fn of(stretches: &[Stretch], residues: &[Residue]) -> Vec<Secondary> {
    let mut index: HashMap<(&str, i32, Option<char>), usize> = HashMap::new();
    for (i, r) in residues.iter().enumerate() {
        index.entry((&r.chain, r.number, r.insertion)).or_insert(i);
    }
    let find = |(chain, number, letter): &Place| index.get(&(chain.as_str(), *number, *letter)).copied();
    let mut out = vec![Secondary::Coil; residues.len()];
    let mut stated = false;
    for stretch in stretches {
        let Some((from, to)) = find(&stretch.from).zip(find(&stretch.to)) else { continue };
        if from > to || residues[from].chain != residues[to].chain {
            continue;
        }
        out[from..=to].fill(stretch.kind);
        stated = true;
    }
    if stated { out } else { Vec::new() }
}
