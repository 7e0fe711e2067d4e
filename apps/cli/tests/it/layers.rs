//! Layers from several files and from tables, asked by `pick`: what stands where, and how far away it is seen.

use super::Place;
use serde_json::Value;

/// From the origin along y; a point (x, y, z) is seen at (50 + 50 x / y, 50 - 50 z / y), at the depth y.
const CAMERA: &str = "format = 1\ncrs = 'EPSG:32631'\n[camera]\neye = [0, 0, 0]\nlook_at = [0, 100, 0]\nfov_y_deg = 90\nimage = [100, 100]\n";

fn picked(place: &Place, layer: &str, pixels: &[[f64; 2]]) -> Vec<Value> {
    place.write("s.toml", &format!("{CAMERA}[[layer]]\nid = 'it'\n{layer}"));
    place.write("p.json", &serde_json::json!(pixels).to_string());
    let answer = place.json(&["pick", "s.toml", "--pixels", "p.json"]);
    answer["pixels"].as_array().expect("a list").clone()
}

fn depths(picked: &[Value]) -> Vec<f64> {
    picked.iter().map(|p| p["depth"].as_f64().unwrap_or(f64::INFINITY)).collect()
}

fn assert_depths(picked: &[Value], expected: &[f64]) {
    let found = depths(picked);
    assert_eq!(found.len(), expected.len());
    for (f, e) in found.iter().zip(expected) {
        assert!(f == e || (f - e).abs() < 1e-6, "{found:?}, expected {expected:?}");
    }
}

#[test]
fn several_mesh_files_are_one_layer() {
    let place = Place::new();
    let wall = |y: f64, [from, to]: [f64; 2]| {
        let corner = |x: f64, z: f64| format!("v {x} {y} {z}\n");
        let corners = [corner(from, -20.0), corner(to, -20.0), corner(to, 20.0), corner(from, 20.0)];
        format!("{}f 1 2 3\nf 1 3 4\n", corners.concat())
    };
    place.write("left.obj", &wall(100.0, [-80.0, -20.0]));
    place.write("right.obj", &wall(50.0, [10.0, 40.0]));
    place.write("far.obj", &wall(200.0, [-20.0, 20.0]));
    let layer = "kind = 'mesh'\nsource = ['left.obj', 'right.obj', 'far.obj']\n";
    // Each wall above and below its diagonal, and the sky over it.
    let pixels = [[25.0, 52.0], [25.0, 48.0], [75.0, 52.0], [75.0, 48.0], [50.0, 51.0], [50.0, 49.0], [25.0, 30.0]];
    let seen = picked(&place, layer, &pixels);
    assert_depths(&seen, &[100.0, 100.0, 50.0, 50.0, 200.0, 200.0, f64::INFINITY]);
    assert!(seen[..6].iter().all(|p| p["layer"] == "it"), "{seen:?}");
}

#[test]
fn boxes_come_from_tables_with_and_without_yaw_and_colour() {
    let place = Place::new();
    let table = "x,y,z,size_x,size_y,size_z,yaw_deg,color\n0,100,-10,20,20,20,45\n60,100,-10,20,20,20\n\n\
        -60,100,-10,20,20,20,,#c02020\n0,300,40,20,20,20,90,#20c020\n";
    place.write("boxes.csv", table);
    let layer = "kind = 'boxes'\nsource = 'boxes.csv'\n";
    // Turned by 45 degrees an edge comes to the front, at 100 - 10 sqrt(2); half a pixel beside it the side has fallen back by 1 %.
    let edge = (100.0 - 10.0 * 2f64.sqrt()) / 0.99;
    // Fronts of the others lie at 90; what leaves the front by the side is seen past it.
    let beside = 50.0 * 60.0 / 90.0;
    let pixels = [[50.5, 50.0], [49.5, 50.0], [50.0 + beside, 50.0], [50.0 - beside, 50.0], [50.0, 42.0], [50.0, 30.0]];
    assert_depths(&picked(&place, layer, &pixels), &[edge, edge, 90.0, 90.0, 290.0, f64::INFINITY]);
    for (row, line) in [
        ("0,100,-10,20,20,20,east", 9),
        ("0,100,-10,20,20,nan", 9),
        ("0,100,-10,20,20", 9),
        ("0,100,-10,20,20,20,45,#c02020,more", 9),
    ] {
        place.write("boxes.csv", &format!("{table}\n\n{row}\n"));
        let said = place.fails(&["check", "s.toml"]);
        assert!(said.contains("boxes.csv") && said.contains(&line.to_string()) && said.contains("yaw_deg"), "{said}");
    }
}

#[test]
fn a_line_is_picked_from_one_end_to_the_other() {
    let place = Place::new();
    let line = r#"{"type":"Feature","properties":{"name":"Ridge way"},"geometry":{"type":"LineString","coordinates":[[-60,150,0],[60,150,0]]}}"#;
    let crs = r#""crs":{"type":"name","properties":{"name":"EPSG:32631"}}"#;
    place.write("way.geojson", &format!("{{\"type\":\"FeatureCollection\",{crs},\"features\":[{line}]}}"));
    // From x = -60 to 60 at the depth 150: from 30 to 70 in the picture.
    let pixels = [[31.0, 50.0], [45.0, 50.0], [69.0, 50.0], [25.0, 50.0], [75.0, 50.0], [45.0, 60.0]];
    let seen = picked(&place, "kind = 'line'\nsource = 'way.geojson'\n", &pixels);
    assert_depths(&seen, &[150.0, 150.0, 150.0, f64::INFINITY, f64::INFINITY, f64::INFINITY]);
    for (picked, x) in seen.iter().zip([-57.0, -15.0, 57.0]) {
        assert_eq!(picked["feature"], "Ridge way");
        assert!((picked["point"][0].as_f64().expect("a number") - x).abs() < 1e-6, "{picked}");
    }
}
