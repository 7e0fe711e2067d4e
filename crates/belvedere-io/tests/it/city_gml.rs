//! CityGML: buildings, everything else in it, and broken files.

use crate::support_files::Folder;
use belvedere_io::{CityFile, Limits, Loaded, load_city};
use belvedere_scene::{HeightSource, LandCover, StructureKind, Surface};
use belvedere_testkit::data;
use std::collections::BTreeMap;

const HEAD: &str = r#"<?xml version="1.0"?>
<core:CityModel xmlns:core="http://www.opengis.net/citygml/2.0" xmlns:gml="http://www.opengis.net/gml" xmlns:xlink="http://www.w3.org/1999/xlink"
 xmlns:bldg="http://www.opengis.net/citygml/building/2.0" xmlns:gen="http://www.opengis.net/citygml/generics/2.0">
<gml:boundedBy><gml:Envelope srsName="urn:ogc:def:crs,crs:EPSG::25832,crs:EPSG::5783" srsDimension="3"/></gml:boundedBy>
"#;

fn load(objects: &str) -> Result<Loaded<CityFile>, String> {
    load_text(&format!("{HEAD}{objects}</core:CityModel>"), None)
}

fn load_text(text: &str, lod: Option<&str>) -> Result<Loaded<CityFile>, String> {
    let folder = Folder::new();
    let path = folder.file("town.gml", text.as_ref());
    load_city(&path, lod, &Limits::default()).map_err(|e| e.to_string())
}

fn member(object: &str) -> String {
    format!("<core:cityObjectMember>{object}</core:cityObjectMember>")
}

fn polygon(id: &str, positions: &str) -> String {
    format!(
        r#"<gml:Polygon gml:id="{id}"><gml:exterior><gml:LinearRing><gml:posList>{positions}</gml:posList></gml:LinearRing></gml:exterior></gml:Polygon>"#
    )
}

fn surface(kind: &str, polygon: &str) -> String {
    format!(
        "<bldg:boundedBy><bldg:{kind}><bldg:lod2MultiSurface><gml:MultiSurface><gml:surfaceMember>{polygon}</gml:surfaceMember></gml:MultiSurface></bldg:lod2MultiSurface></bldg:{kind}></bldg:boundedBy>"
    )
}

const FLOOR: &str = "0 0 5 0 10 5 20 10 5 20 0 5 0 0 5";
const ROOF: &str = "0 0 17 20 0 17 20 10 17 0 10 17 0 0 17";
const WALL: &str = "0 0 5 20 0 5 20 0 17 0 0 17 0 0 5";

fn house() -> String {
    let solid = r##"<bldg:lod2Solid><gml:Solid><gml:exterior><gml:CompositeSurface><gml:surfaceMember xlink:href="#roof"/><gml:surfaceMember xlink:href="#floor"/></gml:CompositeSurface></gml:exterior></gml:Solid></bldg:lod2Solid>"##;
    let surfaces = [("GroundSurface", "floor", FLOOR), ("RoofSurface", "roof", ROOF), ("WallSurface", "wall", WALL)];
    let surfaces: String = surfaces.iter().map(|(kind, id, at)| surface(kind, &polygon(id, at))).collect();
    let part = format!(
        "<bldg:consistsOfBuildingPart><bldg:BuildingPart>{}</bldg:BuildingPart></bldg:consistsOfBuildingPart>",
        surface("RoofSurface", &polygon("part", "30 0 17 40 0 17 40 10 17 30 0 17"))
    );
    let room = surface("RoofSurface", &polygon("room", FLOOR)).replace("boundedBy", "interiorRoom");
    member(&format!(
        r#"<bldg:Building gml:id="b1"><gml:name>St. Mary &amp; St. John</gml:name><gen:stringAttribute name="Amenity"><gen:value>place_of_worship</gen:value></gen:stringAttribute><bldg:measuredHeight uom="m">12.3</bldg:measuredHeight>{solid}{surfaces}{part}{room}</bldg:Building>"#
    ))
}

#[test]
fn buildings_have_surfaces_parts_and_names() {
    let file = load(&house()).unwrap().value;
    assert_eq!((file.format.as_str(), file.lods.join(",")), ("CityGML 2.0", "2".to_owned()));
    assert_eq!(file.crs.and_then(|c| c.epsg()), Some(25832));
    let building = &file.city.buildings[0];
    assert_eq!((building.id.as_str(), building.name.as_str()), ("b1", "St. Mary & St. John"));
    assert!(building.landmark);
    assert_eq!((building.base_m, building.height_m, building.height_source), (Some(5.0), 12.0, HeightSource::Shape));
    let count = |s: Surface| building.faces.iter().filter(|f| f.surface == s).count();
    assert_eq!([Surface::Roof, Surface::Wall, Surface::Ground].map(count), [2, 1, 1], "references show nothing twice");
    assert!(building.faces.iter().flat_map(|f| &f.rings).all(|r| r.len() < 5 && r.first() != r.last()));
}

#[test]
fn outlines_take_their_height_from_attributes() {
    let flat = |about: &str| {
        member(&format!(
            "<bldg:Building gml:id=\"b\">{about}<bldg:lod0FootPrint><gml:MultiSurface><gml:surfaceMember>{}</gml:surfaceMember></gml:MultiSurface></bldg:lod0FootPrint></bldg:Building>",
            polygon("p", FLOOR)
        ))
    };
    for (about, want) in [
        ("<bldg:measuredHeight>12.5</bldg:measuredHeight>", (12.5, HeightSource::Stated)),
        ("<bldg:storeysAboveGround>4</bldg:storeysAboveGround>", (13.0, HeightSource::Levels)),
        ("<bldg:measuredHeight>0</bldg:measuredHeight>", (9.0, HeightSource::Assumed)),
        ("", (9.0, HeightSource::Assumed)),
    ] {
        let building = load(&flat(about)).unwrap().value.city.buildings.remove(0);
        assert_eq!((building.height_m, building.height_source), want, "{about}");
        assert!(building.faces.is_empty() && building.footprint.len() == 1);
    }
}

#[test]
fn the_wanted_level_of_detail_is_taken() {
    let block = format!(
        "<bldg:lod1Solid><gml:Solid><gml:exterior><gml:CompositeSurface><gml:surfaceMember>{}</gml:surfaceMember><gml:surfaceMember>{}</gml:surfaceMember></gml:CompositeSurface></gml:exterior></gml:Solid></bldg:lod1Solid>",
        polygon("l1a", FLOOR),
        polygon("l1b", &ROOF.replace("17", "15"))
    );
    let text =
        format!("{HEAD}{}</core:CityModel>", house().replace("<bldg:lod2Solid>", &format!("{block}<bldg:lod2Solid>")));
    assert_eq!(load_text(&text, None).unwrap().value.city.buildings[0].height_m, 12.0);
    let first = load_text(&text, Some("1")).unwrap().value;
    assert_eq!((first.city.buildings[0].height_m, first.lods.join(",")), (10.0, "1,2".to_owned()));
    let error = load_text(&text, Some("4")).unwrap_err();
    assert!(error.contains("no level of detail 4; it has 1, 2"), "{error}");
}

#[test]
fn what_is_no_building_is_kept_too() {
    let lod1 = |prefix: &str, kind: &str, positions: &str| {
        member(&format!(
            "<{prefix}:{kind} gml:id=\"{kind}\"><{prefix}:lod1MultiSurface><gml:MultiSurface><gml:surfaceMember>{}</gml:surfaceMember></gml:MultiSurface></{prefix}:lod1MultiSurface></{prefix}:{kind}>",
            polygon("x", positions)
        ))
    };
    let tree = member(&format!(
        r#"<veg:SolitaryVegetationObject gml:id="tree"><veg:lod2ImplicitRepresentation><core:ImplicitGeometry><core:transformationMatrix>2 0 0 0 0 2 0 0 0 0 2 0 0 0 0 1</core:transformationMatrix><core:relativeGMLGeometry><gml:MultiSurface><gml:surfaceMember>{}</gml:surfaceMember></gml:MultiSurface></core:relativeGMLGeometry><core:referencePoint><gml:Point><gml:pos>100 200 5</gml:pos></gml:Point></core:referencePoint></core:ImplicitGeometry></veg:lod2ImplicitRepresentation></veg:SolitaryVegetationObject>"#,
        polygon("crown", "0 0 0 1 0 0 0 0 3 0 0 0")
    ));
    let objects = [
        lod1("brid", "Bridge", WALL),
        lod1("wtr", "WaterBody", FLOOR),
        lod1("veg", "PlantCover", FLOOR),
        lod1("tran", "TransportationComplex", FLOOR),
        lod1("luse", "LandUse", FLOOR),
        lod1("dem", "TINRelief", FLOOR),
        tree,
    ];
    let loaded = load(&objects.concat()).unwrap();
    let city = &loaded.value.city;
    let covers: Vec<LandCover> = city.areas.iter().map(|a| a.cover).collect();
    assert_eq!(covers, [LandCover::Water, LandCover::Green, LandCover::Road, LandCover::Other]);
    let kinds: Vec<StructureKind> = city.structures.iter().map(|s| s.kind).collect();
    assert_eq!(kinds, [StructureKind::Bridge, StructureKind::Vegetation]);
    let top = city.structures[1].faces[0].rings[0][2];
    assert_eq!(top.to_array(), [100.0, 200.0, 11.0], "a shape stands at its place, in its size");
    assert!(loaded.warnings.iter().any(|w| w.text().contains("1 TINRelief")), "{:?}", loaded.warnings);
}

#[test]
fn positions_come_in_several_writings() {
    let ring = |inner: &str| {
        let polygon = format!(
            "<gml:Polygon gml:id=\"roof\"><gml:exterior><gml:LinearRing>{inner}</gml:LinearRing></gml:exterior></gml:Polygon>"
        );
        house().replace(&polygon_of_roof(), &polygon)
    };
    let each =
        "<gml:pos>0 0 17</gml:pos><gml:pos>20 0 17</gml:pos><gml:pos>20 10 17</gml:pos><gml:pos>0 10 17</gml:pos>";
    let old = "<gml:coordinates>0,0,17 20,0,17 20,10,17 0,10,17</gml:coordinates>";
    for inner in [each, old] {
        let building = load(&ring(inner)).unwrap().value.city.buildings.remove(0);
        assert_eq!(building.height_m, 12.0, "{inner}");
    }
    let north_first = format!("{HEAD}{}</core:CityModel>", house()).replace("EPSG::25832,", "EPSG::4326,");
    let file = load_text(&north_first, None).unwrap().value;
    let widest = file.city.buildings[0].footprint[0].outer.iter().map(|p| p.x).fold(0.0, f64::max);
    assert_eq!(widest, 10.0, "latitudes come first in such systems");
}

fn polygon_of_roof() -> String {
    polygon("roof", ROOF)
}

#[test]
fn broken_documents_end_in_one_sentence() {
    let whole = format!("{HEAD}{}</core:CityModel>", house());
    for (from, to, want) in [
        ("20 0 17", "20 NaN 17", "\"NaN\" in posList is no finite number"),
        ("20 0 17", "20 zero 17", "no finite number"),
        ("20 0 17", "20 17", "does not divide into positions of 3"),
        ("</bldg:Building>", "</bldg:House>", "no well-formed XML"),
        ("core:cityObjectMember", "core:nothing", "no geometry that is read"),
    ] {
        let error = load_text(&whole.replace(from, to), None).unwrap_err();
        assert!(error.contains(want) && error.lines().count() == 1, "{from} -> {to}: {error}");
        assert!(to != "20 NaN 17" || error.contains("\"b1\": line 5"), "{error}");
    }
    let error = load_text(&whole[..whole.len() - 40], None).unwrap_err();
    assert!(error.contains("cut off"), "{error}");
    let deep = format!("{HEAD}{}", "<a>".repeat(5000));
    assert!(load_text(&deep, None).unwrap_err().contains("deeper than 200"));
    let flat = load_text(&whole.replace(WALL, "0 0 5 20 0 5 0 0 5"), None).unwrap();
    assert!(flat.warnings.iter().any(|w| w.text().contains("1 rings")), "{:?}", flat.warnings);
}

#[test]
fn a_reference_that_leads_nowhere_costs_its_surface_alone_and_blanks_before_its_name_do_not_count() {
    let whole = format!("{HEAD}{}</core:CityModel>", house());
    let faces = |text: &str| {
        let loaded = load_text(text, None).expect("read");
        let said = loaded.warnings.iter().any(|w| w.text().contains("1 references to surfaces lead nowhere"));
        (loaded.value.city.buildings[0].faces.len(), said)
    };
    let (all, said) = faces(&whole);
    assert!(!said && all > 2, "{all}");
    assert_eq!(faces(&whole.replace("\"#roof\"", "\"# roof \"")), (all, false));
    // The roof belongs to the building, so that the reference would show it twice.
    assert_eq!(faces(&whole.replace("\"#roof\"", "\"#nowhere\"")), (all, true));
}

#[test]
fn truncations_and_flips_never_panic() {
    let whole = format!("{HEAD}{}</core:CityModel>", house()).into_bytes();
    let folder = Folder::new();
    let mut failed = 0;
    for at in (1..whole.len()).step_by(7) {
        for flip in [false, true] {
            let mut broken = whole.clone();
            if flip {
                broken[at] ^= 1 << (at % 8);
            } else {
                broken.truncate(at);
            }
            let path = folder.file("town.gml", &broken);
            let result = load_city(&path, None, &Limits::default());
            assert!(flip || result.is_err(), "cut at {at}");
            failed += usize::from(result.is_err());
        }
    }
    assert!(failed > whole.len() / 7);
}

#[test]
fn cycles_of_references_end() {
    let a = r##"<gml:MultiSurface gml:id="a"><gml:surfaceMember xlink:href="#c"/></gml:MultiSurface>"##;
    let c = r##"<gml:MultiSurface gml:id="c"><gml:surfaceMember xlink:href="#a"/></gml:MultiSurface>"##;
    let shell = |id: &str, inner: &str| {
        member(&format!(
            "<gen:GenericCityObject gml:id=\"{id}\"><gen:lod1Geometry>{inner}</gen:lod1Geometry></gen:GenericCityObject>"
        ))
    };
    let loaded = load(&[shell("g", a), shell("h", c), house()].concat()).unwrap();
    assert!(loaded.warnings.iter().any(|w| w.text().contains("2 objects have no geometry")), "{:?}", loaded.warnings);
}

#[test]
fn berlin_stands_as_it_was_measured() {
    let Some(path) = data("city_berlin/berlin_lod2_citygml1.gml") else { return };
    let Loaded { value, warnings, .. } = load_city(&path, None, &Limits::default()).unwrap();
    assert_eq!((value.format.as_str(), value.crs.as_ref().and_then(|c| c.epsg())), ("CityGML 1.0", Some(25833)));
    assert_eq!(value.city.buildings.len(), 61);
    assert!(value.city.buildings.iter().all(|b| b.height_source == HeightSource::Shape));
    for b in &value.city.buildings {
        assert!((0.1..60.0).contains(&b.height_m) && b.name.is_empty(), "{} \"{}\": {} m", b.id, b.name, b.height_m);
    }
    let mut faces: BTreeMap<Surface, usize> = BTreeMap::new();
    for face in value.city.buildings.iter().flat_map(|b| &b.faces) {
        *faces.entry(face.surface).or_default() += 1;
        for p in face.rings.iter().flatten() {
            assert!((390_477.0..390_704.0).contains(&p.x) && (27.0..65.0).contains(&p.z));
        }
    }
    assert!(faces[&Surface::Roof] > 61 && faces[&Surface::Wall] > 4 * 61 && faces[&Surface::Ground] >= 61, "{faces:?}");
    assert!(warnings.is_empty(), "{warnings:?}");
}

#[test]
fn tiny_houses_of_two_solids_are_read() {
    for name in ["city_berlin/kit_b1_lod2_s.gml", "city_berlin/kit_b1_lod2_cs_w_sem.gml"] {
        let Some(path) = data(name) else { continue };
        let file = load_city(&path, None, &Limits::default()).unwrap().value;
        assert_eq!(file.city.buildings.len(), 1, "{name}");
        let building = &file.city.buildings[0];
        assert!(building.height_m >= 100.0 && !building.footprint.is_empty(), "{name}: {}", building.height_m);
    }
}
