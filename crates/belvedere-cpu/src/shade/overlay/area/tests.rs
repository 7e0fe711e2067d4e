use super::*;
use belvedere_scene::Hidden;

fn layer(rings: Vec<Vec<DVec2>>) -> AreaLayer {
    AreaLayer {
        features: vec![AreaFeature { style: None, name: String::new(), rings }],
        fill: Color::rgb(1, 2, 3),
        outline: None,
        width_px: 1.0,
        surface: AreaSurface::Water,
        hidden: Hidden::Cut,
        lift_m: 0.0,
        label_px: None,
        beyond: 0.0,
    }
}

#[test]
fn inside_agrees_with_ray_crossing_everywhere() {
    let star: Vec<DVec2> =
        (0..40).map(|i| DVec2::from_angle(f64::from(i) * 0.157) * if i % 2 == 0 { 90.0 } else { 37.0 }).collect();
    let hole: Vec<DVec2> =
        (0..9).map(|i| DVec2::from_angle(f64::from(i) * 0.698) * 20.0 + DVec2::new(5.0, 3.0)).collect();
    let rings = vec![star, hole];
    let map = AreaMap::new(0, &layer(rings.clone()), &AreaCache::default()).unwrap();
    let mut inside = 0;
    for i in 0..20_000 {
        let p = DVec2::new(
            (f64::from(i) * 0.618_034).fract() * 220.0 - 110.0,
            (f64::from(i) * 0.754_878).fract() * 220.0 - 110.0,
        );
        let odd = rings
            .iter()
            .flat_map(|r| (0..r.len()).map(move |k| (r[k], r[(k + 1) % r.len()])))
            .filter(|(a, b)| (a.y > p.y) != (b.y > p.y) && p.x < a.x + (p.y - a.y) / (b.y - a.y) * (b.x - a.x));
        let expected = odd.count() % 2 == 1;
        inside += u32::from(expected);
        assert_eq!(map.border(p).inside > 0.0, expected, "{p}");
    }
    assert!(inside > 3000);
}
#[test]
fn an_index_is_made_once_for_the_same_edges() {
    let square = |size: f64| vec![vec![DVec2::ZERO, DVec2::X * size, DVec2::splat(size), DVec2::Y * size]];
    let cache = AreaCache::default();
    let index = |size: f64, width_px: f64| {
        let area = AreaLayer { width_px, ..layer(square(size)) };
        AreaMap::new(3, &area, &cache).unwrap().index
    };
    let first = index(10.0, 1.0);
    assert!(Arc::ptr_eq(&first, &index(10.0, 0.2)), "the same edges in another style");
    assert!(!Arc::ptr_eq(&first, &index(11.0, 1.0)), "other edges");
    (0..KEPT).for_each(|k| drop(index(20.0 + k as f64, 1.0)));
    assert!(!Arc::ptr_eq(&first, &index(10.0, 1.0)), "used long ago");
    assert!(AreaMap::new(0, &layer(vec![]), &cache).is_none());
}
