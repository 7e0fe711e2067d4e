use super::*;
use belvedere_scene::city::HeightSource;

fn block() -> Building {
    let ring = |points: &[[f64; 2]]| points.iter().map(|p| DVec2::from(*p) + 1000.25).collect::<Vec<_>>();
    Building {
        id: "loa1-1".into(),
        name: String::new(),
        landmark: false,
        footprint: vec![Polygon {
            outer: ring(&[[0.0, 0.0], [30.0, 0.0], [30.0, 20.0], [0.0, 20.0]]),
            holes: vec![ring(&[[10.0, 5.0], [10.0, 15.0], [20.0, 15.0], [20.0, 5.0]])],
        }],
        base_m: Some(12.5),
        height_m: 8.0,
        height_source: HeightSource::Stated,
        faces: Vec::new(),
    }
}

/// Volume within the shells, by the divergence theorem: right only if every surface is seen from outside counter-clockwise.
fn volume(document: &Value) -> f64 {
    let point = |i: &Value| {
        let v = &document["vertices"][i.as_u64().expect("a place") as usize];
        DVec3::from([0, 1, 2].map(|k| v[k].as_f64().expect("a number") * STEP_M))
    };
    let list = |v: &Value| v.as_array().expect("a list").clone();
    let mut six = 0.0;
    for object in document["CityObjects"].as_object().expect("objects").values() {
        for geometry in list(&object["geometry"]) {
            for ring in list(&geometry["boundaries"][0]).iter().flat_map(&list) {
                let corners: Vec<DVec3> = list(&ring).iter().map(point).collect();
                six += (2..corners.len()).map(|i| corners[0].dot(corners[i - 1].cross(corners[i]))).sum::<f64>();
            }
        }
    }
    six / 6.0
}

#[test]
fn a_block_is_a_closed_solid_with_its_attributes() {
    let city = City { buildings: vec![block()], ..City::default() };
    let text = city_json(&city, &[BlockFigures { coverage: 0.5, count: 7 }], Some(32734)).expect("a document");
    let document: Value = serde_json::from_str(&text).expect("JSON");
    assert!((volume(&document) - (30.0 * 20.0 - 100.0) * 8.0).abs() < 1e-3, "{}", volume(&document));
    let object = &document["CityObjects"]["loa1-1"];
    assert_eq!(object["attributes"], json!({ "height": 8.0, "base": 12.5, "coverage": 0.5, "count": 7 }));
    assert_eq!(object["geometry"][0]["semantics"]["values"][0], json!([0, 1, 2, 2, 2, 2, 2, 2, 2, 2]));
    assert_eq!(document["vertices"].as_array().map(Vec::len), Some(16));
    assert_eq!(document["metadata"]["geographicalExtent"], json!([1000.25, 1000.25, 12.5, 1030.25, 1020.25, 20.5]));
    assert_eq!(document["metadata"]["referenceSystem"], "https://www.opengis.net/def/crs/EPSG/0/32734");
}

#[test]
fn a_block_on_a_slope_is_one_closed_solid_for_each_piece() {
    let mut sloped = block();
    let mut second = sloped.footprint[0].clone();
    second.outer.iter_mut().chain(second.holes.iter_mut().flatten()).for_each(|p| p.x += 50.0);
    sloped.footprint.push(second);
    let ground = |p: DVec2| Some(0.3 * (p.x - 1000.0) + 2.0 * (p.y / 5.0).sin());
    sloped.faces = crate::city::prism_on(&sloped.footprint, 8.0, 0.0, &ground).expect("a prism");
    let city = City { buildings: vec![sloped.clone()], ..City::default() };
    let figures = [BlockFigures { coverage: 0.5, count: 7 }];
    let document: Value = serde_json::from_str(&city_json(&city, &figures, None).expect("text")).expect("JSON");
    let pieces = document["CityObjects"]["loa1-1"]["geometry"].as_array().expect("a list");
    assert_eq!(pieces.iter().map(|g| g["type"].clone()).collect::<Vec<_>>(), ["Solid", "Solid"]);
    let expected = 2.0 * 500.0 * 8.0;
    assert!((expected - 0.1..1.3 * expected).contains(&volume(&document)), "{}", volume(&document));
    sloped.faces.pop();
    let open = City { buildings: vec![sloped], ..City::default() };
    let document: Value = serde_json::from_str(&city_json(&open, &figures, None).expect("text")).expect("JSON");
    assert_eq!(document["CityObjects"]["loa1-1"]["geometry"][0]["type"], "MultiSurface", "a wall is missing");
}

#[test]
fn equal_ids_are_told_apart_and_no_numbers_refused() {
    let mut city = City { buildings: vec![block(), block()], ..City::default() };
    let document: Value = serde_json::from_str(&city_json(&city, &[], None).expect("a document")).expect("JSON");
    assert_eq!(document["CityObjects"].as_object().map(Map::len), Some(2));
    city.buildings[0].footprint[0].outer[0].x = f64::NAN;
    assert!(city_json(&city, &[], None).expect_err("refused").contains("are no numbers"));
}
