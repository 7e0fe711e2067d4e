//! Biological assemblies: which chains are copied by which operations, as files describe them. Nothing is copied before it is asked for.

use crate::Limits;
use belvedere_core::DVec3;
use belvedere_scene::Molecule;
use belvedere_scene::molecule::{Copies, Operation};
use glam::DMat3;
use std::collections::HashMap;

/// Most copies of an assembly. Capsids have 60, the largest in the Protein Data Bank some thousands.
pub const MOST_COPIES: u64 = 10_000;

/// Bytes of an atom of a copy, with its share of residues and bonds, reckoned from their sizes.
const PER_ATOM: u64 = 250;

/// An assembly of a file.
#[derive(Debug, Clone, PartialEq)]
pub struct Assembly {
    /// Its name: `1`.
    pub id: String,
    /// What the file says of it: `author_defined_assembly`, `180-meric`; possibly empty.
    pub details: String,
    /// Copies of the chain that is copied most often.
    pub copies: u64,
    /// Atoms of all copies.
    pub atoms: u64,
    parts: Vec<Part>,
}

/// Residues that are copied by the operations of an expression.
#[derive(Debug, Clone, PartialEq)]
struct Part {
    residues: Vec<[u32; 2]>,
    expression: Expression,
}

/// The assemblies of a file, and the operations that they name.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Assemblies {
    list: Vec<Assembly>,
    operations: HashMap<String, Operation>,
}

/// Groups of names whose products are meant; in each group names and ranges of numbers: `(1-60)`, `(X0)(1-5)`, `1,2,5`.
#[derive(Debug, Clone, PartialEq)]
struct Expression {
    groups: Vec<Vec<Names>>,
}

#[derive(Debug, Clone, PartialEq)]
enum Names {
    One(String),
    Range(u64, u64),
}

impl Names {
    fn count(&self) -> u64 {
        match self {
            Self::One(_) => 1,
            Self::Range(from, to) => (to - from).saturating_add(1),
        }
    }
}

impl Expression {
    /// Reads an expression; the error is a part of a sentence.
    fn parse(text: &str) -> Result<Self, String> {
        let bad = || {
            let short: String = text.chars().take(60).collect();
            format!("the expression of operations {short:?} cannot be read; it is damaged")
        };
        let compact: String = text.chars().filter(|c| !c.is_whitespace()).collect();
        let mut groups = Vec::new();
        let mut rest = compact.as_str();
        while !rest.is_empty() {
            let (group, after) = match rest.strip_prefix('(') {
                Some(inner) => inner.split_once(')').ok_or_else(bad)?,
                None => rest.split_at(rest.find('(').unwrap_or(rest.len())),
            };
            let names = group.trim_matches(',').split(',').map(Self::names).collect::<Option<Vec<_>>>();
            groups.push(names.ok_or_else(bad)?);
            rest = after;
        }
        if groups.is_empty() { Err(bad()) } else { Ok(Self { groups }) }
    }

    fn names(text: &str) -> Option<Names> {
        if text.is_empty() || text.contains(['(', ')']) {
            return None;
        }
        let range = text.split_once('-').and_then(|(a, b)| Some((a.parse::<u64>().ok()?, b.parse::<u64>().ok()?)));
        match range {
            Some((from, to)) => (from <= to).then_some(Names::Range(from, to)),
            None => Some(Names::One(text.to_owned())),
        }
    }

    /// Number of operations, without making any.
    fn count(&self) -> u64 {
        let of = |group: &Vec<Names>| group.iter().map(Names::count).fold(0u64, u64::saturating_add);
        self.groups.iter().map(of).fold(1, u64::saturating_mul)
    }

    /// The operations; the last group is done first.
    fn operations(&self, known: &HashMap<String, Operation>) -> Result<Vec<Operation>, String> {
        let find = |name: &str| {
            known
                .get(name)
                .copied()
                .ok_or_else(|| format!("operation {name:?} has no matrix in the file; it is damaged"))
        };
        let mut all = vec![Operation::IDENTITY];
        for group in &self.groups {
            let mut own = Vec::new();
            for names in group {
                match names {
                    Names::One(name) => own.push(find(name)?),
                    Names::Range(from, to) => {
                        for number in *from..=*to {
                            own.push(find(&number.to_string())?);
                        }
                    }
                }
            }
            all = all.iter().flat_map(|outer| own.iter().map(|inner| outer.after(inner))).collect();
        }
        Ok(all)
    }
}

/// Assemblies as a file names them, before its residues are known.
#[derive(Debug, Clone, Default)]
pub(super) struct Described {
    /// Name, expression of operations, chains; several of one name belong together.
    pub(super) parts: Vec<(String, String, Vec<String>)>,
    pub(super) details: HashMap<String, String>,
    pub(super) operations: HashMap<String, [[f64; 4]; 3]>,
}

impl Described {
    /// The assemblies of a molecule, of whose residues each has the name of a chain as the description knows it. With one sentence about
    /// each that cannot be understood.
    pub(super) fn of(self, molecule: &Molecule, chains: &[String]) -> (Assemblies, Vec<String>) {
        let mut sizes = vec![0u64; molecule.residues().len()];
        molecule.atoms().iter().for_each(|a| sizes[a.residue as usize] += 1);
        let mut ranges: HashMap<&str, (Vec<[u32; 2]>, u64)> = HashMap::new();
        for (r, chain) in chains.iter().enumerate() {
            let (list, atoms) = ranges.entry(chain).or_default();
            *atoms += sizes[r];
            match list.last_mut() {
                Some(last) if last[1] == r as u32 => last[1] += 1,
                _ => list.push([r as u32, r as u32 + 1]),
            }
        }
        let mut out = Assemblies {
            operations: self.operations.iter().map(|(k, m)| (k.clone(), operation(m))).collect(),
            list: Vec::new(),
        };
        let mut complaints = Vec::new();
        for (id, expression, names) in &self.parts {
            let expression = match Expression::parse(expression) {
                Ok(expression) => expression,
                Err(reason) => {
                    complaints.push(format!("assembly {id}: {reason}"));
                    continue;
                }
            };
            let mut residues = Vec::new();
            let mut atoms = 0u64;
            let mut seen: Vec<&str> = names.iter().map(String::as_str).collect();
            seen.sort_unstable();
            seen.dedup();
            for (list, count) in seen.into_iter().filter_map(|name| ranges.get(name)) {
                residues.extend_from_slice(list);
                atoms += count;
            }
            if residues.is_empty() {
                continue;
            }
            residues.sort_unstable();
            let copies = expression.count();
            let at = out.list.iter().position(|a| a.id == *id).unwrap_or_else(|| {
                let details = self.details.get(id).cloned().unwrap_or_default();
                out.list.push(Assembly { id: id.clone(), details, copies: 0, atoms: 0, parts: Vec::new() });
                out.list.len() - 1
            });
            let assembly = &mut out.list[at];
            assembly.copies = assembly.copies.max(copies);
            assembly.atoms = assembly.atoms.saturating_add(atoms.saturating_mul(copies));
            assembly.parts.push(Part { residues, expression });
        }
        (out, complaints)
    }
}

fn operation(m: &[[f64; 4]; 3]) -> Operation {
    let column = |k: usize| DVec3::new(m[0][k], m[1][k], m[2][k]);
    Operation { turn: DMat3::from_cols(column(0), column(1), column(2)), to: column(3) }
}

impl Assemblies {
    /// All, in the order of the file.
    pub fn list(&self) -> &[Assembly] {
        &self.list
    }

    /// The operations of an assembly, those of all its parts one after the other.
    ///
    /// # Errors
    /// One sentence, as of [`Assemblies::assemble`].
    pub fn operations(&self, id: &str) -> Result<Vec<Operation>, String> {
        Ok(self.copies(id)?.into_iter().flat_map(|c| c.operations).collect())
    }

    /// The molecule of an assembly, made of the molecule of the file.
    ///
    /// # Errors
    /// One sentence: no assembly has that name, it has more than [`MOST_COPIES`] copies, takes more memory than allowed, names operations
    /// that do not exist or distort, or has too many atoms.
    pub fn assemble(&self, molecule: &Molecule, id: &str, limits: &Limits) -> Result<Molecule, String> {
        let assembly = self.find(id)?;
        if assembly.atoms <= Molecule::MAX as u64 && assembly.copies <= MOST_COPIES {
            let what = format!("the {} copies of assembly {id}", assembly.copies);
            limits.ask(&what, assembly.atoms.saturating_mul(PER_ATOM)).map_err(|e| e.to_string())?;
        }
        molecule.assembled(&self.copies(id)?).map_err(|e| format!("assembly {id}: {e}"))
    }

    fn find(&self, id: &str) -> Result<&Assembly, String> {
        self.list.iter().find(|a| a.id == id).ok_or_else(|| {
            let known: Vec<&str> = self.list.iter().take(20).map(|a| a.id.as_str()).collect();
            let short: String = id.chars().take(40).collect();
            match known.is_empty() {
                true => format!("there is no assembly {short:?}, the file describes none; leave it out"),
                false => {
                    format!("there is no assembly {short:?}, the file describes {}; name one of them", known.join(", "))
                }
            }
        })
    }

    fn copies(&self, id: &str) -> Result<Vec<Copies>, String> {
        let assembly = self.find(id)?;
        if assembly.copies > MOST_COPIES {
            return Err(format!(
                "assembly {id} has {} copies, at most {MOST_COPIES} are made; draw the molecule of the file, or another assembly",
                assembly.copies
            ));
        }
        if assembly.atoms > Molecule::MAX as u64 {
            return Err(format!(
                "assembly {id} has {} atoms, at most {} are possible; draw the molecule of the file, or another assembly",
                assembly.atoms,
                Molecule::MAX
            ));
        }
        let of = |part: &Part| {
            let operations = part.expression.operations(&self.operations).map_err(|e| format!("assembly {id}: {e}"))?;
            if operations.iter().any(|o| !o.is_rigid()) {
                return Err(format!("assembly {id}: a matrix is no rotation; the file is damaged"));
            }
            Ok(Copies { residues: part.residues.clone(), operations })
        };
        assembly.parts.iter().map(of).collect()
    }
}

#[cfg(test)]
mod tests;
