use super::*;

#[test]
fn longitudes_are_taken_the_nearest_way_round() {
    let (from, to) = (CoordinateSystem::wgs84().unwrap(), CoordinateSystem::from_epsg(3857).unwrap());
    // Nodes every degree around the whole earth, from Greenwich and from its opposite.
    for west in [0.5, -179.5] {
        let map = Affine([1.0, 0.0, west, 0.0, -1.0, 60.0]);
        let link = Link::of(map, Some(&from), [360, 121], Some(&to), Path::new("world")).unwrap();
        for c in 0..360 {
            let index = DVec2::new(f64::from(c), 40.0);
            let back = link.index_from_scene(link.scene_from_index(index).unwrap()).unwrap();
            assert!((back - index).length() < 1e-6, "{index} from {west} comes back as {back}");
        }
    }
}

#[test]
fn a_local_scene_is_in_metres_whatever_the_source_counts_in() {
    let feet = CoordinateSystem::from_epsg(2230).unwrap();
    let map = Affine([100.0, 0.0, 0.0, 0.0, -100.0, 0.0]);
    let link = Link::of(map, Some(&feet), [2, 2], None, Path::new("x")).unwrap();
    let p = link.scene_from_index(DVec2::new(39.37, 0.0)).unwrap();
    assert!((p - DVec2::new(1200.0, 0.0)).length() < 1e-9, "{p}");
    assert!((link.index_from_scene(p).unwrap() - DVec2::new(39.37, 0.0)).length() < 1e-12);
}

#[test]
fn beyond_all_numbers_there_is_no_position() {
    let link = Link::of(Affine([10.0, 0.0, 0.0, 0.0, -10.0, 0.0]), None, [2, 2], None, Path::new("x")).unwrap();
    assert_eq!(link.scene_from_index(DVec2::new(3.0, 4.0)), Some(DVec2::new(30.0, -40.0)));
    assert_eq!(link.scene_from_index(DVec2::new(f64::MAX, 0.0)), None);
}

#[test]
fn a_map_that_bends_only_far_from_its_first_node_is_within_the_tolerance_everywhere() {
    let bump = |x: f64| 1e-3 * (x - 80.0).max(0.0).powi(2);
    let along_x = |p: DVec2| Some(p + DVec2::new(0.0, bump(p.x)));
    let along_y = |p: DVec2| Some(p + DVec2::new(bump(p.y), 0.0));
    for exact in [&along_x as &(dyn Fn(DVec2) -> Option<DVec2> + Sync), &along_y] {
        let map = GridMap::new(129, 129, 0.01, exact);
        assert!(map.step > 1, "every node is computed exactly");
        let mut row = vec![DVec2::ZERO; 129];
        for r in 0..129 {
            map.row(r, &mut row);
            for (c, p) in row.iter().enumerate() {
                let off = p.distance(exact(DVec2::new(c as f64, r as f64)).unwrap());
                assert!(off < 0.01, "node {c}, {r} is {off} off");
            }
        }
    }
}
