//! The heights that `disocclude` writes are the solved ones, and its lakes are level.

use belvedere::core::DVec2;
use belvedere::places::Place;
use belvedere::request::{Disocclude, Stated, WrittenGrid};
use belvedere::scene::{Heightfield, Progress};
use belvedere::verbs::disocclude::{DisoccludeFiles, disocclude};
use belvedere::{OpenOptions, Session};
use std::path::Path;

const WATER_M: f64 = 100.0;

/// A lake behind a ridge; its northern shore lies two rows up the bank.
fn height(c: usize, r: usize) -> f64 {
    match (c, r) {
        (30..60, 20..36) => WATER_M,
        (_, 0..20) => WATER_M + 20.0 * (20 - r) as f64,
        (_, 50..60) => 180.0,
        _ => WATER_M + 8.0 + 3.0 * ((c * 5 + r * 3) as f64 / 7.0).sin(),
    }
}

fn request(folder: &Path) -> Disocclude {
    let row = |r: usize| (0..90).map(|c| format!("{:.3} ", height(c, r))).collect::<String>() + "\n";
    let header = "ncols 90\nnrows 90\nxllcorner 499990\nyllcorner 4999990\ncellsize 20\nNODATA_value -9999\n";
    let [dem, lake] = ["dem.asc", "lake.geojson"].map(|name| folder.join(name));
    std::fs::write(&dem, header.to_owned() + &(0..90).map(row).collect::<String>()).unwrap();
    // Column 30 is x = 500600, row 18 y = 5001420, row 35 y = 5001080.
    let area = r#"{"type": "FeatureCollection", "crs": {"type": "name", "properties": {"name": "EPSG:32632"}},
        "features": [{"type": "Feature", "properties": {"natural": "water", "name": "Tarn"}, "geometry": {"type": "Polygon",
        "coordinates": [[[500595, 5001075], [501185, 5001075], [501185, 5001425], [500595, 5001425], [500595, 5001075]]]}}]}"#;
    std::fs::write(&lake, area).unwrap();
    let text = |path: &Path| path.display().to_string();
    Disocclude {
        data: text(&dem),
        features: vec![text(&lake)],
        stated: Stated::in_crs("EPSG:32632"),
        eye: Some(Place::of([500_900.0, 5_000_100.0], Some(150.0))),
        look: Some(Place::of([500_900.0, 5_001_300.0], None)),
        ..Disocclude::default()
    }
}

fn terrain_of(file: &Path) -> Heightfield {
    let text = format!(
        "format = 1\n[[layer]]\nid = \"ground\"\nkind = \"terrain\"\nsource = {:?}\n[camera]\neye = [500900.0, 5000100.0, 900.0]\n\
         look_at = [500900.0, 5001200.0, 100.0]\n",
        file.display().to_string()
    );
    let options = OpenOptions { allow_roots: vec![file.parent().unwrap().to_owned()], ..OpenOptions::default() };
    Session::from_text(Path::new("written.toml"), &text, &options).unwrap().scene().terrain().unwrap().clone()
}

#[test]
fn written_heights_are_those_solved_and_their_lakes_are_level() {
    let folder = tempfile::tempdir().unwrap();
    for (grid, name) in [(WrittenGrid::Scene, "scene.tif"), (WrittenGrid::Input, "input.tif")] {
        let request = Disocclude { grid: Some(grid), ..request(folder.path()) };
        let found = disocclude(&request, &OpenOptions::default()).unwrap();
        let lakes = &found.solved.report.lakes;
        assert!(lakes.len() == 1 && lakes[0].name == "Tarn" && (lakes[0].height_m - WATER_M).abs() < 1e-9, "{lakes:?}");
        let out = folder.path().join(name);
        found
            .write(&DisoccludeFiles { out: out.clone(), ..DisoccludeFiles::default() }, true, &Progress::silent())
            .unwrap();
        let written = terrain_of(&out);
        let (mut water, mut bank, mut most) = (Vec::new(), 0, 0.0f64);
        for (c, r) in (0..90).flat_map(|r| (0..90).map(move |c| (c, r))) {
            let p = DVec2::new(500_000.0 + 20.0 * c as f64, 5_001_780.0 - 20.0 * r as f64);
            let (z, moved) = (written.surface_at(p).unwrap(), found.solved.stage.delta_at(p.extend(0.0)));
            assert!((z - height(c, r) - moved).abs() < 0.01, "{name} {c} {r}: {z}, solved {}", height(c, r) + moved);
            most = most.max(moved.abs());
            match (30..60).contains(&c) && (18..36).contains(&r) {
                true if r < 20 => bank += usize::from((moved - lakes[0].moved_m).abs() > 0.1),
                true => water.push(z),
                false => {}
            }
        }
        let [low, high] = water.iter().fold([f64::INFINITY, f64::NEG_INFINITY], |[a, b], z| [a.min(*z), b.max(*z)]);
        assert!(high - low < 0.01 && water.len() == 480, "{name}: water between {low} and {high} m");
        assert!(most > 5.0 && bank > 0, "{name}: {most} m, {bank} nodes of the bank move otherwise than the water");
    }
}
