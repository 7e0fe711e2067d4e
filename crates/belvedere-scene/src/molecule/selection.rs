//! Selections of atoms, as short texts: `chain B and resi 12-18`.

use super::{Element, Molecule};

/// A choice of atoms.
///
/// ```text
/// chain B            residues of chain B, in all its copies; lists with commas: chain A,B
/// copy 2-5           copies by number, of an assembly; copy 2 of chain B is chain B-2, too
/// resi 12-18         residue numbers and ranges of them, 12,15-18; 52A with its insertion letter
/// resn DA,DT         names of residues
/// name P             names of atoms
/// element FE         elements
/// atom 1234          numbers of atoms in the file, ranges too
/// water, hetero, hydrogen, all, none
/// and, or, not, ( )  not binds first, then and, then or
/// ```
///
/// Names of chains are case-sensitive, everything else is not.
#[derive(Debug, Clone, PartialEq)]
pub struct Selection {
    text: String,
    rule: Rule,
}

/// A text that is not a selection.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[error("selection \"{text}\": {reason}")]
pub struct SelectionError {
    /// The text, shortened.
    pub text: String,
    /// The error, and what to do.
    pub reason: String,
}

#[derive(Debug, Clone, PartialEq)]
enum Rule {
    All,
    None,
    Water,
    Hetero,
    Chain(Vec<String>),
    Copy(Vec<Numbers>),
    ResidueNumber(Vec<Numbers>),
    ResidueName(Vec<String>),
    AtomName(Vec<String>),
    Element(Vec<Element>),
    Serial(Vec<Numbers>),
    Not(Box<Rule>),
    And(Box<[Rule; 2]>),
    Or(Box<[Rule; 2]>),
}

/// A range of numbers; a single one may carry the insertion letter of a residue.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Numbers {
    from: i64,
    to: i64,
    letter: Option<char>,
}

impl Numbers {
    fn holds(&self, number: i64) -> bool {
        (self.from..=self.to).contains(&number)
    }
}

const WORDS: &str =
    "chain, copy, resi, resn, name, element, atom, water, hetero, hydrogen, all, none, and, or, not, and parentheses";

/// Deepest nesting of parentheses and `not`.
const DEEPEST: usize = 50;

impl Selection {
    /// Reads a selection.
    ///
    /// # Errors
    /// [`SelectionError`] with the word that is not understood.
    pub fn parse(text: &str) -> Result<Self, SelectionError> {
        let tokens = tokens(text);
        let mut parser = Parser { tokens: &tokens, at: 0, depth: 0 };
        let rule = parser.any().and_then(|rule| match parser.next() {
            None => Ok(rule),
            Some(")") => Err("a parenthesis closes that none opened; remove it".to_owned()),
            Some(word) => {
                Err(format!("\"{}\" stands where \"and\" or \"or\" is needed; put one before it", short(word)))
            }
        });
        rule.map(|rule| Self { text: text.trim().to_owned(), rule })
            .map_err(|reason| SelectionError { text: short(text), reason })
    }

    /// All atoms.
    pub fn all() -> Self {
        Self { text: "all".into(), rule: Rule::All }
    }

    /// All atoms but those of waters.
    pub fn dry() -> Self {
        Self { text: "not water".into(), rule: Rule::Not(Box::new(Rule::Water)) }
    }

    /// Whether an atom is chosen.
    pub fn holds(&self, molecule: &Molecule, atom: usize) -> bool {
        self.rule.holds(molecule, atom)
    }

    /// Whether each atom is chosen, by index.
    pub fn mask(&self, molecule: &Molecule) -> Vec<bool> {
        (0..molecule.atoms().len()).map(|i| self.holds(molecule, i)).collect()
    }
}

impl std::fmt::Display for Selection {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(&self.text)
    }
}

impl Rule {
    fn holds(&self, m: &Molecule, i: usize) -> bool {
        let (atom, residue) = (&m.atoms()[i], m.residue_of(i));
        let named = |names: &[String], name: &str| names.iter().any(|n| n.eq_ignore_ascii_case(name));
        match self {
            Self::All => true,
            Self::None => false,
            Self::Water => residue.is_water(),
            Self::Hetero => residue.hetero,
            Self::Chain(names) => {
                names.contains(&residue.chain)
                    || m.has_copy_at(i) && names.iter().any(|n| n == m.chain_in_file(atom.residue as usize))
            }
            Self::Copy(numbers) => numbers.iter().any(|n| n.holds(m.copy(atom.residue as usize).into())),
            Self::ResidueNumber(numbers) => numbers
                .iter()
                .any(|n| n.holds(residue.number.into()) && n.letter.is_none_or(|l| Some(l) == residue.insertion)),
            Self::ResidueName(names) => named(names, &residue.name),
            Self::AtomName(names) => named(names, &atom.name),
            Self::Element(elements) => elements.contains(&atom.element),
            Self::Serial(numbers) => numbers.iter().any(|n| n.holds(atom.serial)),
            Self::Not(rule) => !rule.holds(m, i),
            Self::And(rules) => rules.iter().all(|r| r.holds(m, i)),
            Self::Or(rules) => rules.iter().any(|r| r.holds(m, i)),
        }
    }
}

/// Words and parentheses; commas hold lists together whatever spaces stand beside them.
fn tokens(text: &str) -> Vec<String> {
    let mut out: Vec<String> = Vec::new();
    let mut join = false;
    let spaced = text.replace('(', " ( ").replace(')', " ) ").replace(',', " , ");
    for word in spaced.split_whitespace() {
        match out.last_mut() {
            Some(last) if word == "," || join => {
                last.push_str(word);
                join = word == ",";
            }
            _ => out.push(word.to_owned()),
        }
    }
    out
}

struct Parser<'t> {
    tokens: &'t [String],
    at: usize,
    depth: usize,
}

impl<'t> Parser<'t> {
    fn next(&mut self) -> Option<&'t str> {
        self.at += 1;
        self.tokens.get(self.at - 1).map(String::as_str)
    }

    /// Consumes the next word if it is `word`.
    fn takes(&mut self, word: &str) -> bool {
        let is = self.tokens.get(self.at).is_some_and(|t| t.eq_ignore_ascii_case(word));
        self.at += usize::from(is);
        is
    }

    fn any(&mut self) -> Result<Rule, String> {
        let mut rule = self.every()?;
        while self.takes("or") {
            rule = Rule::Or(Box::new([rule, self.every()?]));
        }
        Ok(rule)
    }

    fn every(&mut self) -> Result<Rule, String> {
        let mut rule = self.one()?;
        while self.takes("and") {
            rule = Rule::And(Box::new([rule, self.one()?]));
        }
        Ok(rule)
    }

    fn one(&mut self) -> Result<Rule, String> {
        self.depth += 1;
        if self.depth > DEEPEST {
            return Err(format!("it is nested more than {DEEPEST} deep; write it flatter"));
        }
        let Some(word) = self.next() else { return Err(format!("it ends too early; words are {WORDS}")) };
        let rule = match word.to_ascii_lowercase().as_str() {
            "(" => {
                let rule = self.any()?;
                if !self.takes(")") {
                    return Err("a parenthesis is not closed; add one".into());
                }
                rule
            }
            "not" => Rule::Not(Box::new(self.one()?)),
            "all" => Rule::All,
            "none" => Rule::None,
            "water" => Rule::Water,
            "hetero" => Rule::Hetero,
            "hydrogen" => Rule::Element(vec![Element::H]),
            "chain" => Rule::Chain(self.list("chain")?),
            "resn" => Rule::ResidueName(self.list("resn")?),
            "name" => Rule::AtomName(self.list("name")?),
            "copy" => Rule::Copy(self.numbers("copy")?),
            "resi" => Rule::ResidueNumber(self.numbers("resi")?),
            "atom" => Rule::Serial(self.numbers("atom")?),
            "element" => {
                let element = |s: &String| {
                    Element::from_symbol(s).ok_or_else(|| format!("\"{}\" is no element; write a symbol", short(s)))
                };
                Rule::Element(self.list("element")?.iter().map(element).collect::<Result<_, _>>()?)
            }
            _ => return Err(format!("\"{}\" is no word of selections; words are {WORDS}", short(word))),
        };
        self.depth -= 1;
        Ok(rule)
    }

    fn list(&mut self, word: &str) -> Result<Vec<String>, String> {
        let list = self.next().ok_or_else(|| format!("{word} stands at the end; name what is meant after it"))?;
        if list.split(',').any(str::is_empty) {
            return Err(format!("\"{}\" has a comma too many; write {word} A,B", short(list)));
        }
        // The empty name of a chain is written as two quotes.
        Ok(list.split(',').map(|s| if s == "\"\"" { String::new() } else { s.to_owned() }).collect())
    }

    fn numbers(&mut self, word: &str) -> Result<Vec<Numbers>, String> {
        let parse = |text: &String| {
            numbers(text, word == "resi").ok_or_else(|| {
                format!("\"{}\" is no number or range; write {word} 12, {word} 12-18 or {word} 3,12-18", short(text))
            })
        };
        self.list(word)?.iter().map(parse).collect()
    }
}

/// `12`, `-3`, `12-18`, `-5--1`, and `52A` where letters are allowed.
fn numbers(text: &str, letters: bool) -> Option<Numbers> {
    if let Ok(n) = text.parse() {
        return Some(Numbers { from: n, to: n, letter: None });
    }
    let last = text.chars().last()?;
    if letters && last.is_ascii_alphabetic() {
        let n = text[..text.len() - 1].parse().ok()?;
        return Some(Numbers { from: n, to: n, letter: Some(last) });
    }
    // The dash of the range is the first one after a digit.
    let dash = text.char_indices().skip(1).find(|(_, c)| matches!(c, '-' | ':'))?.0;
    let (from, to): (i64, i64) = (text[..dash].parse().ok()?, text[dash + 1..].parse().ok()?);
    (from <= to).then_some(Numbers { from, to, letter: None })
}

fn short(text: &str) -> String {
    text.chars().take(60).collect()
}

#[cfg(test)]
mod tests;
