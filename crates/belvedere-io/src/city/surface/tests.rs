use super::*;
use belvedere_scene::{HeightSource, LandCover};

fn square(from: f64, to: f64) -> Vec<DVec2> {
    vec![DVec2::new(from, from), DVec2::new(to, from), DVec2::new(to, to), DVec2::new(from, to)]
}

#[test]
fn footprints_become_closed_walls_and_roofs_with_courts() {
    let mut court = square(3.0, 7.0);
    court.reverse();
    let footprint = vec![Polygon { outer: square(0.0, 10.0), holes: vec![court] }];
    let building = Building {
        id: "b".into(),
        name: "hall".into(),
        landmark: false,
        footprint,
        base_m: None,
        height_m: 12.0,
        height_source: HeightSource::Stated,
        faces: Vec::new(),
    };
    let areas = vec![belvedere_scene::CityArea {
        name: String::new(),
        cover: LandCover::Water,
        polygons: vec![Polygon { outer: square(20.0, 30.0), holes: vec![] }],
    }];
    let city = City { buildings: vec![building], areas, ..City::default() };
    let mesh = surface(&city, &CityColors::default(), CityGround::Plate(0.0, &[]));
    let corners = |t: &[u32; 3]| t.map(|v| mesh.positions[v as usize]);
    let part = |p: u32| mesh.triangles.iter().zip(&mesh.parts).filter(move |(_, q)| **q == p).map(|(t, _)| corners(t));
    assert_eq!(mesh.names, ["", "hall"]);
    let area = |[a, b, c]: [DVec3; 3]| 0.5 * (b - a).cross(c - a);
    let roof: f64 = part(1).map(area).filter(|n| n.z.abs() > 1e-9).map(|n| n.z).sum();
    let walls: f64 = part(1).map(area).filter(|n| n.z.abs() < 1e-9).map(DVec3::length).sum();
    assert!((roof - 84.0).abs() < 1e-9 && (walls - 12.0 * 56.0).abs() < 1e-9, "{roof} {walls}");
    // Walls look outwards: their flow through a closed surface is that of the roof downwards, nothing sideways.
    let sum: DVec3 = part(1).map(area).sum();
    assert!(sum.truncate().length() < 1e-9, "{sum}");
    let on_ground = surface(&city, &CityColors::default(), CityGround::Terrain(&|xy: DVec2| Some(100.0 + xy.x)));
    let lowest = on_ground.positions.iter().map(|p| p.z).fold(f64::INFINITY, f64::min);
    assert_eq!((lowest, on_ground.names.len()), (100.0, 2));
}

#[test]
fn roofs_of_buildings_lie_over_the_ground_on_any_slope() {
    let building = |height_m: f64| Building {
        id: "b".into(),
        name: String::new(),
        landmark: false,
        footprint: vec![Polygon { outer: square(0.0, 60.0), holes: Vec::new() }],
        base_m: None,
        height_m,
        height_source: HeightSource::Stated,
        faces: Vec::new(),
    };
    // A ridge in the middle of the building, off its outline.
    let ridge = |xy: DVec2| Some(100.0 + 20.0 * (1.0 - ((xy - 30.0).abs().max_element() / 30.0)).max(0.0));
    let slope = |xy: DVec2| Some(100.0 + 0.6 * xy.x);
    let grounds: [&dyn Fn(DVec2) -> Option<f64>; 2] = [&ridge, &slope];
    for (ground, highest) in grounds.into_iter().zip([115.0, 136.0]) {
        for height in [2.0, 7.0, 80.0] {
            let city = City { buildings: vec![building(height)], ..City::default() };
            let mesh = surface(&city, &CityColors::default(), CityGround::Terrain(ground));
            let top = mesh.positions.iter().map(|p| p.z).fold(f64::MIN, f64::max);
            let low = mesh.positions.iter().map(|p| p.z).fold(f64::MAX, f64::min);
            assert!(top > highest + height.min(2.0) - 1e-9 && top >= 100.0 + height, "{top} with {height}");
            assert!((low - 100.0).abs() < 1e-9, "{low}");
        }
    }
}
