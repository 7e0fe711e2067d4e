//! The tables of the languages hold what the sources say, no more and no less; the window speaks the chosen language.

use crate::sources::{Literal, sources, translated, untranslated};
use crate::{app, find, opened, press, scene, settle};
use belvedere_viewer::Opening;
use egui_kittest::kittest::Queryable;
use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};

/// Name and entries of each table.
fn tables() -> Vec<(String, BTreeMap<String, String>)> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("languages");
    let mut files: Vec<PathBuf> = std::fs::read_dir(folder).expect("folder").flatten().map(|e| e.path()).collect();
    files.sort();
    let read = |file: &PathBuf| {
        let text = std::fs::read_to_string(file).expect("table");
        let name = file.file_name().unwrap_or_default().to_string_lossy().into_owned();
        let table = toml::from_str(&text).unwrap_or_else(|e| panic!("{name}: {e}"));
        (name, table)
    };
    files.iter().map(read).collect()
}

/// The places `{0}`, `{1}`, … in words.
fn places(words: &str) -> BTreeSet<String> {
    let starts = words.match_indices('{').map(|(at, _)| &words[at..]);
    starts.filter_map(|rest| Some(rest[..=rest.find('}')?].to_owned())).collect()
}

#[test]
fn each_table_has_each_text_of_the_sources_with_its_places_and_no_other() {
    let all: Vec<Literal> = sources().iter().flat_map(|(file, text)| translated(file, text)).collect();
    assert!(all.len() > 400, "only {} texts are found", all.len());
    let known: BTreeSet<&str> = all.iter().map(|literal| literal.text.as_str()).collect();
    let mut wrong = String::new();
    for (name, table) in tables() {
        let mut told = BTreeSet::new();
        for Literal { text, file, line } in &all {
            if !table.contains_key(text) && told.insert(text) {
                wrong += &format!("languages/{name} lacks {text:?} of {file}:{line}\n");
            }
        }
        for (english, words) in &table {
            if !known.contains(english.as_str()) {
                wrong += &format!("languages/{name} has {english:?}, which nothing says any more\n");
            }
            if places(english) != places(words) || words.trim().is_empty() {
                wrong += &format!("languages/{name}: {english:?} and {words:?} have other places for values\n");
            }
        }
    }
    assert!(wrong.is_empty(), "\n{wrong}");
}

#[test]
fn words_on_controls_pass_through_the_tables() {
    let found: Vec<Literal> = sources().iter().flat_map(|(file, text)| untranslated(file, text)).collect();
    let told: Vec<String> = found.iter().map(|l| format!("{}:{}: {:?} without tr", l.file, l.line, l.text)).collect();
    assert!(told.is_empty(), "\n{}", told.join("\n"));
}

#[test]
fn a_language_is_chosen_in_the_menu_applied_at_once_and_remembered() {
    let folder = tempfile::tempdir().expect("folder");
    let opening = Opening { state: Some(folder.path().join("state")), ..opened(&[scene(folder.path())]) };
    let mut harness = app(&opening);
    settle(&mut harness);
    press(&mut harness, "View");
    press(&mut harness, "Deutsch");
    find(&harness, "Ansicht");
    press(&mut harness, "Export");
    find(&harness, "Bild exportieren …");
    drop(harness);
    let mut again = app(&opening);
    settle(&mut again);
    press(&mut again, "Ansicht");
    press(&mut again, "English");
    find(&again, "File");
    drop(again);
    let mut third = app(&opening);
    settle(&mut third);
    find(&third, "File");
}

#[test]
fn the_language_of_the_system_is_spoken_unless_another_is_chosen() {
    let folder = tempfile::tempdir().expect("folder");
    let speaking = |tag: &str| Opening { language: tag.into(), ..opened(&[scene(folder.path())]) };
    let mut french = app(&speaking("fr_CH.UTF-8"));
    settle(&mut french);
    find(&french, "Couches");
    let mut unknown = app(&speaking("xx"));
    settle(&mut unknown);
    find(&unknown, "Layers");
    // Windows of two languages do not disturb each other.
    french.step();
    find(&french, "Couches");
    assert!(french.query_by_label("Layers").is_none());
}
