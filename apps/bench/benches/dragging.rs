//! Dragging on the data collection: time from input to picture at 1280 x 720, scene by scene.
//!
//! `cargo bench -p belvedere-bench --bench dragging -- [--scene NAME] [--threads N] [--least PICTURES] [--json]`
//!
//! `--least` draws that many pictures of the least quality, one after the other; their processor time hardly depends on what else runs.
#![allow(missing_docs, clippy::print_stdout)]

use anyhow::{Context, Result};
use belvedere_bench::collection::SCENES;
use belvedere_bench::dragging::{drag, least};
use std::path::{Path, PathBuf};

const IMAGE: [u32; 2] = [1280, 720];

fn main() -> Result<()> {
    let (mut only, mut json, mut threads, mut pictures) = (None, false, 0, None);
    let mut args = std::env::args().skip(1);
    while let Some(arg) = args.next() {
        match arg.as_str() {
            "--scene" => only = args.next(),
            "--threads" => threads = args.next().context("--threads needs a number")?.parse()?,
            "--least" => pictures = Some(args.next().context("--least needs a number")?.parse()?),
            "--json" => json = true,
            _ => {}
        }
    }
    rayon::ThreadPoolBuilder::new().num_threads(threads).build_global()?;
    let repository = Path::new(env!("CARGO_MANIFEST_DIR")).join("../..");
    let data = std::env::var_os("BELVEDERE_DATA").map_or_else(|| repository.join("../shared/data"), PathBuf::from);
    if pictures.is_some() {
        println!("{:<28} {:>8} {:>8} {:>9}", "scene", "cpu ms", "wall ms", "triangles");
    } else {
        heading();
    }
    for (name, make) in SCENES {
        let exact = SCENES.iter().any(|(name, _)| only.as_deref() == Some(*name));
        if only.as_deref().is_some_and(|only| if exact { *name != only } else { !name.contains(only) }) {
            continue;
        }
        let editor = make(&data).with_context(|| format!("scene {name}"))?;
        if let Some(pictures) = pictures {
            let cost = least(name, editor, IMAGE, pictures).with_context(|| format!("scene {name}"))?;
            told(&cost, json)?;
        } else {
            told(&drag(name, editor, IMAGE).with_context(|| format!("scene {name}"))?, json)?;
        }
    }
    Ok(())
}

/// Prints one cost.
fn told(cost: &(impl serde::Serialize + std::fmt::Display), json: bool) -> Result<()> {
    if json {
        println!("{}", serde_json::to_string(cost)?);
    } else {
        println!("{cost}");
    }
    Ok(())
}

fn heading() {
    println!(
        "{:<28} {:>4} {:>8} {:>8} {:>8} {:>8} {:>7} {:>8} {:>8} {:>6} {:>2} {:>9} {:>6}",
        "scene",
        "pics",
        "p50 ms",
        "p95 ms",
        "worst",
        "drawing",
        "cpu",
        "first",
        "rest",
        "width",
        "",
        "triangles",
        "per px"
    );
}
