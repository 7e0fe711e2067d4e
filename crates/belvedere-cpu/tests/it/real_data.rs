//! Pictures of Andorra.

use crate::subdivision::cracks;
use crate::support::{layer, line, options, pinhole, render, scene, show, terrain};
use crate::support_views::spline_over;
use belvedere_core::{DVec2, DVec3, View};
use belvedere_scene::{AreaFeature, AreaLayer, Color, Heightfield, Hidden, LayerKind, LineFeature, NodeState, Scene};

const LAT0: f64 = 42.5;
const LON0: f64 = 1.5;

/// Approximate metric position, accurate enough for pictures.
fn metric(lon: f64, lat: f64) -> DVec2 {
    DVec2::new((lon - LON0) * 111_320.0 * LAT0.to_radians().cos(), (lat - LAT0) * 111_132.0)
}

pub(crate) fn andorra() -> Option<Heightfield> {
    let bytes = std::fs::read(belvedere_testkit::data("andorra/N42E001.hgt")?).expect("readable");
    let n = 1201;
    let raw: Vec<i16> = bytes.chunks_exact(2).map(|b| i16::from_be_bytes([b[0], b[1]])).collect();
    let states = raw.iter().map(|&h| if h == i16::MIN { NodeState::Void } else { NodeState::Measured }).collect();
    let (nw, se) = (metric(1.0, 43.0), metric(2.0, 42.0));
    let spacing = DVec2::new(se.x - nw.x, nw.y - se.y) / (n - 1) as f64;
    Heightfield::new(nw, spacing, n, n, raw.into_iter().map(f32::from).collect(), states).ok()
}

fn over(hf: &Heightfield, lon: f64, lat: f64, above: f64) -> DVec3 {
    let xy = metric(lon, lat);
    xy.extend(hf.height_at(xy).unwrap_or(0.0) + above)
}

fn view(hf: &Heightfield, eye: [f64; 3], at: [f64; 3], fov: f64, image: [u32; 2]) -> View {
    let [eye, at] = [eye, at].map(|p| over(hf, p[0], p[1], p[2]));
    View::straight(pinhole(eye, at, fov, image))
}

fn andorra_scene() -> Option<(Scene, Heightfield)> {
    let hf = andorra()?;
    let layers = vec![
        layer("ground", LayerKind::Terrain(terrain(hf.clone()))),
        layer("lakes", LayerKind::Area(lakes()?)),
        layer("gr11", LayerKind::Line(route(&hf)?)),
    ];
    Some((scene(layers), hf))
}

/// The GR 11, segment by segment, with added points so that their spacing is that of the ground.
fn route(hf: &Heightfield) -> Option<belvedere_scene::LineLayer> {
    let text = std::fs::read_to_string(belvedere_testkit::data("andorra/gr11_andorra_no_elevation.gpx")?).ok()?;
    let mut out = line(Vec::new(), Hidden::Dash);
    out.features.clear();
    for segment in text.split("<trkseg>").skip(1) {
        let number = |s: &str, key: &str| s.split(key).nth(1)?.split('"').next()?.parse::<f64>().ok();
        let xy: Vec<DVec2> =
            segment.split("<trkpt").filter_map(|p| Some(metric(number(p, "lon=\"")?, number(p, "lat=\"")?))).collect();
        let mut points = Vec::new();
        for w in xy.windows(2) {
            let n = ((w[1] - w[0]).length() / 60.0).ceil().max(1.0) as usize;
            for i in 0..n {
                let p = w[0].lerp(w[1], i as f64 / n as f64);
                points.extend(hf.height_at(p).map(|z| p.extend(z)));
            }
        }
        out.features.push(LineFeature { style: None, name: String::new(), points });
    }
    Some(out)
}

fn lakes() -> Option<AreaLayer> {
    let text = std::fs::read_to_string(belvedere_testkit::data("andorra/water.geojson")?).ok()?;
    let json: serde_json::Value = serde_json::from_str(&text).ok()?;
    let ring = |r: &serde_json::Value| -> Vec<DVec2> {
        r.as_array().into_iter().flatten().filter_map(|p| Some(metric(p[0].as_f64()?, p[1].as_f64()?))).collect()
    };
    let polygon = |p: &serde_json::Value| AreaFeature {
        style: None,
        name: String::new(),
        rings: p.as_array().into_iter().flatten().map(ring).collect(),
    };
    let mut features = Vec::new();
    for f in json["features"].as_array()? {
        let g = &f["geometry"];
        match g["type"].as_str() {
            Some("Polygon") => features.push(polygon(&g["coordinates"])),
            Some("MultiPolygon") => features.extend(g["coordinates"].as_array()?.iter().map(polygon)),
            _ => {}
        }
    }
    let fill = Color::rgb(96, 150, 190);
    Some(AreaLayer {
        features,
        fill,
        outline: None,
        width_px: 1.0,
        surface: belvedere_scene::AreaSurface::Water,
        hidden: Hidden::Cut,
        lift_m: 1.0,
        label_px: None,
        beyond: 0.0,
    })
}

#[test]
fn andorra_has_no_cracks_below_its_skyline() {
    let Some((scene, hf)) = andorra_scene() else { return };
    let cameras: [(&str, [f64; 3], [f64; 3], f64); 4] = [
        ("andorra", [1.52, 42.42, 900.0], [1.60, 42.60, 0.0], 45.0),
        ("andorra_down", [1.50, 42.38, 3200.0], [1.58, 42.53, 0.0], 45.0),
        ("andorra_lakes", [1.52, 42.475, 1500.0], [1.572, 42.512, 0.0], 40.0),
        ("andorra_above", [1.56, 42.40, 9000.0], [1.56, 42.53, 0.0], 50.0),
    ];
    for (name, eye, at, fov) in cameras {
        let frame = render(&scene, &view(&hf, eye, at, fov, [1280, 720]), &options(4));
        show(name, &frame);
        // Sky below the first ground of a column comes from holes in the data.
        let mut holes = 0;
        for x in 0..frame.width {
            let column: Vec<u32> = (0..frame.height).map(|y| frame.id[y * frame.width + x]).collect();
            let first = column.iter().position(|&id| id != 0).unwrap_or(frame.height);
            holes += column[first..].iter().filter(|&&id| id == 0).count();
        }
        assert!(holes < 8000, "{name}: {holes} pixels of sky below the skyline");
        assert!(frame.id.iter().filter(|&&id| id != 0).count() > frame.id.len() / 2, "{name}");
    }
}

#[test]
fn bent_andorra_has_no_cracks_either() {
    let Some(hf) = andorra() else { return };
    let straight = view(&hf, [1.50, 42.38, 3200.0], [1.58, 42.53, 0.0], 45.0, [1280, 720]);
    let view = spline_over(straight.pinhole().clone(), "progressive", 1500.0);
    let drawn = |name: &str, hf: Heightfield| {
        let frame = render(&scene(vec![layer("ground", LayerKind::Terrain(terrain(hf)))]), &view, &options(1));
        show(name, &frame);
        assert!(frame.id.iter().filter(|&&id| id != 0).count() > frame.id.len() / 2, "{name}");
        cracks(&frame)
    };
    // Holes of the data are no cracks.
    assert_eq!(drawn("andorra_bent", whole(&hf, &[])), 0);
    let torn: Vec<usize> = (300..700).step_by(40).collect();
    assert!(drawn("andorra_torn", whole(&hf, &torn)) > 0, "rows without heights are seen");
}

/// The ground with heights in place of voids, but for whole rows.
fn whole(hf: &Heightfield, torn: &[usize]) -> Heightfield {
    let (cols, rows) = (hf.cols(), hf.rows());
    let mut last = 0.0;
    let mut heights = Vec::with_capacity(cols * rows);
    for node in (0..rows).flat_map(|row| (0..cols).map(move |col| hf.node(col, row))) {
        last = node.map_or(last, |p| p.z as f32);
        heights.push(last);
    }
    let state = |k: usize| if torn.contains(&(k / cols)) { NodeState::Void } else { NodeState::Measured };
    Heightfield::new(metric(1.0, 43.0), hf.spacing(), cols, rows, heights, (0..cols * rows).map(state).collect())
        .expect("ground")
}

#[test]
fn built_in_scenes_fill_their_pictures() {
    let scenes = [("massif", belvedere_builtin::massif(7, 513)), ("street", belvedere_builtin::street(7))];
    for (name, made) in scenes {
        let (scene, camera) = made.expect("the built-in scene can be made");
        let view = View::straight(pinhole(camera.eye, camera.look_at, camera.fov_y.to_degrees(), [1280, 720]));
        let frame = render(&scene, &view, &options(4));
        show(name, &frame);
        assert!(frame.id.iter().filter(|&&id| id != 0).count() > frame.id.len() / 3, "{name}");
    }
}
