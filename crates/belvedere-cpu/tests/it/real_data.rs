//! Andorra, looked at.

use crate::support::{layer, options, pinhole, render, scene, show, terrain};
use belvedere_core::{DVec2, DVec3, View};
use belvedere_scene::{Heightfield, LayerKind, NodeState, Scene};

const LAT0: f64 = 42.5;
const LON0: f64 = 1.5;

/// Rough metric position: good enough to look at pictures.
fn metric(lon: f64, lat: f64) -> DVec2 {
    DVec2::new((lon - LON0) * 111_320.0 * LAT0.to_radians().cos(), (lat - LAT0) * 111_132.0)
}

fn andorra() -> Option<Heightfield> {
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
    Some((scene(vec![layer("ground", LayerKind::Terrain(terrain(hf.clone())))]), hf))
}

#[test]
fn andorra_fills_the_picture_below_its_skyline() {
    let Some((scene, hf)) = andorra_scene() else { return };
    let view = view(&hf, [1.52, 42.42, 900.0], [1.60, 42.60, 0.0], 45.0, [1280, 720]);
    let frame = render(&scene, &view, &options(4));
    show("andorra", &frame);
    // Below the first ground of a column there is no sky: no cracks; what sky there is are the holes of the data.
    let mut holes = 0;
    for x in 0..frame.width {
        let column: Vec<u32> = (0..frame.height).map(|y| frame.id[y * frame.width + x]).collect();
        let first = column.iter().position(|&id| id != 0).unwrap_or(frame.height);
        holes += column[first..].iter().filter(|&&id| id == 0).count();
    }
    assert!(holes < 4000, "{holes} pixels of sky below the skyline");
    assert!(frame.id.iter().filter(|&&id| id == 1).count() > frame.id.len() / 2);
}
