use super::*;

fn at(lon: f64, lat: f64, time: Option<f64>) -> Recorded {
    (Vertex { xy: DVec2::new(lon, lat), z: None }, time)
}

/// A walk of 200 steps of about 14 m, a second or ten apart.
fn walk(seconds: Option<f64>) -> Vec<Recorded> {
    (0..200)
        .map(|k| at(11.0 + 1e-4 * f64::from(k), 47.0 + 1e-4 * f64::from(k % 7), seconds.map(|s| s * f64::from(k))))
        .collect()
}

fn lengths(track: &[Recorded]) -> (Vec<usize>, Phantoms) {
    let mut found = Phantoms::default();
    let runs = runs(track, &mut found);
    (runs.iter().map(Vec::len).collect(), found)
}

#[test]
fn an_ordinary_track_stays_whole() {
    for seconds in [None, Some(1.0), Some(10.0)] {
        assert_eq!(lengths(&walk(seconds)), (vec![200], Phantoms::default()));
    }
    // a flight, a ride with a break and a train between, and a plan of few points
    let flight: Vec<_> = (0..100).map(|k| at(8.0 + 0.003 * f64::from(k), 47.0, Some(f64::from(k)))).collect();
    assert_eq!(lengths(&flight).0, [100]);
    let mut ride = walk(Some(10.0));
    ride[100..].iter_mut().for_each(|(v, t)| (v.xy.y, *t) = (v.xy.y + 0.2, t.map(|t| t + 3600.0)));
    assert_eq!(lengths(&ride).0, [200]);
    let plan: Vec<_> = (0..9).map(|k| at(8.0 + 0.1 * f64::from(k), 47.0, None)).collect();
    assert_eq!(lengths(&plan).0, [9]);
}

#[test]
fn zeros_and_jumps_split_a_track_and_are_counted() {
    for seconds in [None, Some(1.0)] {
        let mut track = walk(seconds);
        track[60].0.xy = DVec2::ZERO;
        track[61].0.xy = DVec2::ZERO;
        let (runs, found) = lengths(&track);
        assert_eq!((runs, found.zeros, found.jumps), (vec![60, 138], 2, 0), "{seconds:?}");
        let mut track = walk(seconds);
        track[60].0.xy.x += 0.5;
        let (runs, found) = lengths(&track);
        assert_eq!((runs, found.jumps), (vec![60, 1, 139], 2), "{seconds:?}");
        assert!((found.longest_m - 37_900.0).abs() < 300.0, "{found:?}");
        let mut track = walk(seconds);
        track[120..].iter_mut().for_each(|(v, _)| v.xy.y += 0.3);
        assert_eq!(lengths(&track).0, [120, 80], "{seconds:?}");
    }
    // two vertices 2 km away, without times
    let mut track = walk(None);
    track[60..62].iter_mut().for_each(|(v, _)| v.xy.y += 0.02);
    assert_eq!(lengths(&track).0, [60, 2, 138]);
}

#[test]
fn lines_that_are_no_tracks_lose_excursions_alone() {
    let line = |odd: &dyn Fn(&mut Vec<Vertex>)| {
        let mut vertices: Vec<Vertex> = walk(None).into_iter().map(|(v, _)| v).collect();
        odd(&mut vertices);
        let mut found = Phantoms::default();
        let runs = without_excursions(&vertices, &mut found);
        (runs.iter().map(Vec::len).collect::<Vec<_>>(), found.jumps)
    };
    assert_eq!(line(&|_| ()), (vec![200], 0));
    assert_eq!(line(&|l| l[60].xy.x += 0.5), (vec![60, 139], 2));
    assert_eq!(line(&|l| l[60..63].iter_mut().for_each(|v| v.xy.y += 0.2)), (vec![60, 137], 2));
    // a ferry, the end of a line, a long detour
    assert_eq!(line(&|l| l[120..].iter_mut().for_each(|v| v.xy.y += 0.3)), (vec![200], 0));
    assert_eq!(line(&|l| l[199].xy.y += 0.3), (vec![200], 0));
    assert_eq!(line(&|l| l[60..80].iter_mut().for_each(|v| v.xy.y += 0.2)), (vec![200], 0));
    let short: Vec<Vertex> = [0.0, 1.0, 0.01].map(|x| at(11.0 + x, 46.9, None).0).to_vec();
    let mut vectors = Vectors {
        path: "l".into(),
        format: "GeoJSON",
        layer: String::new(),
        crs: crate::crs::CoordinateSystem::wgs84().expect("known"),
        crs_stated: true,
        features: vec![super::super::VectorFeature {
            style: None,
            name: String::new(),
            properties: Default::default(),
            geometry: Geometry::Lines(vec![short]),
        }],
    };
    drop_excursions(&mut vectors, &mut Phantoms::default());
    assert_eq!(vectors.vertex_count(), 3, "drawn with few vertices");
}

#[test]
fn tracks_over_null_island_and_round_the_equator_stay() {
    let near: Vec<_> = (-20..=20).map(|k| at(0.01 * f64::from(k), 0.0, None)).collect();
    assert_eq!(lengths(&near).0, [41]);
    let equator: Vec<_> = (-18..=18).map(|k| at(10.0 * f64::from(k), 0.0, None)).collect();
    assert_eq!(lengths(&equator).0, [37]);
}
