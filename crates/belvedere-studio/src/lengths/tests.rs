use super::*;

fn hills() -> Scene {
    let heights =
        (0..61 * 81).map(|i| (60.0 * (f64::from(i % 81) / 6.0).sin() * (f64::from(i / 81) / 9.0).cos()) as f32);
    let ground = Heightfield::measured(DVec2::new(-400.0, 1800.0), DVec2::new(25.0, 30.0), 81, 61, heights.collect());
    Scene::default().with_terrain("ground", ground.expect("ground"))
}

/// Sums over many short steps on the drawn surface.
fn by_small_steps(scene: &Scene, points: &[DVec3]) -> [f64; 3] {
    let ground = scene.terrain().expect("ground");
    let [mut length, mut climb, mut descent] = [0.0; 3];
    for pair in points.windows(2) {
        let at = |k: u32| {
            let xy = pair[0].truncate().lerp(pair[1].truncate(), f64::from(k) / 200_000.0);
            xy.extend(ground.surface_at(xy).expect("ground"))
        };
        let mut last = at(0);
        for k in 1..=200_000 {
            let now = at(k);
            length += now.distance(last);
            climb += (now.z - last.z).max(0.0);
            descent += (last.z - now.z).max(0.0);
            last = now;
        }
    }
    [length, climb, descent]
}

#[test]
fn lengths_along_the_ground_are_those_of_many_small_steps() {
    let scene = hills();
    let points =
        [[-390.0, 20.0, 0.0], [1500.0, 1700.0, 0.0], [1333.0, 210.0, 0.0], [-100.0, 210.0, 0.0]].map(DVec3::from_array);
    let of = lengths(&scene, &points);
    let [length, climb, descent] = by_small_steps(&scene, &points);
    let along = of.along_ground.expect("ground everywhere");
    assert!((along - length).abs() < 1e-6 * length, "{along} {length}");
    assert!((of.climb - climb).abs() < 1e-6 * climb && (of.descent - descent).abs() < 1e-6 * descent);
    assert!(along > of.straight + 20.0, "hills make a way longer: {along} {}", of.straight);
    let steps = of.profile.windows(2).all(|pair| pair[1][0] >= pair[0][0]);
    assert!(steps && of.profile.len() > 100 && of.profile.len() <= PROFILE);
}

#[test]
fn areas_are_in_plan_and_gaps_are_not_walked_over() {
    let scene = hills();
    let square = [[0.0, 0.0, 5.0], [300.0, 0.0, 90.0], [300.0, 200.0, 7.0], [0.0, 200.0, 0.0]].map(DVec3::from_array);
    assert_eq!(lengths(&scene, &square).area, Some(60_000.0));
    assert_eq!(lengths(&scene, &square[..2]).area, None);
    let beyond = [square[0], DVec3::new(5000.0, 0.0, 0.0)];
    let of = lengths(&scene, &beyond);
    assert_eq!((of.along_ground, of.straight), (None, beyond[0].distance(beyond[1])));
    assert_eq!(lengths(&scene, &[]).straight, 0.0);
}

#[test]
fn a_chain_is_written_as_geojson_in_the_system_of_its_scene() {
    let points = [[500_000.0, 4_649_776.0, 3.0], [501_000.0, 4_649_776.0, 3.0], [500_000.0, 4_650_776.0, 3.0]]
        .map(DVec3::from_array);
    let here = Scene { crs: Crs::Epsg(32633), ..Scene::default() };
    let line = lengths_geojson(&here, &points, false);
    let geometry = &line["features"][0]["geometry"];
    assert_eq!(geometry["type"], "LineString");
    // The middle of zone 33 on 42 degrees north.
    let first = [0, 1].map(|i| geometry["coordinates"][0][i].as_f64().expect("a number"));
    assert!((first[0] - 15.0).abs() < 1e-6 && (first[1] - 42.0).abs() < 1e-4, "{first:?}");
    let ring = lengths_geojson(&Scene::default(), &points, true);
    assert_eq!(ring["features"][0]["geometry"]["coordinates"][0].as_array().map(Vec::len), Some(4));
    assert_eq!(ring["features"][0]["geometry"]["coordinates"][0][1][0], 501_000.0);
    assert_eq!(ring["features"][0]["properties"]["area_in_plan"], 500_000.0);
}
