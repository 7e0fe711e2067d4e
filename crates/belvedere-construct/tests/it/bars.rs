//! Goals of `reveal` on real mountains.

use crate::reveal::assert_bars;
use belvedere_construct::{RevealMemory, RevealOptions, reveal};
use belvedere_io::load_vectors;
use belvedere_io::vector::lines_on_terrain;
use belvedere_io::{TerrainRequest, load_terrain};
use belvedere_scene::{Progress, Scene};
use belvedere_testkit::synthetic::{line_layer, terrain_layer};

fn load(terrain: &str, lines: &str) -> Option<Scene> {
    let (terrain, lines) = (belvedere_testkit::data(terrain)?, belvedere_testkit::data(lines)?);
    let loaded = load_terrain(&[terrain], &TerrainRequest::default(), &Progress::silent()).unwrap().value;
    let vectors = load_vectors(&lines).unwrap().value;
    let features = lines_on_terrain(&vectors, loaded.crs, Some(&loaded.heightfield)).unwrap().value;
    let mut route = line_layer("route", Vec::new());
    if let Some(line) = route.kind.lines_mut() {
        line.features = features.features;
    }
    Some(Scene { crs: loaded.crs, layers: vec![terrain_layer(loaded.heightfield), route], ..Scene::default() })
}

fn shows_the_route(terrain: &str, lines: &str) {
    let Some(scene) = load(terrain, lines) else { return };
    let options = RevealOptions { image: [960, 540], ..RevealOptions::default() };
    let found = reveal(&scene, None, &options, &mut RevealMemory::default(), &Progress::silent()).unwrap();
    assert_bars(terrain, &scene, &found);
}

#[test]
fn andorra_shows_the_gr_11() {
    shows_the_route("andorra/N42E001.hgt", "andorra/gr11_andorra_no_elevation.gpx");
}

#[test]
fn the_canyon_shows_its_river() {
    shows_the_route("grand_canyon/grandcanyon_dem_3857.tif", "grand_canyon/colorado_river_line_derived.geojson");
}

#[test]
fn baltoro_shows_its_glaciers() {
    shows_the_route("baltoro/baltoro_srtm.tif", "baltoro/glacier_centerlines.geojson");
}
