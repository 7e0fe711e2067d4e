//! Dragging on the data collection: time from input to picture at 1280 x 720, scene by scene.
//!
//! `cargo bench -p belvedere-bench --bench dragging -- [--scene NAME] [--threads N] [--least PICTURES] [--json]`
//!
//! `--least` draws that many pictures of the least quality, one after the other; their processor time hardly depends on what else runs.
#![allow(missing_docs, clippy::print_stdout)]

use anyhow::{Context, Result};
use belvedere::editor::Editor;
use belvedere::scene::Progress;
use belvedere::scene_file::{LayerDoc, StageDoc};
use belvedere::verbs::open_files::open_files;
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
        let editor = make(&repository, &data).with_context(|| format!("scene {name}"))?;
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

type Make = fn(&Path, &Path) -> Result<Editor>;

/// Names of the scenes, and how they are made.
const SCENES: &[(&str, Make)] = &[
    ("andorra, GR 11, bent", |r, d| ready(r, d, "andorra")),
    ("andorra, HRP, revealed", |_, d| files(d, &["andorra/N42E001.hgt", "andorra/hrp_andorra_no_elevation.gpx"])),
    ("andorra, close, bent", |r, d| close(r, d, false)),
    ("andorra, close, makes way", |r, d| close(r, d, true)),
    ("andorra, ground makes way", |r, d| ready(r, d, "andorra_terrain")),
    ("gotthard", |r, d| ready(r, d, "gotthard")),
    ("gotthard, makes way", |r, d| ready(r, d, "gotthard_terrain")),
    ("grand canyon", |r, d| ready(r, d, "grand_canyon")),
    ("baltoro", |r, d| ready(r, d, "baltoro")),
    ("swellendam, drape", |r, d| ready(r, d, "swellendam")),
    ("delft, CityJSON", |_, d| files(d, &["city_delft/delft.city.json"])),
    ("berlin, CityGML, styled", |_, d| styled(d, "city_berlin/berlin_lod2_citygml1.gml")),
    ("andorra, OSM, three sections", |_, d| sections(d, "andorra/andorra.osm.pbf")),
    ("delft, three sections", |_, d| sections(d, "city_delft/delft.city.json")),
    ("town, three sections", |r, d| ready(r, d, "town_sections")),
    ("molecule, 559 atoms", |_, d| files(d, &["molecules/1bna.pdb"])),
    ("molecule, 2,000 atoms", |r, d| atoms(r, d)),
    ("molecule, 16,755 atoms", |_, d| files(d, &["molecules/1kx5.pdb"])),
    ("molecule, 26,430 atoms", |_, d| files(d, &["molecules/4yvs.cif"])),
    ("volume, engine", |_, d| files(d, &["volumes/engine.vti"])),
    ("volume, chest", |_, d| files(d, &["volumes/LIDC2.vti"])),
    ("mesh, bunny", |_, d| files(d, &["odd/bunny.ply"])),
];

/// A ready scene.
fn ready(repository: &Path, data: &Path, name: &str) -> Result<Editor> {
    Ok(Editor::open(&repository.join(format!("scenes/{name}.toml")), vec![data.to_owned()])?)
}

/// Files, opened as the window opens them.
fn files(data: &Path, names: &[&str]) -> Result<Editor> {
    let paths: Vec<PathBuf> = names.iter().map(|name| data.join(name)).collect();
    Ok(open_files(&paths, &[], &Progress::silent())?)
}

/// A document written here, its files in the data collection.
fn written(data: &Path, text: &str) -> Result<Editor> {
    let source = belvedere::scene_file::parse(Path::new("dragging.toml"), text)?;
    let mut editor = Editor::new(source.document, Default::default());
    editor.place.roots.allowed.push(data.to_owned());
    Ok(editor)
}

/// A route that begins 30 m before the eye on steep ground, under a bend; the ground may make way.
fn close(repository: &Path, data: &Path, makes_way: bool) -> Result<Editor> {
    let name = if makes_way { "andorra_terrain" } else { "andorra" };
    let mut editor = ready(repository, data, name)?;
    let text = "format = 1\n[camera]\neye = { lon = 1.5655, lat = 42.5862, above_ground_m = 12 }\n\
                look_at = { lon = 1.5700, lat = 42.5900, above_ground_m = 0 }\nfov_y_deg = 50.0\n\
                [[stage]]\nkind = \"spline_bend\"\npresets = \"progressive\"\n";
    let near = belvedere::scene_file::parse(Path::new("close.toml"), text)?.document;
    editor.edit(|document| {
        document.camera = near.camera;
        document.stage.retain(|stage| !matches!(stage, StageDoc::SplineBend(_)));
        document.stage.extend(near.stage);
    });
    Ok(editor)
}

/// A city with edges, shades and shadows.
fn styled(data: &Path, name: &str) -> Result<Editor> {
    let mut editor = files(data, &[name])?;
    let style = "format = 1\n[camera]\neye = [0, 0, 1]\nlook_at = [0, 1, 1]\n[stylisation]\nedges = true\nunsharp = 3\n\
                 [light]\nazimuth_deg = 300\naltitude_deg = 42\nshadows = true\n";
    let style = belvedere::scene_file::parse(Path::new("style.toml"), style)?.document;
    editor.edit(|document| (document.stylisation, document.light) = (style.stylisation, style.light));
    Ok(editor)
}

/// A city at three levels of abstraction in the sections of the demo presets.
fn sections(data: &Path, name: &str) -> Result<Editor> {
    let mut editor = styled(data, name)?;
    if name.ends_with(".pbf") {
        // In degrees the city would be a point.
        let text = "format = 1\n[camera]\neye = { lon = 1.5218, lat = 42.497, above_ground_m = 400 }\n\
                    look_at = { lon = 1.5218, lat = 42.508, above_ground_m = 0 }\nfov_y_deg = 45.0\n";
        let camera = belvedere::scene_file::parse(Path::new("camera.toml"), text)?.document.camera;
        let ground = ready(Path::new(env!("CARGO_MANIFEST_DIR")).join("../..").as_path(), data, "andorra")?;
        editor.edit(|document| {
            document.camera = camera;
            document.crs = "auto".into();
            document.layer.splice(0..0, ground.document().layer.first().cloned());
        });
        editor.place.roots.allowed.push(data.to_owned());
    }
    let stage = "format = 1\n[camera]\neye = [0, 0, 1]\nlook_at = [0, 1, 1]\n[[stage]]\nkind = \"spline_bend\"\npresets = \"demo\"\n";
    let stage = belvedere::scene_file::parse(Path::new("stage.toml"), stage)?.document.stage;
    editor.edit(|document| {
        let Some(LayerDoc::City(city)) = document.layer.pop() else { return };
        let levels = [0u8, 1, 2].map(|loa| {
            let mut level = city.clone();
            (level.id, level.loa) = (format!("loa{loa}"), loa);
            level
        });
        document.representations = levels.iter().map(|l| (l.id.clone(), vec![l.id.clone()])).collect();
        document.layer.extend(levels.map(LayerDoc::City));
        document.stage = stage;
    });
    Ok(editor)
}

/// About 2,000 atoms, finely cut.
fn atoms(_: &Path, data: &Path) -> Result<Editor> {
    written(
        data,
        "format = 1\nunit = \"angstrom\"\n[[layer]]\nid = \"dna\"\nkind = \"molecule\"\nsource = \"builtin:dna?pairs=48&seed=7\"\n\
         [camera]\neye = [0.0, -220.0, 20.0]\nlook_at = [0.0, 0.0, 0.0]\nfov_y_deg = 40\n\
         [[stage]]\nkind = \"spline_bend\"\npresets = \"progressive\"\n",
    )
}
