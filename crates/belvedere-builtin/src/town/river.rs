//! The river, its bridges, and trees.

use super::grid::Grid;
use super::solids::{face, stacked};
use crate::noise::Random;
use belvedere_core::{DVec2, DVec3};
use belvedere_scene::{City, CityArea, LandCover, Polygon, Structure, StructureKind, Surface, Way, WayClass};

/// Length of the river beyond the streets, metres.
const BEYOND_M: f64 = 160.0;
/// Bank between the street along the river and the water, metres.
const BANK_M: f64 = 6.0;

/// Adds the water, its centre line, its bridges, and trees on its banks.
pub(super) fn build(grid: &Grid, random: &mut Random, city: &mut City) {
    let row = grid.river();
    let half_streets = [0.5 * grid.width(row, 1) + BANK_M, 0.5 * grid.width(row + 1, 1) + BANK_M];
    let (mut south, mut north, mut middle) = (Vec::new(), Vec::new(), Vec::new());
    for col in 0..=grid.cols() {
        let (a, b) = (grid.node(col, row), grid.node(col, row + 1));
        let across = (b - a).normalize_or_zero();
        south.push(a + across * half_streets[0]);
        north.push(b - across * half_streets[1]);
        middle.push(0.5 * (a + b));
        if grid.goes_north(col, row) {
            city.structures.push(bridge(a, b, grid.width(col, 0), city.structures.len()));
        }
    }
    for bank in [&mut south, &mut north, &mut middle] {
        if let [first, .., last] = bank[..] {
            bank.insert(0, first - DVec2::X * BEYOND_M);
            bank.push(last + DVec2::X * BEYOND_M);
        }
    }
    for bank in [&south, &north] {
        for pair in bank.windows(2).skip(1) {
            if random.unit() < 0.6 {
                let outward = if std::ptr::eq(bank, &south) { -3.0 } else { 3.0 };
                let at = pair[0].lerp(pair[1], random.range(0.25, 0.75)) + DVec2::Y * outward;
                city.structures.push(tree(at, random, city.structures.len()));
            }
        }
    }
    let outer = south.into_iter().chain(north.into_iter().rev()).collect();
    let polygons = vec![Polygon { outer, holes: Vec::new() }];
    city.areas.push(CityArea { name: "River".into(), cover: LandCover::Water, polygons });
    city.ways.push(Way { name: "River".into(), class: WayClass::Waterway, points: middle });
}

/// Adds trees on a lawn, a convex ring of four corners.
pub(super) fn plant(lawn: &[DVec2], random: &mut Random, city: &mut City) {
    for _ in 0..34 {
        let (u, v) = (random.range(0.06, 0.94), random.range(0.06, 0.94));
        let at = lawn[0].lerp(lawn[1], u).lerp(lawn[3].lerp(lawn[2], u), v);
        city.structures.push(tree(at, random, city.structures.len()));
    }
}

/// A deck that rises to the middle of the river.
fn bridge(a: DVec2, b: DVec2, width: f64, count: usize) -> Structure {
    let side = (b - a).normalize_or_zero().perp() * (0.5 * width);
    let deck: Vec<(DVec2, f64)> =
        [(0.0, 0.3), (0.25, 1.6), (0.5, 2.0), (0.75, 1.6), (1.0, 0.3)].map(|(t, z)| (a.lerp(b, t), z)).to_vec();
    let mut faces = Vec::new();
    for pair in deck.windows(2) {
        let ((p, low), (q, high)) = (pair[0], pair[1]);
        let corner = |at: DVec2, z: f64, down: f64, sign: f64| (at + side * sign).extend(z - down);
        let quad = |ring: [DVec3; 4]| face(Surface::Other, ring.to_vec());
        faces.push(quad([
            corner(p, low, 0.0, -1.0),
            corner(q, high, 0.0, -1.0),
            corner(q, high, 0.0, 1.0),
            corner(p, low, 0.0, 1.0),
        ]));
        faces.push(quad([
            corner(p, low, 0.9, 1.0),
            corner(q, high, 0.9, 1.0),
            corner(q, high, 0.9, -1.0),
            corner(p, low, 0.9, -1.0),
        ]));
        faces.push(quad([
            corner(p, low, 0.9, -1.0),
            corner(q, high, 0.9, -1.0),
            corner(q, high, 0.0, -1.0),
            corner(p, low, 0.0, -1.0),
        ]));
        faces.push(quad([
            corner(q, high, 0.9, 1.0),
            corner(p, low, 0.9, 1.0),
            corner(p, low, 0.0, 1.0),
            corner(q, high, 0.0, 1.0),
        ]));
    }
    Structure { id: format!("bridge-{}", count + 1), name: String::new(), kind: StructureKind::Bridge, faces }
}

/// A crown of six sides, pointed above and below.
fn tree(at: DVec2, random: &mut Random, count: usize) -> Structure {
    const HALF_SQRT_3: f64 = 0.866_025_403_784_438_6;
    let (height, radius) = (random.range(7.0, 13.0), random.range(2.2, 3.6));
    let hexagon =
        [(1.0, 0.0), (0.5, HALF_SQRT_3), (-0.5, HALF_SQRT_3), (-1.0, 0.0), (-0.5, -HALF_SQRT_3), (0.5, -HALF_SQRT_3)];
    let ring = |scale: f64, z: f64| hexagon.map(|(x, y)| (at + DVec2::new(x, y) * radius * scale).extend(z)).to_vec();
    let rings = [vec![at.extend(0.0)], ring(0.85, 0.3 * height), ring(1.0, 0.55 * height), vec![at.extend(height)]];
    Structure {
        id: format!("tree-{}", count + 1),
        name: String::new(),
        kind: StructureKind::Vegetation,
        faces: stacked(&rings),
    }
}
