//! The built-in town: the same on every platform, buildings without overlaps, its faces closed and turned outward.

use belvedere_builtin::{BuiltinError, town};
use belvedere_core::{DVec2, DVec3};
use belvedere_scene::{City, CityFace, HeightSource, LandCover, StructureKind, WayClass};
use std::collections::{BTreeSet, HashMap};

fn doubled_area(ring: &[DVec2]) -> f64 {
    (0..ring.len()).map(|k| ring[k].perp_dot(ring[(k + 1) % ring.len()])).sum()
}

/// Six times the volume within the faces.
fn volume(faces: &[CityFace]) -> f64 {
    faces
        .iter()
        .flat_map(|f| &f.rings)
        .flat_map(|r| (1..r.len() - 1).map(move |k| r[0].dot(r[k].cross(r[k + 1]))))
        .sum()
}

/// Whether every edge is used equally often in both directions.
fn closed(faces: &[CityFace]) -> bool {
    let key = |p: DVec3| [p.x, p.y, p.z].map(|v| (v * 1e6).round() as i64);
    let mut edges: HashMap<_, i32> = HashMap::new();
    for ring in faces.iter().flat_map(|f| &f.rings) {
        for k in 0..ring.len() {
            let (a, b) = (key(ring[k]), key(ring[(k + 1) % ring.len()]));
            *edges.entry((a.min(b), a.max(b))).or_default() += if a < b { 1 } else { -1 };
        }
    }
    edges.values().all(|v| *v == 0)
}

#[test]
fn town_has_what_a_town_has() {
    let city = town(7, 1200.0).unwrap();
    assert!((1200..=1900).contains(&city.buildings.len()), "{} buildings", city.buildings.len());
    let flat = city.buildings.iter().filter(|b| b.faces.is_empty()).count();
    let share = flat as f64 / city.buildings.len() as f64;
    assert!((0.2..0.4).contains(&share), "{share} under flat roofs");
    let landmarks: Vec<&str> = city.buildings.iter().filter(|b| b.landmark).map(|b| b.name.as_str()).collect();
    assert_eq!(landmarks, ["Town Church", "Town Hall"]);
    let classes: BTreeSet<WayClass> = city.ways.iter().map(|w| w.class).collect();
    for class in [WayClass::Primary, WayClass::Secondary, WayClass::Tertiary, WayClass::Residential, WayClass::Waterway]
    {
        assert!(classes.contains(&class), "no way of {class:?}");
    }
    let covers: BTreeSet<LandCover> = city.areas.iter().map(|a| a.cover).collect();
    assert!([LandCover::Water, LandCover::Green, LandCover::Road].iter().all(|c| covers.contains(c)), "{covers:?}");
    let bridges = city.structures.iter().filter(|s| s.kind == StructureKind::Bridge).count();
    assert!((2..=9).contains(&bridges), "{bridges} bridges");
}

#[test]
fn faces_are_closed_and_turned_outward() {
    let city = town(11, 900.0).unwrap();
    for building in &city.buildings {
        assert!(building.height_m > 2.0 && building.height_m < 70.0);
        assert!(building.footprint.iter().all(|p| doubled_area(&p.outer) > 0.0));
        assert_eq!(building.faces.is_empty(), building.height_source == HeightSource::Stated);
        if !building.faces.is_empty() {
            assert!(volume(&building.faces) > 0.0, "{} is inside out", building.id);
            assert!(closed(&building.faces), "{} has a hole", building.id);
        }
    }
    for tree in city.structures.iter().filter(|s| s.kind == StructureKind::Vegetation) {
        assert!(volume(&tree.faces) > 0.0 && closed(&tree.faces), "{}", tree.id);
    }
}

#[test]
fn areas_and_ways_are_well_formed() {
    for seed in 0..12 {
        let city = town(seed, 700.0 + 150.0 * seed as f64).unwrap();
        for polygon in city.areas.iter().flat_map(|a| &a.polygons) {
            assert!(doubled_area(&polygon.outer) > 0.0, "seed {seed}");
        }
        assert!(city.ways.iter().all(|w| w.points.len() >= 2 && !w.name.is_empty()));
        let ids: BTreeSet<&str> = city.buildings.iter().map(|b| b.id.as_str()).collect();
        assert_eq!(ids.len(), city.buildings.len(), "seed {seed}: ids repeat");
    }
}

#[test]
fn houses_stay_out_of_each_other_and_off_the_water() {
    let city = town(7, 1200.0).unwrap();
    let middle = |city: &City, k: usize| {
        let ring = &city.buildings[k].footprint[0].outer;
        ring.iter().sum::<DVec2>() / ring.len() as f64
    };
    let inside = |ring: &[DVec2], p: DVec2| {
        (0..ring.len()).fold(false, |within, k| {
            let (a, b) = (ring[k], ring[(k + 1) % ring.len()]);
            let crosses = (a.y > p.y) != (b.y > p.y) && p.x < a.x + (b.x - a.x) * (p.y - a.y) / (b.y - a.y);
            within != crosses
        })
    };
    let water = &city.areas.iter().find(|a| a.cover == LandCover::Water).unwrap().polygons[0].outer;
    for k in 0..city.buildings.len() {
        let at = middle(&city, k);
        assert!(!inside(water, at), "{} stands in the river", city.buildings[k].id);
        for other in 0..city.buildings.len() {
            let hit = other != k && city.buildings[other].footprint.iter().any(|p| inside(&p.outer, at));
            assert!(!hit, "{} stands in {}", city.buildings[k].id, city.buildings[other].id);
        }
    }
}

#[test]
fn seeds_differ_and_repeat() {
    assert_eq!(town(7, 800.0).unwrap(), town(7, 800.0).unwrap());
    assert_ne!(town(7, 800.0).unwrap(), town(8, 800.0).unwrap());
    for size_m in [0.0, 499.0, 5001.0, f64::NAN, f64::INFINITY] {
        assert!(matches!(town(7, size_m), Err(BuiltinError::TownSize { .. })), "{size_m}");
    }
}
