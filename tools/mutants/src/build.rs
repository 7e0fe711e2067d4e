//! Building the tree, and finding out which faults do not compile.

use crate::Args;
use crate::plant::Planted;
use anyhow::{Context, Result, bail, ensure};
use serde_json::Value;
use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

/// The packages of a workspace.
pub(crate) struct Packages {
    /// Root of the library of each package that has one.
    pub(crate) roots: BTreeMap<String, PathBuf>,
    /// For each package, the workspace packages that its tests are linked with, itself included.
    contains: BTreeMap<String, BTreeSet<String>>,
}

/// An executable that contains tests.
#[derive(Debug, Clone, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) struct Suite {
    /// Its package.
    pub(crate) package: String,
    /// `lib`, `bin` or `test`.
    pub(crate) kind: String,
    /// Name of the target.
    pub(crate) name: String,
    /// Path of the executable.
    pub(crate) program: PathBuf,
    /// Folder of its package, in which it is run.
    pub(crate) folder: PathBuf,
    /// Workspace packages that it is linked with.
    pub(crate) contains: BTreeSet<String>,
    /// Whether it belongs to an application.
    pub(crate) of_application: bool,
}

impl Suite {
    /// The names of its package and of its target.
    pub(crate) fn label(&self) -> String {
        format!("{} {}", self.package, if self.kind == "lib" { "unit" } else { &self.name })
    }
}

fn cargo(tree: &Path, target: &Path, args: &[&str]) -> Command {
    let mut command = Command::new(std::env::var_os("CARGO").unwrap_or_else(|| "cargo".into()));
    command
        .args(args)
        .current_dir(tree)
        .env("CARGO_TARGET_DIR", target)
        .env("CARGO_INCREMENTAL", "0")
        .stdin(Stdio::null());
    command
}

/// The packages of the workspace at `tree`.
pub(crate) fn packages(tree: &Path) -> Result<Packages> {
    let out =
        cargo(tree, Path::new("target"), &["metadata", "--format-version", "1", "--no-deps", "--offline"]).output()?;
    let metadata: Value =
        serde_json::from_slice(&out.stdout).context(String::from_utf8_lossy(&out.stderr).into_owned())?;
    let text = |v: &Value| v.as_str().unwrap_or_default().to_owned();
    let (mut roots, mut direct) = (BTreeMap::new(), BTreeMap::new());
    for package in metadata["packages"].as_array().into_iter().flatten() {
        let name = text(&package["name"]);
        for target in package["targets"].as_array().into_iter().flatten() {
            if target["kind"][0] == "lib" {
                roots.insert(name.clone(), PathBuf::from(text(&target["src_path"])));
            }
        }
        let dependencies = package["dependencies"].as_array().into_iter().flatten();
        let of_workspace = dependencies.filter(|d| d["path"].is_string());
        direct.insert(name, of_workspace.map(|d| (text(&d["name"]), d["kind"] == "dev")).collect::<Vec<_>>());
    }
    let contains = direct.keys().map(|name| (name.clone(), closure(name, &direct))).collect();
    Ok(Packages { roots, contains })
}

/// Every package that the tests of `name` are linked with: its dependencies, those of its tests, and their dependencies in turn.
fn closure(name: &str, direct: &BTreeMap<String, Vec<(String, bool)>>) -> BTreeSet<String> {
    let (mut all, mut open) = (BTreeSet::new(), vec![(name.to_owned(), true)]);
    while let Some((package, tests)) = open.pop() {
        let needed = direct.get(&package).into_iter().flatten().filter(|(_, dev)| tests || !dev);
        open.extend(needed.filter(|(n, _)| !all.contains(n)).map(|(n, _)| (n.clone(), false)));
        all.insert(package);
    }
    all
}

/// Downloads the crates that the workspace needs. Everything later is done offline.
pub(crate) fn fetch(workspace: &Path) -> Result<()> {
    let status = cargo(workspace, Path::new("target"), &["fetch", "--locked"]).status()?;
    ensure!(status.success(), "the crates that the workspace needs cannot be fetched");
    Ok(())
}

/// Compiles the libraries and returns the faults that do not compile; none if all of them compile.
pub(crate) fn refused(tree: &Path, target: &Path, args: &Args, planted: &Planted) -> Result<BTreeSet<usize>> {
    let mut command = cargo(tree, target, &["check", "--offline", "--keep-going", "--message-format=json", "--lib"]);
    command.args(args.release.then_some("--release"));
    command.args(args.planted().iter().flat_map(|p| ["-p", p])).stderr(Stdio::null());
    let out = command.output()?;
    let mut found = BTreeSet::new();
    let mut unexplained = String::new();
    for message in
        messages(&out.stdout).filter(|m| m["reason"] == "compiler-message" && m["message"]["level"] == "error")
    {
        let at = faults_at(&message["message"], planted);
        if at.is_empty() && !message["message"]["spans"].as_array().is_none_or(Vec::is_empty) {
            unexplained += message["message"]["rendered"].as_str().unwrap_or_default();
        }
        found.extend(at);
    }
    if !out.status.success() && found.is_empty() {
        bail!("the tree does not compile, and no fault is to blame:\n{unexplained}");
    }
    Ok(found)
}

fn messages(stdout: &[u8]) -> impl Iterator<Item = Value> {
    stdout.split(|b| *b == b'\n').filter_map(|line| serde_json::from_slice(line).ok())
}

/// The faults that a compiler message refers to: those under its primary spans, otherwise those under any of its spans.
fn faults_at(message: &Value, planted: &Planted) -> BTreeSet<usize> {
    let spans = message["spans"].as_array().map(Vec::as_slice).unwrap_or_default();
    let under = |primary: bool| {
        let spans = spans.iter().filter(|s| !primary || s["is_primary"] == true);
        let touches = |span: &Value, (file, range): &(PathBuf, std::ops::Range<usize>)| {
            let byte = |key: &str| span[key].as_u64().unwrap_or(0) as usize;
            span["file_name"].as_str().is_some_and(|f| Path::new(f) == file)
                && byte("byte_start") < range.end
                && range.start < byte("byte_end")
        };
        spans.flat_map(|s| planted.iter().filter(|(_, at)| touches(s, at)).map(|(id, _)| *id)).collect::<BTreeSet<_>>()
    };
    let primary = under(true);
    if primary.is_empty() { under(false) } else { primary }
}

/// Builds the tests of the packages `only`, of the whole workspace if there are none.
pub(crate) fn suites(
    tree: &Path,
    target: &Path,
    packages: &Packages,
    only: &[String],
    release: bool,
) -> Result<Vec<Suite>> {
    let args = ["test", "--offline", "--tests", "--no-run", "--message-format=json"];
    let mut command = cargo(tree, target, &args);
    command.args(release.then_some("--release"));
    match only {
        [] => command.args(["--workspace", "--exclude", env!("CARGO_PKG_NAME")]),
        only => command.args(only.iter().flat_map(|p| ["-p", p])),
    };
    let out = command.stderr(Stdio::inherit()).output()?;
    if !out.status.success() {
        let errors = messages(&out.stdout).filter(|m| m["message"]["level"] == "error");
        let text: String = errors.map(|m| m["message"]["rendered"].as_str().unwrap_or_default().to_owned()).collect();
        bail!("the tests do not compile with the faults in place:\n{text}");
    }
    let mut suites = Vec::new();
    for message in messages(&out.stdout).filter(|m| m["reason"] == "compiler-artifact" && m["profile"]["test"] == true)
    {
        let text = |v: &Value| v.as_str().unwrap_or_default().to_owned();
        let Some(program) = message["executable"].as_str() else { continue };
        let folder = PathBuf::from(text(&message["manifest_path"])).parent().context("a folder")?.to_owned();
        let manifest = std::fs::read_to_string(folder.join("Cargo.toml"))?;
        let name = manifest.lines().find_map(|l| l.strip_prefix("name = ")).context("a package has a name")?;
        let package = name.trim_matches('"').to_owned();
        suites.push(Suite {
            contains: packages.contains.get(&package).cloned().unwrap_or_default(),
            of_application: folder.starts_with(tree.join("apps")),
            kind: text(&message["target"]["kind"][0]),
            name: text(&message["target"]["name"]),
            program: program.into(),
            package,
            folder,
        });
    }
    suites.sort();
    Ok(suites)
}
