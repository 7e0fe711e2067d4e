//! Programs that are killed, and disks that are full: outputs are whole or absent, and the next run finds its way.
#![cfg(unix)]

use super::{Place, read};
use std::path::Path;
use std::process::{Command, Stdio};
use std::time::Duration;

const SCENE: &str = "format = 1
[[layer]]
id = 'street'
kind = 'boxes'
source = 'builtin:street'
[camera]
eye = [0, -300, 100]
look_at = [0, 0, 0]
image = [96, 64]
";

/// Moments at which the program is killed, milliseconds after its start.
const MOMENTS: [u64; 6] = [3, 20, 45, 80, 130, 200];

fn place() -> Place {
    let place = Place::new();
    place.write("s.toml", SCENE);
    place
}

/// Names of the files below a folder, hidden ones too.
fn names(folder: &Path) -> Vec<String> {
    let entries = std::fs::read_dir(folder).into_iter().flatten().flatten();
    let mut names: Vec<String> = entries.map(|entry| entry.file_name().to_string_lossy().into_owned()).collect();
    names.sort();
    names
}

fn killed(place: &Place, args: &[&str], after: Duration) {
    let quiet = |command: &mut Command| command.stdout(Stdio::null()).stderr(Stdio::null()).spawn();
    let mut child = quiet(&mut place.command(args)).expect("the program starts");
    std::thread::sleep(after);
    child.kill().expect("killed");
    child.wait().expect("it ends");
}

#[test]
fn a_killed_animation_goes_on_to_the_same_bytes() {
    let place = place();
    let args = |out: &'static str| ["animate", "s.toml", "-o", out, "--turntable", "--frames", "12", "--resume"];
    place.ok(&args("whole"));
    MOMENTS.iter().for_each(|ms| killed(&place, &args("broken"), Duration::from_millis(*ms)));
    // What a killed program leaves in the worst moment.
    let gone = place.command(&["schema"]).stdout(Stdio::null()).spawn().expect("started");
    let number = gone.id();
    gone.wait_with_output().expect("ended");
    std::fs::create_dir_all(place.path("broken")).expect("folder");
    place.write(&format!("broken/.frame_00003.png.belvedere-{number}-aB3.tmp"), "half");
    place.ok(&[&args("broken")[..], &["--threads", "1"]].concat());
    place.write("broken/frame_00005.png", "damaged");
    place.ok(&args("broken"));
    let (whole, broken) = (place.path("whole"), place.path("broken"));
    assert_eq!(names(&whole), names(&broken));
    names(&whole).iter().for_each(|name| assert!(read(&whole.join(name)) == read(&broken.join(name)), "{name}"));
}

#[test]
fn a_killed_picture_is_whole_or_absent() {
    let place = place();
    let args = ["render", "s.toml", "-o", "a.png", "--overwrite", "--aux", "depth"];
    place.ok(&args);
    let whole: Vec<(String, Vec<u8>)> =
        names(&place.path(".")).into_iter().map(|n| (n.clone(), read(&place.path(&n)))).collect();
    let record: serde_json::Value = serde_json::from_slice(&read(&place.path("a.png.json"))).expect("JSON");
    let hash = belvedere::io::sha256(&read(&place.path("a.png")));
    assert_eq!(record["picture_sha256"], hash.as_str(), "the record tells which picture it belongs to");
    for ms in MOMENTS {
        killed(&place, &args, Duration::from_millis(ms));
        whole.iter().for_each(|(name, bytes)| assert!(read(&place.path(name)) == *bytes, "{name} after {ms} ms"));
    }
    place.ok(&args);
    assert_eq!(names(&place.path(".")), whole.iter().map(|(name, _)| name.clone()).collect::<Vec<_>>());
}

/// Ground that does not pack into one block, and a way over it.
fn write_ground(place: &Place) {
    let heights: String = (0..1600).map(|i| format!("{} ", 5.0 + f64::from(i * 7919 % 97) / 30.0)).collect();
    place.write(
        "dem.asc",
        &format!("ncols 40\nnrows 40\nxllcorner 500000\nyllcorner 5000000\ncellsize 10\n{}", heights),
    );
    place.write("way.geojson", r#"{"type":"LineString","crs":{"type":"name","properties":{"name":"EPSG:32632"}},"coordinates":[[500050,5000200,6],[500350,5000210,6]]}"#);
}

/// Two houses and a road around them.
fn write_town(place: &Place) {
    let feature = |properties: &str, kind: &str, coordinates: &str| {
        format!(
            r#"{{"type":"FeatureCollection","features":[{{"type":"Feature","properties":{properties},"geometry":{{"type":"{kind}","coordinates":{coordinates}}}}}]}}"#
        )
    };
    let houses = "[[[[8.01,46.01],[8.0103,46.01],[8.0103,46.0103],[8.01,46.01]]],[[[8.011,46.01],[8.0113,46.01],[8.0113,46.0103],[8.011,46.01]]]]";
    let road = "[[8.009,46.009],[8.013,46.009],[8.013,46.0115],[8.009,46.0115],[8.009,46.009]]";
    place.write("houses.geojson", &feature(r#"{"building":"yes","height":9}"#, "MultiPolygon", houses));
    place.write("roads.geojson", &feature(r#"{"highway":"secondary"}"#, "LineString", road));
}

#[test]
fn a_killed_reveal_leaves_what_was_there_or_all_of_it() {
    let place = Place::new();
    write_ground(&place);
    let args = [
        "reveal",
        "dem.asc",
        "way.geojson",
        "--source-crs",
        "EPSG:32632",
        "--eye",
        "500200,5000020,+5",
        "--look",
        "500200,5000300",
        "-o",
        "a.png",
        "--scene",
        "b.toml",
        "--report",
        "r.json",
        "--size",
        "64x48",
    ];
    let all = ["a.pair.png", "a.png", "a.png.json", "b.toml", "dem.asc", "r.json", "way.geojson"];
    for ms in MOMENTS {
        killed(&place, &args, Duration::from_millis(ms));
        let there: Vec<String> = names(&place.path(".")).into_iter().filter(|name| !name.starts_with('.')).collect();
        // Names appear one by one, the files behind them are whole.
        let parts = |name: &str| read(&place.path(name));
        for name in &there {
            assert!(all.contains(&name.as_str()), "{name} after {ms} ms");
            assert!(!name.ends_with(".png") || parts(name).ends_with(b"IEND\xaeB`\x82"), "{name} after {ms} ms");
            assert!(
                !name.ends_with(".json") || serde_json::from_slice::<serde_json::Value>(&parts(name)).is_ok(),
                "{name}"
            );
        }
    }
    place.ok(&[&args[..], &["--overwrite", "--quiet"]].concat());
    assert_eq!(names(&place.path(".")), all);
}

#[test]
fn a_full_disk_leaves_nothing_and_harms_nothing() {
    let place = place();
    place.write("before.png", "as it was");
    place.write("before.png.json", "as it was");
    write_ground(&place);
    write_town(&place);
    let app = place.path("app");
    std::fs::create_dir(&app).expect("folder");
    ["index.html", "page.css", "page.js", "kept.js", "mirror.js", "LICENCES.txt", "belvedere.js", "belvedere_bg.wasm"]
        .iter()
        .for_each(|name| std::fs::write(app.join(name), [7; 3000]).expect("written"));
    let before = names(&place.path("."));
    let program = env!("CARGO_BIN_EXE_belvedere");
    for args in [
        "render s.toml -o a.png",
        "render s.toml -o before.png --overwrite",
        "render s.toml -o a.png --aux depth,world",
        "render s.toml -o a.png --aux depth --aux-format exr",
        "animate s.toml -o film --turntable --frames 2",
        "reveal dem.asc way.geojson --source-crs EPSG:32632 --eye 500200,5000020,+5 --look 500200,5000300 -o a.png --scene b.toml",
        "disocclude dem.asc way.geojson --source-crs EPSG:32632 --eye 500200,5000020,+5 --look 500200,5000300 -o a.tif",
        "schema -o a.json",
        "demo -o demo",
        "generalise houses.geojson roads.geojson -o city",
        "pack s.toml -o page --app app",
        "preset new -o own.toml --from demo",
        "preset plot demo -o a.png",
        "figures curved -o figures --scale 0.1",
    ] {
        // Files end after one block: what the system says of a full disk differs by its number alone.
        let limited = format!("ulimit -f 1; trap '' XFSZ; exec '{program}' {args} --no-remember --quiet");
        let out = Command::new("sh").current_dir(place.path(".")).args(["-c", &limited]).output().expect("it runs");
        let said = String::from_utf8_lossy(&out.stderr).into_owned();
        assert_eq!(out.status.code(), Some(2), "{args}: {said}");
        assert!(said.lines().count() == 1 && said.starts_with("belvedere: ") && said.len() < 500, "{args}: {said}");
        ["film", "demo", "city", "page", "figures"].iter().for_each(|folder| {
            assert!(
                names(&place.path(folder)).iter().all(|name| name.ends_with(".toml")),
                "{args}: {:?}",
                names(&place.path(folder))
            );
            let _ = std::fs::remove_dir_all(place.path(folder));
        });
        assert_eq!(names(&place.path(".")), before, "{args}");
        assert_eq!(read(&place.path("before.png")), b"as it was");
    }
}

#[test]
fn one_path_is_no_place_for_two_outputs() {
    let place = place();
    std::fs::create_dir(place.path("sub")).expect("folder");
    for args in [
        &["render", "s.toml", "-o", "a.png", "--timings", "a.png.json"][..],
        &["render", "s.toml", "-o", "a.png", "--timings", "sub/../a.png"],
        &["measure", "s.toml", "-o", "m.json", "--timings", "./m.json"],
    ] {
        assert!(place.fails(args).contains("is named for two outputs"), "{args:?}");
    }
}
