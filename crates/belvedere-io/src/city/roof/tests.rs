use super::*;
use std::collections::HashMap;

fn ring(corners: &[[f64; 2]]) -> Vec<DVec2> {
    corners.iter().map(|c| DVec2::from(*c) + 500_000.0).collect()
}

/// An L with a court and a long arm.
fn footprint() -> Vec<Polygon> {
    let outer = ring(&[[0.0, 0.0], [120.0, 5.0], [118.0, 60.0], [70.0, 55.0], [66.0, 210.0], [-3.0, 200.0]]);
    let court = ring(&[[20.0, 20.0], [18.0, 80.0], [45.0, 82.0], [48.0, 22.0]]);
    vec![Polygon { outer, holes: vec![court] }]
}

fn area(polygon: &Polygon) -> f64 {
    let ring = |r: &Vec<DVec2>| (0..r.len()).map(|k| (r[k] - r[0]).perp_dot(r[(k + 1) % r.len()] - r[0])).sum::<f64>();
    0.5 * (ring(&polygon.outer) + polygon.holes.iter().map(ring).sum::<f64>())
}

fn volume(faces: &[CityFace]) -> f64 {
    let origin = faces[0].rings[0][0];
    let of = |ring: &Vec<DVec3>| {
        let at = |k: usize| ring[k] - origin;
        (2..ring.len()).map(|k| at(0).dot(at(k - 1).cross(at(k)))).sum::<f64>()
    };
    faces.iter().flat_map(|f| &f.rings).map(of).sum::<f64>() / 6.0
}

type Ground = Box<dyn Fn(DVec2) -> Option<f64>>;

/// Grounds of all slopes, plane, bent, stepped.
fn grounds() -> Vec<(String, Ground)> {
    let mut out: Vec<(String, Ground)> = Vec::new();
    for slope in [0.0, 0.1, 0.3, 0.6, 1.0] {
        let along = move |p: DVec2| (p - 500_000.0).dot(DVec2::new(0.6, 0.8));
        out.push((format!("plane {slope}"), Box::new(move |p| Some(900.0 + slope * along(p)))));
        let wave = move |p: DVec2| 6.0 * ((p.x - 500_000.0) / 40.0).sin() * ((p.y - 500_000.0) / 55.0).cos();
        out.push((format!("waves on {slope}"), Box::new(move |p| Some(900.0 + slope * along(p) + wave(p)))));
        let steps = move |p: DVec2| {
            let s = slope * along(p);
            (s / 12.0).floor() * 12.0 + (s.rem_euclid(12.0) * 3.0).min(12.0)
        };
        out.push((format!("terraces of {slope}"), Box::new(move |p| Some(900.0 + steps(p)))));
    }
    out
}

#[test]
fn roofs_lie_over_their_ground_on_any_slope_and_the_prism_is_closed() {
    for (name, ground) in grounds() {
        let (shape, height) = (footprint(), 9.0);
        let faces = prism_on(&shape, height, 0.0, &*ground).expect("a prism");
        let mut edges: HashMap<[[u64; 3]; 2], i32> = HashMap::new();
        let key = |p: DVec3| p.to_array().map(f64::to_bits);
        for ring in faces.iter().flat_map(|f| &f.rings) {
            for (a, b) in ring.iter().zip(ring.iter().cycle().skip(1)) {
                *edges.entry([key(*a), key(*b)]).or_default() += 1;
            }
        }
        for ([a, b], count) in &edges {
            assert!(*count == 1 && edges.get(&[*b, *a]) == Some(&1), "{name}: an edge {count} times, or open");
        }
        let expected = area(&shape[0]) * height;
        let found = volume(&faces);
        // Where ground breaks off at steps of 12 m, the floor lies below the lowest of it and the roof over the highest.
        let room = [("plane", 1e-6), ("waves", 0.6), ("terraces", 1.5)].into_iter().find(|(k, _)| name.starts_with(k));
        let room = room.expect("a kind").1;
        assert!((-1e-6..room).contains(&(found / expected - 1.0)), "{name}: {found} for {expected} m^3");
        check_clear(&name, &faces, height, &*ground);
    }
}

/// Points of the roof's triangles lie at least half its height over the ground, floors in the ground.
fn check_clear(name: &str, faces: &[CityFace], height: f64, ground: &dyn Fn(DVec2) -> Option<f64>) {
    let mut roof = 0;
    for face in faces.iter().filter(|f| f.surface != Surface::Wall && f.rings.len() == 1) {
        let corners = &face.rings[0];
        for k in 0..66 {
            let (u, v) = (f64::from(k % 11) / 10.0, f64::from(k / 11) / 10.0);
            let at = corners[0] + (corners[1] - corners[0]) * u.min(1.0 - v) + (corners[2] - corners[0]) * v;
            let over = at.z - ground(at.truncate()).expect("ground");
            if face.surface == Surface::Roof {
                roof += 1;
                assert!((0.4 * height..2.8 * height).contains(&over), "{name}: a roof {over} m over its ground");
            } else {
                assert!(over < 0.1 * height, "{name}: a floor {over} m over the ground");
            }
        }
    }
    assert!(roof > 0 || faces.iter().any(|f| f.rings.len() > 1), "{name}: no roof");
}

#[test]
fn flat_roofs_have_one_face_and_unknown_ground_is_told() {
    let level = prism_on(&footprint(), 8.0, 1.5, &|_| Some(20.0)).expect("a prism");
    assert_eq!(level.len(), 2 + 6 + 4);
    let heights: Vec<f64> = level.iter().flat_map(|f| &f.rings).flatten().map(|p| p.z).collect();
    assert!(heights.iter().all(|z| (z - 28.0).abs() < 1e-6 || (z - 18.5).abs() < 1e-6), "{heights:?}");
    assert_eq!(prism_on(&footprint(), 8.0, 0.0, &|_| None), None);
    let half = |p: DVec2| (p.x < 500_050.0).then_some(20.0);
    assert!(prism_on(&footprint(), 8.0, 0.0, &half).is_some());
}
