//! Cities: OpenStreetMap in three spellings, CityJSON, CityGML, footprints.

use super::{CORNER, degrees, square};

/// A way: its tags, and its positions in metres from the corner of the ground.
type Way = (&'static [(&'static str, &'static str)], Vec<[f64; 2]>);

fn ways() -> Vec<Way> {
    vec![
        (
            &[
                ("building", "church"),
                ("name", "Sankt Anna"),
                ("height", "21 m"),
                ("roof:shape", "gabled"),
                ("roof:height", "6"),
            ],
            square(200.0, 250.0, 12.0),
        ),
        (&[("building", "yes"), ("building:levels", "4"), ("roof:shape", "dome")], square(260.0, 250.0, 9.0)),
        (&[("building:part", "yes"), ("min_height", "3"), ("height", "9")], square(260.0, 250.0, 5.0)),
        (&[("landuse", "forest")], square(350.0, 400.0, 60.0)),
        (
            &[("highway", "primary"), ("name", "Hauptstra\u{df}e"), ("lanes", "3")],
            vec![[50.0, 100.0], [250.0, 140.0], [500.0, 120.0]],
        ),
        (&[("waterway", "river"), ("width", "8")], vec![[50.0, 300.0], [300.0, 320.0], [500.0, 500.0]]),
        (&[], square(150.0, 420.0, 40.0)),
    ]
}

/// Ids and positions of the nodes; of each way the ids of its nodes.
type Numbered = (Vec<(i64, [f64; 2])>, Vec<Vec<i64>>);

/// A closed way ends with the node that it begins with.
fn numbered() -> Numbered {
    let (mut nodes, mut lists) = (Vec::new(), Vec::new());
    for (_, line) in ways() {
        let first = nodes.len() as i64 + 1;
        let closed = line.first() == line.last();
        let own = line.len() - usize::from(closed);
        nodes.extend(line[..own].iter().enumerate().map(|(k, [x, y])| (first + k as i64, degrees(*x, *y))));
        let mut list: Vec<i64> = (first..first + own as i64).collect();
        list.extend(closed.then_some(first));
        lists.push(list);
    }
    (nodes, lists)
}

const RELATION: &[(&str, &str)] = &[("type", "multipolygon"), ("natural", "water"), ("name", "See")];

/// OpenStreetMap as XML.
pub fn osm_xml() -> Vec<Vec<u8>> {
    let tags =
        |tags: &[(&str, &str)]| tags.iter().map(|(k, v)| format!("<tag k=\"{k}\" v=\"{v}\"/>")).collect::<String>();
    let (nodes, lists) = numbered();
    let mut text = "<?xml version=\"1.0\"?>\n<osm version=\"0.6\"><bounds/>\n".to_owned();
    text.extend(
        nodes.iter().map(|(id, [lon, lat])| format!("<node id=\"{id}\" lon=\"{lon:.7}\" lat=\"{lat:.7}\"/>\n")),
    );
    for (k, ((of, _), list)) in ways().iter().zip(&lists).enumerate() {
        let refs: String = list.iter().map(|id| format!("<nd ref=\"{id}\"/>")).collect();
        text += &format!("<way id=\"{}\">{refs}{}</way>\n", k + 1, tags(of));
    }
    let relation = tags(RELATION);
    text += &format!(
        "<relation id=\"1\"><member type=\"way\" ref=\"{}\" role=\"outer\"/>{relation}</relation>\n</osm>\n",
        lists.len()
    );
    vec![text.into_bytes()]
}

/// The same as the answer of Overpass.
pub fn overpass() -> Vec<Vec<u8>> {
    let tags = |tags: &[(&str, &str)]| {
        let all: Vec<String> = tags.iter().map(|(k, v)| format!("\"{k}\":\"{v}\"")).collect();
        format!("{{{}}}", all.join(","))
    };
    let (nodes, lists) = numbered();
    let mut elements: Vec<String> = nodes
        .iter()
        .map(|(id, [lon, lat])| format!("{{\"type\":\"node\",\"id\":{id},\"lon\":{lon:.7},\"lat\":{lat:.7}}}"))
        .collect();
    for (k, ((of, _), list)) in ways().iter().zip(&lists).enumerate() {
        elements.push(format!("{{\"type\":\"way\",\"id\":{},\"nodes\":{list:?},\"tags\":{}}}", k + 1, tags(of)));
    }
    let member = format!("{{\"type\":\"way\",\"ref\":{},\"role\":\"outer\"}}", lists.len());
    elements.push(format!("{{\"type\":\"relation\",\"id\":1,\"members\":[{member}],\"tags\":{}}}", tags(RELATION)));
    let text =
        format!("{{\"version\":0.6,\"osm3s\":{{\"copyright\":\"x\"}},\"elements\":[\n{}]}}", elements.join(",\n"));
    vec![text.into_bytes()]
}

fn varint(mut value: u64, out: &mut Vec<u8>) {
    while value > 0x7f {
        out.push(value as u8 | 0x80);
        value >>= 7;
    }
    out.push(value as u8);
}

/// A field of bytes.
fn field(number: u64, bytes: &[u8]) -> Vec<u8> {
    let mut out = Vec::new();
    varint(number << 3 | 2, &mut out);
    varint(bytes.len() as u64, &mut out);
    [out, bytes.to_vec()].concat()
}

fn integer(number: u64, value: u64) -> Vec<u8> {
    let mut out = Vec::new();
    varint(number << 3, &mut out);
    varint(value, &mut out);
    out
}

fn packed(number: u64, values: impl IntoIterator<Item = u64>) -> Vec<u8> {
    let mut list = Vec::new();
    values.into_iter().for_each(|v| varint(v, &mut list));
    field(number, &list)
}

/// Differences, with the sign in the lowest bit.
fn deltas(values: impl IntoIterator<Item = i64>) -> Vec<u64> {
    let zigzag = |v: i64| ((v << 1) ^ (v >> 63)) as u64;
    values.into_iter().scan(0, |last, v| Some(zigzag(v - std::mem::replace(last, v)))).collect()
}

/// A blob; the second kind is compressed.
fn blob(kind: &str, message: &[u8], compressed: bool) -> Vec<u8> {
    let body = if compressed {
        let zlib = super::packages::zlib(message);
        [integer(2, message.len() as u64), field(3, &zlib)].concat()
    } else {
        field(1, message)
    };
    let header = [field(1, kind.as_bytes()), integer(3, body.len() as u64)].concat();
    [(header.len() as u32).to_be_bytes().to_vec(), header, body].concat()
}

/// OpenStreetMap as PBF, plain and compressed.
pub fn pbf() -> Vec<Vec<u8>> {
    let mut words = vec![String::new(), "outer".into()];
    let mut word = |text: &str| {
        let at = words.iter().position(|w| w == text).unwrap_or(words.len());
        if at == words.len() {
            words.push(text.into());
        }
        at as u64
    };
    let mut tagged = |id: u64, tags: &[(&str, &str)]| {
        let (keys, values): (Vec<u64>, Vec<u64>) = tags.iter().map(|(k, v)| (word(k), word(v))).unzip();
        [integer(1, id), packed(2, keys), packed(3, values)].concat()
    };
    let (nodes, lists) = numbered();
    let mut groups = Vec::new();
    for (k, ((of, _), list)) in ways().iter().zip(&lists).enumerate() {
        let way = [tagged(k as u64 + 1, of), packed(8, deltas(list.iter().copied()))].concat();
        groups.extend(field(2, &field(3, &way)));
    }
    let members = [packed(8, [1]), packed(9, deltas([lists.len() as i64])), packed(10, [1])].concat();
    groups.extend(field(2, &field(4, &[tagged(1, RELATION), members].concat())));
    let table: Vec<u8> = words.iter().flat_map(|w| field(1, w.as_bytes())).collect();
    let scaled = |v: f64| (v * 1e7).round() as i64;
    let dense = [
        packed(1, deltas(nodes.iter().map(|n| n.0))),
        packed(8, deltas(nodes.iter().map(|n| scaled(n.1[1])))),
        packed(9, deltas(nodes.iter().map(|n| scaled(n.1[0])))),
    ]
    .concat();
    let block = [field(1, &table), field(2, &field(2, &dense)), groups].concat();
    let header = field(4, b"OsmSchema-V0.6");
    [false, true].map(|c| [blob("OSMHeader", &header, c), blob("OSMData", &block, c)].concat()).into()
}

/// Corners of a house, its faces by indices, and what each is.
const FACES: [([usize; 4], &str); 6] = [
    ([0, 3, 2, 1], "GroundSurface"),
    ([4, 5, 6, 7], "RoofSurface"),
    ([0, 1, 5, 4], "WallSurface"),
    ([1, 2, 6, 5], "WallSurface"),
    ([2, 3, 7, 6], "WallSurface"),
    ([3, 0, 4, 7], "WallSurface"),
];

fn corners() -> Vec<[f64; 3]> {
    let ring = &square(220.0, 260.0, 15.0)[..4];
    [905.0, 917.0].iter().flat_map(|z| ring.iter().map(|[x, y]| [*x, *y, *z])).collect()
}

fn house(kind: &str) -> String {
    let shell: Vec<String> = FACES.iter().map(|(f, _)| format!("[{f:?}]")).collect();
    let semantics: Vec<String> = FACES.iter().map(|(_, s)| format!("{{\"type\":\"{s}\"}}")).collect();
    format!(
        r#""house":{{"type":"{kind}","attributes":{{"name":"Haus","measuredHeight":12.5,"storeys":4}},"geometry":[{{"type":"Solid","lod":"2.2","boundaries":[[{}]],"semantics":{{"surfaces":[{}],"values":[[0,1,2,3,4,5]]}}}}]}},
"tree":{{"type":"SolitaryVegetationObject","geometry":[{{"type":"MultiSurface","lod":1,"boundaries":[[[0,1,5]],[[0,1,2,3],[4,5,6]]]}}]}}"#,
        shell.join(","),
        semantics.join(",")
    )
}

fn vertices() -> String {
    let all: Vec<String> = corners().iter().map(|c| format!("{:?}", c.map(|v| (1000.0 * v) as i64))).collect();
    format!("[{}]", all.join(","))
}

fn transform() -> String {
    format!(r#""transform":{{"scale":[0.001,0.001,0.001],"translate":[{},{},0]}}"#, CORNER.x, CORNER.y)
}

const METADATA: &str = r#""metadata":{"referenceSystem":"https://www.opengis.net/def/crs/EPSG/0/32632"}"#;

/// CityJSON, one with a template.
pub fn cityjson() -> Vec<Vec<u8>> {
    let (objects, vertices, transform) = (house("Building"), vertices(), transform());
    let plain = format!(
        r#"{{"type":"CityJSON","version":"2.0",{transform},{METADATA},"CityObjects":{{{objects}}},"vertices":{vertices}}}"#
    );
    let template = r#""lamp":{"type":"CityFurniture","geometry":[{"type":"GeometryInstance","template":0,"boundaries":[2],"transformationMatrix":[2,0,0,0,0,2,0,0,0,0,2,0,0,0,0,1]}]}"#;
    let templates = r#""geometry-templates":{"templates":[{"type":"MultiSurface","lod":"2","boundaries":[[[0,1,2]],[[0,2,1]]]}],"vertices-templates":[[0,0,0],[1,0,0],[0,1,4]]}"#;
    let with = format!(
        r#"{{"type":"CityJSON","version":"1.1",{transform},{METADATA},"CityObjects":{{{objects},{template}}},{templates},"vertices":{vertices}}}"#
    );
    vec![plain.into_bytes(), with.into_bytes()]
}

/// CityJSONSeq.
pub fn cityjson_sequence() -> Vec<Vec<u8>> {
    let head =
        format!(r#"{{"type":"CityJSON","version":"2.0",{},{METADATA},"CityObjects":{{}},"vertices":[]}}"#, transform());
    let one = |id: &str| {
        let objects = house("Building")
            .replace('\n', "")
            .replace("\"house\"", &format!("\"{id}\""))
            .replace("\"tree\"", &format!("\"{id}-tree\""));
        format!(r#"{{"type":"CityJSONFeature","id":"{id}","CityObjects":{{{objects}}},"vertices":{}}}"#, vertices())
    };
    vec![[head, one("a"), one("b")].join("\n").into_bytes()]
}

/// CityGML 2.
pub fn citygml() -> Vec<Vec<u8>> {
    let at = corners();
    let polygon = |face: &[usize; 4], id: usize| {
        let list: Vec<String> = face
            .iter()
            .chain(&face[..1])
            .map(|&k| format!("{} {} {}", CORNER.x + at[k][0], CORNER.y + at[k][1], at[k][2]))
            .collect();
        format!(
            "<gml:Polygon gml:id=\"p{id}\"><gml:exterior><gml:LinearRing><gml:posList srsDimension=\"3\">{}</gml:posList></gml:LinearRing></gml:exterior></gml:Polygon>",
            list.join(" ")
        )
    };
    let surface = |(k, (face, kind)): (usize, &([usize; 4], &str))| {
        format!(
            "<bldg:boundedBy><bldg:{kind}><bldg:lod2MultiSurface><gml:MultiSurface><gml:surfaceMember>{}</gml:surfaceMember></gml:MultiSurface></bldg:lod2MultiSurface></bldg:{kind}></bldg:boundedBy>\n",
            polygon(face, k)
        )
    };
    let surfaces: String = FACES.iter().enumerate().map(surface).collect();
    let text = format!(
        r##"<?xml version="1.0" encoding="UTF-8"?>
<core:CityModel xmlns:core="http://www.opengis.net/citygml/2.0" xmlns:gml="http://www.opengis.net/gml" xmlns:xlink="http://www.w3.org/1999/xlink" xmlns:bldg="http://www.opengis.net/citygml/building/2.0" xmlns:gen="http://www.opengis.net/citygml/generics/2.0">
<gml:boundedBy><gml:Envelope srsName="urn:ogc:def:crs:EPSG::32632" srsDimension="3"><gml:lowerCorner>600000 5200000 0</gml:lowerCorner></gml:Envelope></gml:boundedBy>
<core:cityObjectMember><bldg:Building gml:id="b1"><gml:name>St. Mary &amp; St. John</gml:name><gen:stringAttribute name="use"><gen:value>church</gen:value></gen:stringAttribute><bldg:measuredHeight uom="m">12.3</bldg:measuredHeight>
<bldg:lod2Solid><gml:Solid><gml:exterior><gml:CompositeSurface><gml:surfaceMember xlink:href="#p1"/><gml:surfaceMember xlink:href="#p0"/></gml:CompositeSurface></gml:exterior></gml:Solid></bldg:lod2Solid>
{surfaces}</bldg:Building></core:cityObjectMember>
</core:CityModel>
"##
    );
    vec![text.into_bytes()]
}

/// Footprints with heights, as features.
pub fn footprints() -> Vec<Vec<u8>> {
    let one = |(tags, line): &Way| {
        let all: Vec<String> = tags.iter().map(|(k, v)| format!("\"{k}\":\"{v}\"")).collect();
        let ring: Vec<String> = line.iter().map(|p| format!("{:?}", degrees(p[0], p[1]))).collect();
        let (ring, closed) = (ring.join(","), line.first() == line.last());
        let geometry = if closed {
            format!(r#"{{"type":"Polygon","coordinates":[[{ring}]]}}"#)
        } else {
            format!(r#"{{"type":"LineString","coordinates":[{ring}]}}"#)
        };
        format!(r#"{{"type":"Feature","properties":{{{}}},"geometry":{geometry}}}"#, all.join(","))
    };
    let all: Vec<String> = ways().iter().map(one).collect();
    vec![format!(r#"{{"type":"FeatureCollection","features":[{}]}}"#, all.join(",\n")).into_bytes()]
}
