use super::*;
use crate::crs::CoordinateSystem;
use crate::vector::{VectorFeature, Vertex};
use glam::DVec2;

fn of(tags: &[(&str, &str)]) -> Option<AreaSurface> {
    let tags = tags.iter().map(|(k, v)| ((*k).to_owned(), (*v).to_owned())).collect();
    of_properties(&tags).map(|found| found.0)
}

fn file(name: &str, layer: &str, areas: &[&[(&str, &str)]]) -> Vectors {
    let corner = |x: f64, y: f64| Vertex { xy: DVec2::new(x, y), z: None };
    let ring = vec![corner(0.0, 0.0), corner(1.0, 0.0), corner(0.0, 1.0)];
    let feature = |tags: &&[(&str, &str)]| VectorFeature {
        style: None,
        name: String::new(),
        properties: tags.iter().map(|(k, v)| ((*k).to_owned(), (*v).to_owned())).collect(),
        geometry: Geometry::Polygons(vec![vec![ring.clone()]]),
    };
    Vectors {
        path: name.into(),
        format: "GeoJSON",
        layer: layer.into(),
        crs: CoordinateSystem::wgs84().unwrap(),
        crs_stated: false,
        features: areas.iter().map(feature).collect(),
    }
}

#[test]
fn properties_of_the_usual_sources_tell_what_an_area_is() {
    let table: [(AreaSurface, &[(&str, &str)]); 24] = [
        (Glacier, &[("natural", "glacier")]),
        (Glacier, &[("featurecla", "Glaciated areas")]),
        (Glacier, &[("RGIId", "RGI60-11.01450"), ("Name", "Aletschgletscher")]),
        (Glacier, &[("rgi_id", "RGI2000-v7.0-G-11-02596")]),
        (Glacier, &[("GLIMSId", "G008016E46497N")]),
        (Glacier, &[("glac_id", "G1"), ("line_type", "glac_bound")]),
        (Glacier, &[("sgi-id", "B36-26")]),
        (Glacier, &[("OBJEKTART", "Gletscher")]),
        (Glacier, &[("code_18", "335")]),
        (Water, &[("natural", "water")]),
        (Water, &[("natural", "water"), ("leisure", "park")]),
        (Water, &[("landuse", "reservoir")]),
        (Water, &[("waterway", "riverbank")]),
        (Water, &[("water", "lake")]),
        (Water, &[("featurecla", "Alkaline Lake")]),
        (Water, &[("Hylak_id", "1203"), ("Lake_type", "1")]),
        (Water, &[("code_18", "512")]),
        (Forest, &[("landuse", "forest")]),
        (Forest, &[("natural", "wood"), ("boundary", "protected_area")]),
        (Forest, &[("fclass", "forest")]),
        (Park, &[("boundary", "national_park")]),
        (Park, &[("boundary", "protected_area"), ("leisure", "nature_reserve"), ("name", "Lake Park")]),
        (Park, &[("WDPAID", "916"), ("NAME", "Swiss National Park")]),
        (Park, &[("fclass", "nature_reserve")]),
    ];
    for (kind, tags) in table {
        assert_eq!(of(tags), Some(kind), "{tags:?}");
    }
    let unknown: [&[(&str, &str)]; 7] = [
        &[],
        &[("natural", "peak")],
        &[("name", "Black Lake")],
        &[("water", "no")],
        &[("building", "yes")],
        &[("boundary", "administrative")],
        &[("glac_id", "G1"), ("line_type", "intrnl_rock")],
    ];
    for tags in unknown {
        assert_eq!(of(tags), None, "{tags:?}");
    }
}

#[test]
fn names_tell_where_properties_do_not_and_nothing_makes_an_outline() {
    let plain: &[&[(&str, &str)]] = &[&[("Name", "x")]];
    let kind = |name: &str, layer: &str, ids: &[&str]| area_kind(&file(name, layer, plain), ids).surface;
    for (name, want) in [
        ("a/glacier_outline.shp", Glacier),
        ("Gletscher2016.shp", Glacier),
        ("SwissLakes.geojson", Water),
        ("wald-tirol.geojson", Forest),
        ("glacier_national_park.geojson", Park),
        ("parking.geojson", Outline),
        ("watershed.shp", Outline),
        ("sealevel_rise.shp", Outline),
        ("lakes/districts.shp", Outline),
    ] {
        assert_eq!(kind(name, "", &["features1"]), want, "{name}");
    }
    assert_eq!(kind("a.json", "lakes", &[]), Water);
    assert_eq!(kind("lakes.json", "", &["glaciers"]), Glacier, "the scene's own name counts first");
    assert!(area_kind(&file("a.json", "", plain), &[]).why.contains("neither properties nor names"));
}

#[test]
fn properties_count_before_names_and_several_kinds_make_an_outline() {
    const ICE: &[(&str, &str)] = &[("natural", "glacier")];
    const LAKE: &[(&str, &str)] = &[("natural", "water")];
    const NOTHING: &[(&str, &str)] = &[];
    let kind = |areas: &[&[(&str, &str)]]| area_kind(&file("lakes.json", "", areas), &[]);
    let found = kind(&[ICE, ICE, NOTHING]);
    assert_eq!(found, AreaKind { surface: Glacier, why: "property natural = glacier; so say 2 of 3 areas".into() });
    let mixed = kind(&[ICE, LAKE]);
    assert_eq!(mixed.surface, Outline);
    assert!(mixed.why.contains("1 glacier, 1 water"), "{}", mixed.why);
    assert_eq!(kind(&[&[ICE; 9][..], &[LAKE]].concat()).surface, Glacier, "nine of ten");
    assert_eq!(kind(&[ICE, NOTHING, NOTHING]).surface, Water, "few say anything, the file does");
}
