//! Every external crate of the workspace is justified in docs/dependencies.md, and nothing else is.

use std::collections::BTreeSet;
use std::process::Command;

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

/// Most packages that a program is built from, our own included.
const MOST: [(&str, usize); 2] = [("belvedere-cli", 205), ("belvedere-viewer", 345)];
/// Most packages in the lock file, those of tests and other systems included.
const MOST_LOCKED: usize = 563;

#[test]
fn dependencies_do_not_grow_unnoticed() {
    for (package, most) in MOST {
        let output = Command::new(env!("CARGO"))
            .args(["tree", "--locked", "--offline", "-p", package, "-e", "normal", "--prefix", "none", "--no-dedupe"])
            .args(["--target", "x86_64-unknown-linux-gnu"])
            .current_dir(belvedere_testkit::workspace_root())
            .env_remove("CARGO_RESOLVER_FEATURE_UNIFICATION")
            .output()
            .expect("cargo tree runs");
        assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
        let tree = String::from_utf8(output.stdout).expect("UTF-8");
        let packages: BTreeSet<&str> = tree.lines().filter_map(|line| line.split(" (").next()).collect();
        assert!(packages.len() > 20, "{tree}");
        assert!(packages.len() <= most, "{package} is built from {} packages, the limit is {most}", packages.len());
    }
    let locked = read("Cargo.lock").lines().filter(|line| *line == "[[package]]").count();
    assert!(locked > 100 && locked <= MOST_LOCKED, "{locked} packages in Cargo.lock, the limit is {MOST_LOCKED}");
}
