//! Pictures of targets and of data alone: all that is drawn lies inside, and cameras that are given stay.

use belvedere::core::{DVec2, DVec3};
use belvedere::places::Place;
use belvedere::request::{Air, Look, Reveal};
use belvedere::scene::LayerKind;
use belvedere::scene_file::camera::{cut_to_frame, fit, frame_factor, navigation, set_camera};
use belvedere::scene_file::{CameraDoc, SourceDocument, parse};
use belvedere::verbs::open_files::scene_of_data;
use belvedere::verbs::reveal::{Found, RefitRecord, RevealAnswer, Setting, reveal};
use belvedere::{OpenOptions, Session};
use belvedere_testkit::Random;
use std::path::Path;

fn request(file: &str, see: &str, image: [u32; 2]) -> Reveal {
    let air = Air { sky: Some("white".into()), ..Air::default() };
    Reveal {
        data: file.into(),
        see: Some(see.into()),
        transfer: file.contains("engine").then(|| "solid".into()),
        size: Some(image),
        samples: Some(1),
        appearance: Look { air, no_mark: true, ..Look::default() },
        ..Reveal::default()
    }
}

fn revealed(asked: &Reveal) -> RevealAnswer {
    reveal(asked, &Setting::default()).expect("revealed")
}

fn refit(found: &RevealAnswer) -> Option<RefitRecord> {
    let Found::Target { refit, .. } = &found.found else { panic!("no target") };
    *refit
}

/// Shares of the picture beside what is drawn: left, above, right, below.
fn margins(found: &RevealAnswer) -> [f64; 4] {
    let frame = &found.picture.frame;
    let is_drawn = |x: usize, y: usize| frame.color[y * frame.width + x].iter().any(|c| *c < 235);
    let column = |x: &usize| (0..frame.height).any(|y| is_drawn(*x, y));
    let row = |y: &usize| (0..frame.width).any(|x| is_drawn(x, *y));
    let ends = |mut all: std::ops::Range<usize>, is: &dyn Fn(&usize) -> bool| {
        let count = all.len() as f64;
        let first = all.clone().find(is).expect("something is drawn");
        [first as f64 / count, 1.0 - (all.rfind(is).expect("something is drawn") + 1) as f64 / count]
    };
    let [[left, right], [above, below]] = [ends(0..frame.width, &column), ends(0..frame.height, &row)];
    [left, above, right, below]
}

#[test]
fn bent_and_straight_models_lie_inside_with_even_margins_in_tall_and_wide_pictures() {
    for (file, see, image) in [
        ("builtin:engine", "80,92,62", [192, 108]),
        ("builtin:engine", "80,92,62", [90, 180]),
        ("builtin:dna?pairs=14", "resi 5", [108, 192]),
    ] {
        let found = revealed(&request(file, see, image));
        let beside = margins(&found);
        let [left, above, right, below] = beside;
        assert!(beside.iter().all(|m| *m > 0.0), "{file} {image:?}: {beside:?}");
        assert!((left - right).abs() < 0.035 && (above - below).abs() < 0.035, "{file} {image:?}: {beside:?}");
        assert!(beside.iter().any(|m| *m < 0.065), "{file} {image:?} fills its picture: {beside:?}");
        let refit = refit(&found).expect("framed again");
        assert_eq!(refit.outside[1], 0.0, "{refit:?}");
        if image == [192, 108] {
            assert!(found.shares.visible_bent == 1.0 && found.shares.visible_straight == 0.0, "{:?}", found.shares);
            assert!(
                refit.outside[0] > 0.05 && refit.turned_deg > 1.0,
                "the bend moved much out of the frame: {refit:?}"
            );
        }
    }
}

#[test]
fn a_camera_that_is_given_stays_and_a_field_of_view_that_is_given_too() {
    let [eye, look] = [([80.0, -300.0], 60.0), ([80.0, 90.0], 60.0)].map(|(at, z)| Some(Place::of(at, Some(z))));
    let free = request("builtin:engine", "80,92,62", [96, 54]);
    let given = revealed(&Reveal { eye, look, ..free.clone() });
    assert_eq!(refit(&given), None);
    let eye = given.session.view().pinhole().eye;
    assert!(eye.distance(DVec3::new(80.0, -300.0, 60.0)) < 1e-9, "{eye}");
    let ahead = given.session.view().pinhole().forward;
    assert!(ahead.y > 1.0 - 1e-9, "{ahead}");
    let narrow = revealed(&Reveal { fov: Some(36.0), ..free });
    let [before, after] = refit(&narrow).expect("turned").fov_y_deg;
    assert!((before - 36.0).abs() < 1e-9 && (after - 36.0).abs() < 1e-9, "{before} {after}");
}

/// How far outside its picture, in shares of half of it, the farthest point lies of those that must be in it, seen alone from a file.
fn farthest(file: &Path, wanted: &dyn Fn(&Session) -> Vec<DVec3>) -> f64 {
    let source = scene_of_data(&[file.to_path_buf()]).expect("read").expect("a scene");
    let session = Session::from_document(source, &OpenOptions::default()).expect("opened");
    let pinhole = session.view().pinhole();
    let half = pinhole.center_px();
    let off = |p: DVec3| match pinhole.project(p) {
        Ok((pixel, depth)) if depth > pinhole.near => ((pixel - half) / half).abs().max_element(),
        _ => f64::INFINITY,
    };
    wanted(&session).into_iter().map(off).fold(0.0, f64::max)
}

#[test]
fn every_visible_voxel_of_a_small_or_thickly_sliced_volume_is_in_its_picture() {
    let folder = tempfile::tempdir().unwrap();
    let mut random = Random::new(711);
    for k in 0..24 {
        let dims: [usize; 3] = std::array::from_fn(|_| 3 + random.below(if k % 2 == 0 { 14 } else { 44 }));
        let low: [usize; 3] = dims.map(|n| random.below(n / 2));
        let high: [usize; 3] = std::array::from_fn(|a| low[a] + 2 + random.below(dims[a] - low[a] - 1));
        let spacing: [f64; 3] = std::array::from_fn(|_| 10f64.powf(random.range(-0.5, 0.8)));
        // Denser towards the middle of the body, so that the most opaque voxels lie far from its surface.
        let value = |i: usize| {
            let at = [i % dims[0], i / dims[0] % dims[1], i / dims[0] / dims[1]];
            let beside = (0..3).map(|a| at[a].abs_diff((low[a] + high[a]) / 2)).max().unwrap_or(0);
            if (0..3).all(|a| (low[a]..high[a]).contains(&at[a])) { 250 - 4 * beside.min(25) } else { 0 }
        };
        let values: Vec<String> = (0..dims.iter().product()).map(|i| value(i).to_string()).collect();
        let header = |key: &str, of: [String; 3]| format!("{key}: {}\n", of.join(" "));
        let text = "NRRD0004\ntype: uchar\ndimension: 3\n".to_owned()
            + &header("sizes", dims.map(|n| n.to_string()))
            + &header("spacings", spacing.map(|s| s.to_string()))
            + "encoding: ascii\n\n"
            + &values.join(" ");
        let file = folder.path().join(format!("body{k}.nrrd"));
        std::fs::write(&file, text).unwrap();
        let off = farthest(&file, &|session| {
            let LayerKind::Volume(layer) = &session.scene().layers[0].kind else { panic!("a volume") };
            let all = (0..dims.iter().product())
                .filter(|&i: &usize| layer.transfer.opacity(f64::from(layer.volume.values().at(i))) > 0.0);
            let place = |i: usize| [i % dims[0], i / dims[0] % dims[1], i / dims[0] / dims[1]].map(|n| n as f64);
            all.map(|i| layer.volume.scene_from_lattice(DVec3::from_array(place(i)))).collect()
        });
        assert!(off < 1.0, "{dims:?}, {spacing:?}, {low:?} to {high:?}: {off}");
        assert!(off > 0.8, "{dims:?}, {spacing:?}, {low:?} to {high:?} fills its picture: {off}");
    }
}

#[test]
fn a_single_far_triangle_of_a_large_mesh_is_in_its_picture() {
    let folder = tempfile::tempdir().unwrap();
    // A sheet of more triangles than are looked at one by one, and a spike beside it.
    let n = 180;
    let mut text: String = (0..n * n).map(|i| format!("v {} {} 0\n", i % n, i / n)).collect();
    for i in (0..(n - 1) * (n - 1)).map(|i| i / (n - 1) * n + i % (n - 1) + 1) {
        text += &format!("f {} {} {}\nf {} {} {}\n", i, i + 1, i + n + 1, i, i + n + 1, i + n);
        if i == n * n / 2 {
            text += &format!("v 0 0 0\nv 1 0 0\nv 40 60 900\nf {} {} {}\n", n * n + 1, n * n + 2, n * n + 3);
        }
    }
    let file = folder.path().join("sheet.obj");
    std::fs::write(&file, text).unwrap();
    let off = farthest(&file, &|session| {
        let LayerKind::Mesh(layer) = &session.scene().layers[0].kind else { panic!("a mesh") };
        (0..layer.mesh.vertex_count() as u32).map(|v| layer.mesh.vertex(v)).collect()
    });
    assert!((0.8..1.0).contains(&off), "{off}");
}

#[test]
fn a_picture_of_any_shape_holds_the_frame_and_gives_the_camera_back_unchanged() {
    let scene = |camera: &str| {
        let text = format!(
            "format = 1\n[camera]\neye = [0, -900, 4000]\nlook_at = [0, 0, 300]\nimage = [320, 180]\n{camera}\n"
        );
        parse(Path::new("s.toml"), &text).expect("scene").document
    };
    for camera in ["fov_y_deg = 30.0", "projection = 'orthographic'\northo_height_m = 900.0", "fov_y_deg = 120.0"] {
        let document = scene(camera);
        for image in [[390, 844], [640, 640], [320, 180], [1920, 500]] {
            let mut shown = document.clone();
            fit(&mut shown, image);
            let session = Session::from_document(SourceDocument::new(shown), &OpenOptions::default());
            let session = session.expect("session");
            let factor = frame_factor(&document, image);
            let on_screen =
                navigation(&document.camera, &document.camera, session.view(), session.scene(), (image, factor));
            assert_eq!(on_screen.pinhole.projection, session.view().pinhole().projection, "{camera} {image:?}");
            let mut back = document.clone();
            set_camera(&mut back, &on_screen);
            assert_eq!(back.camera.fov_y_deg, document.camera.fov_y_deg, "{image:?}");
            let height = |camera: &CameraDoc| camera.ortho_height_m.unwrap_or(0.0);
            assert!((height(&back.camera) - height(&document.camera)).abs() < 1e-9);
            // A corner of the frame lies in the picture, unless its field of view is at its limit.
            let framed = cut_to_frame(session.view(), &document, image);
            assert_eq!(framed.pinhole().image, [320, 180], "{camera} {image:?}");
            let corner = framed.ray(DVec2::ZERO).at(1000.0).expect("a point").point;
            let at = session.view().project(corner).expect("seen").pixel;
            let limit = factor * 180.0 / 320.0 < f64::from(image[1]) / f64::from(image[0]) - 1e-9;
            assert!(limit || (at.x > -1e-6 && at.y > -1e-6), "{camera} {image:?}: {at}");
        }
    }
}

#[test]
fn another_shape_of_paper_widens_and_cuts_nothing_off() {
    let text =
        "format = 1\n[camera]\neye = [0, -900, 4000]\nlook_at = [0, 0, 300]\nimage = [320, 180]\nfov_y_deg = 45.0\n";
    let open = |image: Option<[u32; 2]>| {
        let source = parse(Path::new("s.toml"), text).expect("scene");
        Session::from_document(source, &OpenOptions { image, ..OpenOptions::default() }).expect("session")
    };
    let own = open(None);
    for image in [[640, 360], [210, 297], [100, 100], [900, 300]] {
        let other = open(Some(image));
        for session in [other, own.resized(image, &belvedere::scene::Progress::silent()).expect("resized")] {
            for corner in [DVec2::ZERO, DVec2::new(320.0, 0.0), DVec2::new(0.0, 180.0), DVec2::new(320.0, 180.0)] {
                let p = own.view().ray(corner).at(1000.0).expect("a point").point;
                let off = session.view().project(p).expect("seen").pixel
                    / DVec2::new(f64::from(image[0]), f64::from(image[1]));
                assert!(off.min_element() > -1e-9 && off.max_element() < 1.0 + 1e-9, "{image:?}: {off}");
            }
            assert_eq!(session.view().pinhole().eye, own.view().pinhole().eye);
        }
    }
}

#[test]
fn a_town_is_framed_by_its_buildings_and_not_by_its_water() {
    let folder = tempfile::tempdir().unwrap();
    let (mut vertices, mut objects) = (Vec::new(), Vec::new());
    for k in 0..4 {
        let [x, y, high] = [4000 + 25 * k, 300 + 11 * (k % 2), 8 + 3 * k];
        let corners = [[0, 0], [12, 0], [12, 9], [0, 9]];
        let first = vertices.len();
        vertices.extend([0, high].iter().flat_map(|z| corners.map(|[dx, dy]| format!("[{},{},{z}]", x + dx, y + dy))));
        let faces = [[3, 2, 1, 0], [4, 5, 6, 7], [0, 1, 5, 4], [1, 2, 6, 5], [2, 3, 7, 6], [3, 0, 4, 7]];
        let shell = faces.map(|f| format!("[[{}]]", f.map(|v| (first + v).to_string()).join(","))).join(",");
        objects.push(format!(
            r#""b{k}":{{"type":"Building","geometry":[{{"type":"Solid","lod":"1","boundaries":[[{shell}]]}}]}}"#
        ));
    }
    let first = vertices.len();
    vertices.extend(["[0,500,0]", "[9000,500,0]", "[9000,540,0]", "[0,540,0]"].map(String::from));
    let ring: Vec<String> = (first..first + 4).map(|v| v.to_string()).collect();
    let shape = format!(r#"{{"type":"MultiSurface","lod":"1","boundaries":[[[{}]]]}}"#, ring.join(","));
    objects.push(format!(r#""canal":{{"type":"WaterBody","geometry":[{shape}]}}"#));
    let text = format!(
        r#"{{"type":"CityJSON","version":"2.0","transform":{{"scale":[1,1,1],"translate":[0,0,0]}},"CityObjects":{{{}}},"vertices":[{}]}}"#,
        objects.join(","),
        vertices.join(",")
    );
    let file = folder.path().join("town.city.json");
    std::fs::write(&file, text).unwrap();
    let of = |water: bool| {
        farthest(&file, &move |session| {
            let LayerKind::Mesh(layer) = &session.scene().layers[0].kind else { panic!("a mesh") };
            let mesh = &layer.mesh;
            let chosen = (0..mesh.triangles().len()).filter(|t| (mesh.part(*t) == Some(0)) == water);
            chosen.flat_map(|t| mesh.corners(t)).collect()
        })
    };
    let buildings = of(false);
    assert!((0.8..1.0).contains(&buildings), "buildings fill their picture: {buildings}");
    assert!(of(true) > 3.0, "the canal goes on beyond it");
}

/// A town of 400 houses, alone or with one farm 20 km away.
#[test]
fn a_town_is_framed_without_the_farms_far_from_it() {
    let folder = tempfile::tempdir().unwrap();
    let town = |farms: usize| {
        let house = |k: usize| {
            let [x, y] = match k.checked_sub(400) {
                Some(farm) => [520_000.0 + 5_000.0 * farm as f64, 5_020_000.0],
                None => [500_000.0 + 30.0 * (k % 20) as f64, 5_000_000.0 + 30.0 * (k / 20) as f64],
            };
            let ring = [[x, y], [x + 12.0, y], [x + 12.0, y + 12.0], [x, y + 12.0], [x, y]];
            serde_json::json!({ "type": "Feature", "properties": { "building": "yes", "height": 8 },
                "geometry": { "type": "Polygon", "coordinates": [ring] } })
        };
        let features: Vec<_> = (0..400 + farms).map(house).collect();
        let crs = serde_json::json!({ "type": "name", "properties": { "name": "urn:ogc:def:crs:EPSG::32632" } });
        let text = serde_json::json!({ "type": "FeatureCollection", "crs": crs, "features": features }).to_string();
        let file = folder.path().join(format!("town{farms}.geojson"));
        std::fs::write(&file, text).unwrap();
        let corners = farthest(&file, &|session: &Session| {
            let LayerKind::Mesh(layer) = &session.scene().layers[0].kind else { panic!("a mesh") };
            let houses =
                (0..layer.mesh.triangles().len()).filter(|t| (1..=400).contains(&layer.mesh.part(*t).unwrap_or(0)));
            houses.flat_map(|t| layer.mesh.corners(t)).collect()
        });
        let source = scene_of_data(&[file]).unwrap().unwrap();
        let session = Session::from_document(source, &OpenOptions::default()).unwrap();
        (corners, session.warnings().iter().map(ToString::to_string).collect::<String>())
    };
    let (alone, said) = town(0);
    assert!((0.8..1.0).contains(&alone) && said.contains("all of it is shown"), "{alone} {said}");
    let (with_farms, said) = town(2);
    assert!((0.8..1.0).contains(&with_farms), "the town fills its picture: {with_farms}");
    assert!(said.contains("without 2 buildings far apart"), "{said}");
}
