//! Terrain disocclusion as a displacement grid.

use belvedere_core::grid::{Grid, GridError, Nodes};
use belvedere_core::{Aabb, DVec2, DVec3, SpaceMap, TerrainDisocclusion};
use belvedere_testkit::Random;
use belvedere_testkit::laws::{Continuity, Joint, MapCase, Similarity};

const COLS: usize = 9;
const ROWS: usize = 7;

/// Random displacements, 0 on the rim.
fn values(strength: f64) -> Vec<f64> {
    let mut random = Random::new(4);
    (0..COLS * ROWS)
        .map(|i| {
            let (c, r) = (i % COLS, i / COLS);
            let rim = c == 0 || r == 0 || c == COLS - 1 || r == ROWS - 1;
            let v = strength * random.range(-60.0, 20.0);
            if rim { 0.0 } else { v }
        })
        .collect()
}

fn map(values: Vec<f64>) -> TerrainDisocclusion {
    let grid = Grid::new(DVec2::new(500.0, 900.0), DVec2::new(100.0, 80.0), COLS, ROWS, values).unwrap();
    TerrainDisocclusion::new(grid)
}

/// Grids lie along the axes, so a case is moved by shift and scale alone.
fn moved(s: &Similarity) -> TerrainDisocclusion {
    let north_west = s.translation.truncate() + s.scale * DVec2::new(500.0, 900.0);
    let values = values(1.0).into_iter().map(|v| s.length(v)).collect();
    let grid = Grid::new(north_west, s.scale * DVec2::new(100.0, 80.0), COLS, ROWS, values).unwrap();
    TerrainDisocclusion::new(grid)
}

fn case() -> MapCase<TerrainDisocclusion> {
    let region = Aabb::of([DVec3::new(300.0, 200.0, -100.0), DVec3::new(1500.0, 1000.0, 900.0)]);
    let joints = [
        Joint { point: DVec3::new(700.0, 611.0, 50.0), across: DVec3::X },
        Joint { point: DVec3::new(733.0, 660.0, 50.0), across: DVec3::Y },
        Joint { point: DVec3::new(500.0, 611.0, 50.0), across: DVec3::X },
    ];
    MapCase::new("random grid", region, moved)
        .continuity(Continuity::C0)
        .unturned()
        .joints(joints)
        .domain(0.9, |map, p| {
            // Differences across a grid line measure neither side.
            let g = map.grid().grid_from_scene(p.truncate());
            (g - g.round()).abs().min_element() > 1e-3
        })
        .identity_at_zero_strength(|| map(values(0.0)))
}

belvedere_testkit::space_map_laws!(laws, super::case());

/// The same over ground whose nodes lie closer than those of the grid.
fn on_ground(map: TerrainDisocclusion, s: &Similarity) -> TerrainDisocclusion {
    let north_west = s.translation.truncate() + s.scale * DVec2::new(500.0, 900.0);
    let ground = Nodes { north_west, spacing: s.scale * DVec2::new(25.0, 40.0), cols: 33, rows: 13 };
    TerrainDisocclusion::new(map.grid().clone().on_facets(ground))
}

fn case_on_facets() -> MapCase<TerrainDisocclusion> {
    let region = Aabb::of([DVec3::new(300.0, 200.0, -100.0), DVec3::new(1500.0, 1000.0, 900.0)]);
    let joints = [
        Joint { point: DVec3::new(700.0, 611.0, 50.0), across: DVec3::X },
        Joint { point: DVec3::new(712.5, 640.0, 50.0), across: DVec3::new(1.0, 1.0, 0.0) },
    ];
    MapCase::new("random grid on facets", region, |s| on_ground(moved(s), s))
        .continuity(Continuity::C0)
        .unturned()
        .joints(joints)
        .domain(0.8, |map, p| {
            // Differences across an edge measure neither side.
            let g = map.grid().facets().unwrap_or(map.grid().nodes()).grid_from_scene(p.truncate());
            let away = |v: f64| (v - v.round()).abs() > 1e-3;
            away(g.x) && away(g.y) && away(g.x - g.y)
        })
        .identity_at_zero_strength(|| on_ground(map(values(0.0)), &Similarity::IDENTITY))
}

belvedere_testkit::space_map_laws!(laws_on_facets, super::case_on_facets());

#[test]
fn on_facets_values_are_those_of_the_nodes_of_the_ground_and_flat_between() {
    let bilinear = map(values(1.0));
    let m = on_ground(bilinear.clone(), &Similarity::IDENTITY);
    let at =
        |m: &TerrainDisocclusion, g: [f64; 2]| m.delta_at(DVec3::new(500.0 + 25.0 * g[0], 900.0 - 40.0 * g[1], 0.0));
    let mut most = 0.0f64;
    for (col, row) in (0..12).flat_map(|row| (0..32).map(move |col| (f64::from(col), f64::from(row)))) {
        let [nw, ne, sw, se] =
            [[0.0, 0.0], [1.0, 0.0], [0.0, 1.0], [1.0, 1.0]].map(|[x, y]| at(&m, [col + x, row + y]));
        for (g, corner) in [([0.0, 0.0], nw), ([1.0, 0.0], ne), ([0.0, 1.0], sw), ([1.0, 1.0], se)] {
            assert!((at(&bilinear, [col + g[0], row + g[1]]) - corner).abs() < 1e-9);
        }
        for ([x, y], flat) in [
            ([0.5, 0.5], 0.5 * (nw + se)),
            ([0.75, 0.25], 0.25 * nw + 0.5 * ne + 0.25 * se),
            ([0.25, 0.75], 0.25 * nw + 0.5 * sw + 0.25 * se),
        ] {
            assert!((at(&m, [col + x, row + y]) - flat).abs() < 1e-9, "{col} {row}: {x} {y}");
            most = most.max((at(&bilinear, [col + x, row + y]) - flat).abs());
        }
    }
    assert!(most > 0.3, "{most}");
    // An edge of a triangle stays straight; one across it does not.
    let p = |g: [f64; 2]| DVec3::new(500.0 + 25.0 * g[0], 900.0 - 40.0 * g[1], 0.0);
    assert!(m.edge_bound(p([14.0, 5.0]), p([15.0, 6.0])) < 1e-9 && m.edge_bound(p([15.0, 5.0]), p([14.0, 6.0])) > 1e-3);
}

#[test]
fn nodes_are_read_from_the_north_west_row_by_row() {
    let mut v = vec![0.0; COLS * ROWS];
    v[2 * COLS + 5] = -7.5; // row 2 from the north, column 5 from the west
    let m = map(v);
    let node = DVec3::new(500.0 + 5.0 * 100.0, 900.0 - 2.0 * 80.0, 12.0);
    assert_eq!(m.apply(node).unwrap(), node + DVec3::new(0.0, 0.0, -7.5));
    assert_eq!(m.delta_at(node + DVec3::new(50.0, 40.0, 0.0)), -7.5 / 4.0);
    assert_eq!(m.delta_at(node + DVec3::new(100.0, 0.0, 0.0)), 0.0);
    // One-sided on the grid line: the cell to the east falls back to 0 over 100 m.
    assert!((m.jacobian(node).unwrap().x_axis.z - 7.5 / 100.0).abs() < 1e-15);
    assert!((m.jacobian(node).unwrap().y_axis.z - -7.5 / 80.0).abs() < 1e-15);
}

#[test]
fn outside_the_grid_nothing_moves_and_the_rim_keeps_its_values() {
    let m = map(vec![-5.0; COLS * ROWS]);
    for (p, delta) in [
        (DVec3::new(500.0, 900.0, 1.0), -5.0),
        (DVec3::new(1300.0, 420.0, 1.0), -5.0),
        (DVec3::new(499.999, 900.0, 1.0), 0.0),
        (DVec3::new(800.0, 419.999, 1.0), 0.0),
    ] {
        assert_eq!(m.apply(p).unwrap().z - p.z, delta, "{p}");
    }
    // The step at the rim is part of the bound of an edge across it.
    let bound = m.edge_bound(DVec3::new(450.0, 700.0, 0.0), DVec3::new(650.0, 700.0, 0.0));
    assert!((3.75..5.1).contains(&bound), "{bound}");
}

#[test]
fn edge_bound_is_never_below_the_sampled_truth() {
    let mut random = Random::new(15);
    let mut ratios = Vec::new();
    for round in 0..20_000 {
        let m = if round % 2 == 0 {
            map(values(1.0))
        } else {
            map((0..COLS * ROWS).map(|i| (i * i % 13) as f64).collect())
        };
        let m = if round % 3 == 0 { on_ground(m, &Similarity::IDENTITY) } else { m };
        let p0 = DVec3::new(random.range(300.0, 1500.0), random.range(200.0, 1000.0), random.range(0.0, 900.0));
        let mut edge = random.direction() * 10f64.powf(random.range(0.0, 3.2));
        if round % 7 == 0 {
            edge.x = 0.0;
        }
        let p1 = p0 + edge;
        let bound = m.edge_bound(p0, p1);
        let (d0, d1) = (m.delta_at(p0), m.delta_at(p1));
        let truth = (0..=100)
            .map(|i| f64::from(i) / 100.0)
            .map(|t| (m.delta_at(p0.lerp(p1, t)) - (d0 + t * (d1 - d0))).abs())
            .fold(0.0, f64::max);
        assert!(bound >= truth - 1e-9, "edge {p0} {p1}: bound {bound}, truth {truth}");
        if truth > 0.1 {
            ratios.push(bound / truth);
        }
    }
    ratios.sort_by(f64::total_cmp);
    let high = ratios[ratios.len() * 95 / 100];
    assert!(high < 2.1, "95 % of the bounds are within a factor of {high}");
    let m = map(values(1.0));
    assert_eq!(m.edge_bound(DVec3::new(-9e9, 0.0, 0.0), DVec3::new(9e9, 1.0, 0.0)), 0.0);
    assert_eq!(m.edge_bound(DVec3::ZERO, DVec3::NAN), f64::INFINITY);
}

#[test]
fn displaced_boxes_contain_the_images_of_their_points() {
    let (m, mut random) = (map(values(1.0)), Random::new(16));
    for _ in 0..1000 {
        let a = DVec3::new(random.range(300.0, 1500.0), random.range(200.0, 1000.0), 0.0);
        let bounds = Aabb::of([a, a + DVec3::new(random.range(-400.0, 400.0), random.range(-400.0, 400.0), 100.0)]);
        let out = m.displaced_bounds(&bounds).unwrap();
        for _ in 0..50 {
            let q = m.apply(random.point(&bounds)).unwrap();
            assert!(q.cmpge(out.min).all() && q.cmple(out.max).all(), "{q} leaves {out:?}");
        }
    }
    assert!(m.displaced_bounds(&Aabb::EMPTY).is_none());
}

#[test]
fn unusable_grids_are_refused() {
    let new =
        |dx: f64, cols, rows, v: Vec<f64>| Grid::new(DVec2::ZERO, DVec2::new(dx, 1.0), cols, rows, v).unwrap_err();
    assert!(matches!(new(1.0, 1, 5, vec![0.0; 5]), GridError::TooSmall { cols: 1, rows: 5 }));
    assert!(matches!(new(1.0, 3, 2, vec![0.0; 5]), GridError::Length { given: 5, .. }));
    assert!(matches!(new(1.0, usize::MAX, 2, vec![0.0; 5]), GridError::Length { .. }));
    for dx in [0.0, -1.0, f64::NAN, f64::INFINITY] {
        assert!(matches!(new(dx, 2, 2, vec![0.0; 4]), GridError::Placement { .. }));
    }
    assert!(matches!(new(1.0, 2, 2, vec![0.0, 1.0, f64::NAN, 2.0]), GridError::NotFinite { col: 0, row: 1, .. }));
    let text = new(1.0, 2, 2, vec![f64::INFINITY; 4]).to_string();
    assert!(text.contains("column 0, row 0"), "{text}");
}
