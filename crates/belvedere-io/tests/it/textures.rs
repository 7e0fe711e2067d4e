//! Pictures on meshes and named parts, in real and made-up files.

use belvedere_io::{Limits, Loaded, MeshFile, load_mesh};
use belvedere_scene::{Color, Mesh, MeshColors, MeshLayer};
use belvedere_testkit::data;
use glam::DVec3;
use std::path::{Path, PathBuf};

fn layer(file: MeshFile) -> MeshLayer {
    let MeshFile { positions, triangles, colors, parts, names, texturing, .. } = file;
    let mesh = Mesh::textured(&positions, triangles, colors, parts, texturing).expect("a reader returns a mesh");
    MeshLayer { names, ..MeshLayer::new(mesh, Color::rgb(1, 2, 3)) }
}

fn load(path: &Path) -> Loaded<MeshFile> {
    load_mesh(path, &Limits::default()).unwrap_or_else(|e| panic!("{e}"))
}

fn area(mesh: &Mesh, t: usize) -> f64 {
    let [a, b, c] = mesh.corners(t);
    0.5 * (b - a).cross(c - a).length()
}

fn files_of(folder: &Path) -> Vec<PathBuf> {
    let is_mesh = |p: &PathBuf| {
        let ending = p.extension().map(|e| e.to_string_lossy().to_lowercase()).unwrap_or_default();
        ["obj", "ply", "stl", "gltf", "glb"].contains(&ending.as_str())
    };
    let entries = std::fs::read_dir(folder).expect("folder").map(|e| e.expect("entry").path());
    let mut files: Vec<PathBuf> = entries.filter(is_mesh).collect();
    files.sort();
    files
}

#[test]
fn every_file_of_the_block_city_wears_its_palette() {
    for (folder, least) in [("city_kaykit/gltf", 20), ("city_kaykit/obj", 4)] {
        let Some(folder) = data(folder) else { continue };
        let files = files_of(&folder);
        assert!(files.len() >= least, "{files:?}");
        for path in files {
            let loaded = load(&path);
            assert!(loaded.warnings.is_empty(), "{path:?}: {:?}", loaded.warnings);
            assert!(loaded.files.iter().any(|f| f.path.ends_with("citybits_texture.png")), "{path:?}");
            let layer = layer(loaded.value);
            assert!(!layer.names.is_empty() && layer.name_of(0).is_some(), "{path:?}");
            let white = Color::rgb(255, 255, 255);
            let colored = |t: &usize| layer.mesh.surface_color_at(*t, [0.3, 0.3, 0.4], 0.0).is_some_and(|c| c != white);
            let all = layer.mesh.triangles().len();
            assert_eq!((0..all).filter(colored).count(), all, "{path:?}");
        }
    }
}

#[test]
fn a_building_has_the_same_colours_from_obj_and_gltf() {
    let (Some(obj), Some(gltf)) = (data("city_kaykit/obj/building_A.obj"), data("city_kaykit/gltf/building_A.gltf"))
    else {
        return;
    };
    // Area by colour: the files order triangles differently, and OBJ counts v upwards.
    let by_color = |path: &Path| {
        let layer = layer(load(path).value);
        let mut out = std::collections::BTreeMap::new();
        for t in 0..layer.mesh.triangles().len() {
            let c = layer.mesh.surface_color_at(t, [1.0 / 3.0; 3], 0.0).expect("a colour");
            *out.entry([c.r, c.g, c.b].map(|v| v / 16)).or_insert(0.0) += area(&layer.mesh, t);
        }
        out
    };
    let (a, b) = (by_color(&obj), by_color(&gltf));
    let total: f64 = a.values().sum();
    let keys: std::collections::BTreeSet<_> = a.keys().chain(b.keys()).collect();
    assert!(keys.len() > 8, "{keys:?}");
    let off: f64 = keys.iter().map(|k| (a.get(*k).unwrap_or(&0.0) - b.get(*k).unwrap_or(&0.0)).abs()).sum();
    assert!(off < 0.01 * total, "{off} of {total}");
}

#[test]
fn the_duck_is_yellow_with_black_eyes_and_an_orange_beak() {
    let Some(path) = data("odd/Duck.glb") else { return };
    let layer = layer(load(&path).value);
    let all: f64 = (0..layer.mesh.triangles().len()).map(|t| area(&layer.mesh, t)).sum();
    let share = |is: &dyn Fn(Color) -> bool| {
        let on = |t: &usize| is(layer.mesh.surface_color_at(*t, [1.0 / 3.0; 3], 0.0).expect("a colour"));
        (0..layer.mesh.triangles().len()).filter(on).map(|t| area(&layer.mesh, t)).sum::<f64>() / all
    };
    let yellow = share(&|c| c.r > 180 && c.g > 150 && c.b < 120);
    let orange = share(&|c| c.r > 200 && (90..150).contains(&c.g) && c.b < 80);
    let black = share(&|c| c.r.max(c.g).max(c.b) < 50);
    assert!(
        yellow > 0.7 && (0.01..0.2).contains(&orange) && (0.0005..0.05).contains(&black),
        "{yellow} {orange} {black}"
    );
}

#[test]
fn odd_meshes_load_or_explain_themselves() {
    let Some(readme) = data("odd/empty.obj") else { return };
    let refused =
        ["empty.obj", "empty.ply", "empty.stl", "empty_nodes.glb", "face_in_group_name.obj", "points_emptyface.ply"];
    let files = files_of(readme.parent().expect("folder"));
    assert!(files.len() >= 20, "{files:?}");
    for path in files {
        let name = path.file_name().and_then(|n| n.to_str()).expect("UTF-8");
        match load_mesh(&path, &Limits::default()) {
            Ok(loaded) => {
                assert!(!refused.contains(&name), "{name}");
                assert!(!layer(loaded.value).mesh.bounds().is_empty(), "{name}");
            }
            Err(e) => {
                let text = e.to_string();
                assert!(text.lines().count() == 1 && text.contains(name), "{text}");
                assert!(refused.contains(&name), "{text}");
            }
        }
    }
}

/// A picture of 2 x 2 pixels: red, green over blue, white.
fn picture(folder: &Path, name: &str) {
    let pixels = [255, 0, 0, 0, 255, 0, 0, 0, 255, 255, 255, 255];
    belvedere_io::png::write(&folder.join(name), false, 2, 2, belvedere_io::png::Channels::Rgb, &pixels, &[])
        .expect("written");
}

const SQUARE: &str = "mtllib m.mtl\nv 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nvt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\n\
    o left wing\nusemtl paper\nf 1/1 2/2 3/3\no right wing\nf 1/1 3/3 4/4\n";

#[test]
fn materials_place_their_picture_upright_and_parts_keep_their_names() {
    let folder = tempfile::tempdir().expect("folder");
    picture(folder.path(), "p.png");
    std::fs::write(folder.path().join("s.obj"), SQUARE).expect("written");
    std::fs::write(folder.path().join("m.mtl"), "newmtl paper\nKd 1 1 1\nmap_Kd p.png\n").expect("written");
    let loaded = load(&folder.path().join("s.obj"));
    assert_eq!((loaded.warnings.len(), loaded.files.len()), (0, 3), "{loaded:?}");
    let layer = layer(loaded.value);
    assert_eq!(layer.names, ["left wing", "right wing"]);
    assert_eq!((layer.parts_named("RIGHT WING"), layer.parts_named("wing")), (vec![1], vec![]));
    // Seen with x to the right and y up the picture stands upright: its red corner is at (0, 1).
    for (p, color) in
        [([0.0, 1.0], [255, 0, 0]), ([1.0, 1.0], [0, 255, 0]), ([0.0, 0.0], [0, 0, 255]), ([1.0, 0.0], [255; 3])]
    {
        let at = DVec3::new(0.25 + 0.5 * p[0], 0.25 + 0.5 * p[1], 0.0);
        let of = |t: &usize| layer.mesh.weights_at(*t, at).iter().all(|w| *w >= -1e-9);
        let t = (0..2).find(of).expect("inside");
        let found = layer.mesh.surface_color_at(t, layer.mesh.weights_at(t, at), 0.0);
        assert_eq!(found, Some(Color::rgb(color[0], color[1], color[2])), "{p:?}");
    }
    // From far away the colour is the mean of the picture's linear light.
    let far = layer.mesh.surface_color_at(0, [0.2, 0.3, 0.5], 1.0).expect("a colour");
    assert!([far.r, far.g, far.b].iter().all(|v| (170..190).contains(v)), "{far:?}");
}

#[test]
fn pictures_that_cannot_be_read_leave_the_colour_with_a_word() {
    let folder = tempfile::tempdir().expect("folder");
    std::fs::write(folder.path().join("s.obj"), SQUARE).expect("written");
    std::fs::write(folder.path().join("noise.png"), b"\x89PNG\r\n and then nothing").expect("written");
    std::fs::write(folder.path().join("text.txt"), b"no picture").expect("written");
    for (name, said) in [
        ("missing.png", "missing.png"),
        ("noise.png", "is a PNG that cannot be read"),
        ("text.txt", "is neither PNG nor JPEG"),
        ("../p.png", "not a file below its own folder"),
        ("/etc/hostname", "not a file below its own folder"),
    ] {
        let mtl = format!("newmtl paper\nKd 0.5 0 0\nmap_Kd {name}\n");
        std::fs::write(folder.path().join("m.mtl"), mtl).expect("written");
        let loaded = load(&folder.path().join("s.obj"));
        assert!(
            loaded.warnings.len() == 1 && loaded.warnings[0].text().contains(said),
            "{name}: {:?}",
            loaded.warnings
        );
        assert!(loaded.value.texturing.is_none());
        assert_eq!(loaded.value.colors, MeshColors::PerTriangle(vec![Color::rgb(128, 0, 0); 2]));
    }
}

#[test]
fn what_is_all_air_is_left_out_and_what_is_glass_is_said() {
    let folder = tempfile::tempdir().expect("folder");
    let buffer = "data:application/octet-stream;base64,AAAAAAAAAAAAAAAAAACAPwAAAAAAAAAAAAAAAAAAgD8AAAAA";
    let gltf = |alpha: f64| {
        format!(
            r#"{{"asset":{{"version":"2.0"}},"scene":0,"scenes":[{{"nodes":[0,1]}}],
            "nodes":[{{"mesh":0,"name":"wall"}},{{"mesh":1,"name":"pane"}}],
            "meshes":[{{"primitives":[{{"attributes":{{"POSITION":0}}}}]}},{{"primitives":[{{"attributes":{{"POSITION":0}},"material":0}}]}}],
            "materials":[{{"alphaMode":"BLEND","pbrMetallicRoughness":{{"baseColorFactor":[1,1,1,{alpha}]}}}}],
            "accessors":[{{"bufferView":0,"componentType":5126,"count":3,"type":"VEC3","min":[0,0,0],"max":[1,1,0]}}],
            "bufferViews":[{{"buffer":0,"byteLength":36}}],"buffers":[{{"byteLength":36,"uri":"{buffer}"}}]}}"#
        )
    };
    let path = folder.path().join("a.gltf");
    for (alpha, triangles, warnings) in [(0.0, 1, 0), (0.5, 2, 1)] {
        std::fs::write(&path, gltf(alpha)).expect("written");
        let loaded = load(&path);
        assert_eq!((loaded.value.triangles.len(), loaded.warnings.len()), (triangles, warnings), "{loaded:?}");
        assert_eq!(loaded.value.names, ["wall", "pane"]);
        assert_eq!(loaded.value.parts, (0..triangles as u32).collect::<Vec<_>>());
    }
}

/// Three textures over one file beside it, two of which repeat it: it is decoded once for each way to go on beyond its edge.
#[test]
fn a_picture_that_many_textures_name_is_decoded_once() {
    let folder = tempfile::tempdir().expect("folder");
    picture(folder.path(), "p.png");
    let corners: Vec<u8> = [0.0f32, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 1.0]
        .iter()
        .flat_map(|v| v.to_le_bytes())
        .collect();
    std::fs::write(folder.path().join("b.bin"), corners).expect("written");
    let primitive =
        |material: usize| serde_json::json!({"attributes": {"POSITION": 0, "TEXCOORD_0": 1}, "material": material});
    let material =
        |texture: usize| serde_json::json!({"pbrMetallicRoughness": {"baseColorTexture": {"index": texture}}});
    let gltf = serde_json::json!({
        "asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": [0]}], "nodes": [{"mesh": 0}],
        "meshes": [{"primitives": [primitive(0), primitive(1), primitive(2)]}],
        "materials": [material(0), material(1), material(2)],
        "textures": [{"source": 0}, {"source": 1}, {"source": 1, "sampler": 0}],
        "samplers": [{"wrapS": 33071}],
        "images": [{"uri": "p.png"}, {"uri": "p.png"}],
        "buffers": [{"byteLength": 60, "uri": "b.bin"}],
        "bufferViews": [{"buffer": 0, "byteLength": 36}, {"buffer": 0, "byteOffset": 36, "byteLength": 24}],
        "accessors": [
            {"bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3", "min": [0, 0, 0], "max": [1, 1, 0]},
            {"bufferView": 1, "componentType": 5126, "count": 3, "type": "VEC2"},
        ],
    });
    let path = folder.path().join("m.gltf");
    std::fs::write(&path, gltf.to_string()).expect("written");
    let loaded = load(&path);
    let texturing = loaded.value.texturing.expect("pictures");
    assert_eq!((texturing.textures.len(), texturing.of_triangle), (2, vec![0, 0, 1]));
    assert_ne!(texturing.textures[0], texturing.textures[1]);
}
