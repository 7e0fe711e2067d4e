use super::*;

fn square(from: [f64; 2], to: [f64; 2]) -> Polygon {
    let outer = [from, [to[0], from[1]], to, [from[0], to[1]]].map(DVec2::from).to_vec();
    Polygon { outer, holes: Vec::new() }
}

fn area(polygons: &[Polygon]) -> f64 {
    let ring = |r: &Vec<DVec2>| (0..r.len()).map(|k| r[k].perp_dot(r[(k + 1) % r.len()])).sum::<f64>() / 2.0;
    polygons.iter().flat_map(|p| std::iter::once(&p.outer).chain(&p.holes)).map(ring).sum()
}

#[test]
fn streets_of_one_area_that_cross_each_other_often_stay_streets() {
    // 40 streets each way of 2 m, every 10 m: 1,600 crossings of four edges each.
    let along = (0..40).map(|k| 10.0 * f64::from(k) + 4.0);
    let streets = along.flat_map(|at| [square([at, 0.0], [at + 2.0, 400.0]), square([0.0, at], [400.0, at + 2.0])]);
    let roads = CityArea { name: "a".into(), cover: LandCover::Road, polygons: streets.collect() };
    let map = land_cover(&[roads], [DVec2::ZERO, DVec2::splat(400.0)]);
    let roads = area(&map.areas[0].polygons);
    assert!((roads - (400.0 * 400.0 - 320.0 * 320.0)).abs() < 1.0, "{roads} m^2 of streets");
}

#[test]
fn pieces_cover_the_ground_once_and_share_their_vertices() {
    let of = |cover, polygon| CityArea { name: "a".into(), cover, polygons: vec![polygon] };
    let areas = [
        of(LandCover::Green, square([10.0, 10.0], [60.0, 60.0])),
        of(LandCover::Green, square([50.0, 10.0], [80.0, 40.0])),
        of(LandCover::Road, square([-20.0, 30.0], [200.0, 36.0])),
        of(LandCover::Water, square([40.0, 0.0], [48.0, 100.0])),
    ];
    let map = land_cover(&areas, [DVec2::ZERO, DVec2::splat(100.0)]);
    let kind = |cover| area(&map.areas.iter().find(|a| a.cover == cover).expect("a piece").polygons);
    assert!((kind(LandCover::Road) - 600.0).abs() < 1e-3);
    assert!((kind(LandCover::Water) - 8.0 * 94.0).abs() < 1e-3);
    let green = 50.0 * 50.0 + 20.0 * 30.0 - 6.0 * 70.0 - 8.0 * 44.0;
    assert!((kind(LandCover::Green) - green).abs() < 1e-3);
    let all: f64 = map.areas.iter().map(|a| area(&a.polygons)).sum::<f64>() + area(&map.bare);
    assert!((all - 1e4).abs() < 1e-3);
    // No vertex lies inside an edge: each edge inside the ground is one of another piece, backwards.
    let polygons = map.areas.iter().flat_map(|a| &a.polygons).chain(&map.bare);
    let rings = polygons.flat_map(|p| std::iter::once(&p.outer).chain(&p.holes));
    let key = |p: DVec2| (p * 1e3).round().to_array().map(|v| v as i64);
    let edges: Vec<_> = rings.flat_map(|r| (0..r.len()).map(|k| [key(r[k]), key(r[(k + 1) % r.len()])])).collect();
    let rim = |[p, q]: &[[i64; 2]; 2]| (0..2).any(|c| p[c] == q[c] && (p[c] == 0 || p[c] == 100_000));
    for edge in edges.iter().filter(|e| !rim(e)) {
        assert!(edges.contains(&[edge[1], edge[0]]), "{edge:?}");
    }
}
