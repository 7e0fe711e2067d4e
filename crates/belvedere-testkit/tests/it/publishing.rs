//! What publishing asks of a crate: `cargo publish --dry-run` is tried by tools/release, these are its reasons to fail that need no build.

use std::process::Command;

fn metadata() -> serde_json::Value {
    let output = Command::new(env!("CARGO"))
        .args(["metadata", "--format-version", "1", "--no-deps", "--offline"])
        .current_dir(belvedere_testkit::workspace_root())
        .output()
        .expect("cargo metadata runs");
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    serde_json::from_slice(&output.stdout).expect("cargo metadata prints JSON")
}

/// Packages that may be published.
fn published(metadata: &serde_json::Value) -> Vec<&serde_json::Value> {
    let packages = metadata["packages"].as_array().expect("packages");
    packages.iter().filter(|package| package["publish"].is_null()).collect()
}

/// Reasons why a package cannot be published.
fn reasons(package: &serde_json::Value, names: &[&str]) -> Vec<String> {
    let mut found = Vec::new();
    for key in ["description", "license", "repository"] {
        if package[key].as_str().is_none_or(str::is_empty) {
            found.push(format!("{}: no {key}", package["name"]));
        }
    }
    for dependency in package["dependencies"].as_array().expect("dependencies") {
        if !dependency["path"].is_string() {
            continue;
        }
        let (name, version) = (dependency["name"].as_str().expect("a name"), &dependency["req"]);
        match dependency["kind"].as_str() {
            Some("dev") if version != "*" => {
                found.push(format!("{} needs {name} for tests by version: a circle", package["name"]));
            }
            Some("dev") => {}
            _ if version == "*" => found.push(format!("{} needs {name} without a version", package["name"])),
            _ if *version != format!("^{}", package["version"].as_str().expect("a version")) => {
                found.push(format!("{} needs {name} {version}, not its own version", package["name"]));
            }
            _ if !names.contains(&name) => {
                found.push(format!("{} needs {name}, which is not published", package["name"]))
            }
            _ => {}
        }
    }
    found
}

#[test]
fn library_crates_can_be_published() {
    let metadata = metadata();
    let packages = published(&metadata);
    let names: Vec<&str> = packages.iter().filter_map(|package| package["name"].as_str()).collect();
    let script =
        std::fs::read_to_string(belvedere_testkit::workspace_root().join("tools/release")).expect("the script");
    let list = script.split_once("crates=\"").and_then(|(_, rest)| rest.split_once('"')).expect("a list of crates").0;
    let mut listed: Vec<&str> = list.split_whitespace().collect();
    let mut sorted = names.clone();
    listed.sort_unstable();
    sorted.sort_unstable();
    assert_eq!(listed, sorted, "left: tools/release, right: crates without publish = false");
    let found: Vec<String> = packages.iter().flat_map(|package| reasons(package, &names)).collect();
    assert_eq!(found, Vec::<String>::new());
}

#[test]
fn a_crate_that_cannot_be_published_is_noticed() {
    let metadata = metadata();
    let mut package = published(&metadata)[0].clone();
    package["description"] = "".into();
    let dependency =
        |kind: Option<&str>, req: &str| serde_json::json!({ "name": "x", "path": "/x", "kind": kind, "req": req });
    package["dependencies"] = serde_json::json!([
        dependency(None, "*"),
        dependency(Some("dev"), "^0.1.0"),
        dependency(None, "^9.0.0"),
        dependency(None, &format!("^{}", package["version"].as_str().expect("a version"))),
        dependency(Some("dev"), "*"),
    ]);
    assert_eq!(reasons(&package, &[]).len(), 5);
}

#[test]
fn packages_hold_their_sources_and_nothing_that_was_built() {
    let output = Command::new(env!("CARGO"))
        .args(["package", "--list", "--offline", "--allow-dirty", "-p", "belvedere-core"])
        .current_dir(belvedere_testkit::workspace_root())
        .output()
        .expect("cargo package runs");
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let list = String::from_utf8(output.stdout).expect("UTF-8");
    let files: Vec<&str> = list.lines().collect();
    for file in ["Cargo.toml", "src/lib.rs", "tests/it/main.rs"] {
        assert!(files.contains(&file), "{file}: {list}");
    }
    let odd = |file: &&&str| {
        file.starts_with("target") || file.starts_with('.') && **file != ".cargo_vcs_info.json" || file.contains("~")
    };
    assert_eq!(files.iter().find(odd), None);
}
