//! OpenStreetMap's PBF: files made here byte by byte, broken ones, and a real extract.

use crate::support_files::Folder;
use belvedere_io::load_vectors;
use belvedere_io::{CityFile, Limits, Loaded, load_city};
use belvedere_scene::{HeightSource, LandCover, WayClass};
use belvedere_testkit::data;

fn varint(mut value: u64, out: &mut Vec<u8>) {
    while value > 0x7f {
        out.push(value as u8 | 0x80);
        value >>= 7;
    }
    out.push(value as u8);
}

fn zigzag(value: i64) -> u64 {
    ((value << 1) ^ (value >> 63)) as u64
}

/// A field of bytes.
fn field(number: u64, bytes: &[u8], out: &mut Vec<u8>) {
    varint(number << 3 | 2, out);
    varint(bytes.len() as u64, out);
    out.extend(bytes);
}

fn number(field: u64, value: u64, out: &mut Vec<u8>) {
    varint(field << 3, out);
    varint(value, out);
}

/// A packed list.
fn packed(at: u64, values: impl IntoIterator<Item = u64>, out: &mut Vec<u8>) {
    let mut list = Vec::new();
    values.into_iter().for_each(|v| varint(v, &mut list));
    field(at, &list, out);
}

fn deltas(values: &[i64]) -> Vec<u64> {
    values.iter().scan(0, |last, v| Some(zigzag(v - std::mem::replace(last, *v)))).collect()
}

fn blob(kind: &str, message: &[u8], out: &mut Vec<u8>) {
    let (mut header, mut body) = (Vec::new(), Vec::new());
    field(1, message, &mut body);
    field(1, kind.as_bytes(), &mut header);
    number(3, body.len() as u64, &mut header);
    out.extend((header.len() as u32).to_be_bytes());
    out.extend(header);
    out.extend(body);
}

type Tags<'a> = &'a [(&'a str, &'a str)];

#[derive(Default)]
struct Extract {
    words: Vec<String>,
    nodes: Vec<(i64, f64, f64)>,
    groups: Vec<u8>,
    /// The number written for the type of members; 1 stands for ways.
    member_type: u64,
}

impl Extract {
    fn word(&mut self, word: &str) -> u64 {
        if self.words.is_empty() {
            self.words.push(String::new());
        }
        let at = self.words.iter().position(|w| w == word).unwrap_or(self.words.len());
        if at == self.words.len() {
            self.words.push(word.into());
        }
        at as u64
    }

    fn tagged(&mut self, id: i64, tags: Tags<'_>) -> Vec<u8> {
        let mut out = Vec::new();
        number(1, id as u64, &mut out);
        let (keys, values): (Vec<u64>, Vec<u64>) = tags.iter().map(|(k, v)| (self.word(k), self.word(v))).unzip();
        packed(2, keys, &mut out);
        packed(3, values, &mut out);
        out
    }

    fn way(&mut self, id: i64, tags: Tags<'_>, nodes: &[i64]) {
        let mut way = self.tagged(id, tags);
        packed(8, deltas(nodes), &mut way);
        let mut group = Vec::new();
        field(3, &way, &mut group);
        field(2, &group, &mut self.groups);
    }

    fn relation(&mut self, id: i64, tags: Tags<'_>, ways: &[i64]) {
        let mut relation = self.tagged(id, tags);
        let role = self.word("outer");
        packed(8, ways.iter().map(|_| role), &mut relation);
        packed(9, deltas(ways), &mut relation);
        packed(10, ways.iter().map(|_| self.member_type), &mut relation);
        let mut group = Vec::new();
        field(4, &relation, &mut group);
        field(2, &group, &mut self.groups);
    }

    fn bytes(&self) -> Vec<u8> {
        let (mut table, mut dense, mut block, mut header, mut out) =
            (Vec::new(), Vec::new(), Vec::new(), Vec::new(), Vec::new());
        self.words.iter().for_each(|w| field(1, w.as_bytes(), &mut table));
        let of = |pick: fn(&(i64, f64, f64)) -> i64| deltas(&self.nodes.iter().map(pick).collect::<Vec<_>>());
        packed(1, of(|n| n.0), &mut dense);
        packed(8, of(|n| (n.2 * 1e7).round() as i64), &mut dense);
        packed(9, of(|n| (n.1 * 1e7).round() as i64), &mut dense);
        let mut group = Vec::new();
        field(2, &dense, &mut group);
        field(1, &table, &mut block);
        field(2, &group, &mut block);
        block.extend(&self.groups);
        field(4, b"OsmSchema-V0.6", &mut header);
        blob("OSMHeader", &header, &mut out);
        blob("OSMData", &block, &mut out);
        out
    }
}

/// A square of side `2 half` degrees around 1.5, 42.5, its nodes from `first` on.
fn square(extract: &mut Extract, first: i64, half: f64) -> Vec<i64> {
    for (k, (x, y)) in [(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)].into_iter().enumerate() {
        extract.nodes.push((first + k as i64, 1.5 + half * x, 42.5 + half * y));
    }
    vec![first, first + 1, first + 2, first + 3, first]
}

fn town() -> Extract {
    let mut e = Extract { member_type: 1, ..Extract::default() };
    let ring = square(&mut e, 10, 0.001);
    e.way(1, &[("building", "church"), ("name", "Sant Esteve"), ("height", "21 m")], &ring);
    let ring = square(&mut e, 20, 0.002);
    e.way(2, &[("building", "yes"), ("building:levels", "4")], &ring);
    let ring = square(&mut e, 30, 0.01);
    e.way(3, &[("landuse", "forest")], &ring);
    e.way(4, &[("highway", "primary"), ("name", "Avinguda")], &[10, 12, 21]);
    e.way(5, &[("highway", "residential")], &[10, 12, 999, 20, 21]);
    e.way(6, &[("waterway", "river")], &[30, 32]);
    e.way(7, &[("railway", "abandoned")], &[30, 32]);
    e.way(8, &[("natural", "cliff")], &[30, 31, 32, 30]);
    let outer = square(&mut e, 40, 0.004);
    let inner = square(&mut e, 50, 0.003);
    e.way(9, &[], &outer[..3]);
    e.way(10, &[("building", "yes")], &[42, 43, 40]);
    e.way(11, &[], &inner);
    e.relation(1, &[("type", "multipolygon"), ("building", "hospital")], &[9, 10, 11]);
    e.relation(2, &[("type", "multipolygon"), ("natural", "water")], &[9, 777]);
    e
}

fn load(bytes: &[u8]) -> Result<Loaded<CityFile>, String> {
    let folder = Folder::new();
    let path = folder.file("town.osm.pbf", bytes.as_ref());
    load_city(&path, None, &Limits::default()).map_err(|e| e.to_string())
}

#[test]
fn ways_and_multipolygons_become_a_city() {
    let Loaded { value, warnings, .. } = load(&town().bytes()).unwrap();
    assert_eq!(value.format, "OSM PBF");
    assert!(value.crs.is_some_and(|c| c.is_geographic()));
    let city = value.city;
    let about: Vec<(&str, &str, f64, HeightSource, bool)> = city
        .buildings
        .iter()
        .map(|b| (b.id.as_str(), b.name.as_str(), b.height_m, b.height_source, b.landmark))
        .collect();
    assert_eq!(
        about,
        [
            ("relation/1", "", 9.0, HeightSource::Assumed, false),
            ("way/1", "Sant Esteve", 21.0, HeightSource::Stated, true),
            ("way/2", "", 13.0, HeightSource::Levels, false),
        ]
    );
    let court = &city.buildings[0].footprint[0];
    assert_eq!((court.outer.len(), court.holes.len()), (4, 1), "half rings join, and the ring within is a court");
    let classes: Vec<(WayClass, usize)> = city.ways.iter().map(|w| (w.class, w.points.len())).collect();
    let street = WayClass::Residential;
    assert_eq!(classes, [(WayClass::Primary, 3), (street, 2), (street, 2), (WayClass::Waterway, 2)]);
    assert_eq!(city.areas.iter().map(|a| a.cover).collect::<Vec<_>>(), [LandCover::Forest]);
    for want in ["1 vertices of ways are not in the file", "1 multipolygons do not close"] {
        assert!(warnings.iter().any(|w| w.text().contains(want)), "{want}: {warnings:?}");
    }
}

/// Lowest and highest z of the surfaces of a building, metres above its ground.
fn reach(b: &belvedere_scene::Building) -> [f64; 2] {
    let all = b.faces.iter().flat_map(|f| &f.rings).flatten().map(|p| p.z);
    all.fold([f64::INFINITY, f64::NEG_INFINITY], |[lo, hi], z| [lo.min(z), hi.max(z)])
}

#[test]
fn parts_float_stand_on_each_other_and_hide_underground() {
    let mut e = Extract { member_type: 1, ..Extract::default() };
    let mut way = |id: i64, half: f64, tags: Tags<'_>| {
        let ring = square(&mut e, 100 * id, half);
        e.way(id, tags, &ring);
    };
    way(1, 0.001, &[("building", "yes"), ("height", "60"), ("name", "Tower")]);
    way(2, 0.0009, &[("building:part", "yes"), ("height", "10")]);
    way(3, 0.0002, &[("building:part", "yes"), ("height", "50"), ("min_height", "10")]);
    way(
        4,
        0.0006,
        &[
            ("building:part", "yes"),
            ("height", "66"),
            ("min_height", "50"),
            ("roof:shape", "pyramidal"),
            ("roof:height", "6"),
        ],
    );
    way(5, 0.01, &[("building", "yes"), ("height", "12"), ("location", "underground")]);
    way(6, 0.02, &[("building", "yes"), ("building:levels", "7"), ("building:min_level", "4")]);
    way(7, 0.03, &[("building", "house"), ("height", "10"), ("roof:shape", "gabled"), ("roof:height", "4")]);
    way(8, 0.04, &[("building", "roof"), ("height", "5")]);
    way(9, 0.05, &[("building", "yes"), ("height", "65'6\"")]);
    way(10, 0.06, &[("building", "no"), ("building:part", "no"), ("height", "30")]);
    e.way(20, &[("highway", "primary"), ("tunnel", "yes")], &[100, 101]);
    e.way(21, &[("highway", "residential"), ("tunnel", "building_passage")], &[100, 102]);
    let Loaded { value, warnings, .. } = load(&e.bytes()).unwrap();
    let find = |id: &str| value.city.buildings.iter().find(|b| b.id == id);
    let tower = find("way/1").expect("there");
    assert_eq!((tower.name.as_str(), tower.height_m, reach(tower)), ("Tower", 66.0, [0.0, 66.0]));
    assert!(["way/2", "way/3", "way/4", "way/5", "way/10"].iter().all(|id| find(id).is_none()));
    // between 10 and 50 m there is only the shaft: no wall of the outline
    let wide = |z: f64| {
        let crossing =
            tower.faces.iter().filter(|f| f.rings[0].iter().any(|p| p.z < z) && f.rings[0].iter().any(|p| p.z > z));
        crossing.flat_map(|f| &f.rings[0]).map(|p| (p.x - 1.5).abs()).fold(0.0, f64::max)
    };
    for (z, half) in [(5.0, 0.0009), (30.0, 0.0002), (55.0, 0.0006)] {
        assert!((wide(z) - half).abs() < 1e-6, "{z}: {}", wide(z));
    }
    for (id, want) in [("way/6", [12.0, 22.0]), ("way/7", [0.0, 10.0]), ("way/8", [4.6, 5.0])] {
        let found = reach(find(id).expect(id));
        assert!((found[0] - want[0]).abs() < 1e-6 && (found[1] - want[1]).abs() < 1e-6, "{id}: {found:?}");
    }
    let block = find("way/9").expect("there");
    assert!(block.faces.is_empty() && (block.height_m - 19.9644).abs() < 1e-9);
    assert_eq!(value.city.ways.len(), 1, "the passage");
    assert!(warnings.iter().any(|w| w.text().contains("2 buildings and ways that lie underground")), "{warnings:?}");
}

/// The same town as XML and as the answer of Overpass.
fn as_text(town: &Extract) -> [String; 2] {
    let xml = "<osm version=\"0.6\"><bounds/>".to_owned();
    let nodes = town.nodes.iter().map(|(id, x, y)| format!("<node id=\"{id}\" lon=\"{x}\" lat=\"{y}\"/>\n"));
    let way = "<way id=\"1\"><nd ref=\"10\"/><nd ref=\"11\"/><nd ref=\"12\"/><nd ref=\"13\"/><nd ref=\"10\"/>\
        <tag k=\"building\" v=\"yes\"/><tag k=\"name\" v=\"Bread &amp; Co\"/><tag k=\"height\" v=\"~18\"/></way>\n\
        <way id=\"2\"><nd ref=\"20\"/><nd ref=\"22\"/><tag k=\"highway\" v=\"residential\"/><tag k=\"name\" v=\"Lane\"/></way>\n\
        <relation id=\"3\"><member type=\"way\" ref=\"4\" role=\"outer\"/><tag k=\"type\" v=\"multipolygon\"/>\
        <tag k=\"leisure\" v=\"park\"/></relation><way id=\"4\"><nd ref=\"30\"/><nd ref=\"31\"/><nd ref=\"32\"/><nd ref=\"30\"/></way></osm>";
    let json_nodes =
        town.nodes.iter().map(|(id, x, y)| format!("{{\"type\":\"node\",\"id\":{id},\"lon\":{x},\"lat\":{y}}},\n"));
    let json_ways = "{\"type\":\"way\",\"id\":1,\"nodes\":[10,11,12,13,10],\"tags\":{\"building\":\"yes\",\"name\":\"Bread & Co\",\"height\":\"~18\"}},\
        {\"type\":\"way\",\"id\":2,\"nodes\":[20,22],\"tags\":{\"highway\":\"residential\",\"name\":\"Lane\"}},\
        {\"type\":\"relation\",\"id\":3,\"members\":[{\"type\":\"way\",\"ref\":4,\"role\":\"outer\"}],\"tags\":{\"type\":\"multipolygon\",\"leisure\":\"park\"}},\
        {\"type\":\"way\",\"id\":4,\"nodes\":[30,31,32,30]}]}";
    let json = "{\"version\":0.6,\"osm3s\":{\"copyright\":\"x\"},\"elements\":[\n".to_owned();
    [xml + &nodes.collect::<String>() + way, json + &json_nodes.collect::<String>() + json_ways]
}

#[test]
fn xml_and_the_answer_of_overpass_are_read_as_pbf_is_and_their_objects_are_features() {
    let folder = Folder::new();
    let texts = as_text(&town());
    for (name, format, text) in [("a.osm", "OSM XML", &texts[0]), ("a.json", "Overpass JSON", &texts[1])] {
        let path = folder.file(name, text.as_bytes());
        let Loaded { value, warnings, .. } = load_city(&path, None, &Limits::default()).expect(name);
        assert_eq!(value.format, format);
        let [building] = &value.city.buildings[..] else { panic!("{:?}", value.city.buildings) };
        assert_eq!((building.name.as_str(), building.height_m), ("Bread & Co", 18.0));
        assert!(warnings.iter().any(|w| w.text().contains("1 heights are stated as approximate")), "{warnings:?}");
        assert!(value.about[0].is_meant("bread & co") && value.about[0].is_meant("building=yes"));
        assert_eq!((value.city.ways.len(), value.city.areas.len()), (1, 1));
        let features = load_vectors(&path).expect(name).value.features;
        let names: Vec<(&str, &str)> =
            features.iter().map(|f| (f.properties["id"].as_str(), f.name.as_str())).collect();
        assert_eq!(names, [("relation/3", ""), ("way/1", "Bread & Co"), ("way/2", "Lane")]);
        // Of XML what is whole is read, JSON is whole or nothing.
        let cut = load_city(&folder.file(name, &text.as_bytes()[..text.len() - 20]), None, &Limits::default());
        match cut {
            Ok(loaded) => assert!(loaded.warnings.iter().any(|w| w.text().contains("cut off")) && name == "a.osm"),
            Err(error) => assert!(error.to_string().contains("damaged or cut off") && name == "a.json", "{error}"),
        }
    }
}

#[test]
fn broken_files_end_in_one_sentence() {
    let whole = town().bytes();
    for (bytes, want) in [
        (whole[..whole.len() - 30].to_vec(), "damaged or cut off"),
        (whole[..40.min(whole.len())].to_vec(), "OSM PBF"),
        (Extract::default().bytes(), "of 0 nodes, 0 ways and 0 relations holds no building"),
        (Extract { member_type: 9, ..town() }.bytes(), "OSM PBF"),
    ] {
        match load(&bytes) {
            Ok(_) => assert!(want == "OSM PBF", "{want}"),
            Err(error) => assert!(error.contains(want) && error.lines().count() == 1, "{want}: {error}"),
        }
    }
    let mut odd = Extract { member_type: 9, ..Extract::default() };
    odd.relation(1, &[("type", "multipolygon"), ("building", "yes")], &[1]);
    let error = load(&odd.bytes()).unwrap_err();
    assert!(error.contains("contradict"), "{error}");
}

#[test]
fn truncations_and_flips_never_panic() {
    let whole = town().bytes();
    let mut failed = 0;
    for at in 8..whole.len() {
        let mut broken = whole.clone();
        broken[at] ^= 1 << (at % 8);
        failed += usize::from(load(&broken).is_err()) + usize::from(load(&whole[..at]).is_err());
    }
    assert!(failed > whole.len() / 2, "{failed} of {}", 2 * whole.len());
}

#[test]
fn andorra_is_a_town_among_mountains() {
    let Some(path) = data("andorra/andorra.osm.pbf") else { return };
    let Loaded { value, warnings, .. } = load_city(&path, None, &Limits::default()).unwrap();
    let city = value.city;
    let count = |class: WayClass| city.ways.iter().filter(|w| w.class == class).count();
    let streets = count(WayClass::Primary) + count(WayClass::Residential) + count(WayClass::Service);
    // By another reader of the same extract: 292 buildings, 89 rivers, canals and streams over ground.
    assert_eq!(city.buildings.len(), 292);
    assert!((89..131).contains(&count(WayClass::Waterway)), "{}", count(WayClass::Waterway));
    assert!(streets > 1000, "{streets} streets");
    assert_eq!(warnings.len(), 2, "{warnings:?}");
    assert!(warnings[0].text().contains("lie underground"), "{warnings:?}");
    assert!(city.areas.iter().any(|a| a.cover == LandCover::Water));
    let all = city.buildings.iter().flat_map(|b| &b.footprint).flat_map(|p| &p.outer);
    assert!(all.clone().all(|p| (1.0..2.0).contains(&p.x) && (42.0..43.0).contains(&p.y)));
}
