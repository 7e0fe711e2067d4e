//! What is remembered of names from one frame of a film to the next, and the order in which they find room.

use crate::marks::request::LabelRequest;
use belvedere_scene::{NameId, NamePlace, PlacedName};
use std::collections::{HashMap, HashSet};

/// How much more a name must count than another to take its place, as a share of the larger rank.
const CLEARLY: f64 = 0.5;

/// The names of a frame, and those that went shortly before.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct NameMemory {
    shown: Vec<Shown>,
    /// Names that went, and for how many more placings they stay away.
    away: HashMap<NameId, u32>,
}

#[derive(Debug, Clone, PartialEq)]
struct Shown {
    name: PlacedName,
    /// Placings for which something has hidden its point.
    hidden: u32,
}

impl NameMemory {
    /// The names of the frame, in the order in which they found room.
    pub fn names(&self) -> Vec<PlacedName> {
        self.shown.iter().map(|shown| shown.name.clone()).collect()
    }
}

/// How the names of a picture are chosen.
#[derive(Debug, Clone, Copy)]
pub(crate) enum Choice<'a> {
    /// All that find room.
    Free,
    /// Those of a frame that were placed before.
    Given(&'a [PlacedName]),
    /// Those of the next frame of a film.
    Next(&'a NameMemory, Patience),
}

/// Placings for which a hidden name stays, and for which a name that went stays away.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Patience(pub u32);

/// A text that waits for room.
#[derive(Debug, PartialEq)]
pub(crate) struct Turn {
    pub(crate) request: LabelRequest,
    pub(crate) when: When,
}

/// When a text finds room.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum When {
    /// In its turn.
    InTurn,
    /// In its turn at the place that it had; if that is taken, after all other turns.
    Held(NamePlace),
    /// After all other turns.
    Last,
    /// It is not written, its marker alone is kept clear.
    Never,
}

impl Choice<'_> {
    /// Whether texts are asked for whose points are hidden.
    pub(crate) fn asks_for_hidden(&self) -> bool {
        !matches!(self, Self::Free)
    }

    /// The place of a name of a line in the frame before, or in this one.
    pub(crate) fn held_line(&self, layer: u32, text: &str) -> Option<NamePlace> {
        let is_it = |name: &&PlacedName| name.id.layer == layer && name.place.anchor.is_some() && name.id.text == text;
        match self {
            Self::Free => None,
            Self::Given(names) => names.iter().find(is_it).map(|name| name.place),
            Self::Next(memory, _) => memory.shown.iter().map(|shown| &shown.name).find(is_it).map(|name| name.place),
        }
    }

    /// The texts in the order in which they find room.
    /// * `requests`: the most important of a layer first.
    pub(crate) fn turns(&self, requests: Vec<LabelRequest>) -> Vec<Turn> {
        match self {
            Self::Free => requests.into_iter().map(|request| Turn { request, when: When::InTurn }).collect(),
            Self::Given(names) => given(names, requests),
            Self::Next(memory, patience) => next(memory, *patience, requests),
        }
    }

    /// What is remembered of a frame whose names found these places.
    /// * `placed`: names with whether their points are seen, in the order in which they found room.
    pub(crate) fn remembered(&self, placed: Vec<(PlacedName, bool)>) -> NameMemory {
        let Self::Next(before, Patience(patience)) = self else { return NameMemory::default() };
        let hidden: HashMap<&NameId, u32> = before.shown.iter().map(|s| (&s.name.id, s.hidden)).collect();
        let shown: Vec<Shown> = placed
            .into_iter()
            .map(|(name, seen)| {
                let hidden = if seen { 0 } else { hidden.get(&name.id).map_or(1, |frames| frames + 1) };
                Shown { name, hidden }
            })
            .collect();
        let stayed: HashSet<&NameId> = shown.iter().map(|s| &s.name.id).collect();
        let went = before.shown.iter().map(|s| &s.name.id).filter(|id| !stayed.contains(id));
        let mut away: HashMap<NameId, u32> = went.map(|id| (id.clone(), *patience)).collect();
        away.extend(before.away.iter().filter(|(_, left)| **left > 1).map(|(id, left)| (id.clone(), left - 1)));
        away.retain(|_, left| *left > 0);
        NameMemory { shown, away }
    }
}

fn given(names: &[PlacedName], requests: Vec<LabelRequest>) -> Vec<Turn> {
    let order: HashMap<&NameId, usize> = names.iter().enumerate().map(|(i, name)| (&name.id, i)).collect();
    let mut turns: Vec<(usize, Turn)> = requests
        .into_iter()
        .filter_map(|request| {
            let number = order.get(&request.id()).copied();
            let when = number.map_or(When::Never, |i| When::Held(names[i].place));
            (number.is_some() || request.seen).then_some((number.unwrap_or(usize::MAX), Turn { request, when }))
        })
        .collect();
    turns.sort_by_key(|(number, _)| *number);
    turns.into_iter().map(|(_, turn)| turn).collect()
}

fn next(memory: &NameMemory, Patience(patience): Patience, requests: Vec<LabelRequest>) -> Vec<Turn> {
    let before: HashMap<&NameId, &Shown> = memory.shown.iter().map(|shown| (&shown.name.id, shown)).collect();
    let (mut held, mut new, mut silent): (Vec<Turn>, Vec<Turn>, Vec<Turn>) = Default::default();
    for request in requests {
        let id = request.id();
        match before.get(&id) {
            Some(shown) if request.seen || shown.hidden < patience => {
                held.push(Turn { request, when: When::Held(shown.name.place) });
            }
            _ if !request.seen => {}
            None if !memory.away.contains_key(&id) => new.push(Turn { request, when: When::Last }),
            _ => silent.push(Turn { request, when: When::Never }),
        }
    }
    // A new name goes before the first of its layer that it clearly outranks, else behind all names that were there.
    let mut before_held: Vec<(usize, Turn)> = new
        .into_iter()
        .map(|turn| {
            let is_less = |other: &Turn| other.request.layer == turn.request.layer && outranks(&turn, other);
            (held.iter().position(is_less).unwrap_or(held.len()), turn)
        })
        .collect();
    before_held.sort_by_key(|(place, _)| *place);
    let mut out = Vec::new();
    let mut new = before_held.into_iter().peekable();
    for (i, turn) in held.into_iter().enumerate() {
        while let Some((_, first)) = new.next_if(|(place, _)| *place <= i) {
            out.push(Turn { when: When::InTurn, ..first });
        }
        out.push(turn);
    }
    out.extend(new.map(|(_, turn)| turn));
    out.extend(silent);
    out
}

/// Whether the rank of a name is so much higher that it may take the place of another.
fn outranks(new: &Turn, other: &Turn) -> bool {
    let (a, b) = (new.request.rank, other.request.rank);
    a > b && (b == f64::NEG_INFINITY || a - b >= CLEARLY * a.abs().max(b.abs()))
}

#[cfg(test)]
mod tests;
