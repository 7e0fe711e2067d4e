//! Categories of mmCIF besides atoms: assemblies and their operations, helices and strands, orders of bonds.

use super::assembly::Described;
use super::cif::{ASSEMBLIES, COMPONENT_BONDS, GENERATED, HELICES, OPERATIONS, STRANDS, Table, Tables};
use super::structure::{Place, Stretch};
use belvedere_scene::molecule::Secondary;

/// A row of a table, by the items of its category.
struct Rows<'a, 't> {
    table: &'a Table<'t>,
    category: &'static str,
}

impl<'a, 't> Rows<'a, 't> {
    fn of(tables: &'a Tables<'t>, category: &'static str) -> Self {
        Self { table: tables.of(category), category }
    }

    /// Values of an item, by row; nothing where the item or the value is missing.
    fn column(&self, item: &str) -> impl Fn(usize) -> Option<&'t str> + use<'a, 't> {
        let (at, table) = (self.table.column(&[&format!("{}{item}", self.category)]), self.table);
        move |row| at.and_then(|k| table.rows[row].1.get(k).copied().flatten())
    }

    fn count(&self) -> usize {
        self.table.rows.len()
    }
}

/// Assemblies; chains are those of `label_asym_id`.
pub(super) fn assemblies(tables: &Tables<'_>) -> Described {
    let mut out = Described::default();
    let generated = Rows::of(tables, GENERATED);
    let [id, expression, chains] =
        ["assembly_id", "oper_expression", "asym_id_list"].map(|item| generated.column(item));
    for row in 0..generated.count() {
        let (Some(id), Some(expression), Some(chains)) = (id(row), expression(row), chains(row)) else { continue };
        let chains = chains.split(',').map(|c| c.trim().to_owned()).filter(|c| !c.is_empty()).collect();
        out.parts.push((id.to_owned(), expression.to_owned(), chains));
    }
    let named = Rows::of(tables, ASSEMBLIES);
    let [id, details, kind] = ["id", "oligomeric_details", "details"].map(|item| named.column(item));
    for row in 0..named.count() {
        if let Some((id, said)) = id(row).zip(details(row).or_else(|| kind(row))) {
            out.details.insert(id.to_owned(), said.to_owned());
        }
    }
    let operations = Rows::of(tables, OPERATIONS);
    let id = operations.column("id");
    let cells: [[_; 4]; 3] = std::array::from_fn(|i| {
        std::array::from_fn(|k| match k {
            3 => operations.column(&format!("vector[{}]", i + 1)),
            _ => operations.column(&format!("matrix[{}][{}]", i + 1, k + 1)),
        })
    });
    for row in 0..operations.count() {
        let Some(id) = id(row) else { continue };
        let values = std::array::from_fn(|i| {
            std::array::from_fn(|k| cells[i][k](row).and_then(|t| t.parse::<f64>().ok()).unwrap_or(f64::NAN))
        });
        out.operations.insert(id.to_owned(), values);
    }
    out
}

/// Helices of `struct_conf` and strands of `struct_sheet_range`, by the authors' names of chains and numbers of residues.
pub(super) fn structure(tables: &Tables<'_>) -> Vec<Stretch> {
    let mut out = Vec::new();
    for (category, kind) in [(HELICES, Secondary::Helix), (STRANDS, Secondary::Strand)] {
        let rows = Rows::of(tables, category);
        let place = |end: &str| {
            let chain = rows.column(&format!("{end}_auth_asym_id"));
            let number = rows.column(&format!("{end}_auth_seq_id"));
            let letter = rows.column(&format!("pdbx_{end}_PDB_ins_code"));
            move |row: usize| -> Option<Place> {
                Some((chain(row)?.to_owned(), number(row)?.parse().ok()?, letter(row).and_then(|t| t.chars().next())))
            }
        };
        let (from, to, conf) = (place("beg"), place("end"), rows.column("conf_type_id"));
        for row in 0..rows.count() {
            // Turns are listed beside helices.
            let is_meant =
                kind == Secondary::Strand || conf(row).is_some_and(|c| c.to_ascii_uppercase().starts_with("HELX"));
            if let Some((from, to)) = from(row).zip(to(row)).filter(|_| is_meant) {
                out.push(Stretch { kind, from, to });
            }
        }
    }
    out
}

/// Orders of bonds by names of residues and atoms; aromatic bonds, whose order is between, have the order that their form is written with.
pub(super) fn orders(tables: &Tables<'_>) -> Vec<(String, [String; 2], u8)> {
    let rows = Rows::of(tables, COMPONENT_BONDS);
    let [residue, a, b, order] = ["comp_id", "atom_id_1", "atom_id_2", "value_order"].map(|item| rows.column(item));
    let one = |row: usize| {
        let order = match order(row)?.get(..4)?.to_ascii_lowercase().as_str() {
            "sing" => 1,
            "doub" => 2,
            "trip" => 3,
            _ => return None,
        };
        Some((residue(row)?.to_owned(), [a(row)?.to_owned(), b(row)?.to_owned()], order))
    };
    (0..rows.count()).filter_map(one).collect()
}
