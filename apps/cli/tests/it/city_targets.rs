//! `reveal` of cities: buildings, streets, areas and routes in maps and models of cities.

use super::{Place, read};
use belvedere_testkit::data;
use std::fmt::Write;

/// Blocks of 24 m on a side and 30 m high, streets of 8 m between; one street has a name, one block is a lower church behind others, one
/// is a park.
const BLOCKS: i32 = 5;
const STEP: f64 = 32.0;
const SIDE: f64 = 24.0;

/// Degrees of a place in metres from the south-west corner.
fn degrees([x, y]: [f64; 2]) -> [f64; 2] {
    [9.0 + x / (111_320.0 * 47f64.to_radians().cos()), 47.0 + y / 111_132.0]
}

fn map() -> String {
    let (mut nodes, mut ways, mut id) = (String::new(), String::new(), 0);
    let mut node = |at: [f64; 2]| {
        let [lon, lat] = degrees(at);
        id += 1;
        writeln!(nodes, "<node id=\"{id}\" lon=\"{lon:.8}\" lat=\"{lat:.8}\"/>").expect("written");
        id
    };
    let mut way = |id: i32, corners: &[i32], tags: &[(&str, &str)]| {
        write!(ways, "<way id=\"{id}\">").expect("written");
        corners.iter().for_each(|n| write!(ways, "<nd ref=\"{n}\"/>").expect("written"));
        tags.iter().for_each(|(k, v)| write!(ways, "<tag k=\"{k}\" v=\"{v}\"/>").expect("written"));
        ways.push_str("</way>\n");
    };
    for k in 0..BLOCKS * BLOCKS {
        let [x, y] = [f64::from(k % BLOCKS) * STEP, f64::from(k / BLOCKS) * STEP];
        let ring = [[x, y], [x + SIDE, y], [x + SIDE, y + SIDE], [x, y + SIDE]].map(&mut node);
        let ring = [&ring[..], &ring[..1]].concat();
        match k {
            12 => way(12, &ring, &[("building", "church"), ("name", "Old Church"), ("height", "~9")]),
            16 => way(16, &ring, &[("leisure", "park"), ("name", "Rose Garden")]),
            _ => way(k, &ring, &[("building", "yes"), ("height", "30")]),
        }
    }
    let (middle, end) = (2.0 * STEP - 4.0, f64::from(BLOCKS) * STEP - 8.0);
    let street = [[0.0, middle], [0.5 * end, middle], [end, middle]].map(&mut node);
    way(100, &street, &[("highway", "residential"), ("name", "High Street")]);
    format!("<osm version=\"0.6\">\n{nodes}{ways}</osm>\n")
}

fn report(place: &Place) -> serde_json::Value {
    serde_json::from_slice(&read(&place.path("r.json"))).expect("JSON")
}

fn share(report: &serde_json::Value, key: &str) -> f64 {
    report[key].as_f64().unwrap_or_else(|| panic!("{key} in {report}"))
}

const FILES: [&str; 8] = ["-o", "r.png", "--report", "r.json", "--scene", "r.toml", "--overwrite", "--size"];

#[test]
fn buildings_streets_and_areas_of_a_map_are_seen_by_name_id_and_tag() {
    let place = Place::new();
    place.write("town.osm", &map());
    let info = place.json(&["info", "town.osm", "--json"]);
    let see = &info["files"][0]["see"];
    assert_eq!((&see["buildings"]["Old Church"], &see["ways"]["High Street"]), (&1.into(), &1.into()), "{see}");
    assert_eq!((&see["areas"]["Rose Garden"], &see["kinds"]["building=yes"]), (&1.into(), &23.into()), "{see}");
    for (what, least) in [
        ("Old Church", 0.95),
        ("way/12", 0.95),
        ("building=church", 0.95),
        ("High Street", 0.97),
        ("leisure=park", 0.9),
    ] {
        place.ok(&[&["reveal", "town.osm", "--see", what][..], &FILES, &["320x180"]].concat());
        let found = report(&place);
        assert!(share(&found, "visible") > least && share(&found, "in_frame") > 0.99, "{what}: {found}");
        assert!(share(&found, "visible") >= share(&found, "visible_straight"), "{what}: {found}");
    }
    // From low down the church is hidden, and bent rays go over the blocks before it.
    let low = ["--eye", "9.00105,46.9984,50", "--look", "9.00105,47.0007,5"];
    place.ok(&[&["reveal", "town.osm", "--see", "Old Church"][..], &low, &FILES, &["320x180"]].concat());
    let found = report(&place);
    assert!(share(&found, "visible_straight") < 0.3 && share(&found, "visible") > 0.5, "{found}");
    assert_eq!(found["technique"], "curved_rays");
    // The scene that was written draws the same picture.
    place.ok(&["render", "r.toml", "-o", "again.png", "--size", "320x180"]);
    let line = place.fails(&["reveal", "town.osm", "--see", "Old Chruch", "-o", "x.png"]);
    assert!(line.contains("is no building, street or area") && line.contains("did you mean \"Old Church\""), "{line}");
    let line = place.fails(&["reveal", "town.osm", "-o", "x.png"]);
    assert!(line.contains("give --see WHAT or a file of routes"), "{line}");
    let args = ["reveal", "town.osm", "--see", "Old Church", "--technique", "spline", "-o", "x.png"];
    assert!(place.fails(&args).contains("give --technique curved_rays"));
}

#[test]
fn routes_through_a_city_are_seen_with_and_without_an_elevation_model() {
    let place = Place::new();
    place.write("town.osm", &map());
    let middle = 3.0 * STEP - 4.0;
    let turn = [[-6.0, middle], [3.0 * STEP - 4.0, middle], [3.0 * STEP - 4.0, 150.0]].map(degrees);
    let points: String = turn.iter().map(|[x, y]| format!("<trkpt lon=\"{x}\" lat=\"{y}\"/>")).collect();
    place.write("way.gpx", &format!("<gpx><trk><trkseg>{points}</trkseg></trk></gpx>"));
    for given in
        [&["town.osm", "way.gpx"][..], &["town.osm", "--see", "way.gpx"], &["way.gpx", "town.osm", "--see", "way"]]
    {
        place.ok(&[&["reveal"][..], given, &FILES, &["320x180"]].concat());
        let found = report(&place);
        assert!(share(&found, "visible") > 0.95 && share(&found, "in_frame") > 0.99, "{given:?}: {found}");
    }
    // Ground that rises to the north.
    let rows: String = (0..12).map(|row| format!("{} ", 500 - 4 * row).repeat(12) + "\n").collect();
    let [x, y] = degrees([-60.0, -60.0]);
    let head = format!("ncols 12\nnrows 12\nxllcorner {x}\nyllcorner {y}\ncellsize 0.0003\n");
    place.write("dem.asc", &(head + &rows));
    place.write("dem.prj", "GEOGCS[\"WGS 84\",DATUM[\"WGS_1984\",SPHEROID[\"WGS 84\",6378137,298.257223563]],PRIMEM[\"Greenwich\",0],UNIT[\"degree\",0.0174532925199433]]");
    place.ok(&[&["reveal", "dem.asc", "town.osm", "way.gpx"][..], &FILES, &["320x180"]].concat());
    let found = report(&place);
    assert!(share(&found, "visible") > 0.9 && share(&found, "in_frame") > 0.99, "{found}");
}

#[test]
fn a_file_that_must_be_seen_is_an_input_and_reports_name_it_without_its_folder() {
    let place = Place::new();
    std::fs::create_dir(place.path("mine")).expect("folder");
    place.write("town.osm", &map());
    let [from, to] = [degrees([10.0, 2.0 * STEP - 4.0]), degrees([100.0, 2.0 * STEP - 4.0])];
    place.write("mine/way.geojson", &format!("{{\"type\":\"LineString\",\"coordinates\":[{from:?},{to:?}]}}"));
    let see = ["reveal", "town.osm", "--see", "mine/way.geojson", "-o", "x.png", "--size", "64x36", "--overwrite"];
    assert!(place.fails(&[&see[..], &["--report", "mine/way.geojson"]].concat()).contains("input"));
    place.ok(&[&see[..], &["--report", "r.json", "--scene", "r.toml"]].concat());
    assert_eq!(report(&place)["see"], "way.geojson");
    let scene = String::from_utf8(read(&place.path("r.toml"))).expect("UTF-8");
    assert!(scene.contains("title = \"way.geojson revealed\""), "{scene}");
}

#[test]
fn footprints_are_a_city_for_the_lines_beside_them() {
    let place = Place::new();
    let ring = |x: f64, y: f64| {
        let corners = [[x, y], [x + 20.0, y], [x + 20.0, y + 20.0], [x, y + 20.0], [x, y]].map(degrees);
        format!(
            "{{\"type\":\"Feature\",\"properties\":{{\"height\":25,\"use\":\"u{x}\"}},\"geometry\":{{\"type\":\"Polygon\",\"coordinates\":[{corners:?}]}}}}"
        )
    };
    let houses: Vec<String> = (0..9).map(|k| ring(30.0 * f64::from(k % 3), 30.0 * f64::from(k / 3))).collect();
    place.write("h.geojson", &format!("{{\"type\":\"FeatureCollection\",\"features\":[{}]}}", houses.join(",")));
    let line = [[-5.0, 25.0], [85.0, 25.0]].map(degrees);
    place.write("s.geojson", &format!("{{\"type\":\"LineString\",\"coordinates\":{line:?}}}"));
    place.ok(&[&["reveal", "h.geojson", "s.geojson"][..], &FILES, &["320x180"]].concat());
    assert!(share(&report(&place), "visible") > 0.95, "{}", report(&place));
    place.ok(&[&["reveal", "h.geojson", "--see", "use=u30"][..], &FILES, &["320x180"]].concat());
    assert!(share(&report(&place), "visible") > 0.8, "{}", report(&place));
}

#[test]
fn drafts_of_a_target_come_with_the_commands_that_make_them() {
    let place = Place::new();
    place.write("town.osm", &map());
    for data in [["town.osm", "--see", "Old Church"], ["builtin:dna?pairs=6", "--see", "resi 3"]] {
        let args = ["-o", "sheet.png", "--size", "160x90", "--drafts", "2", "--overwrite"];
        let said = place.ok(&[&["reveal"][..], &data, &args].concat());
        let lines: Vec<&str> = said.lines().collect();
        assert_eq!(lines.len(), 2, "{said}");
        for line in lines {
            let (words, command) = line.split_once("belvedere ").expect("a command");
            let plain = command.replace(&format!("'{}'", data[2]), "SEE").replace(&format!("'{}'", data[0]), data[0]);
            let mut again: Vec<&str> = plain.split_whitespace().map(|w| if w == "SEE" { data[2] } else { w }).collect();
            let out = again.iter().position(|a| *a == "-o").expect("an output");
            again[out + 1] = "one.png";
            let result = place.json(&[&again[..], &["--overwrite", "--json"]].concat());
            let stated = words.split("visible ").nth(1).and_then(|w| w.split(' ').next()).expect("a share");
            let stated: f64 = stated.parse().expect("a number");
            let visible = share(&result, "visible");
            assert!((stated - 100.0 * visible).abs() < 0.11, "{line}: {visible}");
        }
    }
}

#[test]
fn targets_have_outlines_and_shares_by_their_pixels() {
    let place = Place::new();
    place.write("town.osm", &map());
    let low = ["--eye", "9.00105,46.9984,50", "--look", "9.00105,47.0007,5"];
    place.ok(&[&["reveal", "town.osm", "--see", "Old Church"][..], &low, &FILES, &["320x180"]].concat());
    let found = report(&place);
    assert!(found["mark"].as_str().is_some_and(|mark| mark.contains("outline")), "{found}");
    // The scene alone has no outline.
    place.ok(&["render", "r.toml", "-o", "bare.png"]);
    let pixels = |name: &str| super::light_and_tints::pixels(&read(&place.path(name)));
    assert!(pixels("r.png") != pixels("bare.png"));
}

#[test]
fn buildings_of_real_cities_are_seen() {
    for (file, see) in [
        ("city_delft/delft.city.json", "b1105d28c-00ba-11e6-b420-2bdcc4ab5d7f"),
        ("city_delft/delft.city.json", "lokaalid=G0503.032e68eff7ec49cce0532ee22091b28c"),
        ("city_berlin/berlin_lod2_citygml1.gml", "BLDG_0003000e002837e8"),
        ("andorra/andorra.osm.pbf", "Casa de la Vall"),
    ] {
        let Some(path) = data(file) else { continue };
        let place = Place::new();
        let city = path.to_str().expect("UTF-8");
        place.ok(&[&["reveal", city, "--see", see][..], &FILES, &["320x180"]].concat());
        let found = report(&place);
        assert!(share(&found, "visible") > 0.97 && share(&found, "in_frame") > 0.99, "{file} {see}: {found}");
    }
}
