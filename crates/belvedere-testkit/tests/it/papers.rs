//! docs/papers.md assigns code and tests that exist to every equation, figure and parameter.

use std::fs;

/// A row `| item | function | test | reading |`.
struct Row<'a> {
    line: usize,
    item: &'a str,
    code: Vec<&'a str>,
    tests: Vec<&'a str>,
    reading: &'a str,
}

fn rows(document: &str) -> Vec<Row<'_>> {
    document
        .lines()
        .enumerate()
        .filter(|(_, line)| line.starts_with('|') && !line.starts_with("|-") && !line.starts_with("| item"))
        .map(|(index, line)| {
            let cells: Vec<&str> = line.trim_matches('|').split('|').map(str::trim).collect();
            assert_eq!(cells.len(), 4, "docs/papers.md:{}: a row has four cells", index + 1);
            Row { line: index + 1, item: cells[0], code: quoted(cells[1]), tests: quoted(cells[2]), reading: cells[3] }
        })
        .collect()
}

/// The `code spans` of a cell.
fn quoted(cell: &str) -> Vec<&str> {
    cell.split('`').skip(1).step_by(2).collect()
}

/// Whether `file::name` names a definition in that file of the workspace.
fn exists(reference: &str) -> bool {
    let Some((file, name)) = reference.rsplit_once("::") else { return false };
    let Ok(text) = fs::read_to_string(belvedere_testkit::workspace_root().join(file)) else { return false };
    ["fn ", "struct ", "enum ", "const ", "static ", "trait ", "def ", "class "].iter().any(|keyword| {
        text.match_indices(&format!("{keyword}{name}"))
            .any(|(at, found)| !text[at + found.len()..].starts_with(|c: char| c.is_alphanumeric() || c == '_'))
    })
}

#[test]
fn every_row_names_code_and_tests_that_exist() {
    let path = belvedere_testkit::workspace_root().join("docs/papers.md");
    let document = fs::read_to_string(&path).expect("docs/papers.md");
    let rows = rows(&document);
    assert!(rows.len() >= 40, "only {} rows: the table was not read", rows.len());
    for row in rows {
        let later = row.reading.starts_with("later:") || row.reading.starts_with("no:");
        assert!(later || !row.code.is_empty(), "docs/papers.md:{} ({}) names no code", row.line, row.item);
        assert!(later || !row.tests.is_empty(), "docs/papers.md:{} ({}) names no test", row.line, row.item);
        assert!(!row.reading.is_empty(), "docs/papers.md:{} ({}) says nothing of our reading", row.line, row.item);
        for reference in row.code.iter().chain(&row.tests) {
            assert!(exists(reference), "docs/papers.md:{} ({}): {reference} does not exist", row.line, row.item);
        }
    }
}

/// Promises of the papers that were listed as neither equation nor figure.
const PROMISES: usize = 14;

#[test]
fn every_promise_of_the_papers_is_kept_or_answered() {
    let path = belvedere_testkit::workspace_root().join("docs/papers.md");
    let document = fs::read_to_string(&path).expect("docs/papers.md");
    let (_, section) = document.split_once("## Promises that are no equation").expect("a section of promises");
    let rows = rows(section);
    assert_eq!(rows.len(), PROMISES);
    for row in rows {
        let paper = ["(Cui 2010", "(Deng 2013", "(Pasewaldt 2011"].iter().any(|name| row.item.contains(name));
        assert!(paper && row.reading.len() > 20, "{}: {}", row.item, row.reading);
    }
}

#[test]
fn a_missing_function_is_noticed() {
    assert!(exists("crates/belvedere-testkit/src/lib.rs::workspace_root"));
    assert!(!exists("crates/belvedere-testkit/src/lib.rs::workspace_roo"));
    assert!(!exists("crates/belvedere-testkit/src/nowhere.rs::workspace_root"));
}
