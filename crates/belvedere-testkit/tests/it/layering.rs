//! The import rule of docs/ARCHITECTURE.md, checked with `cargo metadata`.

use std::collections::BTreeMap;
use std::process::Command;

/// Which workspace crates and which external crates each crate may depend on (dev-dependencies are free).
const RULES: &[(&str, &[&str], &[&str])] = &[
    ("belvedere-core", &[], &["glam", "schemars", "serde", "thiserror"]),
    ("belvedere-scene", &["belvedere-core"], &["glam", "rayon", "schemars", "serde", "thiserror", "web-time"]),
    ("belvedere-sight", &["belvedere-core", "belvedere-scene"], &["glam", "obvhs", "rayon", "thiserror"]),
    ("belvedere-builtin", &["belvedere-core", "belvedere-scene", "belvedere-sight"], &["rayon", "thiserror"]),
    (
        "belvedere-io",
        &["belvedere-core", "belvedere-scene"],
        &[
            "crs-definitions",
            "dbase",
            "earcut",
            "encoding_rs",
            "exr",
            "flate2",
            "geojson",
            "glam",
            "gltf",
            "gpx",
            "image-webp",
            "jpeg-encoder",
            "laz",
            "ply-rs-bw",
            "png",
            "proj4rs",
            "prost",
            "quick-xml",
            "rayon",
            "rusqlite",
            "ruzstd",
            "schemars",
            "serde",
            "serde_json",
            "sha2",
            "shapefile",
            "tempfile",
            "thiserror",
            "tiff",
            "tobj",
            "tracing",
            "weezl",
            "zip",
            "zune-core",
            "zune-jpeg",
        ],
    ),
    (
        "belvedere-disocclusion",
        &["belvedere-core", "belvedere-scene", "belvedere-sight"],
        &["glam", "pulp", "rayon", "rsparse", "rustfft", "schemars", "serde", "thiserror", "tracing"],
    ),
    (
        "belvedere-document",
        &["belvedere-core", "belvedere-io", "belvedere-scene"],
        &["clap", "schemars", "serde", "serde_json", "strsim", "thiserror", "toml", "toml_edit"],
    ),
    (
        "belvedere-construct",
        &["belvedere-core", "belvedere-scene", "belvedere-sight"],
        &["geo", "glam", "rayon", "schemars", "serde", "thiserror"],
    ),
    (
        "belvedere-composite",
        &["belvedere-core", "belvedere-scene", "belvedere-sight"],
        &["ab_glyph_rasterizer", "glam", "harfrust", "rayon", "skrifa"],
    ),
    (
        "belvedere-overlay",
        &[
            "belvedere-composite",
            "belvedere-core",
            "belvedere-disocclusion",
            "belvedere-document",
            "belvedere-scene",
            "belvedere-sight",
        ],
        &["flate2", "glam", "pdf-writer", "rayon", "schemars", "serde", "thiserror"],
    ),
    (
        "belvedere-cpu",
        &["belvedere-composite", "belvedere-core", "belvedere-scene", "belvedere-sight"],
        &["glam", "pulp", "rayon", "thiserror", "tracing"],
    ),
    (
        "belvedere-resolve",
        &[
            "belvedere-builtin",
            "belvedere-composite",
            "belvedere-construct",
            "belvedere-core",
            "belvedere-disocclusion",
            "belvedere-document",
            "belvedere-io",
            "belvedere-overlay",
            "belvedere-scene",
            "belvedere-sight",
        ],
        &["glam", "rayon", "schemars", "serde", "serde_json", "thiserror", "toml"],
    ),
    (
        "belvedere",
        &[
            "belvedere-builtin",
            "belvedere-composite",
            "belvedere-construct",
            "belvedere-core",
            "belvedere-cpu",
            "belvedere-disocclusion",
            "belvedere-document",
            "belvedere-io",
            "belvedere-overlay",
            "belvedere-resolve",
            "belvedere-scene",
            "belvedere-sight",
        ],
        &["glam", "rayon", "schemars", "serde", "serde_json", "thiserror", "toml"],
    ),
    ("belvedere-studio", &["belvedere"], &["rayon", "serde", "serde_json"]),
    (
        "belvedere-bench",
        &["belvedere", "belvedere-studio"],
        &["anyhow", "rayon", "schemars", "serde", "serde_json", "tempfile"],
    ),
    ("belvedere-gallery", &["belvedere"], &["anyhow", "plotters", "plotters-backend", "serde"]),
    (
        "belvedere-viewer",
        &["belvedere", "belvedere-studio"],
        &[
            "clap",
            "eframe",
            "rfd",
            "serde",
            "serde_json",
            "thiserror",
            "toml",
            "wasm-bindgen",
            "wasm-bindgen-futures",
            "wasm-bindgen-rayon",
            "web-sys",
        ],
    ),
    ("belvedere-testkit", &["belvedere-core", "belvedere-scene"], &["glam", "rayon"]),
    ("belvedere-fuzz", &["belvedere"], &["anyhow", "clap", "flate2", "tempfile", "zip"]),
    ("belvedere-mutants", &[], &["anyhow", "clap", "proc-macro2", "serde", "serde_json", "syn"]),
    (
        "belvedere-cli",
        &["belvedere", "belvedere-bench", "belvedere-gallery"],
        &[
            "anyhow",
            "clap",
            "clap_complete",
            "clap_mangen",
            "ctrlc",
            "indicatif",
            "serde_json",
            "signal-hook",
            "tempfile",
            "tracing",
            "tracing-subscriber",
        ],
    ),
    ("belvedere-python", &["belvedere", "belvedere-cli"], &["pyo3", "rayon", "serde", "serde_json"]),
];

fn metadata() -> serde_json::Value {
    let output = Command::new(env!("CARGO"))
        .args(["metadata", "--format-version", "1", "--no-deps", "--offline"])
        .current_dir(belvedere_testkit::workspace_root())
        .output()
        .expect("cargo metadata runs");
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    serde_json::from_slice(&output.stdout).expect("cargo metadata prints JSON")
}

/// Normal and build dependencies of every workspace crate: (workspace, external).
fn edges() -> BTreeMap<String, (Vec<String>, Vec<String>)> {
    let metadata = metadata();
    let packages = metadata["packages"].as_array().expect("packages");
    packages
        .iter()
        .map(|package| {
            let (mut workspace, mut external) = (Vec::new(), Vec::new());
            for dependency in package["dependencies"].as_array().expect("dependencies") {
                if dependency["kind"] == "dev" {
                    continue;
                }
                let name = dependency["name"].as_str().expect("name").to_owned();
                if dependency["path"].is_string() { workspace.push(name) } else { external.push(name) }
            }
            (package["name"].as_str().expect("name").to_owned(), (workspace, external))
        })
        .collect()
}

/// Every violation of the rules, one sentence each.
fn violations(edges: &BTreeMap<String, (Vec<String>, Vec<String>)>) -> Vec<String> {
    let mut found = Vec::new();
    for (package, (workspace, external)) in edges {
        let Some((_, may_workspace, may_external)) = RULES.iter().find(|(name, ..)| name == package) else {
            found.push(format!("{package} has no rule; add one to RULES and docs/ARCHITECTURE.md"));
            continue;
        };
        found.extend(
            workspace
                .iter()
                .filter(|d| !may_workspace.contains(&d.as_str()))
                .map(|d| format!("{package} may not import {d}")),
        );
        found.extend(
            external
                .iter()
                .filter(|d| !may_external.contains(&d.as_str()))
                .map(|d| format!("{package} may not use the crate {d}")),
        );
    }
    found
}

#[test]
fn dependencies_point_downwards() {
    let edges = edges();
    assert_eq!(edges.len(), RULES.len(), "every workspace crate has a rule: {:?}", edges.keys());
    assert_eq!(violations(&edges), Vec::<String>::new());
}

#[test]
fn a_forbidden_edge_is_found() {
    let mut edges = edges();
    edges.get_mut("belvedere-core").expect("core").0.push("belvedere-io".to_owned());
    edges.get_mut("belvedere-cli").expect("cli").1.push("tiff".to_owned());
    assert_eq!(violations(&edges).len(), 2);
}

#[test]
fn cargo_run_means_the_program() {
    let metadata = metadata();
    let default = metadata["workspace_default_members"].as_array().expect("default members");
    let packages = metadata["packages"].as_array().expect("packages").iter().filter(|p| default.contains(&p["id"]));
    let programs: Vec<_> = packages.filter_map(|p| p["default_run"].as_str()).collect();
    assert_eq!(programs, ["belvedere"]);
}

#[test]
fn the_program_links_no_c_library() {
    // Features that tests add are not the program's.
    let output = Command::new(env!("CARGO"))
        .args(["tree", "--locked", "--offline", "-p", "belvedere-cli", "-e", "normal,build", "--prefix", "none"])
        .current_dir(belvedere_testkit::workspace_root())
        .env_remove("CARGO_RESOLVER_FEATURE_UNIFICATION")
        .output()
        .expect("cargo tree runs");
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let tree = String::from_utf8(output.stdout).expect("UTF-8");
    assert!(tree.contains("belvedere-io "), "{tree}");
    let compilers = ["cc ", "cmake ", "pkg-config ", "libsqlite3-sys "];
    let found: Vec<&str> = tree.lines().filter(|line| compilers.iter().any(|name| line.starts_with(name))).collect();
    assert!(found.is_empty(), "{found:?} compile or link C");
}
