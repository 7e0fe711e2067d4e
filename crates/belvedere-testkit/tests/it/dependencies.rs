//! Every external crate of the workspace is justified in docs/dependencies.md, and nothing else is.

use std::collections::BTreeSet;

fn read(relative: &str) -> String {
    let path = belvedere_testkit::workspace_root().join(relative);
    std::fs::read_to_string(&path).unwrap_or_else(|e| panic!("{}: {e}", path.display()))
}

#[test]
fn every_dependency_is_justified_in_one_line() {
    let manifest = read("Cargo.toml");
    let section = manifest.split("[workspace.dependencies]").nth(1).expect("section").split("\n[").next().expect("end");
    let used: BTreeSet<&str> = section
        .lines()
        .filter_map(|line| line.split_once('=').map(|(name, _)| name.trim()))
        .filter(|name| !name.starts_with("belvedere"))
        .collect();
    let document = read("docs/dependencies.md");
    let justified: BTreeSet<&str> = document
        .lines()
        .filter_map(|line| line.strip_prefix("- "))
        .filter_map(|line| line.split_whitespace().next())
        .collect();
    assert_eq!(used, justified, "left: Cargo.toml, right: docs/dependencies.md");
}
