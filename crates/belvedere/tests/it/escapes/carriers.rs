//! Places in which a file can name another one.

use belvedere::io::png::{Channels, encode};

/// Names and contents of files.
type Files = Vec<(&'static str, Vec<u8>)>;

/// A place that names a file.
pub(super) struct Carrier {
    /// What it is; of a file that is found by its name, that name.
    pub(super) name: &'static str,
    /// Ending of the named file.
    pub(super) ending: &'static str,
    /// Content with which the named file would be read.
    pub(super) content: fn() -> Vec<u8>,
    /// Files beside the scene, which name the file.
    pub(super) files: fn(&str) -> Files,
    /// Text of the scene.
    pub(super) scene: fn(&str) -> String,
}

pub(super) const CAMERA: &str = "[camera]\neye = [0, -300, 100]\nlook_at = [0, 0, 0]\nimage = [64, 48]\n";

const GRID: &str = "ncols 3\nnrows 3\nxllcorner 0\nyllcorner 0\ncellsize 10\n1 2 3\n4 5 6\n7 8 9\n";
const LINE: &str =
    r#"{"type":"Feature","properties":{"name":"CANARY"},"geometry":{"type":"LineString","coordinates":[[1,2],[9,9]]}}"#;
const OBJ: &str = "v 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0\nvt 1 0\nvt 0 1\nusemtl a\nf 1/1 2/2 3/3\n";

fn none(_: &str) -> Files {
    Vec::new()
}

fn text(text: &str) -> Vec<u8> {
    text.as_bytes().to_vec()
}

fn picture() -> Vec<u8> {
    let mut bytes = Vec::new();
    encode(&mut bytes, 2, 2, Channels::Rgb, &[200; 12], &[]).expect("encoded");
    bytes
}

fn triangle() -> Vec<u8> {
    let corners: [f32; 9] = [0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0];
    let places: [f32; 6] = [0.0, 0.0, 1.0, 0.0, 0.0, 1.0];
    corners.iter().chain(&places).flat_map(|v| v.to_le_bytes()).collect()
}

fn quoted(name: &str) -> String {
    serde_json::to_string(name).expect("text")
}

fn layer(kind: &str, source: &str, more: &str) -> String {
    format!("[[layer]]\nid = \"x\"\nkind = \"{kind}\"\nsource = {}\n{more}\n", quoted(source))
}

fn gltf(buffer: &str, images: &str) -> Vec<u8> {
    let material = if images.is_empty() { "" } else { r#","material":0"# };
    format!(
        r#"{{"asset":{{"version":"2.0"}},"buffers":[{{"uri":{},"byteLength":60}}],
        "bufferViews":[{{"buffer":0,"byteLength":36}},{{"buffer":0,"byteOffset":36,"byteLength":24}}],
        "accessors":[{{"bufferView":0,"componentType":5126,"count":3,"type":"VEC3","min":[0,0,0],"max":[1,1,0]}},
        {{"bufferView":1,"componentType":5126,"count":3,"type":"VEC2"}}],
        "meshes":[{{"primitives":[{{"attributes":{{"POSITION":0,"TEXCOORD_0":1}}{material}}}]}}],{images}
        "nodes":[{{"mesh":0}}],"scenes":[{{"nodes":[0]}}],"scene":0}}"#,
        quoted(buffer)
    )
    .into_bytes()
}

fn city(image: &str) -> Vec<u8> {
    format!(
        r#"{{"type":"CityJSON","version":"1.1","transform":{{"scale":[1,1,1],"translate":[0,0,0]}},
        "appearance":{{"textures":[{{"type":"PNG","image":{}}}],"vertices-texture":[[0,0],[1,0],[1,1],[0,1]]}},
        "CityObjects":{{"b":{{"type":"Building","geometry":[{{"type":"MultiSurface","lod":"2",
        "boundaries":[[[0,1,2,3]],[[4,5,6,7]]],"texture":{{"t":{{"values":[[[0,0,1,2,3]],[[0,0,1,2,3]]]}}}}}}]}}}},
        "vertices":[[0,0,0],[9,0,0],[9,9,0],[0,9,0],[0,0,5],[9,0,5],[9,9,5],[0,9,5]]}}"#,
        quoted(image)
    )
    .into_bytes()
}

/// A shapefile of one point.
fn shape() -> Vec<u8> {
    let mut bytes = vec![0; 128];
    bytes[..4].copy_from_slice(&9994u32.to_be_bytes());
    bytes[24..28].copy_from_slice(&64u32.to_be_bytes());
    bytes[28..32].copy_from_slice(&1000u32.to_le_bytes());
    bytes[32..36].copy_from_slice(&1u32.to_le_bytes());
    bytes[100..104].copy_from_slice(&1u32.to_be_bytes());
    bytes[104..108].copy_from_slice(&10u32.to_be_bytes());
    bytes[108..112].copy_from_slice(&1u32.to_le_bytes());
    bytes[112..120].copy_from_slice(&500.0f64.to_le_bytes());
    bytes[120..128].copy_from_slice(&500.0f64.to_le_bytes());
    bytes
}

const fn named(
    name: &'static str,
    ending: &'static str,
    content: fn() -> Vec<u8>,
    scene: fn(&str) -> String,
) -> Carrier {
    Carrier { name, ending, content, files: none, scene }
}

/// Places that name a file by a text.
pub(super) const CARRIERS: &[Carrier] = &[
    named("source of terrain", "asc", || text(GRID), |name| layer("terrain", name, "")),
    named("source of lines", "geojson", || text(LINE), |name| layer("line", name, "")),
    named("source of areas", "geojson", || text(LINE), |name| layer("area", name, "")),
    named("source of points", "geojson", || text(LINE), |name| layer("point", name, "")),
    named("source of boxes", "geojson", || text(LINE), |name| layer("boxes", name, "")),
    named("source of a mesh", "obj", || text(OBJ), |name| layer("mesh", name, "")),
    named("source of a city", "json", || city("t.png"), |name| layer("city", name, "")),
    named(
        "source of a molecule",
        "pdb",
        || text("HEADER    CANARY\n"),
        |name| "unit = \"angstrom\"\n".to_owned() + &layer("molecule", name, ""),
    ),
    named("source of a volume", "nrrd", || text("NRRD0004\n# CANARY\n"), |name| layer("volume", name, "")),
    named(
        "transfer of a volume",
        "json",
        || text("{\"CANARY\": 1}"),
        |name| layer("volume", "builtin:engine", &format!("transfer = {}", quoted(name))),
    ),
    named("drape", "png", picture, |name| {
        layer("terrain", "builtin:massif?size=65", &format!("drape = {}", quoted(name)))
    }),
    named(
        "palette",
        "cpt",
        || text("CANARY"),
        |name| layer("terrain", "builtin:massif?size=65", &format!("style = {{ palette = {} }}", quoted(name))),
    ),
    named(
        "presets of a bend",
        "json",
        || text("{\"CANARY\": 1}"),
        |name| {
            let stage = format!("[[stage]]\nkind = \"spline_bend\"\npresets = {}\n", quoted(name));
            layer("terrain", "builtin:massif?size=65", "") + &stage
        },
    ),
    Carrier {
        name: "materials of an OBJ",
        ending: "mtl",
        content: || text("newmtl a\nKd 1 0 0\n"),
        files: |name| vec![("m.obj", text(&format!("mtllib {name}\n{OBJ}")))],
        scene: |_| layer("mesh", "m.obj", ""),
    },
    Carrier {
        name: "picture of an OBJ",
        ending: "png",
        content: picture,
        files: |name| {
            let materials = format!("newmtl a\nKd 1 1 1\nmap_Kd {name}\n");
            vec![("m.obj", text(&format!("mtllib m.mtl\n{OBJ}"))), ("m.mtl", text(&materials))]
        },
        scene: |_| layer("mesh", "m.obj", ""),
    },
    Carrier {
        name: "buffer of a glTF",
        ending: "bin",
        content: triangle,
        files: |name| vec![("m.gltf", gltf(name, ""))],
        scene: |_| layer("mesh", "m.gltf", ""),
    },
    Carrier {
        name: "picture of a glTF",
        ending: "png",
        content: picture,
        files: |name| {
            let images = format!(
                r#""images":[{{"uri":{}}}],"textures":[{{"source":0}}],"materials":[{{"pbrMetallicRoughness":{{"baseColorTexture":{{"index":0}}}}}}],"#,
                quoted(name)
            );
            vec![("m.gltf", gltf("b.bin", &images)), ("b.bin", triangle())]
        },
        scene: |_| layer("mesh", "m.gltf", ""),
    },
    Carrier {
        name: "samples of an NRRD",
        ending: "raw",
        content: || vec![7; 8],
        files: |name| {
            let head = "NRRD0004\ntype: uchar\ndimension: 3\nsizes: 2 2 2\nencoding: raw\n";
            vec![("v.nhdr", text(&format!("{head}data file: {name}\n\n")))]
        },
        scene: |_| layer("volume", "v.nhdr", ""),
    },
    Carrier {
        name: "picture of a CityJSON",
        ending: "png",
        content: picture,
        files: |name| vec![("c.city.json", city(name))],
        scene: |_| layer("city", "c.city.json", ""),
    },
];

/// Files that are found by their names beside others.
pub(super) const SIDECARS: &[Carrier] = &[
    Carrier {
        name: "g.prj",
        ending: "prj",
        content: || text("CANARY"),
        files: |_| vec![("g.asc", text(GRID))],
        scene: |_| layer("terrain", "g.asc", ""),
    },
    Carrier {
        name: "p.dbf",
        ending: "dbf",
        content: || text("CANARY"),
        files: |_| vec![("p.shp", shape())],
        scene: |_| layer("point", "p.shp", ""),
    },
    Carrier {
        name: "p.prj",
        ending: "prj",
        content: || text("CANARY"),
        files: |_| vec![("p.shp", shape())],
        scene: |_| layer("point", "p.shp", ""),
    },
    Carrier {
        name: "p.cpg",
        ending: "cpg",
        content: || text("CANARY"),
        files: |_| vec![("p.shp", shape())],
        scene: |_| layer("point", "p.shp", ""),
    },
    Carrier {
        name: "p.shx",
        ending: "shx",
        content: || text("CANARY"),
        files: |_| vec![("p.shp", shape())],
        scene: |_| layer("point", "p.shp", ""),
    },
    Carrier {
        name: "d.pgw",
        ending: "pgw",
        content: || text("CANARY"),
        files: |_| vec![("d.png", picture())],
        scene: |_| layer("terrain", "builtin:massif?size=65", "drape = \"d.png\""),
    },
];
