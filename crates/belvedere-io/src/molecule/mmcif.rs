//! mmCIF: the loop of atom sites, the bonds of `struct_conn` that share electrons, and what [`super::categories`] reads.

use super::Models;
use super::categories;
use super::cif::{BONDS, SITES, Table, tables};
use super::sites::{Site, Sites};
use belvedere_core::{Warning, WarningKind};
use belvedere_scene::molecule::{Element, Residue};
use glam::DVec3;
use std::collections::HashMap;

/// * `wanted`: models whose atoms are read; `frames`: whether the places of all models are read, too.
pub(super) fn read(text: &str, wanted: Models, frames: bool) -> Result<Sites, String> {
    let tables = tables(text)?;
    let sites = tables.of(SITES);
    let mut out = Sites::default();
    let mut models: Vec<Option<&str>> = Vec::new();
    if let Some((line, what)) = tables.cut.filter(|_| sites.rows.is_empty()) {
        return Err(format!("line {line}: {what} is not closed; it is truncated, get it again"));
    }
    let column = Columns::of(sites)?;
    for (line, row) in &sites.rows {
        let model = column.model.and_then(|k| row[k]);
        // Rows of a model stand together in most files.
        let at = match models.last() == Some(&model) {
            true => models.len(),
            false => models.iter().position(|m| *m == model).map_or_else(
                || {
                    models.push(model);
                    models.len()
                },
                |at| at + 1,
            ),
        };
        if wanted.has(at) || frames {
            let running = out.sites.len() as i64 + 1;
            let mut site = column.site(row, running).map_err(|e| format!("line {line}: {e}"))?;
            if frames {
                out.place(at, site.position);
            }
            if wanted.has(at) {
                site.model = at;
                out.sites.push(site);
            }
        }
    }
    if let Some((line, what)) = tables.cut {
        let count = sites.rows.len();
        let text =
            format!("{what} on line {line} is cut off by the end of the file; the {count} atoms before are read");
        out.warnings.push(Warning::new(WarningKind::Repaired, text).with("atoms", count as f64));
    }
    out.models = models.len().max(1);
    out.bonds = named_bonds(tables.of(BONDS), &out.sites);
    out.structure = categories::structure(&tables);
    out.assemblies = categories::assemblies(&tables);
    out.named_orders = categories::orders(&tables);
    Ok(out)
}

/// Columns of the items of an atom in a row.
struct Columns {
    group: Option<usize>,
    serial: Option<usize>,
    element: Option<usize>,
    name: usize,
    alternate: Option<usize>,
    residue: usize,
    chain: Option<usize>,
    asym: Option<usize>,
    number: Option<usize>,
    insertion: Option<usize>,
    position: [usize; 3],
    occupancy: Option<usize>,
    model: Option<usize>,
}

impl Columns {
    fn of(table: &Table<'_>) -> Result<Self, String> {
        let find = |items: &[&str]| {
            let names: Vec<String> = items.iter().map(|i| format!("{SITES}{i}")).collect();
            table.column(&names.iter().map(String::as_str).collect::<Vec<_>>())
        };
        let must = |items: &[&str]| {
            find(items).ok_or_else(|| {
                if table.rows.is_empty() {
                    "it holds no atom; a file of coordinates is needed".to_owned()
                } else {
                    format!("its atoms have no {SITES}{}; it is damaged or no file of coordinates", items[0])
                }
            })
        };
        // The authors' names are those used in papers.
        Ok(Self {
            position: [must(&["Cartn_x"])?, must(&["Cartn_y"])?, must(&["Cartn_z"])?],
            group: find(&["group_PDB"]),
            serial: find(&["id"]),
            element: find(&["type_symbol"]),
            name: must(&["auth_atom_id", "label_atom_id"])?,
            alternate: find(&["label_alt_id"]),
            residue: must(&["auth_comp_id", "label_comp_id"])?,
            chain: find(&["auth_asym_id", "label_asym_id"]),
            asym: find(&["label_asym_id", "auth_asym_id"]),
            number: find(&["auth_seq_id", "label_seq_id"]),
            insertion: find(&["pdbx_PDB_ins_code"]),
            occupancy: find(&["occupancy"]),
            model: find(&["pdbx_PDB_model_num"]),
        })
    }

    fn site(&self, row: &[Option<&str>], running: i64) -> Result<Site, String> {
        let text = |k: Option<usize>| k.and_then(|k| row[k]);
        let letter = |k: Option<usize>| text(k).and_then(|t| t.chars().next());
        let coordinate = |k: usize, axis: char| {
            let value = row[k].and_then(|t| t.parse::<f64>().ok()).filter(|v| v.is_finite());
            value.ok_or_else(|| format!("{axis} is {:?}, a number is needed", row[k].unwrap_or("?")))
        };
        let [x, y, z] = self.position;
        let name = row[self.name].unwrap_or("").to_owned();
        let stated = text(self.element).and_then(Element::from_symbol);
        let letters: String = name.chars().filter(char::is_ascii_alphabetic).take(1).collect();
        let guess = if text(self.element).is_none() { Element::from_symbol(&letters) } else { None };
        Ok(Site {
            serial: text(self.serial).and_then(|t| t.parse().ok()).unwrap_or(running),
            model: 1,
            element: stated.or(guess).unwrap_or(Element::UNKNOWN),
            name,
            asym: text(self.asym).unwrap_or("").to_owned(),
            residue: Residue {
                name: row[self.residue].unwrap_or("").to_owned(),
                number: text(self.number).and_then(|t| t.parse().ok()).unwrap_or(0),
                insertion: letter(self.insertion),
                chain: text(self.chain).unwrap_or("").to_owned(),
                hetero: text(self.group).is_some_and(|g| g.eq_ignore_ascii_case("HETATM")),
            },
            position: DVec3::new(coordinate(x, 'x')?, coordinate(y, 'y')?, coordinate(z, 'z')?),
            alternate: letter(self.alternate),
            occupancy: text(self.occupancy).and_then(|t| t.parse().ok()).filter(|o: &f64| o.is_finite()).unwrap_or(1.0),
        })
    }
}

/// Bonds of the kinds covale, disulf and metalc between atoms of the file; those to symmetric copies are ignored.
fn named_bonds(table: &Table<'_>, sites: &[Site]) -> Vec<[i64; 2]> {
    let find = |item: &str| table.column(&[&format!("{BONDS}{item}")]);
    let end = |n: u32| {
        let k = |item: &str| find(&format!("ptnr{n}_{item}"));
        Some([k("auth_asym_id")?, k("auth_seq_id")?, k("label_atom_id")?])
    };
    let (Some(kind), Some(first), Some(second)) = (find("conn_type_id"), end(1), end(2)) else { return Vec::new() };
    let symmetry = [find("ptnr1_symmetry"), find("ptnr2_symmetry")];
    let key = |s: &Site| (s.residue.chain.clone(), s.residue.number, s.name.clone());
    let known: HashMap<(String, i32, String), i64> = sites.iter().rev().map(|s| (key(s), s.serial)).collect();
    let bond = |(_, row): &(usize, Vec<Option<&str>>)| {
        let shares = row[kind].is_some_and(|k| ["covale", "disulf", "metalc"].iter().any(|b| k.starts_with(b)));
        let [here, there] = symmetry.map(|k| k.and_then(|k| row[k]));
        let serial = |[chain, number, name]: [usize; 3]| {
            let number = row[number]?.parse().ok()?;
            known.get(&(row[chain]?.to_owned(), number, row[name]?.to_owned())).copied()
        };
        (shares && here == there).then(|| Some([serial(first)?, serial(second)?])).flatten()
    };
    table.rows.iter().filter_map(bond).collect()
}
