//! `export`: the camera of the file sees marks where our picture shows them, by the numbers of the file alone.

use belvedere::core::{DMat3, DQuat, DVec2, DVec3, Pinhole, View};
use belvedere::export::{ExportOptions, Exported, export};
use belvedere::scene::{Color, Heightfield, Hidden, PointFeature, PointLayer, PointStyle, Scene};
use belvedere::{OpenOptions, Session};
use glam::{DMat4, DVec4};

/// A scene of the repository with three marks.
fn with_marks(name: &str, places: [[f64; 2]; 3]) -> (Session, [DVec3; 3]) {
    let path = belvedere_testkit::workspace_root().join("scenes").join(name);
    let text = std::fs::read_to_string(&path).expect("a scene").replace("&size=513", "");
    let text = text.replace("massif?seed=7", "massif?seed=7&size=65").replace("mode = \"qp\"", "mode = \"paper\"");
    let session = Session::from_text(&path, &text, &OpenOptions::default()).expect("it opens");
    let ground = |xy: DVec2| session.scene().terrain().and_then(|t| t.surface_at(xy)).unwrap_or(3.0);
    let marks = places.map(|xy| DVec2::from(xy).extend(ground(DVec2::from(xy)) + 5.0));
    let features = marks.map(|position| PointFeature { position, ..PointFeature::default() }).to_vec();
    let (color, style) = (Color::rgb(200, 30, 30), PointStyle::default());
    let layer = PointLayer { features, color, size_px: 9.0, style, hidden: Hidden::Show, lift_m: 0.0, beyond: 0.0 };
    let scene = session.scene().clone().with_layer("marks", layer);
    (Session::from_parts(scene, session.view().clone()), marks)
}

/// The scene as another program reads it: the matrix from the file to clip space, and the image.
struct Read {
    file: gltf::Gltf,
    clip_from_file: DMat4,
    image: DVec2,
}

impl Read {
    fn of(made: &Exported) -> Self {
        let file = gltf::Gltf::from_slice(&made.glb).expect("a valid file");
        let node = file.nodes().find(|node| node.camera().is_some()).expect("a camera");
        let (at, turn, _) = node.transform().decomposed();
        let turn = DMat3::from_quat(DQuat::from_array(turn.map(f64::from)));
        let at = DVec3::from(at.map(f64::from));
        let view = DMat4::from_mat3(turn.transpose()) * DMat4::from_translation(-at);
        let projection = match node.camera().expect("a camera").projection() {
            gltf::camera::Projection::Perspective(p) => {
                let focal = 1.0 / (0.5 * f64::from(p.yfov())).tan();
                let aspect = f64::from(p.aspect_ratio().expect("an aspect ratio"));
                DMat4::from_cols(
                    DVec4::new(focal / aspect, 0.0, 0.0, 0.0),
                    DVec4::new(0.0, focal, 0.0, 0.0),
                    DVec4::new(0.0, 0.0, -1.0, -1.0),
                    DVec4::ZERO,
                )
            }
            gltf::camera::Projection::Orthographic(o) => {
                DMat4::from_scale(DVec3::new(1.0 / f64::from(o.xmag()), 1.0 / f64::from(o.ymag()), -1.0))
            }
        };
        let text = &made.glb[20..20 + u32::from_le_bytes(made.glb[12..16].try_into().expect("four")) as usize];
        let json: serde_json::Value = serde_json::from_slice(text).expect("JSON");
        let extras = &json["scenes"][0]["extras"]["belvedere"];
        let image = DVec2::from([0, 1].map(|k| extras["image"][k].as_f64().expect("a size")));
        assert!(extras["origin"][2].is_f64() && extras["stages"].is_array(), "{extras}");
        Self { file, clip_from_file: projection * view, image }
    }

    /// Where the camera of the file sees a point of the file, pixels.
    fn pixel(&self, p: DVec3) -> DVec2 {
        let clip = self.clip_from_file * p.extend(1.0);
        let ndc = clip.truncate() / clip.w;
        0.5 * DVec2::new(1.0 + ndc.x, 1.0 - ndc.y) * self.image
    }

    /// Marks of the layer `marks`, file coordinates.
    fn marks(&self) -> Vec<DVec3> {
        let marks = self.file.nodes().filter(|node| node.name().is_some_and(|name| name.starts_with("marks ")));
        marks.map(|node| DVec3::from(node.transform().decomposed().0.map(f64::from))).collect()
    }

    /// Positions and triangles of a layer, from the bytes of the file.
    fn mesh(&self, layer: &str) -> (Vec<DVec3>, Vec<[u32; 3]>) {
        let mesh = self.file.meshes().find(|mesh| mesh.name() == Some(layer)).expect("a mesh");
        let primitive = mesh.primitives().next().expect("a primitive");
        let words = |accessor: &gltf::Accessor<'_>| -> Vec<[u8; 4]> {
            let from = accessor.view().expect("a view").offset() + accessor.offset();
            let bytes = &self.file.blob.as_deref().expect("bytes")[from..from + accessor.count() * accessor.size()];
            bytes.as_chunks().0.to_vec()
        };
        let places = primitive.get(&gltf::Semantic::Positions).expect("positions");
        let numbers: Vec<f64> = words(&places).into_iter().map(|w| f64::from(f32::from_le_bytes(w))).collect();
        let indices: Vec<u32> =
            words(&primitive.indices().expect("indices")).into_iter().map(u32::from_le_bytes).collect();
        let places = numbers.as_chunks::<3>().0.iter().map(|p| DVec3::from(*p)).collect();
        (places, indices.as_chunks().0.to_vec())
    }
}

/// Largest distance between our pixels and those of the file's camera, pixels.
fn marks_differ_by(name: &str, places: [[f64; 2]; 3], options: &ExportOptions) -> (f64, Exported) {
    let (session, marks) = with_marks(name, places);
    differ_by(&session, marks, options)
}

fn differ_by(session: &Session, marks: [DVec3; 3], options: &ExportOptions) -> (f64, Exported) {
    let made = export(session, options).expect("it is exported");
    let read = Read::of(&made);
    let found = read.marks();
    assert_eq!(found.len(), 3);
    let straight = Session::from_parts(session.scene().clone(), session.view().straightened());
    let ours = if options.straight {
        straight.project(&marks.map(|p| p.to_array()))
    } else {
        session.project(&marks.map(|p| p.to_array()))
    };
    let off = found.iter().zip(&ours).map(|(p, ours)| {
        let pixel = DVec2::from(ours.pixel.expect("an image"));
        assert!(ours.inside, "{pixel}");
        (read.pixel(*p) - pixel).length()
    });
    (off.fold(0.0, f64::max), made)
}

const MASSIF: [[f64; 2]; 3] = [[-800.0, -900.0], [400.0, 300.0], [1500.0, 900.0]];

#[test]
fn the_camera_sees_marks_at_the_pixels_of_the_picture() {
    for name in ["massif.toml", "massif_curved_rays.toml"] {
        // Without bends the scenes differ by their cameras alone.
        for straight in [false, true].into_iter().take(if name == "massif.toml" { 2 } else { 1 }) {
            let options = ExportOptions { straight, ..ExportOptions::default() };
            let (off, made) = marks_differ_by(name, MASSIF, &options);
            assert!(off < 0.05 && made.report.triangles > 8192, "{name}, straight {straight}: {off} px");
        }
    }
}

#[test]
fn marks_on_ground_that_makes_way_are_seen_at_the_pixels_of_the_picture() {
    let (session, marks) = with_marks("massif_terrain.toml", MASSIF);
    let (off, made) = differ_by(&session, marks, &ExportOptions::default());
    assert!(off < 0.05 && made.report.triangles > 8192, "{off} px");
    // The ground under them has moved.
    let straight = session.view().straightened();
    let moved = marks.map(|mark| {
        let [bent, straight] = [session.view(), &straight].map(|view| view.project(mark).expect("an image").pixel);
        (bent - straight).length()
    });
    assert!(moved.into_iter().fold(0.0, f64::max) > 0.3, "{moved:?}");
}

#[test]
fn single_precision_does_not_move_marks_far_from_the_origin_of_a_zone() {
    let heights =
        (0..101 * 101).map(|i| 900.0 + 300.0 * ((i % 101) as f32 * 0.13).sin() * ((i / 101) as f32 * 0.11).cos());
    let (corner, spacing) = (DVec2::new(677_123.25, 5_104_321.75), DVec2::splat(90.0));
    let ground = Heightfield::measured(corner, spacing, 101, 101, heights.collect()).expect("a grid");
    let at = |x: f64, y: f64| (corner + DVec2::new(x, y - 9000.0)).extend(1000.0);
    let marks = [at(3000.0, 4000.0), at(4500.0, 5000.0), at(6000.0, 7000.0)];
    let features = marks.map(|position| PointFeature { position, ..PointFeature::default() }).to_vec();
    let (color, style) = (Color::rgb(200, 30, 30), PointStyle::default());
    let layer = PointLayer { features, color, size_px: 9.0, style, hidden: Hidden::Show, lift_m: 0.0, beyond: 0.0 };
    let scene = Scene::default().with_terrain("ground", ground).with_layer("marks", layer);
    let camera = Pinhole::looking(at(4500.0, -6000.0) + 2000.0 * DVec3::Z, at(4500.0, 5000.0)).image([3840, 2160]);
    let session = Session::from_parts(scene, View::straight(camera.build().expect("a camera")));
    let made = export(&session, &ExportOptions::default()).expect("exported");
    let read = Read::of(&made);
    for (p, mark) in read.marks().iter().zip(&marks) {
        let pixel = session.view().project(*mark).expect("an image").pixel;
        assert!((read.pixel(*p) - pixel).length() < 0.01, "{mark}");
    }
}

#[test]
fn every_node_of_the_ground_is_seen_where_the_picture_shows_it() {
    let (session, _) = with_marks("massif_curved_rays.toml", MASSIF);
    let made = export(&session, &ExportOptions::default()).expect("exported");
    let read = Read::of(&made);
    let ground = &made.report.layers[0].layer;
    let (places, triangles) = read.mesh(ground);
    assert!(triangles.len() >= 8192 && triangles.iter().flatten().all(|v| (*v as usize) < places.len()));
    let origin = DVec3::from(made.report.origin);
    let terrain = session.scene().terrain().expect("ground");
    let mut tried = 0;
    for p in places.iter().step_by(7) {
        // Back to the scene by the file's axes, and through the whole chain.
        let displaced = origin + DVec3::new(p.x, -p.z, p.y);
        let Ok((world, _)) = session.view().undisplace(displaced) else { continue };
        let pixel = session.view().project(world).expect("an image").pixel;
        // Single precision puts nodes of the border beside the ground.
        let Some(surface) = terrain.surface_at(world.truncate()) else { continue };
        if session.view().pinhole().contains(pixel) {
            tried += 1;
            assert!((read.pixel(*p) - pixel).length() < 0.05, "{world}");
            let above = world.z - surface;
            assert!(above.abs() < 0.5, "{world} lies {above} m above the ground");
        }
    }
    assert!(tried > 30, "{tried}");
}

#[test]
fn streets_with_boxes_are_exported_and_seams_refused() {
    let places = [[0.0, 40.0], [1.0, 60.0], [-1.0, 80.0]];
    let (session, _) = with_marks("street.toml", places);
    let made = export(&session, &ExportOptions::default()).expect("exported");
    assert!(made.report.triangles > 100 && made.report.layers.iter().any(|l| l.triangles > 12), "{:?}", made.report);
    gltf::Gltf::from_slice(&made.glb).expect("valid");
    let (split, _) = with_marks("street_split.toml", places);
    let refused = export(&split, &ExportOptions::default()).expect_err("a seam").to_string();
    assert!(refused.contains("export with `straight`"), "{refused}");
    let straight = ExportOptions { straight: true, ..ExportOptions::default() };
    assert!(export(&split, &straight).is_ok());
}

#[test]
fn lines_are_closed_tubes_as_wide_as_in_the_picture() {
    let (session, _) = with_marks("massif.toml", MASSIF);
    let made = export(&session, &ExportOptions { ground_nodes: 2000, ..ExportOptions::default() }).expect("exported");
    let line = session.scene().layers.iter().find_map(|l| l.kind.lines().map(|line| (l.id.clone(), line.width_px)));
    let (id, width_px) = line.expect("a line");
    let (_, triangles) = Read::of(&made).mesh(&id);
    let mut edges = std::collections::HashMap::new();
    for t in &triangles {
        for k in 0..3 {
            *edges.entry((t[k], t[(k + 1) % 3])).or_insert(0) += 1;
        }
    }
    assert!(!edges.is_empty() && edges.iter().all(|((a, b), n)| *n == 1 && edges.get(&(*b, *a)) == Some(&1)), "closed");
    let read = Read::of(&made);
    let (places, triangles) = read.mesh(&id);
    // The widest distance between two corners of a ring, in the picture.
    let widest =
        triangles.iter().map(|t| (read.pixel(places[t[0] as usize]) - read.pixel(places[t[1] as usize])).length());
    let first = widest.take(2).fold(0.0, f64::max);
    assert!(first <= 1.1 * width_px && first > 0.2 * width_px, "{first} of {width_px}");
    let reduced = made.report.warnings.iter().any(|w| w.key() == Some("ground_nodes"));
    assert!(reduced, "{:?}", made.report.warnings);
}
