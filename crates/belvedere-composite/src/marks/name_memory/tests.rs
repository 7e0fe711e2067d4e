use super::*;
use belvedere_core::DVec2;
use belvedere_scene::{Color, NameSide};

fn request(text: &str, rank: f64, seen: bool) -> LabelRequest {
    LabelRequest { rank, seen, layer: 1, ..LabelRequest::new(text, DVec2::ZERO, 12.0, Color::rgb(0, 0, 0)) }
}

/// The frame after another in which all names found room.
fn after(memory: &NameMemory, patience: u32, requests: Vec<LabelRequest>) -> NameMemory {
    let choice = Choice::Next(memory, Patience(patience));
    let place = NamePlace { side: NameSide::Right, anchor: None };
    let turns = choice.turns(requests).into_iter().filter(|turn| turn.when != When::Never);
    choice.remembered(turns.map(|t| (PlacedName { id: t.request.id(), place }, t.request.seen)).collect())
}

fn texts(memory: &NameMemory) -> Vec<String> {
    memory.names().into_iter().map(|name| name.id.text).collect()
}

#[test]
fn a_name_stays_where_its_point_is_hidden_for_a_moment_and_then_stays_away_for_one() {
    let mut memory = after(&NameMemory::default(), 2, vec![request("Piz", 1.0, true)]);
    let seen = [false, false, true, false, false, false, true, true, true];
    let shown: Vec<bool> = seen
        .map(|seen| {
            memory = after(&memory, 2, vec![request("Piz", 1.0, seen)]);
            !memory.shown.is_empty()
        })
        .into();
    assert_eq!(shown, [true, true, true, true, true, false, false, false, true]);
}

#[test]
fn names_that_were_there_come_before_new_ones_unless_those_clearly_outrank_them() {
    let memory = after(&NameMemory::default(), 2, vec![request("High", 3000.0, true), request("Low", 1000.0, true)]);
    let now = |rank: f64| {
        let mut all = vec![request("New", rank, true), request("High", 3000.0, true), request("Low", 1000.0, true)];
        all.sort_by(|a, b| b.rank.total_cmp(&a.rank));
        texts(&after(&memory, 2, all))
    };
    assert_eq!(now(1500.0), ["High", "Low", "New"]);
    assert_eq!(now(2500.0), ["High", "New", "Low"]);
    assert_eq!(now(4000.0), ["High", "New", "Low"]);
    assert_eq!(now(9000.0), ["New", "High", "Low"]);
    assert_eq!(now(f64::NEG_INFINITY), ["High", "Low", "New"]);
}

#[test]
fn given_names_come_in_their_order_and_no_others_are_written() {
    let memory = after(&NameMemory::default(), 2, vec![request("A", 2.0, true), request("B", 1.0, true)]);
    let names: Vec<PlacedName> = memory.names().into_iter().rev().collect();
    let all =
        vec![request("A", 2.0, false), request("C", 9.0, true), request("B", 1.0, true), request("D", 1.0, false)];
    let turns = Choice::Given(&names).turns(all);
    let told: Vec<(&str, bool)> = turns.iter().map(|t| (t.request.text.as_str(), t.when != When::Never)).collect();
    assert_eq!(told, [("B", true), ("A", true), ("C", false)]);
}
