//! What is written says nothing about the machine: no folder above the scene, no home; and it is the same on every machine.

use super::trusted::hills;
use super::{Place, read};
use serde_json::json;
use std::path::{Path, PathBuf};

/// A name that nobody writes by chance.
const TELLING: &str = "ada-lovelace-3f9c";

/// Data of all kinds in a folder with a telling name, and a folder for what is written.
fn place() -> Place {
    let place = Place::new();
    [TELLING, "out"].iter().for_each(|name| std::fs::create_dir(place.path(name)).expect("folder"));
    let put = |name: &str, text: &str| drop(place.write(&format!("{TELLING}/{name}"), text));
    put("dem.asc", &hills().replacen("1000", "-9999", 1));
    put("way.geojson", "{\"type\":\"LineString\",\"coordinates\":[[8.012,46.014],[8.024,46.028],[8.034,46.036]]}");
    // Materials that are not there, an odd face: the mesh is read with warnings.
    put(
        "a.obj",
        "mtllib none.mtl\no a\nv 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\no b\nv 0 0 -1\nv 1 0 -1\nv 0 1 -1\nf 4 5 6\nf 1 1 2\n",
    );
    put("colours.txt", "0 0 0 0\n2000 255 255 255\n");
    let ring = |x: f64| json!([[[x, 46.01], [x + 0.0003, 46.01], [x + 0.0003, 46.0103], [x, 46.0103], [x, 46.01]]]);
    let house = |x: f64| {
        json!({ "type": "Feature", "properties": { "building": "yes", "height": 9 },
        "geometry": { "type": "Polygon", "coordinates": ring(x) } })
    };
    let houses: Vec<_> = (0..4).map(|i| house(8.01 + 0.0005 * f64::from(i))).collect();
    put("houses.geojson", &json!({ "type": "FeatureCollection", "features": houses }).to_string());
    let road = json!({ "type": "Feature", "properties": { "highway": "secondary" },
        "geometry": { "type": "LineString", "coordinates": [[8.009, 46.009], [8.013, 46.009], [8.013, 46.0115], [8.009, 46.0115], [8.009, 46.009]] } });
    put("roads.geojson", &json!({ "type": "FeatureCollection", "features": [road] }).to_string());
    place
}

fn all_below(folder: &Path) -> Vec<PathBuf> {
    let entries = std::fs::read_dir(folder).expect("folder").flatten().map(|entry| entry.path());
    entries.flat_map(|path| if path.is_dir() { all_below(&path) } else { vec![path] }).collect()
}

/// Texts of a PNG stand uncompressed, or in zTXt and iTXt chunks, which are not compressed here.
fn holds(bytes: &[u8], text: &str) -> bool {
    bytes.windows(text.len()).any(|part| part == text.as_bytes())
}

#[test]
fn nothing_that_is_written_tells_the_folder_of_the_data() {
    let place = place();
    let data = |name: &str| place.path(&format!("{TELLING}/{name}")).to_str().expect("UTF-8").to_owned();
    let [dem, way, mesh] = ["dem.asc", "way.geojson", "a.obj"].map(data);
    let view = ["--eye", "8.022,46.002,1500", "--look", "8.024,46.03"];
    let small = ["--size", "64x48"];
    let run = |args: &[&str]| {
        let out = place.run(&[args, &["--quiet"]].concat());
        assert!(out.status.success(), "{args:?}: {}", String::from_utf8_lossy(&out.stderr));
    };
    let reveal = ["reveal", &dem, &way];
    let palette = data("colours.txt");
    let files = ["--before", "out/b.png", "--report", "out/r.json", "--scene", "out/s.toml", "--palette", &palette];
    run(&[&reveal[..], &view, &small, &files, &["-o", "out/a.png", "--timings", "out/t.json"]].concat());
    run(&[
        "reveal",
        &mesh,
        "--see",
        "b",
        "-o",
        "out/m.png",
        "--report",
        "out/m.json",
        "--scene",
        "out/m.toml",
        "--size",
        "64x48",
    ]);
    let others = ["--displacement", "out/d.tif", "--features-out", "out/f.geojson", "--picture", "out/p.png"];
    run(&[&["disocclude", &dem, &way, "-o", "out/e.tif", "--report", "out/e.json"], &view[..], &others].concat());
    run(&[&["render", "out/s.toml", "-o", "out/again.png", "--aux", "depth,world", "--aux-format", "exr"], &small[..]]
        .concat());
    run(&["render", "out/m.toml", "-o", "out/n.png", "--size", "64x48"]);
    run(&["animate", "out/s.toml", "-o", "out/film", "--turntable", "--frames", "2", "--size", "32x24"]);
    run(&["measure", "out/s.toml", "-o", "out/measure.json"]);
    run(&["show", "out/s.toml", "-o", "out/shown.toml"]);
    run(&["generalise", &data("houses.geojson"), &data("roads.geojson"), "-o", "out/city"]);
    // A scene beside its data that names them absolutely, as older versions wrote it.
    let absolute = place.write(
        &format!("{TELLING}/abs.toml"),
        &format!("format = 1\n[camera]\neye = [0, -4, 1]\nlook_at = [0, 0, 0]\nimage = [32, 24]\n[[layer]]\nid = 'a'\nkind = 'mesh'\nsource = '{mesh}'\n"),
    );
    let root = data(".");
    run(&["render", absolute.to_str().expect("UTF-8"), "-o", "out/abs.png", "--allow-root", &root]);
    let app = place.path("app");
    std::fs::create_dir(&app).expect("folder");
    ["index.html", "page.css", "page.js", "kept.js", "mirror.js", "LICENCES.txt", "belvedere.js", "belvedere_bg.wasm"]
        .iter()
        .for_each(|n| std::fs::write(app.join(n), "x").expect("file"));
    run(&["pack", "out/s.toml", "-o", "out/page", "--app", "app"]);
    let written = all_below(&place.path("out"));
    assert!(written.len() > 30, "{written:?}");
    let temporary = place.0.path().canonicalize().expect("folder");
    let (temporary, home) = (temporary.to_str().expect("UTF-8"), std::env::var("HOME").unwrap_or_default());
    let mut scenes = 0;
    for path in written {
        let bytes = read(&path);
        assert!(!holds(&bytes, temporary), "{} names {temporary}", path.display());
        assert!(home.len() < 4 || !holds(&bytes, &home), "{} names {home}", path.display());
        // A scene must say where its data are, from its own folder.
        if path.extension().is_some_and(|e| e == "toml") && !path.starts_with(place.path("out/page")) {
            scenes += 1;
            continue;
        }
        assert!(!holds(&bytes, TELLING), "{} names {TELLING}", path.display());
    }
    assert_eq!(scenes, 3);
    let record: serde_json::Value = serde_json::from_slice(&read(&place.path("out/a.png.json"))).expect("JSON");
    assert_eq!(record["inputs"][0]["path"], "dem.asc");
    assert_eq!(record["inputs"][0]["sha256"].as_str().map(str::len), Some(64));
    assert!(holds(&read(&place.path("out/a.png")), "\"path\":\"dem.asc\""), "the picture says what it was made from");
}

#[test]
fn what_is_printed_of_data_in_the_current_folder_tells_no_folder() {
    let place = place();
    let plain = "ncols 3\nnrows 3\nxllcorner 8.01\nyllcorner 46.01\ncellsize 0.01\n1000 1010 1020\n1030 1040 1050\n1060 1070 1080\n";
    place.write("plain.asc", plain);
    let root = place.0.path().canonicalize().expect("folder");
    let root = root.to_str().expect("UTF-8");
    let out = place.ok(&["show", "plain.asc"]);
    assert!(out.contains("source = \"plain.asc\"") && !out.contains(root), "{out}");
    let below = format!("{TELLING}/dem.asc");
    assert!(place.ok(&["show", &below]).contains(&format!("source = \"{below}\"")));
    for args in [
        &["render", "plain.asc", "-o", "p.png", "--size", "32x24"][..],
        &["show", "plain.asc"],
        &["check", "out.toml"],
        &["info", "plain.asc"],
    ] {
        if args[0] == "check" {
            place.ok(&["show", "plain.asc", "-o", "out.toml"]);
        }
        let said = place.run(args);
        assert!(said.status.success(), "{args:?}");
        let said = String::from_utf8_lossy(&said.stderr).into_owned() + &String::from_utf8_lossy(&said.stdout);
        assert!(!said.contains(root), "{args:?}: {said}");
        assert!(args[0] == "info" || said.contains("plain.asc"), "{args:?}: {said}");
    }
}

#[test]
fn the_same_scene_and_data_in_two_folders_give_the_same_bytes() {
    let [one, two] = ["here", "somewhere/quite/else"].map(|folder| {
        let place = Place::new();
        let folder = place.path(folder);
        ["scenes", "data"].iter().for_each(|name| std::fs::create_dir_all(folder.join(name)).expect("folder"));
        std::fs::write(folder.join("data/dem.asc"), hills()).expect("file");
        let line = "{\"type\":\"LineString\",\"coordinates\":[[8.012,46.014],[8.024,46.028],[8.034,46.036]]}";
        std::fs::write(folder.join("data/way.geojson"), line).expect("file");
        let path = |name: &str| folder.join(name).to_str().expect("UTF-8").to_owned();
        let [dem, way, scene, first, second, film] =
            ["data/dem.asc", "data/way.geojson", "scenes/s.toml", "a.png", "b.png", "film"].map(path);
        let view = ["--eye", "8.022,46.002,1500", "--look", "8.024,46.03", "--size", "64x48", "--technique", "terrain"];
        place.ok(&[&["reveal", &dem, &way, "-o", &first, "--scene", &scene, "--quiet"], &view[..]].concat());
        place.ok(&["render", &scene, "-o", &second, "--size", "64x48", "--threads", "1"]);
        place.ok(&["animate", &scene, "-o", &film, "--turntable", "--frames", "2", "--size", "32x24"]);
        let names = [
            "a.png",
            "a.png.json",
            "a.pair.png",
            "b.png",
            "b.png.json",
            "scenes/s.toml",
            "film/animation.json",
            "film/frame_00001.png",
        ];
        names.map(|name| (name, read(&folder.join(name))))
    });
    for ((name, a), (_, b)) in one.into_iter().zip(two) {
        assert!(a == b, "{name} differs: {} and {}", String::from_utf8_lossy(&a), String::from_utf8_lossy(&b));
    }
}

/// Ready scenes, smaller than they are.
const SCENES: [&str; 17] = [
    "massif",
    "massif_curved_rays",
    "massif_plan_oblique",
    "massif_panorama",
    "massif_moves",
    "massif_strip",
    "tube_straight",
    "massif_circle",
    "massif_terrain",
    "street",
    "street_split",
    "street_sections",
    "street_probe",
    "church",
    "engine_curved_rays",
    "town",
    "town_rigid",
];

/// A ready scene over little ground, with a mesh from a file.
fn small_scene(name: &str) -> String {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join(format!("../../scenes/{name}.toml"));
    let mut text = std::fs::read_to_string(path).expect("scene");
    for size in ["&size=513", "&size=1200"] {
        text = text.replace(size, "");
    }
    text = text.replace("massif?seed=7", "massif?seed=7&size=65").replace("town?seed=7", "town?seed=7&size=500");
    text + "\n[[layer]]\nid = \"own mesh\"\nkind = \"mesh\"\nsource = \"data/a.obj\"\n"
}

#[test]
fn ready_scenes_in_two_folders_give_the_same_bytes() {
    let places =
        [("here", "1"), ("somewhere/quite/else", "3")].map(|(folder, threads)| (Place::new(), folder, threads));
    let draw = |(place, folder, threads): &(Place, &str, &str)| -> Vec<(String, Vec<u8>)> {
        std::fs::create_dir_all(place.path(folder).join("data")).expect("folder");
        place.write(&format!("{folder}/data/a.obj"), "o a\nv 0 0 900\nv 300 0 900\nv 0 300 900\nf 1 2 3\n");
        let drawn = SCENES.iter().flat_map(|name| {
            let at = |ending: &str| format!("{folder}/{name}.{ending}");
            place.write(&at("toml"), &small_scene(name));
            place.ok(&["render", &at("toml"), "-o", &at("png"), "--size", "48x32", "-q", "--threads", threads]);
            ["png", "png.json"].map(|ending| (format!("{name}.{ending}"), read(&place.path(&at(ending)))))
        });
        drawn.collect()
    };
    let [one, two] = &places;
    let (one, two) = std::thread::scope(|threads| {
        let one = threads.spawn(|| draw(one));
        let two = draw(two);
        (one.join().expect("drawn"), two)
    });
    assert_eq!([one.len(), two.len()], [2 * SCENES.len(); 2]);
    for ((name, a), (_, b)) in one.into_iter().zip(two) {
        assert!(a == b, "{name} differs");
        assert!(!name.ends_with("json") || holds(&a, "data/a.obj"), "{name}");
    }
}
