//! Names in scene files that lead nowhere: layers, files, parts, folders; and ids given twice.

use super::good::{MODEL, MOLECULE, SCENE};
use super::usage::{Usage, usage};

/// A right part of a scene, what stands in its place, and what the message names.
const REPLACED: &[(&str, &str, &str, &str)] = &[
    (SCENE, "source = 'dem.asc'", "source = 'den.asc'", "den.asc"),
    (SCENE, "source = 'dem.asc'", "source = 'route.gpx'", "route.gpx"),
    (SCENE, "source = 'dem.asc'", "source = 'picture.png'", "picture.png"),
    (SCENE, "source = 'dem.asc'", "source = ''", "ground"),
    (SCENE, "source = 'dem.asc'", "source = 'folder'", "folder"),
    (SCENE, "source = 'dem.asc'", "source = '../dem.asc'", "../dem.asc"),
    (SCENE, "source = 'dem.asc'", "source = '/etc/hostname'", "/etc/hostname"),
    (SCENE, "source = 'dem.asc'", "source = 'https://example.org/dem.tif'", "https"),
    (SCENE, "source = 'dem.asc'", "source = 'builtin:masif'", "masif"),
    (SCENE, "source = 'dem.asc'", "source = []", "ground"),
    (SCENE, "source = 'dem.asc'", "source = 'dem.asc'\nsource_crs = 'EPSG:77'", "EPSG:77"),
    (SCENE, "source = 'dem.asc'", "source = 'dem.asc'\nvertical_unit = 'feet'", "feet"),
    (SCENE, "source = 'dem.asc'", "source = 'dem.asc'\ndrape = 'picture.png'", "picture.png"),
    (SCENE, "source = 'dem.asc'", "source = 'dem.asc'\ndrape = 'gone.tif'", "gone.tif"),
    (SCENE, "source = 'dem.asc'", "source = 'dem.asc'\nstyle = { palette = 'alpin' }", "alpin"),
    (SCENE, "source = 'route.gpx'", "source = 'dem.asc'", "dem.asc"),
    (SCENE, "source = 'route.gpx'", "source = 'gone.gpx'", "gone.gpx"),
    (SCENE, "source = 'route.gpx'", "source = 'cube.obj'", "cube.obj"),
    (SCENE, "id = 'way'", "id = 'ground'", "ground"),
    (SCENE, "id = 'way'", "id = ''", "id"),
    (SCENE, "kind = 'line'", "kind = 'area'", "route.gpx"),
    (SCENE, "kind = 'line'", "kind = 'point'", "route.gpx"),
    (SCENE, "kind = 'line'", "kind = 'mesh'", "route.gpx"),
    (SCENE, "kind = 'terrain'", "kind = 'volume'", "dem.asc"),
    (SCENE, "[camera]", "[representations]\nmap = ['gone']\n[camera]", "gone"),
    (MODEL, "source = 'cube.obj'", "source = 'gone.obj'", "gone.obj"),
    (MODEL, "source = 'cube.obj'", "source = 'dem.tif'", "dem.tif"),
    (MODEL, "source = 'cube.obj'", "source = 'atoms.pdb'", "atoms.pdb"),
    (MODEL, "source = 'cube.obj'", "source = 'cube.obj'\nmotion = 'points.json'", "points.json"),
    (MODEL, "kind = 'mesh'", "kind = 'city'", "cube.obj"),
    (MOLECULE, "source = 'atoms.pdb'", "source = 'cube.obj'", "cube.obj"),
    (MOLECULE, "source = 'atoms.pdb'", "source = 'gone.pdb'", "gone.pdb"),
];

pub(super) fn table() -> Vec<Usage> {
    let mut out = Vec::new();
    for (scene, right, wrong, names) in REPLACED {
        assert!(scene.contains(right), "{right} is not in the scene");
        // A file with lines of its own is named in place of the scene.
        let place = if wrong.contains("motion") { "points.json:" } else { "s.toml:" };
        out.push(usage("check s.toml").file("s.toml", scene.replacen(right, wrong, 1)).names(place).names(names));
    }
    let at = |lon: f64, lat: f64| {
        format!(r#"{{"type":"LineString","coordinates":[[{lon},{lat}],[{},{lat}]]}}"#, lon + 0.001)
    };
    let reveal =
        |content: String| usage("reveal dem.asc w.geojson -o x.png").file("w.geojson", content).names("w.geojson");
    out.push(reveal(at(20.0, 10.0)));
    out.push(reveal(at(500_000.0, 5_000_000.0)));
    out.push(reveal(r#"{"type":"LineString","coordinates":[[10.005,46.005]]}"#.into()));
    out.push(reveal(r#"{"type":"FeatureCollection","features":[]}"#.into()));
    out.push(reveal(
        r#"{"type":"FeatureCollection","features":[{"type":"Feature","geometry":null,"properties":{}}]}"#.into(),
    ));
    out.push(reveal(r#"{"type":"LineString","coordinates":[[46.009,10.002],[46.0095,10.006]]}"#.into()));
    out
}
