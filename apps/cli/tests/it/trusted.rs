//! Files outside the folder of a scene: whose consent they have, for how long, and for whom.

use super::{BARE, Place, read};
use std::path::Path;

const MESH: &str = "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n";

/// A range of hills and a way over it in `data`, and folders for scenes.
fn place() -> Place {
    let place = Place::new();
    ["data", "out", "elsewhere"].iter().for_each(|name| std::fs::create_dir(place.path(name)).expect("folder"));
    place.write("data/dem.asc", &hills());
    let line = "{\"type\":\"LineString\",\"coordinates\":[[8.012,46.014],[8.024,46.028],[8.034,46.036]]}";
    place.write("data/way.geojson", line);
    place.write("data/a.obj", MESH);
    place
}

pub(super) fn hills() -> String {
    let mut text = "ncols 48\nnrows 48\nxllcorner 8.0\nyllcorner 46.0\ncellsize 0.001\nNODATA_value -9999\n".to_owned();
    for row in 0..48 {
        let height = |col: i32| 1000.0 + 180.0 * (0.45 * f64::from(row)).sin() + 40.0 * (0.3 * f64::from(col)).sin();
        let cells: Vec<String> = (0..48).map(|col| format!("{:.1}", height(col))).collect();
        text += &(cells.join(" ") + "\n");
    }
    text
}

/// The way revealed from a scene that lies beside the folder of its data.
fn reveal(place: &Place, more: &[&str]) {
    let args =
        ["reveal", "data/dem.asc", "data/way.geojson", "-o", "out/a.png", "--scene", "out/s.toml", "--overwrite"];
    let view = ["--size", "64x48", "--eye", "8.022,46.002,1500", "--look", "8.024,46.03", "--quiet"];
    place.ok(&[&args[..], &view, more].concat());
}

#[test]
fn the_scene_that_reveal_wrote_names_the_fonts_of_the_call() {
    let place = place();
    let font = belvedere_testkit::font::tiny_font("Tiny Squares", &['富']);
    std::fs::write(place.path("data/tiny.ttf"), font).expect("written");
    reveal(&place, &["--font", "data/tiny.ttf"]);
    let see = ["reveal", "data/a.obj", "--see", "0.2,0.2,0", "-o", "out/b.png", "--scene", "out/t.toml"];
    place.ok(&[&see[..], &["--size", "64x48", "--font", "data/tiny.ttf", "--quiet"]].concat());
    for name in ["s", "t"] {
        let scene = String::from_utf8(read(&place.path(&format!("out/{name}.toml")))).expect("UTF-8");
        assert!(scene.contains("fonts = \"../data/tiny.ttf\""), "{scene}");
        place.ok(&["render", &format!("out/{name}.toml"), "-o", "c.png", "--size", "64x48", "--overwrite"]);
        let record = String::from_utf8(read(&place.path("c.png.json"))).expect("UTF-8");
        assert!(record.contains("tiny.ttf"), "{record}");
    }
}

/// The program in another folder with the same settings.
fn code_in(place: &Place, folder: &Path, args: &[&str]) -> Option<i32> {
    place.command(args).current_dir(folder).output().expect("the program starts").status.code()
}

#[test]
fn every_verb_opens_the_scene_that_reveal_wrote_from_any_folder() {
    let place = place();
    reveal(&place, &[]);
    let scene = String::from_utf8(read(&place.path("out/s.toml"))).expect("UTF-8");
    assert!(scene.contains("\"../data/dem.asc\"") && scene.contains("\"../data/way.geojson\""), "{scene}");
    place.ok(&["render", "out/s.toml", "-o", "b.png", "--size", "64x48"]);
    place.write("p.json", "[[400000, 5100000, 0]]");
    place.write("q.json", "[[3, 4]]");
    for (verb, more) in [
        ("check", &[][..]),
        ("measure", &[]),
        ("show", &[]),
        ("project", &["--points", "p.json"]),
        ("displace", &["--points", "p.json"]),
        ("rays", &["--pixels", "q.json", "--samples", "2"]),
        ("pick", &["--pixels", "q.json"]),
        ("animate", &["-o", "film", "--turntable", "--frames", "1", "--size", "32x24"]),
    ] {
        place.ok(&[&[verb, "out/s.toml"], more].concat());
    }
    let absolute = place.path("out/s.toml");
    let elsewhere = place.path("elsewhere");
    assert_eq!(code_in(&place, &elsewhere, &["check", "../out/s.toml"]), Some(0));
    assert_eq!(code_in(&place, &elsewhere, &["check", absolute.to_str().expect("UTF-8")]), Some(0));
    assert_eq!(code_in(&place, &place.path("out"), &["check", "s.toml"]), Some(0));
    // Shown into another folder, the scene still finds its files.
    place.ok(&["show", "out/s.toml", "-o", "elsewhere/t.toml"]);
    place.ok(&["check", "elsewhere/t.toml"]);
}

#[test]
fn scenes_that_moved_that_name_other_files_or_that_are_not_remembered_are_refused() {
    let place = place();
    reveal(&place, &[]);
    std::fs::copy(place.path("out/s.toml"), place.path("elsewhere/s.toml")).expect("copied");
    let line = place.fails(&["check", "elsewhere/s.toml"]);
    assert!(
        line.contains("\"../data/dem.asc\" leaves the folder of the scene file")
            && line.ends_with("allow a folder with --allow-root DIR, or for good with: belvedere trust SCENE"),
        "{line}"
    );
    place.ok(&["check", "elsewhere/s.toml", "--allow-root", "data"]);
    place.write("data/secret.asc", &hills());
    let scene = String::from_utf8(read(&place.path("out/s.toml"))).expect("UTF-8");
    place.write("out/s.toml", &scene.replace("dem.asc", "secret.asc"));
    assert!(place.fails(&["check", "out/s.toml"]).contains("secret.asc\" leaves the folder"));
    place.write("out/s.toml", &scene);
    place.ok(&["check", "out/s.toml"]);
    assert!(place.fails(&["check", "out/s.toml", "--no-remember"]).contains("leaves the folder"));
    let out = place.command(&["check", "out/s.toml"]).env("BELVEDERE_NO_TRUST", "1").output().expect("started");
    assert_eq!(out.status.code(), Some(2));
    place.ok(&["trust", "--forget", "out/s.toml"]);
    assert!(place.fails(&["check", "out/s.toml"]).contains("leaves the folder"));
    reveal(&place, &["--no-remember"]);
    assert!(place.fails(&["check", "out/s.toml"]).contains("leaves the folder"));
}

#[test]
fn a_copy_of_a_scene_gets_no_consent_for_files_that_the_scene_may_not_read() {
    let place = place();
    // `show` does not read meshes.
    let mesh = "[[layer]]\nid = 'a'\nkind = 'mesh'\nsource = '../data/a.obj'\n";
    place.write("out/s.toml", &format!("{BARE}{mesh}"));
    place.ok(&["show", "out/s.toml", "-o", "elsewhere/t.toml"]);
    assert!(place.fails(&["check", "elsewhere/t.toml"]).contains("leaves the folder"));
    place.ok(&["show", "out/s.toml", "-o", "elsewhere/t.toml", "--allow-root", "data", "--overwrite"]);
    place.ok(&["check", "elsewhere/t.toml"]);
}

#[test]
fn a_scene_is_trusted_listed_and_forgotten() {
    let place = place();
    let mesh = "[[layer]]\nid = 'a'\nkind = 'mesh'\nsource = ";
    place.write("out/s.toml", &format!("{BARE}{mesh}'../data/a.obj'\n"));
    place.write("out/t.toml", &format!("{BARE}{mesh}'a.obj'\n"));
    place.write("out/u.toml", &format!("{BARE}{mesh}'../data/none.obj'\n"));
    assert!(place.fails(&["check", "out/s.toml"]).contains("leaves the folder"));
    assert!(place.ok(&["trust", "out/s.toml"]).contains("a.obj"));
    place.ok(&["check", "out/s.toml"]);
    // A name that is looked for in an allowed folder.
    assert!(place.fails(&["trust", "out/t.toml"]).contains("\"a.obj\" is not there"));
    place.ok(&["trust", "out/t.toml", "--allow-root", "data"]);
    place.ok(&["check", "out/t.toml"]);
    assert!(place.fails(&["trust", "out/u.toml"]).contains("is not there"));
    let list = place.json(&["trust", "--list", "--json"]);
    let scenes: Vec<&str> =
        list["scenes"].as_array().expect("a list").iter().filter_map(|s| s["scene"].as_str()).collect();
    assert!(scenes.len() == 2 && scenes[0].ends_with("s.toml") && scenes[1].ends_with("t.toml"), "{list}");
    assert!(place.fails(&["trust", "--forget", "out/u.toml"]).contains("is not remembered"));
    assert_eq!(place.ok(&["trust", "--forget", "out/s.toml"]), "forgotten: 1 scene\n");
    assert!(place.fails(&["check", "out/s.toml"]).contains("leaves the folder"));
    place.ok(&["check", "out/t.toml"]);
    place.ok(&["trust", "--forget"]);
    assert_eq!(place.ok(&["trust", "--list"]), "");
    assert!(place.fails(&["trust"]).contains("required"));
    assert!(place.fails(&["trust", "out/s.toml", "--no-remember"]).contains("nothing is remembered"));
}

/// A named pipe, whose opening waits for its other end.
#[cfg(target_os = "linux")]
#[test]
fn a_record_that_is_no_regular_file_is_as_if_it_were_not_there() {
    use std::process::Command;
    let place = Place::new();
    place.write("bare.toml", BARE);
    let check = place.command(&["check", "bare.toml"]);
    let settings = check.get_envs().find(|(name, _)| *name == "XDG_CONFIG_HOME").and_then(|(_, value)| value);
    let folder = Path::new(settings.expect("a folder for settings")).join("belvedere");
    std::fs::create_dir_all(&folder).expect("a folder");
    for name in ["trusted.json", "trusted.lock"] {
        let made = Command::new("mkfifo").args(["-m", "600"]).arg(folder.join(name)).status().expect("mkfifo");
        assert!(made.success());
    }
    let envs: Vec<_> = check.get_envs().filter_map(|(name, value)| Some((name, value?))).collect();
    for verb in ["check", "show"] {
        let mut within = Command::new("timeout");
        within
            .arg("20")
            .arg(check.get_program())
            .args([verb, "bare.toml"])
            .envs(envs.clone())
            .current_dir(place.0.path());
        let out = within.output().expect("it ends");
        assert_eq!(out.status.code(), Some(0), "{verb}: {}", String::from_utf8_lossy(&out.stderr));
    }
    std::fs::remove_dir_all(&folder).expect("removed");
}
