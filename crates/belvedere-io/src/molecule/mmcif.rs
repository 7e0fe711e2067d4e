//! mmCIF: the loop of atom sites, the bonds of `struct_conn` that share electrons, and what [`super::categories`] reads.
//!
//! Format: CIF 1.1 (International Tables for Crystallography G, 2.2) with the names of the PDBx dictionary.

use super::categories;
use super::sites::{Site, Sites};
use belvedere_scene::molecule::{Element, Residue};
use glam::DVec3;
use std::collections::HashMap;

/// A word of the file.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Token<'t> {
    /// `data_...`, `loop_`, `save_...`, `stop_`, `global_`.
    Keyword(&'t str),
    /// `_category.item`.
    Name(&'t str),
    /// A value, without its quotes; `None` for `.` and `?`.
    Value(Option<&'t str>),
}

/// Tokenizer: yields words with their line numbers.
struct Words<'t> {
    text: &'t str,
    at: usize,
    line: usize,
}

impl<'t> Words<'t> {
    /// The next word.
    fn next(&mut self) -> Result<Option<(usize, Token<'t>)>, String> {
        let bytes = self.text.as_bytes();
        loop {
            match bytes.get(self.at) {
                None => return Ok(None),
                Some(b'\n') => {
                    self.line += 1;
                    self.at += 1;
                }
                Some(b'#') => self.at += self.rest().find('\n').unwrap_or(self.rest().len()),
                Some(b) if b.is_ascii_whitespace() => self.at += 1,
                Some(b';') if self.at == 0 || bytes[self.at - 1] == b'\n' => return self.field().map(Some),
                Some(b @ (b'\'' | b'"')) => return self.quoted(*b).map(Some),
                Some(_) => return Ok(Some(self.plain())),
            }
        }
    }

    fn rest(&self) -> &'t str {
        &self.text[self.at..]
    }

    /// Text between lines that begin with a semicolon.
    fn field(&mut self) -> Result<(usize, Token<'t>), String> {
        let (line, start) = (self.line, self.at + 1);
        let end = self.text[start..]
            .find("\n;")
            .ok_or_else(|| format!("line {line}: a text field is not closed; it is truncated, get it again"))?;
        let value = &self.text[start..start + end];
        self.line += value.matches('\n').count() + 1;
        self.at = start + end + 2;
        Ok((line, Token::Value(Some(value))))
    }

    /// A quote ends where white space follows it.
    fn quoted(&mut self, quote: u8) -> Result<(usize, Token<'t>), String> {
        let bytes = self.text.as_bytes();
        let start = self.at + 1;
        let mut end = start;
        loop {
            match bytes.get(end) {
                None | Some(b'\n') => {
                    return Err(format!("line {}: a quote is not closed; it is damaged, get it again", self.line));
                }
                Some(b) if *b == quote && bytes.get(end + 1).is_none_or(u8::is_ascii_whitespace) => break,
                Some(_) => end += 1,
            }
        }
        self.at = end + 1;
        Ok((self.line, Token::Value(Some(&self.text[start..end]))))
    }

    fn plain(&mut self) -> (usize, Token<'t>) {
        let rest = self.rest();
        let word = &rest[..rest.find(|c: char| c.is_ascii_whitespace()).unwrap_or(rest.len())];
        self.at += word.len();
        let starts = |with: &str| word.get(..with.len()).is_some_and(|w| w.eq_ignore_ascii_case(with));
        let token = match word {
            "." | "?" => Token::Value(None),
            _ if word.starts_with('_') => Token::Name(word),
            _ if ["data_", "loop_", "save_", "stop_", "global_"].into_iter().any(starts) => Token::Keyword(word),
            _ => Token::Value(Some(word)),
        };
        (self.line, token)
    }
}

/// Values of a category, row by row, each with the line it begins in.
#[derive(Default)]
pub(super) struct Table<'t> {
    names: Vec<&'t str>,
    pub(super) rows: Vec<(usize, Vec<Option<&'t str>>)>,
}

impl<'t> Table<'t> {
    pub(super) fn column(&self, names: &[&str]) -> Option<usize> {
        names.iter().find_map(|n| self.names.iter().position(|have| have.eq_ignore_ascii_case(n)))
    }
}

const SITES: &str = "_atom_site.";
const BONDS: &str = "_struct_conn.";
/// Categories that are read.
const CATEGORIES: [&str; 8] = [
    SITES,
    BONDS,
    categories::GENERATED,
    categories::OPERATIONS,
    categories::ASSEMBLIES,
    categories::HELICES,
    categories::STRANDS,
    categories::COMPONENT_BONDS,
];

/// Tables of the categories that are read.
#[derive(Default)]
pub(super) struct Tables<'t>([Table<'t>; CATEGORIES.len()]);

impl<'t> Tables<'t> {
    /// That of a category, which is read.
    pub(super) fn of(&self, category: &str) -> &Table<'t> {
        &self.0[CATEGORIES.iter().position(|c| *c == category).unwrap_or(0)]
    }

    fn slot(&mut self, name: &str) -> Option<&mut Table<'t>> {
        let at = CATEGORIES.iter().position(|category| is_in(name, category))?;
        Some(&mut self.0[at])
    }
}

/// * `number`: of the model whose atoms are read, from 1; `frames`: whether the places of all models are read, too.
pub(super) fn read(text: &str, number: usize, frames: bool) -> Result<Sites, String> {
    let tables = tables(text)?;
    let sites = tables.of(SITES);
    let mut out = Sites::default();
    let mut models: Vec<Option<&str>> = Vec::new();
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
        if at == number || frames {
            let running = out.sites.len() as i64 + 1;
            let site = column.site(row, running).map_err(|e| format!("line {line}: {e}"))?;
            if frames {
                out.place(at, site.position);
            }
            if at == number {
                out.sites.push(site);
            }
        }
    }
    out.models = models.len().max(1);
    out.bonds = named_bonds(tables.of(BONDS), &out.sites);
    out.structure = categories::structure(&tables);
    out.assemblies = categories::assemblies(&tables);
    out.named_orders = categories::orders(&tables);
    Ok(out)
}

/// The categories that are read, given as loops or as single values.
fn tables(text: &str) -> Result<Tables<'_>, String> {
    let mut tables = Tables::default();
    let mut words = Words { text, at: 0, line: 1 };
    let mut blocks = 0;
    let mut pending = words.next()?;
    while let Some((line, token)) = pending {
        match token {
            Token::Keyword(word) if word.eq_ignore_ascii_case("loop_") => {
                let (table, next) = looped(&mut words)?;
                let slot = table.names.first().and_then(|n| tables.slot(n)).filter(|slot| slot.rows.is_empty());
                if let Some(slot) = slot {
                    *slot = table;
                }
                pending = next;
                continue;
            }
            Token::Keyword(word) => {
                blocks += usize::from(word.get(..5).is_some_and(|w| w.eq_ignore_ascii_case("data_")));
                // Of several structures the first with atoms is read.
                if blocks > 1 && !tables.of(SITES).rows.is_empty() {
                    break;
                }
            }
            Token::Name(name) => {
                let value = words.next()?;
                let Some((_, Token::Value(value))) = value else {
                    return Err(format!("line {line}: {name} has no value; it is truncated or damaged, get it again"));
                };
                if let Some(table) = tables.slot(name) {
                    single(table, name, value, line);
                }
            }
            Token::Value(_) => {}
        }
        pending = words.next()?;
    }
    Ok(tables)
}

fn is_in(name: &str, category: &str) -> bool {
    name.get(..category.len()).is_some_and(|n| n.eq_ignore_ascii_case(category))
}

/// Adds a value outside a loop to the only row of its category.
fn single<'t>(table: &mut Table<'t>, name: &'t str, value: Option<&'t str>, line: usize) {
    table.names.push(name);
    match table.rows.first_mut() {
        Some((_, row)) => row.push(value),
        None => table.rows.push((line, vec![value])),
    }
}

/// A word with its line number; `None` at the end of the file.
type Next<'t> = Option<(usize, Token<'t>)>;

/// Names and values after `loop_`, and the word after them. Values of other categories are passed over.
fn looped<'t>(words: &mut Words<'t>) -> Result<(Table<'t>, Next<'t>), String> {
    let start = words.line;
    let mut table = Table::default();
    let mut next = words.next()?;
    while let Some((_, Token::Name(name))) = next {
        table.names.push(name);
        next = words.next()?;
    }
    let wanted = table.names.first().is_some_and(|n| CATEGORIES.iter().any(|category| is_in(n, category)));
    let (width, mut count) = (table.names.len(), 0usize);
    while let Some((line, Token::Value(value))) = next {
        if wanted {
            if count.is_multiple_of(width) {
                table.rows.push((line, Vec::with_capacity(width)));
            }
            if let Some((_, row)) = table.rows.last_mut() {
                row.push(value);
            }
        }
        count += 1;
        next = words.next()?;
    }
    if wanted && !count.is_multiple_of(width) {
        return Err(format!(
            "line {start}: the loop of {} has {count} values for {width} columns; it is truncated or damaged, get it again",
            table.names[0]
        ));
    }
    Ok((table, next))
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
