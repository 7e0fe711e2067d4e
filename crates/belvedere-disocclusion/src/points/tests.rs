//! Points on lines, rims and areas of a small field.

use super::*;
use belvedere_scene::{
    AreaFeature, AreaLayer, Color, Heightfield, Hidden, Layer, LineFeature, LineLayer, NodeState, PointFeature,
    PointLayer,
};

/// A plane rising eastwards, 40 x 30 nodes 10 m x 20 m apart, with a void at (20, 10).
fn field() -> Field {
    let (cols, rows) = (40, 30);
    let heights = (0..cols * rows).map(|i| (i % cols) as f32).collect();
    let mut states = vec![NodeState::Measured; cols * rows];
    states[10 * cols + 20] = NodeState::Void;
    let hf = Heightfield::new(DVec2::new(1000.0, 900.0), DVec2::new(10.0, 20.0), cols, rows, heights, states);
    Field::new(&hf.unwrap(), |_| 0.0).unwrap()
}

fn scene_point(field: &Field, g: [f64; 2]) -> DVec2 {
    field.scene_from_grid(DVec2::from(g))
}

fn lines(field: &Field, features: &[&[[f64; 2]]]) -> Scene {
    let path = |f: &[[f64; 2]]| f.iter().map(|&g| scene_point(field, g).extend(0.0)).collect();
    let features = features.iter().map(|f| LineFeature { style: None, name: String::new(), points: path(f) }).collect();
    let color = Color::rgb(0, 0, 0);
    let kind = LayerKind::Line(LineLayer {
        features,
        color,
        width_px: 1.0,
        casing: None,
        hidden: Hidden::Dash,
        lift_m: 1.5,
        markers: None,
        label_px: None,
        marker_px: belvedere_scene::SMALL_LETTERS_PX,
        beyond: 0.0,
    });
    Scene { layers: vec![Layer { id: "line".into(), must_see: true, kind }], ..Scene::default() }
}

fn area(field: &Field, rings: &[&[[f64; 2]]]) -> Scene {
    let ring = |r: &[[f64; 2]]| r.iter().map(|&g| scene_point(field, g)).collect();
    let features =
        vec![AreaFeature { style: None, name: String::new(), rings: rings.iter().map(|r| ring(r)).collect() }];
    let kind = LayerKind::Area(AreaLayer {
        features,
        fill: Color::rgb(0, 0, 0),
        outline: None,
        width_px: 1.0,
        surface: belvedere_scene::AreaSurface::Plain,
        hidden: Hidden::Cut,
        lift_m: 0.5,
        label_px: None,
        beyond: 0.0,
    });
    Scene { layers: vec![Layer { id: "area".into(), must_see: true, kind }], ..Scene::default() }
}

fn points(scene: &Scene, field: &Field, spacing: f64) -> (Vec<ReferencePoint>, Vec<Unusable>) {
    reference_points(scene, field, &TerrainSettings::default(), spacing)
}

#[test]
fn a_line_is_divided_into_equal_lengths_and_both_ends_count() {
    let field = field();
    let scene = lines(&field, &[&[[2.0, 3.0], [5.0, 7.0], [5.0, 7.0], [11.0, 7.0]], &[[1.0, 1.0], [1.0, 2.0]]]);
    let (found, unusable) = points(&scene, &field, 2.0);
    assert!(unusable.is_empty());
    let first: Vec<_> = found.iter().filter(|p| p.feature == 0).collect();
    assert_eq!(first.len(), 7, "11 cells in 6 parts");
    assert!((first[1].grid - DVec2::new(3.1, 3.0 + 11.0 / 6.0 * 0.8)).length() < 1e-12);
    assert!((first[3].grid - DVec2::new(5.5, 7.0)).length() < 1e-12);
    assert_eq!((first[6].grid, first[0].grid), (DVec2::new(11.0, 7.0), DVec2::new(2.0, 3.0)));
    // 3 cells of 10 m east and 4 of 20 m south, then 6 east.
    assert!((first[6].along_m - (30f64.hypot(80.0) + 60.0)).abs() < 1e-9);
    assert!(first.windows(2).all(|w| w[0].along_m < w[1].along_m));
    assert!(first.iter().all(|p| (p.ground - p.grid.x).abs() < 1e-9 && p.lift == 1.5 && p.kind == PointKind::Line));
    assert_eq!(found.len() - first.len(), 2, "a short line is its ends");
    let lifted = TerrainSettings { lift_m: Some(9.0), ..TerrainSettings::default() };
    assert!(reference_points(&scene, &field, &lifted, 2.0).0.iter().all(|p| p.lift == 9.0));
    assert_eq!(points(&scene, &field, 0.25).0.len(), 45 + 5, "dense");
}

#[test]
fn candidates_lie_on_the_bends_of_the_drawn_line() {
    let field = field();
    let scene = lines(&field, &[&[[2.05, 3.3], [9.4, 6.8], [9.4, 12.2], [17.5, 20.3]]]);
    let settings = TerrainSettings::default();
    let (even, _) = points(&scene, &field, settings.candidates);
    let found = candidate_points(&scene, &field, &settings);
    assert_eq!(found.len(), even.len());
    assert!(found.windows(2).all(|w| w[0].along_m <= w[1].along_m), "in their order");
    let bend = |p: DVec2| [p.x, p.y, p.x - p.y].iter().any(|v| (v - v.round()).abs() < 1e-9);
    for (p, q) in found.iter().zip(&even) {
        assert!((p.grid - q.grid).length() <= 0.5 * settings.candidates + 1e-9);
        assert!((p.ground - field.surface_at(p.grid).unwrap()).abs() < 1e-9);
        let corner = [6.8, 12.2].iter().any(|y| (p.grid - DVec2::new(9.4, *y)).length() < 1e-9);
        assert!(p.grid == q.grid || bend(p.grid) || corner, "{p:?}");
    }
    // The second leg runs south along x = 9.4: it crosses rows 7..=12 and the diagonals at y = k + 0.4.
    let leg = |y: f64| found.iter().filter(|p| (p.grid - DVec2::new(9.4, y)).length() < 1e-9).count();
    assert!((7..=12).all(|y| leg(f64::from(y)) == 1) && (7..=11).all(|y| leg(f64::from(y) + 0.4) == 1));
}

#[test]
fn short_and_broken_lines_have_a_defined_result() {
    let field = field();
    let one = points(&lines(&field, &[&[[4.0, 4.0]], &[], &[[6.0, 6.0], [6.0, 6.0]]]), &field, 2.0).0;
    let places: Vec<DVec2> = one.iter().map(|p| p.grid).collect();
    assert_eq!(places, [DVec2::splat(4.0), DVec2::splat(6.0)]);
    let broken = lines(&field, &[&[[4.0, 4.0], [f64::NAN, 2.0], [8.0, 4.0]], &[[f64::INFINITY, 1.0]]]);
    assert_eq!(points(&broken, &field, 2.0).0.len(), 3);
}

#[test]
fn points_beside_the_terrain_or_without_data_are_named_with_the_reason() {
    let field = field();
    let scene = lines(&field, &[&[[36.0, 10.0], [44.0, 10.0]], &[[20.0, 6.0], [20.0, 14.0]]]);
    let (found, unusable) = points(&scene, &field, 1.0);
    let of = |reason| unusable.iter().filter(|u| u.reason == reason).map(|u| u.grid).collect::<Vec<_>>();
    assert_eq!(of(UnusableReason::OutsideDem), (40..=44).map(|x| DVec2::new(f64::from(x), 10.0)).collect::<Vec<_>>());
    assert_eq!(of(UnusableReason::NoData), [DVec2::new(20.0, 10.0)]);
    assert_eq!(found.len() + unusable.len(), 18);
    assert!(found.iter().all(|p| p.ground.is_finite()));
}

#[test]
fn an_area_has_rims_and_a_lattice_inside_that_leaves_out_holes() {
    let field = field();
    let outer: &[[f64; 2]] = &[[2.0, 2.0], [18.0, 2.0], [18.0, 18.0], [2.0, 18.0]];
    let hole: &[[f64; 2]] = &[[6.5, 6.5], [13.5, 6.5], [13.5, 13.5], [6.5, 13.5], [6.5, 6.5]];
    let (found, _) = points(&area(&field, &[outer, hole]), &field, 1.0);
    let of = |kind| found.iter().filter(|p| p.kind == kind).collect::<Vec<_>>();
    assert_eq!(of(PointKind::Rim).len(), 64 + 28);
    // Lattice at 4, 8, 12, 16; the four in the middle lie in the hole.
    let inside: Vec<DVec2> = of(PointKind::Inside).iter().map(|p| p.grid).collect();
    assert_eq!(inside.len(), 12);
    assert!(inside.contains(&DVec2::new(4.0, 8.0)) && !inside.contains(&DVec2::new(8.0, 8.0)));
    let rim = of(PointKind::Rim);
    assert!(rim.windows(2).all(|w| w[0].along_m < w[1].along_m), "rings follow one another");
    // A pond smaller than the lattice still has its middle; one far beyond the terrain costs nothing.
    let pond: &[[f64; 2]] = &[[5.0, 5.0], [6.0, 5.0], [6.0, 6.0], [5.0, 6.0]];
    assert_eq!(points(&area(&field, &[pond]), &field, 2.0).0.last().unwrap().grid, DVec2::splat(5.5));
    let huge: &[[f64; 2]] = &[[-1e9, -1e9], [1e9, -1e9], [1e9, 1e9], [-1e9, 1e9]];
    assert!(points(&area(&field, &[huge]), &field, 2.0).0.is_empty());
}

#[test]
fn landmarks_are_themselves_and_layers_that_need_not_be_seen_have_no_points() {
    let field = field();
    let position = scene_point(&field, [7.25, 3.5]).extend(0.0);
    let kind = LayerKind::Point(PointLayer {
        features: vec![PointFeature { style: None, name: "hut".into(), position }],
        color: Color::rgb(0, 0, 0),
        size_px: 3.0,
        style: belvedere_scene::PointStyle::default(),
        hidden: Hidden::Fade,
        lift_m: 4.0,
        beyond: 0.0,
    });
    let mut scene = Scene { layers: vec![Layer { id: "huts".into(), must_see: true, kind }], ..Scene::default() };
    let found = points(&scene, &field, 2.0).0;
    assert_eq!((found.len(), found[0].grid, found[0].ground, found[0].lift), (1, DVec2::new(7.25, 3.5), 7.25, 4.0));
    scene.layers[0].must_see = false;
    assert!(points(&scene, &field, 2.0).0.is_empty());
}
