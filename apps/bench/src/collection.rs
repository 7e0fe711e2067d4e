//! Scenes of the data collection, as a user opens them: places, towns, molecules, volumes, a mesh.

use anyhow::Result;
use belvedere::scene::Progress;
use belvedere::scene_file::{LayerDoc, StageDoc};
use belvedere::verbs::open_files::open_files;
use belvedere_studio::Editor;
use std::path::{Path, PathBuf};

const ANDORRA: &str = include_str!("../../../scenes/andorra.toml");
const ANDORRA_TERRAIN: &str = include_str!("../../../scenes/andorra_terrain.toml");

/// Makes a scene of the files in the folder of the data collection.
pub type Make = fn(&Path) -> Result<Editor>;

/// Names of the scenes, and how they are made.
pub const SCENES: &[(&str, Make)] = &[
    ("andorra, GR 11, bent", |d| ready(d, ANDORRA)),
    ("andorra, HRP, revealed", |d| files(d, &["andorra/N42E001.hgt", "andorra/hrp_andorra_no_elevation.gpx"])),
    ("andorra, close, bent", |d| close(d, false)),
    ("andorra, close, makes way", |d| close(d, true)),
    ("andorra, ground makes way", |d| ready(d, ANDORRA_TERRAIN)),
    ("gotthard", |d| ready(d, include_str!("../../../scenes/gotthard.toml"))),
    ("gotthard, makes way", |d| ready(d, include_str!("../../../scenes/gotthard_terrain.toml"))),
    ("grand canyon", |d| ready(d, include_str!("../../../scenes/grand_canyon.toml"))),
    ("baltoro", |d| ready(d, include_str!("../../../scenes/baltoro.toml"))),
    ("swellendam, drape", |d| ready(d, include_str!("../../../scenes/swellendam.toml"))),
    ("delft, CityJSON", |d| files(d, &["city_delft/delft.city.json"])),
    ("berlin, CityGML, styled", |d| styled(d, "city_berlin/berlin_lod2_citygml1.gml")),
    ("andorra, OSM, three sections", |d| sections(d, "andorra/andorra.osm.pbf")),
    ("delft, three sections", |d| sections(d, "city_delft/delft.city.json")),
    ("town, three sections", |d| ready(d, include_str!("../../../scenes/town_sections.toml"))),
    ("molecule, 559 atoms", |d| files(d, &["molecules/1bna.pdb"])),
    ("molecule, 2,000 atoms", atoms),
    ("molecule, 16,755 atoms", |d| files(d, &["molecules/1kx5.pdb"])),
    ("molecule, 26,430 atoms", |d| files(d, &["molecules/4yvs.cif"])),
    ("volume, engine", |d| files(d, &["volumes/engine.vti"])),
    ("volume, chest", |d| files(d, &["volumes/LIDC2.vti"])),
    ("mesh, bunny", |d| files(d, &["odd/bunny.ply"])),
];

/// Files, opened as the window opens them.
fn files(data: &Path, names: &[&str]) -> Result<Editor> {
    let paths: Vec<PathBuf> = names.iter().map(|name| data.join(name)).collect();
    Ok(open_files(&paths, &[], &Progress::silent())?.into())
}

/// A document whose files are in the data collection.
fn ready(data: &Path, text: &str) -> Result<Editor> {
    let source = belvedere::scene_file::parse(Path::new("collection.toml"), text)?;
    let mut editor = Editor::new(source.document, Default::default());
    editor.place.roots.allowed.push(data.to_owned());
    Ok(editor)
}

/// A route that begins 30 m before the eye on steep ground, under a bend; the ground may make way.
fn close(data: &Path, makes_way: bool) -> Result<Editor> {
    let mut editor = ready(data, if makes_way { ANDORRA_TERRAIN } else { ANDORRA })?;
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
        let ground = ready(data, ANDORRA)?;
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
fn atoms(data: &Path) -> Result<Editor> {
    ready(
        data,
        "format = 1\nunit = \"angstrom\"\n[[layer]]\nid = \"dna\"\nkind = \"molecule\"\nsource = \"builtin:dna?pairs=48&seed=7\"\n\
         [camera]\neye = [0.0, -220.0, 20.0]\nlook_at = [0.0, 0.0, 0.0]\nfov_y_deg = 40\n\
         [[stage]]\nkind = \"spline_bend\"\npresets = \"progressive\"\n",
    )
}
