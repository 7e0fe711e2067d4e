//! CIF as tables: the categories that are read, given as loops or as single values.
//!
//! Format: CIF 1.1 (International Tables for Crystallography G, 2.2) with the names of the PDBx dictionary.

pub(super) const SITES: &str = "_atom_site.";
pub(super) const BONDS: &str = "_struct_conn.";
pub(super) const GENERATED: &str = "_pdbx_struct_assembly_gen.";
pub(super) const OPERATIONS: &str = "_pdbx_struct_oper_list.";
pub(super) const ASSEMBLIES: &str = "_pdbx_struct_assembly.";
pub(super) const HELICES: &str = "_struct_conf.";
pub(super) const STRANDS: &str = "_struct_sheet_range.";
pub(super) const COMPONENT_BONDS: &str = "_chem_comp_bond.";
/// Categories that are read.
const CATEGORIES: [&str; 8] = [SITES, BONDS, GENERATED, OPERATIONS, ASSEMBLIES, HELICES, STRANDS, COMPONENT_BONDS];

/// Tables of the categories that are read, and what the end of the file cuts off.
#[derive(Default)]
pub(super) struct Tables<'t> {
    of: [Table<'t>; CATEGORIES.len()],
    /// Number of the line, and what ends there too early.
    pub(super) cut: Option<(usize, &'static str)>,
}

impl<'t> Tables<'t> {
    /// That of a category, which is read.
    pub(super) fn of(&self, category: &str) -> &Table<'t> {
        &self.of[CATEGORIES.iter().position(|c| *c == category).unwrap_or(0)]
    }

    fn slot(&mut self, name: &str) -> Option<&mut Table<'t>> {
        let at = CATEGORIES.iter().position(|category| is_in(name, category))?;
        Some(&mut self.of[at])
    }
}

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
    cut: Option<(usize, &'static str)>,
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
                Some(b';') if self.at == 0 || bytes[self.at - 1] == b'\n' => return Ok(self.field()),
                Some(b @ (b'\'' | b'"')) => return self.quoted(*b),
                Some(_) => return Ok(Some(self.plain())),
            }
        }
    }

    fn rest(&self) -> &'t str {
        &self.text[self.at..]
    }

    /// Nothing more: the end of the file cuts off what begins on this line.
    fn ended(&mut self, what: &'static str) {
        self.cut = Some((self.line, what));
        self.at = self.text.len();
    }

    /// Text between lines that begin with a semicolon.
    fn field(&mut self) -> Option<(usize, Token<'t>)> {
        let (line, start) = (self.line, self.at + 1);
        let Some(end) = self.text[start..].find("\n;") else {
            self.ended("a text field");
            return None;
        };
        let value = &self.text[start..start + end];
        self.line += value.matches('\n').count() + 1;
        self.at = start + end + 2;
        Some((line, Token::Value(Some(value))))
    }

    /// A quote ends where white space follows it.
    fn quoted(&mut self, quote: u8) -> Result<Option<(usize, Token<'t>)>, String> {
        let bytes = self.text.as_bytes();
        let start = self.at + 1;
        let mut end = start;
        loop {
            match bytes.get(end) {
                None => {
                    self.ended("a quote");
                    return Ok(None);
                }
                Some(b'\n') => {
                    return Err(format!("line {}: a quote is not closed; it is damaged, get it again", self.line));
                }
                Some(b) if *b == quote && bytes.get(end + 1).is_none_or(u8::is_ascii_whitespace) => break,
                Some(_) => end += 1,
            }
        }
        self.at = end + 1;
        Ok(Some((self.line, Token::Value(Some(&self.text[start..end])))))
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

/// The categories that are read, given as loops or as single values.
pub(super) fn tables(text: &str) -> Result<Tables<'_>, String> {
    let mut tables = Tables::default();
    let mut words = Words { text, at: 0, line: 1, cut: None };
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
                if value.is_none() {
                    words.cut.get_or_insert((line, "a value"));
                    break;
                }
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
    tables.cut = words.cut;
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
    if wanted && next.is_none() && !count.is_multiple_of(width) {
        // The end of the file cuts the last row.
        let row = table.rows.pop().map_or(start, |(line, _)| line);
        words.cut.get_or_insert((row, "a row"));
    } else if wanted && !count.is_multiple_of(width) {
        return Err(format!(
            "line {start}: the loop of {} has {count} values for {width} columns; it is truncated or damaged, get it again",
            table.names[0]
        ));
    }
    Ok((table, next))
}
