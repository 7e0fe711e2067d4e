//! Meshes of the data collection and made-up ones: counts by a script that shares no code with the readers, and broken files.

use belvedere_io::{Limits, MeshFile, load_mesh};
use belvedere_scene::{Color, Mesh, MeshColors};
use belvedere_testkit::data;
use glam::DVec3;
use std::path::Path;

/// File and triangles; 0 = refused.
const FILES: &[(&str, usize)] = &[
    ("city_kaykit/obj/building_A.obj", 828),
    ("city_kaykit/obj/building_E.obj", 1356),
    ("city_kaykit/obj/building_H.obj", 1885),
    ("city_kaykit/obj/road_junction.obj", 170),
    ("city_kaykit/gltf/base.gltf", 60),
    ("city_kaykit/gltf/building_A.gltf", 828),
    ("city_kaykit/gltf/building_H.gltf", 1885),
    ("city_kaykit/gltf/car_taxi.gltf", 1256),
    ("city_kaykit/gltf/road_corner_curved.gltf", 172),
    ("city_kaykit/gltf/watertower.gltf", 146),
    ("odd/fandisk.obj", 5750),
    ("odd/joined_tetrahedra.obj", 8),
    ("odd/negative_indices.obj", 12),
    ("odd/not_convex.obj", 96),
    ("odd/polygonfaces.obj", 3),
    ("odd/empty.obj", 0),
    ("odd/bunny.ply", 16301),
    ("odd/empty.ply", 0),
    ("odd/points_emptyface.ply", 0),
    ("odd/busted.STL", 3878),
    ("odd/soup.stl", 100),
    ("odd/empty.stl", 0),
    ("odd/BoxInterleaved.glb", 12),
    ("odd/Duck.glb", 4212),
    ("odd/Mesh_PrimitiveMode_04.gltf", 2),
    ("odd/nested.glb", 36),
    ("odd/no_indices_3storybuilding.glb", 72),
    ("odd/empty_nodes.glb", 0),
];

fn made(mesh: &MeshFile) -> Mesh {
    let out = Mesh::new(&mesh.positions, mesh.triangles.clone(), mesh.colors.clone()).expect("a reader returns a mesh");
    match &mesh.normals {
        Some(normals) => out.with_normals(normals).expect("one normal per vertex"),
        None => out,
    }
}

#[test]
fn real_meshes_have_the_triangles_that_a_script_counts() {
    for &(name, triangles) in FILES {
        let Some(path) = data(name) else { continue };
        match load_mesh(&path, &Limits::default()) {
            Ok(loaded) => {
                assert_eq!(loaded.value.triangles.len(), triangles, "{name}");
                assert!(made(&loaded.value).triangles().len() <= triangles);
            }
            Err(e) => {
                assert_eq!(triangles, 0, "{name}: {e}");
                assert_eq!(e.to_string().lines().count(), 1, "{e}");
            }
        }
    }
}

#[test]
fn one_building_is_the_same_from_obj_and_gltf() {
    // The OBJ has y up like the glTF.
    let (Some(obj), Some(gltf)) = (data("city_kaykit/obj/building_A.obj"), data("city_kaykit/gltf/building_A.gltf"))
    else {
        return;
    };
    let [obj, gltf] = [obj, gltf].map(|p| load_mesh(&p, &Limits::default()).expect("readable").value);
    let area = |m: &MeshFile, turn: fn(DVec3) -> DVec3| {
        let corner = |v: u32| turn(m.positions[v as usize]);
        let sum = m.triangles.iter().fold(DVec3::ZERO, |sum, t| {
            let [a, b, c] = t.map(corner);
            sum + (b - a).cross(c - a).abs()
        });
        0.5 * sum
    };
    let z_up = |p: DVec3| DVec3::new(p.x, -p.z, p.y);
    let (a, b) = (area(&obj, z_up), area(&gltf, |p| p));
    assert!((a - b).abs().max_element() < 1e-3 * a.max_element(), "{a} {b}");
    assert!(gltf.normals.is_some() && obj.normals.is_some());
}

fn write(folder: &Path, name: &str, bytes: &[u8]) -> std::path::PathBuf {
    let path = folder.join(name);
    std::fs::write(&path, bytes).expect("written");
    path
}

#[test]
fn a_vertex_keeps_its_normal_where_its_corners_agree() {
    let folder = tempfile::tempdir().expect("folder");
    let corners = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 1 1 0\nvn 0 0 2\nvn 1 0 1\n";
    let text = format!("{corners}f 1//1 2//1 3//1\nf 2//1 4//1 3//2\n");
    let path = write(folder.path(), "two.obj", text.as_bytes());
    let mesh = load_mesh(&path, &Limits::default()).expect("a mesh").value;
    let of =
        |p: DVec3| mesh.normals.as_ref().expect("normals")[mesh.positions.iter().position(|q| *q == p).expect("it")];
    assert_eq!(of(DVec3::X), DVec3::Z, "both corners say so");
    assert_eq!(of(DVec3::new(1.0, 1.0, 0.0)), DVec3::Z, "its only corner says so");
    assert_eq!(of(DVec3::Y), DVec3::ZERO, "its corners differ");
}

#[test]
fn truncated_and_mangled_files_end_in_one_line_or_a_mesh() {
    let folder = tempfile::tempdir().expect("folder");
    let mut seed = 5u64;
    for &(name, _) in FILES {
        let Some(path) = data(name) else { continue };
        let bytes = std::fs::read(&path).expect("readable");
        let ending = path.extension().and_then(|e| e.to_str()).unwrap_or_default().to_owned();
        for round in 0..24 {
            let mut broken = bytes.clone();
            seed = seed.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            let at = (seed >> 33) as usize % broken.len().max(1);
            match round % 3 {
                0 => broken.truncate(at),
                1 => broken[at] ^= 1 << (seed % 8),
                _ => {
                    let head = broken.len().min(900);
                    broken[at % head] = (seed >> 20) as u8;
                }
            }
            let path = write(folder.path(), &format!("x.{ending}"), &broken);
            match load_mesh(&path, &Limits::default()) {
                Ok(loaded) => {
                    assert!(!made(&loaded.value).triangles().is_empty() || !loaded.value.triangles.is_empty())
                }
                Err(e) => assert_eq!(e.to_string().lines().count(), 1, "{name}: {e}"),
            }
        }
    }
}

#[test]
fn gltf_reads_nothing_outside_its_folder_and_nothing_remote() {
    let folder = tempfile::tempdir().expect("folder");
    let inner = folder.path().join("in");
    std::fs::create_dir(&inner).expect("folder");
    write(folder.path(), "secret.bin", &[0; 64]);
    for uri in ["../secret.bin", "/etc/hostname", "https://example.org/x.bin", "file:///etc/hostname", "a\\\\b.bin"] {
        let text = format!(
            r#"{{"asset":{{"version":"2.0"}},"buffers":[{{"byteLength":64,"uri":"{uri}"}}],"scenes":[{{"nodes":[]}}]}}"#
        );
        let path = write(&inner, "x.gltf", text.as_bytes());
        let error = load_mesh(&path, &Limits::default()).expect_err("refused").to_string();
        assert!(error.contains("not a file below its own folder"), "{uri}: {error}");
    }
}

#[test]
fn gltf_nodes_place_colour_and_mirror_their_triangles() {
    // One triangle (1, 0, 0), (0, 1, 0), (0, 0, 0), as base64; a node that mirrors x and lifts by 5 along y, a linear red of 0.5.
    let numbers: Vec<u8> =
        [1f32, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0].iter().flat_map(|v| v.to_le_bytes()).collect();
    let text = format!(
        r#"{{"asset":{{"version":"2.0"}},"scene":0,"scenes":[{{"nodes":[0]}}],
        "nodes":[{{"mesh":0,"scale":[-2,1,1],"translation":[0,5,0]}}],
        "meshes":[{{"primitives":[{{"attributes":{{"POSITION":0}},"material":0}}]}}],
        "materials":[{{"pbrMetallicRoughness":{{"baseColorFactor":[0.5,0,0,1]}}}}],
        "accessors":[{{"bufferView":0,"componentType":5126,"count":3,"type":"VEC3","min":[0,0,0],"max":[1,1,0]}}],
        "bufferViews":[{{"buffer":0,"byteLength":36}}],
        "buffers":[{{"byteLength":36,"uri":"data:application/octet-stream;base64,{}"}}]}}"#,
        base64(&numbers)
    );
    let folder = tempfile::tempdir().expect("folder");
    let mesh = load_mesh(&write(folder.path(), "t.gltf", text.as_bytes()), &Limits::default()).expect("readable").value;
    assert_eq!(mesh.positions, [[-2.0, 0.0, 5.0], [0.0, 0.0, 6.0], [0.0, 0.0, 5.0]].map(DVec3::from_array));
    assert_eq!(mesh.triangles, [[0, 2, 1]]);
    // 0.5 linear is 188 stored.
    assert_eq!(mesh.colors, MeshColors::PerTriangle(vec![Color::rgb(188, 0, 0)]));
}

/// Of a multiple of three bytes.
fn base64(bytes: &[u8]) -> String {
    const LETTERS: &[u8; 64] = b"ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    let part = |c: &[u8]| {
        let n = (0..3).fold(0u32, |n, i| n << 8 | u32::from(c.get(i).copied().unwrap_or(0)));
        (0..4).map(move |i| char::from(LETTERS[(n >> (18 - 6 * i)) as usize & 63]))
    };
    bytes.chunks(3).flat_map(part).collect()
}

#[test]
fn obj_materials_colours_and_faces_are_read() {
    let folder = tempfile::tempdir().expect("folder");
    write(folder.path(), "m.mtl", b"newmtl red\nKd 1 0 0\nnewmtl blue\nKd 0 0 1\n");
    let far = "mtllib m.mtl\nv 500000.25 4700000.5 10\nv 500001.25 4700000.5 10\nv 500001.25 4700001.5 10\nv 500000.25 4700001.5 10\nusemtl red\nf 1 2 3 4\nusemtl blue\nf -4 -3 -1\n";
    let mesh = load_mesh(&write(folder.path(), "far.obj", far.as_bytes()), &Limits::default()).expect("readable").value;
    // Double precision: a quarter of a metre half a million metres away.
    assert!(mesh.positions.contains(&DVec3::new(500_000.25, 4_700_001.5, 10.0)));
    let [red, blue] = [Color::rgb(255, 0, 0), Color::rgb(0, 0, 255)];
    assert_eq!(mesh.colors, MeshColors::PerTriangle(vec![red, red, blue]));
    let outside = far.replace("m.mtl", "../m.mtl");
    let loaded = load_mesh(&write(folder.path(), "out.obj", outside.as_bytes()), &Limits::default()).expect("readable");
    assert_eq!((loaded.value.colors, loaded.warnings.len()), (MeshColors::Layer, 1));
    let beyond = load_mesh(&write(folder.path(), "b.obj", b"v 0 0 0\nv 1 0 0\nf 1 2 7\n"), &Limits::default());
    assert!(beyond.expect_err("refused").to_string().contains("names a vertex that there is not"));
}

#[test]
fn ply_colours_and_lies_about_sizes() {
    let folder = tempfile::tempdir().expect("folder");
    let head = "ply\nformat ascii 1.0\nelement vertex 3\nproperty double x\nproperty double y\nproperty double z\nproperty uchar red\nproperty uchar green\nproperty uchar blue\nelement face 1\nproperty list uchar int vertex_indices\nend_header\n";
    let good = format!("{head}0 0 0 255 0 0\n1 0 0 0 255 0\n0 1 0 0 0 255\n3 0 1 2\n");
    let mesh = load_mesh(&write(folder.path(), "c.ply", good.as_bytes()), &Limits::default()).expect("readable").value;
    let colors = [[255, 0, 0], [0, 255, 0], [0, 0, 255]].map(|[r, g, b]| Color::rgb(r, g, b));
    assert_eq!(mesh.colors, MeshColors::PerVertex(colors.to_vec()));
    for (from, to, says) in [
        ("element vertex 3", "element vertex 999999999999", "it is damaged"),
        ("3 0 1 2", "3 0 1 9", "names vertex 9 of 3"),
        ("3 0 1 2", "3 0 1 -1", "names vertex -1"),
    ] {
        let path = write(folder.path(), "bad.ply", good.replace(from, to).as_bytes());
        let error = load_mesh(&path, &Limits::default()).expect_err("refused").to_string();
        assert!(error.contains(says), "{error}");
    }
}

#[test]
fn vertices_that_are_not_finite_cost_their_triangles_only() {
    let folder = tempfile::tempdir().expect("folder");
    let text = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv nan 0 0\nf 1 2 3\nf 1 2 4\n";
    let loaded = load_mesh(&write(folder.path(), "n.obj", text.as_bytes()), &Limits::default());
    match loaded {
        Ok(loaded) => {
            assert_eq!(loaded.value.triangles.len(), 1);
            assert_eq!(loaded.warnings.len(), 1);
        }
        Err(e) => assert_eq!(e.to_string().lines().count(), 1),
    }
}

#[test]
fn text_stl_may_begin_with_blanks() {
    let folder = tempfile::tempdir().expect("folder");
    let text = "solid a\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 0\nendloop\nendfacet\nendsolid a\n";
    for before in ["", "\n", " \t"] {
        let path = write(folder.path(), "t.stl", format!("{before}{text}").as_bytes());
        let mesh = load_mesh(&path, &Limits::default()).unwrap_or_else(|e| panic!("{before:?}: {e}")).value;
        assert_eq!(mesh.positions.len(), 3);
    }
}

/// Found by damaged files: the reader of glTF panicked.
#[test]
fn gltf_pictures_without_a_type_or_an_address_are_left_out_or_read() {
    let numbers: Vec<u8> =
        [0f32, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0].iter().flat_map(|v| v.to_le_bytes()).collect();
    let mut picture = Vec::new();
    belvedere_io::png::encode(&mut picture, 1, 1, belvedere_io::png::Channels::Rgb, &[1, 2, 3], &[]).expect("memory");
    let (length, mut buffer) = (picture.len(), [numbers, picture].concat());
    buffer.resize(buffer.len().next_multiple_of(3), 0);
    let folder = tempfile::tempdir().expect("folder");
    for (image, warned) in [
        (r#"{"bufferView":1}"#, false),
        (r#"{"bufferView":1,"mimeType":null}"#, false),
        (r#"{"bufferView":1,"mimeType":"image/png"}"#, false),
        ("{}", true),
        (r#"{"uri":null,"mimeType":"image/png"}"#, true),
    ] {
        let text = format!(
            r#"{{"asset":{{"version":"2.0"}},"scenes":[{{"nodes":[0]}}],"nodes":[{{"mesh":0}}],
            "meshes":[{{"primitives":[{{"attributes":{{"POSITION":0,"TEXCOORD_0":1}},"material":0}}]}}],
            "materials":[{{"pbrMetallicRoughness":{{"baseColorTexture":{{"index":0}}}}}}],"textures":[{{"source":0}}],"images":[{image}],
            "accessors":[{{"bufferView":0,"componentType":5126,"count":3,"type":"VEC3","min":[0,0,0],"max":[1,1,0]}},
            {{"bufferView":0,"componentType":5126,"count":3,"type":"VEC2"}}],
            "bufferViews":[{{"buffer":0,"byteLength":36}},{{"buffer":0,"byteOffset":36,"byteLength":{length}}}],
            "buffers":[{{"byteLength":{},"uri":"data:application/octet-stream;base64,{}"}}]}}"#,
            buffer.len(),
            base64(&buffer)
        );
        let loaded = load_mesh(&write(folder.path(), "t.gltf", text.as_bytes()), &Limits::default()).expect(image);
        assert_eq!(loaded.value.texturing.is_none(), warned, "{image}");
        let said: Vec<_> = loaded.warnings.iter().map(|w| w.text()).collect();
        assert_eq!(said.iter().any(|text| text.contains("left out")), warned, "{image}: {said:?}");
    }
}

#[test]
fn gltf_accessors_stay_inside_their_bytes() {
    let folder = tempfile::tempdir().expect("folder");
    let numbers = [1f32, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0].map(f32::to_le_bytes).concat();
    for (count, length, whole) in [(3, 36, true), (3, 35, false), (4, 36, false), (1, 8, false), (0, 36, false)] {
        let text = format!(
            r#"{{"asset":{{"version":"2.0"}},"scene":0,"scenes":[{{"nodes":[0]}}],"nodes":[{{"mesh":0}}],
            "meshes":[{{"primitives":[{{"attributes":{{"POSITION":0}}}}]}}],
            "accessors":[{{"bufferView":0,"componentType":5126,"count":{count},"type":"VEC3","min":[0,0,0],"max":[1,1,0]}}],
            "bufferViews":[{{"buffer":0,"byteLength":{length}}}],
            "buffers":[{{"byteLength":36,"uri":"data:application/octet-stream;base64,{}"}}]}}"#,
            base64(&numbers)
        );
        let read = load_mesh(&write(folder.path(), "t.gltf", text.as_bytes()), &Limits::default());
        assert_eq!(read.is_ok(), whole, "{count} vertices in {length} bytes: {read:?}");
    }
}

#[test]
fn files_too_large_for_the_memory_are_refused_before_they_are_read() {
    let folder = tempfile::tempdir().expect("folder");
    let text = format!("v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n# {}\n", "x".repeat(1 << 20));
    let path = write(folder.path(), "t.obj", text.as_bytes());
    // A mesh takes a few times the bytes of its file.
    let read = |mib: u64| load_mesh(&path, &Limits { max_bytes: mib << 20 });
    assert!(read(10).is_ok());
    let error = read(2).expect_err("refused").to_string();
    assert!(error.contains("the mesh needs") && error.contains("allow more memory"), "{error}");
}
