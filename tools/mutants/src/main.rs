//! Would a test notice? Plants many small faults in a copy of the workspace, each behind a switch, and builds the tests once. Then runs
//! for every fault the tests that reach its code, the most specific first, until one fails.
#![allow(clippy::print_stdout, clippy::print_stderr)]

mod build;
mod find;
mod hunt;
mod plant;
mod run;
mod table;

use anyhow::{Context, Result, ensure};
use build::Packages;
use clap::Parser;
use find::Fault;
use serde::{Deserialize, Serialize};
use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};
use std::process::Command;

/// Plants small faults in a copy of the workspace and asks whether a test notices.
///
/// Everything lies in `target/mutants`. A run that was interrupted goes on when the same command is given again;
/// `--fresh` begins anew over the present source. The table comes at the end, and into `report.md`.
#[derive(Parser)]
struct Args {
    /// Number of faults.
    #[arg(long, default_value_t = 120)]
    count: usize,
    /// Which faults: the same number over the same source gives the same ones.
    #[arg(long, default_value_t = 1)]
    seed: u64,
    /// Package to plant faults in, may be repeated.
    #[arg(long = "package", default_values_t = ["belvedere-core", "belvedere-disocclusion", "belvedere-io", "belvedere"].map(String::from))]
    packages: Vec<String>,
    /// The same number of faults from each package; else every line of them has the same chance.
    #[arg(long)]
    each: bool,
    /// With `--each`, plants only the faults drawn from this package: those that a run of all packages plants in it.
    #[arg(long, requires = "each")]
    only: Option<String>,
    /// Builds with the release profile: without checks of overflow, and with the loops of all crates optimised.
    #[arg(long)]
    release: bool,
    /// Tests that run at the same time.
    #[arg(long, default_value_t = 1)]
    jobs: usize,
    /// Leaves out tests whose name contains this, may be repeated.
    #[arg(long)]
    skip: Vec<String>,
    /// How far to go: 0 unit tests of the crate, 1 its integration tests, 2 crates above, 3 applications.
    #[arg(long, default_value_t = 3)]
    level: usize,
    /// Forgets an earlier run.
    #[arg(long)]
    fresh: bool,
    /// Lists the faults and ends.
    #[arg(long)]
    list: bool,
}

impl Args {
    /// The packages that get faults.
    fn planted(&self) -> &[String] {
        self.only.as_ref().map_or(&self.packages[..], std::slice::from_ref)
    }
}

/// The settings of a run, saved so that it can be continued.
#[derive(Debug, Serialize, Deserialize)]
struct Plan {
    seed: u64,
    count: usize,
    packages: Vec<String>,
    #[serde(default)]
    only: Option<String>,
    /// Commit of the source.
    commit: String,
    /// All faults that were tried, in the order in which they were drawn.
    faults: Vec<Fault>,
    /// Numbers of the faults that compile, at most `count`, or its share of them where only one package gets faults.
    chosen: Vec<usize>,
}

fn main() -> Result<()> {
    let args = Args::parse();
    let here = Path::new(env!("CARGO_MANIFEST_DIR"));
    let workspace = here.ancestors().nth(2).context("the tool lies two folders below the root")?;
    let target = std::env::var_os("CARGO_TARGET_DIR").map_or_else(|| workspace.join("target"), PathBuf::from);
    let home = target.join("mutants");
    std::fs::create_dir_all(&home)?;
    let path = home.join("plan.json");
    if args.fresh {
        let _ = std::fs::remove_file(&path);
    }
    let packages = build::packages(workspace)?;
    let plan: Plan = match std::fs::read(&path) {
        Ok(bytes) => {
            serde_json::from_slice(&bytes).with_context(|| format!("{}; begin with --fresh", path.display()))?
        }
        Err(_) => {
            let faults = draw(workspace, &packages, &args)?;
            if args.list {
                faults.iter().for_each(|f| println!("{}", table::line(f)));
                return Ok(());
            }
            let plan = prepare(workspace, &home, &packages, faults, &args)?;
            let _ = std::fs::remove_file(home.join("results.jsonl"));
            std::fs::write(&path, serde_json::to_vec(&plan)?)?;
            plan
        }
    };
    ensure!(
        (plan.seed, plan.count, &plan.packages, &plan.only) == (args.seed, args.count, &args.packages, &args.only),
        "an earlier run is of {} faults by seed {} in {}{}; give the same to go on with it, or --fresh",
        plan.count,
        plan.seed,
        plan.packages.join(", "),
        plan.only.iter().map(|p| format!(", only those of {p}")).collect::<String>()
    );
    eprintln!("{} faults at {}", plan.chosen.len(), plan.commit);
    let only = if args.level < 2 { args.planted() } else { &[] };
    let suites = build::suites(&home.join("tree"), &home.join("build"), &packages, only, args.release)?;
    let results = hunt::hunt(&plan, &suites, &home, &args)?;
    let report = table::report(&plan, &results);
    std::fs::write(home.join("report.md"), &report)?;
    println!("{report}");
    Ok(())
}

/// Faults in random order, at most one per line and none inside another. There are a few more than requested, because some will not
/// compile.
fn draw(workspace: &Path, packages: &Packages, args: &Args) -> Result<Vec<Fault>> {
    let mut random = Random(args.seed);
    let enough = args.count + args.count / 3;
    if !args.each {
        return draw_from(workspace, packages, &args.packages, enough, &mut random);
    }
    for package in args.planted() {
        ensure!(
            args.packages.contains(package),
            "--only {package}: faults are not drawn from that package; name it by --package too"
        );
    }
    let mut parts = Vec::new();
    for package in args.packages.chunks(1) {
        parts.push(draw_from(workspace, packages, package, enough.div_ceil(args.packages.len()), &mut random)?);
    }
    // In turn, so that the first ones are from all packages too.
    let longest = parts.iter().map(Vec::len).max().unwrap_or(0);
    let mixed = (0..longest).flat_map(|k| parts.iter().filter_map(move |part| part.get(k).cloned()));
    Ok(mixed.filter(|f| args.planted().contains(&f.package)).collect())
}

/// At most `enough` faults of these packages.
fn draw_from(
    workspace: &Path,
    packages: &Packages,
    of: &[String],
    enough: usize,
    random: &mut Random,
) -> Result<Vec<Fault>> {
    let mut by_line: BTreeMap<(PathBuf, usize), Vec<Fault>> = BTreeMap::new();
    for package in of {
        let root = packages.roots.get(package).with_context(|| format!("there is no library {package}"))?;
        for fault in find::faults(workspace, package, root)? {
            by_line.entry((fault.file.clone(), fault.line)).or_default().push(fault);
        }
    }
    let mut lines: Vec<Vec<Fault>> = by_line.into_values().collect();
    for k in (1..lines.len()).rev() {
        lines.swap(k, random.below(k + 1));
    }
    let mut drawn: Vec<Fault> = Vec::new();
    for mut line in lines {
        let fault = line.swap_remove(random.below(line.len()));
        let inside = |f: &Fault| f.bytes.start < fault.bytes.end && fault.bytes.start < f.bytes.end;
        if !drawn.iter().any(|f| f.file == fault.file && inside(f)) {
            drawn.push(fault);
        }
        if drawn.len() == enough {
            break;
        }
    }
    Ok(drawn)
}

/// Plants the faults, removes those that do not compile, and builds the tests.
fn prepare(workspace: &Path, home: &Path, packages: &Packages, faults: Vec<Fault>, args: &Args) -> Result<Plan> {
    build::fetch(workspace)?;
    let (tree, target) = (home.join("tree"), home.join("build"));
    let _ = std::fs::remove_dir_all(&tree);
    let roots = packages.roots.iter().filter(|(p, _)| args.planted().contains(p));
    let roots: BTreeMap<_, _> = roots.map(|(p, r)| (p.clone(), r.clone())).collect();
    let mut compiling: BTreeSet<usize> = (0..faults.len()).collect();
    loop {
        let planted = plant::plant(workspace, &tree, &faults, &compiling, &roots)?;
        let refused = build::refused(&tree, &target, args, &planted)?;
        eprintln!("{} faults planted, {} do not compile", compiling.len(), refused.len());
        if refused.is_empty() {
            break;
        }
        compiling.retain(|id| !refused.contains(id));
    }
    let count = if args.only.is_some() { args.count.div_ceil(args.packages.len()) } else { args.count };
    let commit = Command::new("git").args(["describe", "--always", "--dirty"]).current_dir(workspace).output()?;
    Ok(Plan {
        seed: args.seed,
        count: args.count,
        packages: args.packages.clone(),
        only: args.only.clone(),
        commit: String::from_utf8(commit.stdout)?.trim().to_owned(),
        chosen: compiling.into_iter().take(count).collect(),
        faults,
    })
}

/// SplitMix64.
struct Random(u64);

impl Random {
    fn below(&mut self, n: usize) -> usize {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        ((z ^ (z >> 31)) % n as u64) as usize
    }
}
