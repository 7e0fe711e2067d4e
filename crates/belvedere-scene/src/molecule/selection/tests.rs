use super::*;
use crate::molecule::{Atom, Residue};
use belvedere_core::DVec3;

fn sample() -> Molecule {
    let residue = |name: &str, number, insertion, chain: &str, hetero| Residue {
        name: name.into(),
        number,
        insertion,
        chain: chain.into(),
        hetero,
    };
    let residues = vec![
        residue("DA", -2, None, "A", false),
        residue("DT", 12, None, "A", false),
        residue("ALA", 12, Some('B'), "b", false),
        residue("HOH", 301, None, "A", true),
    ];
    let atom = |(i, (name, symbol, residue)): (usize, &(&str, &str, u32))| Atom {
        serial: 100 + i as i64,
        name: (*name).into(),
        element: Element::from_symbol(symbol).unwrap(),
        residue: *residue,
        position: DVec3::new(3.0 * i as f64, 0.0, 0.0),
    };
    let list = [("P", "P", 0), ("O5'", "O", 0), ("P", "P", 1), ("CA", "C", 2), ("H", "H", 2), ("O", "O", 3)];
    Molecule::new(list.iter().enumerate().map(atom).collect(), residues, &[]).unwrap()
}

#[test]
fn words_choose_the_atoms_that_people_expect() {
    let m = sample();
    for (text, expected) in [
        ("all", "111111"),
        ("none", "000000"),
        ("chain A", "111001"),
        ("chain a", "000000"),
        ("chain A,b", "111111"),
        ("chain A , b", "111111"),
        ("resi 12", "001110"),
        ("resi 12B", "000110"),
        ("resi -2", "110000"),
        ("resi -5--1", "110000"),
        ("resi -2-12", "111110"),
        ("resi 12:400", "001111"),
        ("RESN dt,hoh", "001001"),
        ("name P", "101000"),
        ("name o5'", "010000"),
        ("element p", "101000"),
        ("hydrogen", "000010"),
        ("atom 102-103,105", "001101"),
        ("water", "000001"),
        ("hetero", "000001"),
        ("not water and chain A", "111000"),
        ("chain A and not (name P or water)", "010000"),
        ("name CA or name P and resi 12", "001100"),
        ("(name CA or name P) and resi 12", "001100"),
        ("not not all", "111111"),
    ] {
        let mask = Selection::parse(text).unwrap().mask(&m);
        let found: String = mask.iter().map(|b| if *b { '1' } else { '0' }).collect();
        assert_eq!(found, expected, "{text}");
    }
    assert_eq!(Selection::dry().mask(&m), Selection::parse("not water").unwrap().mask(&m));
}

#[test]
fn texts_that_choose_nothing_are_told() {
    for (text, said) in [
        ("", "it ends too early"),
        ("chian B", "\"chian\" is no word of selections; words are chain, copy"),
        ("chain", "chain stands at the end"),
        ("chain A chain B", "\"chain\" stands where \"and\" or \"or\" is needed"),
        ("resi 5-2", "\"5-2\" is no number or range; write resi 12"),
        ("atom 5B", "\"5B\" is no number or range"),
        ("resi é", "is no number or range"),
        ("element Xy", "\"Xy\" is no element"),
        ("(all", "a parenthesis is not closed"),
        ("all)", "a parenthesis closes that none opened"),
        ("chain A,,B", "has a comma too many"),
        ("not", "it ends too early"),
    ] {
        let said_of = Selection::parse(text).unwrap_err().to_string();
        assert!(said_of.contains(said), "{text}: {said_of}");
    }
    let deep = "not ".repeat(1000) + "all";
    assert!(Selection::parse(&deep).unwrap_err().to_string().contains("more than 50 deep"));
    assert!(Selection::parse(&"(".repeat(10_000)).is_err());
}
