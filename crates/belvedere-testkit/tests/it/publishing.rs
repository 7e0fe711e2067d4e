//! What publishing asks of a crate: `cargo publish --dry-run` is tried by tools/release, these are its reasons to fail that need no build.

use std::path::{Path, PathBuf};
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

/// Fonts below a folder, but for what is built.
fn fonts(folder: &Path, found: &mut Vec<PathBuf>) {
    for entry in std::fs::read_dir(folder).expect("folder").flatten() {
        let path = entry.path();
        let hidden = entry.file_name().to_string_lossy().starts_with('.') || entry.file_name() == "target";
        if path.is_dir() && !hidden {
            fonts(&path, found);
        } else if path.extension().is_some_and(|e| e == "ttf" || e == "otf") {
            found.push(path);
        }
    }
}

#[cfg(target_os = "linux")]
#[test]
fn the_licence_of_a_font_that_is_compiled_in_travels_with_archives_wheels_and_pages() {
    let root = belvedere_testkit::workspace_root();
    let mut found = Vec::new();
    fonts(&root, &mut found);
    assert!(!found.is_empty(), "the letters of names are a font");
    let run =
        Command::new(root.join("tools/licences")).arg("belvedere-composite").output().expect("tools/licences runs");
    let written = String::from_utf8_lossy(&run.stdout);
    assert!(run.status.success(), "{}", String::from_utf8_lossy(&run.stderr));
    for font in found {
        let beside = std::fs::read_dir(font.parent().expect("a folder")).expect("folder").flatten();
        let licences: Vec<_> = beside.map(|e| e.path()).filter(|p| p.extension().is_some_and(|e| e == "txt")).collect();
        assert!(!licences.is_empty(), "{}: no licence beside it", font.display());
        for licence in licences {
            let text = std::fs::read_to_string(&licence).expect("text");
            assert!(written.contains(text.trim()), "tools/licences leaves out {}", licence.display());
        }
    }
    for script in ["tools/release", "python/build-wheel", "apps/viewer/web/build"] {
        let script = std::fs::read_to_string(root.join(script)).expect("a script");
        assert!(script.lines().any(|line| line.trim().starts_with("tools/licences")), "the licences are left out");
    }
}
