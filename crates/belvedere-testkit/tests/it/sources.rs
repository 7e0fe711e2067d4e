//! House rules that no lint checks.

use std::fs;
use std::path::{Path, PathBuf};

/// Largest number of lines of a source file. A longer file contains more than one idea.
const MAX_LINES: usize = 600;

fn rust_files(folder: &Path, out: &mut Vec<PathBuf>) {
    for entry in fs::read_dir(folder).expect("folder").map(|e| e.expect("entry").path()) {
        if entry.is_dir() && entry.file_name().is_some_and(|n| n != "target") {
            rust_files(&entry, out);
        } else if entry.extension().is_some_and(|e| e == "rs") {
            out.push(entry);
        }
    }
}

fn all_rust_files() -> Vec<PathBuf> {
    let mut files = Vec::new();
    for folder in ["crates", "apps", "tools", "python"] {
        rust_files(&belvedere_testkit::workspace_root().join(folder), &mut files);
    }
    assert!(files.len() > 30, "only {} source files found", files.len());
    files
}

#[test]
fn files_hold_one_idea() {
    let long: Vec<String> = all_rust_files()
        .iter()
        .map(|f| (f, fs::read_to_string(f).expect("source").lines().count()))
        .filter(|(_, lines)| *lines > MAX_LINES)
        .map(|(f, lines)| format!("{} has {lines} lines, at most {MAX_LINES}", f.display()))
        .collect();
    assert_eq!(long, Vec::<String>::new());
}

/// The one reason for which a test may be left out of `.ci/run`.
const LONG: &str = "= \"long; .ci/long runs it\"]";

#[test]
fn nothing_is_left_unfinished_or_silently_skipped() {
    // Written in two halves so that this file does not find itself.
    let marks =
        [["todo", "!("], ["unimplemented", "!("], ["#[ign", "ore"], ["FIX", "ME"], ["XX", "X:"]].map(|m| m.concat());
    let mut found = Vec::new();
    for file in all_rust_files() {
        let text = fs::read_to_string(&file).expect("source");
        for (number, line) in text.lines().enumerate() {
            if marks.iter().any(|m| line.contains(m.as_str())) && !line.contains(LONG) {
                found.push(format!("{}:{}: {}", file.display(), number + 1, line.trim()));
            }
        }
    }
    assert_eq!(found, Vec::<String>::new());
}

#[test]
fn what_draws_and_judges_names_techniques_in_one_place() {
    const NAMES: [&str; 9] = [
        "EarthCurvature",
        "TerrainDisocclusion",
        "Strip",
        "Relief",
        "SplineBend",
        "Body",
        "Own",
        "CurvedRays",
        "SplitRays",
    ];
    let (mut files, mut found, mut here) = (Vec::new(), Vec::new(), 0);
    for name in ["sight", "composite", "cpu"] {
        rust_files(&belvedere_testkit::workspace_root().join(format!("crates/belvedere-{name}/src")), &mut files);
    }
    for file in files.iter().filter(|f| f.file_name().is_some_and(|n| n != "tests.rs")) {
        let text = fs::read_to_string(file).expect("source");
        let drawing = text.split("#[cfg(test)]").next().unwrap_or_default();
        let named = NAMES.iter().filter(|name| drawing.contains(&format!("Stage::{name}"))).count();
        if file.ends_with("fast.rs") {
            here = named;
        } else if named > 0 {
            found.push(file.display().to_string());
        }
    }
    assert!(here >= 4, "fast.rs names {here} stages");
    assert_eq!(found, Vec::<String>::new());
}

#[test]
fn the_facade_names_renderers_only_where_they_are_chosen() {
    const CHOSEN: [&str; 2] = ["lib.rs", "renderers.rs"];
    let source = belvedere_testkit::workspace_root().join("crates/belvedere/src");
    let mut files = Vec::new();
    rust_files(&source, &mut files);
    let mut naming: Vec<String> = files
        .iter()
        .filter(|f| f.file_name().is_some_and(|n| n != "tests.rs"))
        .filter(|f| {
            let text = fs::read_to_string(f).expect("source");
            text.split("#[cfg(test)]").next().unwrap_or_default().contains("belvedere_cpu")
        })
        .map(|f| f.strip_prefix(&source).expect("below").to_string_lossy().replace('\\', "/"))
        .collect();
    naming.sort();
    assert_eq!(naming, CHOSEN, "the tracer, marks and tints lie below renderers");
}

/// Phrases of docs/CONVENTIONS.md, "Plain English", that hide the subject or the thing; each in two halves so that this file does not find itself.
const UNPLAIN: [[&str; 2]; 9] = [
    [" came", " to;"],
    [" came", " to."],
    [" came", " to,"],
    ["that is", " none"],
    ["is none", " of"],
    ["are none", " of"],
    ["is no value", " for"],
    ["lets one", " "],
    ["for those", " who"],
];

#[test]
fn sentences_are_plain() {
    let phrases = UNPLAIN.map(|halves| halves.concat());
    let mut found = Vec::new();
    for file in all_rust_files() {
        for (number, line) in fs::read_to_string(&file).expect("source").lines().enumerate() {
            if phrases.iter().any(|phrase| line.contains(phrase.as_str())) {
                found.push(format!("{}:{}: {}", file.display(), number + 1, line.trim()));
            }
        }
    }
    assert_eq!(found, Vec::<String>::new());
}

/// Names that say nothing of what is counted.
const EMPTY: [&str; 6] = ["FEW", "LEAST", "MANY", "MOST", "SOME", "STEPS"];

#[test]
fn constants_of_a_crate_say_what_they_count() {
    let mut found = Vec::new();
    let root = belvedere_testkit::workspace_root();
    let crates = ["crates", "apps"].map(|folder| fs::read_dir(root.join(folder)).expect("folder"));
    for folder in crates.into_iter().flatten().map(|entry| entry.expect("entry").path()) {
        let mut files = Vec::new();
        rust_files(&folder.join("src"), &mut files);
        let texts: Vec<String> = files.iter().map(|file| fs::read_to_string(file).expect("source")).collect();
        for name in EMPTY {
            let word = format!("const {name}: ");
            let count: usize = texts.iter().map(|text| text.matches(&word).count()).sum();
            if count > 1 {
                found.push(format!("{}: {count} constants are called {name}", folder.display()));
            }
        }
    }
    assert_eq!(found, Vec::<String>::new());
}
