//! `animate`: frames, their record, going on after an interruption, and the film.

use super::Place;
use std::path::{Path, PathBuf};
use std::process::{Command, Output, Stdio};

const SCENE: &str = "format = 1
[[layer]]
id = 'ground'
kind = 'terrain'
source = 'builtin:massif?size=65'
[[layer]]
id = 'trail'
kind = 'line'
source = 'builtin:massif?size=65'
must_see = true
[camera]
eye = [0, -9000, 5000]
look_at = [0, 0, 1000]
image = [48, 32]
[[stage]]
kind = 'spline_bend'
presets = 'progressive'
";

fn place() -> Place {
    let place = Place::new();
    place.write("s.toml", SCENE);
    place
}

/// Every file of a folder with its bytes.
fn files(folder: &Path) -> Vec<(String, Vec<u8>)> {
    let entries = std::fs::read_dir(folder).unwrap_or_else(|e| panic!("{}: {e}", folder.display()));
    let mut out: Vec<_> = entries
        .map(|e| e.expect("entry").path())
        .map(|p| (p.file_name().expect("name").to_string_lossy().into_owned(), super::read(&p)))
        .collect();
    out.sort();
    out
}

fn record(folder: &Path) -> serde_json::Value {
    serde_json::from_slice(&super::read(&folder.join("animation.json"))).expect("JSON")
}

fn eye(record: &serde_json::Value, frame: usize) -> [f64; 3] {
    std::array::from_fn(|k| record["frames"][frame]["view"]["eye"][k].as_f64().expect("a number"))
}

#[test]
fn what_is_missing_or_damaged_is_drawn_again_to_the_same_bytes() {
    let place = place();
    let go = |out: &str, more: &[&str]| {
        place.json(
            &[&["animate", "s.toml", "-o", out, "--along", "trail", "--frames", "5", "--json"][..], more].concat(),
        )
    };
    assert_eq!(go("whole", &["--threads", "1"])["drawn"], 5);
    assert_eq!(files(&place.path("whole")).len(), 6, "five frames and their record");
    go("broken", &["--threads", "2"]);
    std::fs::remove_file(place.path("broken/frame_00001.png")).expect("removed");
    place.write("broken/frame_00003.png", "half a picture");
    let line = place.fails(&["animate", "s.toml", "-o", "broken", "--along", "trail", "--frames", "5"]);
    assert!(line.contains("--resume") && line.contains("--overwrite"), "{line}");
    assert_eq!(go("broken", &["--resume"])["drawn"], 2);
    assert_eq!(files(&place.path("whole")), files(&place.path("broken")));
    assert_eq!(go("broken", &["--resume"])["drawn"], 0);
}

#[test]
fn another_scene_is_not_gone_on_with() {
    let place = place();
    let args = ["animate", "s.toml", "-o", "out", "--turntable", "--frames", "3"];
    place.ok(&args);
    let refusal = |more: &[&str]| place.fails(&[&args[..], &["--resume"], more].concat());
    assert!(refusal(&["--size", "32x32"]).contains("48 x 32"), "size");
    assert!(refusal(&["--fps", "10"]).contains("way"), "fps");
    place.write("s.toml", &format!("# a remark\n{SCENE}"));
    place.ok(&[&args[..], &["--resume"]].concat());
    place.write("s.toml", &SCENE.replace("5000", "5100"));
    assert!(refusal(&[]).contains("the scene has changed"), "scene");
    place.ok(&[&args[..4], &["--turntable", "--frames", "2", "--overwrite"]].concat());
    assert_eq!(files(&place.path("out")).len(), 3, "frames of the longer animation are gone");
}

/// The change lies behind the first 64 KiB of the file, in a corner that no camera of the scene depends on.
#[test]
fn an_animation_over_a_changed_dem_is_not_gone_on_with() {
    const SIDE: usize = 120;
    let dem = |corner: &str| {
        let head = format!("ncols {SIDE}\nnrows {SIDE}\nxllcorner -6000\nyllcorner -6000\ncellsize 100\n");
        let cells = "1000.0 ".repeat(SIDE * SIDE - 1);
        assert!(cells.len() > 1 << 16);
        head + &cells + corner + "\n"
    };
    let place = place();
    place.write("dem.asc", &dem("1000.0"));
    let (head, rest) = SCENE.split_at(SCENE.find("[camera]").expect("a camera"));
    let ground = "[[layer]]\nid = 'ground'\nkind = 'terrain'\nsource = 'dem.asc'\n";
    place.write("s.toml", &(head.lines().next().expect("a line").to_owned() + "\n" + ground + rest));
    let args = ["animate", "s.toml", "-o", "out", "--sweep", "phi=60:62:1", "--resume"];
    place.ok(&args);
    place.ok(&args);
    place.write("dem.asc", &dem("1000.5"));
    let line = place.fails(&args);
    assert!(line.contains("dem.asc has changed since"), "{line}");
}

#[test]
fn a_cancelled_animation_goes_on() {
    let place = place();
    let args = ["animate", "s.toml", "-o", "out", "--along", "trail", "--frames", "400", "--size", "24x16", "--quiet"];
    let mut child = Command::new(env!("CARGO_BIN_EXE_belvedere"))
        .current_dir(place.0.path())
        .args(args)
        .stderr(Stdio::piped())
        .spawn()
        .expect("the program starts");
    while !place.path("out/frame_00001.png").exists() {
        assert!(child.try_wait().expect("status").is_none(), "it ended before the second frame");
        std::thread::sleep(std::time::Duration::from_millis(2));
    }
    let pid = child.id().to_string();
    assert!(Command::new("kill").args(["-INT", &pid]).status().expect("kill runs").success());
    let out = child.wait_with_output().expect("it ends");
    let said = String::from_utf8_lossy(&out.stderr).into_owned();
    assert_eq!(out.status.code(), Some(130), "{said}");
    assert!(said.contains("of 400 frames") && said.contains("--resume"), "{said}");
    let record = record(&place.path("out"));
    let done = record["done"].as_u64().expect("a count") as usize;
    assert!((2..400).contains(&done), "{done}");
    assert_eq!(files(&place.path("out")).len(), done + 1, "nothing half written is left");
}

#[test]
fn cameras_go_where_they_are_sent() {
    let place = place();
    let run = |out: &str, args: &[&str]| {
        place.ok(&[&["animate", "s.toml", "-o", out][..], args].concat());
        record(&place.path(out))
    };
    // Half way round lies opposite the start, as high, and as far from the pivot.
    let turn = run("turn", &["--turntable", "--frames", "4"]);
    let [a, b, c] = [0, 1, 2].map(|k| eye(&turn, k));
    assert!((a[2] - c[2]).abs() < 1e-6 && (a[2] - b[2]).abs() < 1e-6);
    let middle = [0.5 * (a[0] + c[0]), 0.5 * (a[1] + c[1])];
    let reach = |p: [f64; 3]| (p[0] - middle[0]).hypot(p[1] - middle[1]);
    assert!((reach(a) - reach(b)).abs() < 1e-6 && reach(a) > 1000.0, "{a:?} {b:?} {c:?}");
    // The viewing angle rises in equal steps and ends straight above.
    let sweep = run("sweep", &["--sweep", "phi=30:90:20"]);
    let angle = |k: usize| sweep["frames"][k]["view"]["pitch_deg"].as_f64().expect("a number");
    for (k, phi) in [30.0, 50.0, 70.0, 90.0].into_iter().enumerate() {
        assert!((angle(k) - phi).abs() < 1e-6, "{k}: {}", angle(k));
    }
    // Saved cameras are met exactly, in between the way is smooth.
    let key = |y: f64| format!("{{\"eye\": [0, {y}, 5000], \"look_at\": [0, 0, 1000]}}");
    place.write("path.json", &format!("[{}, {}, {}]", key(-9000.0), key(-8000.0), key(-7000.0)));
    place.write("s.toml", &format!("{SCENE}[animation]\ncamera = 'path.json'\nframes = 5\n"));
    let path = run("path", &[]);
    for (k, y) in [(0, -9000.0), (2, -8000.0), (3, -7500.0), (4, -7000.0)] {
        assert!((eye(&path, k)[1] - y).abs() < if k == 3 { 70.0 } else { 1e-9 }, "{k}: {:?}", eye(&path, k));
    }
}

#[test]
fn impossible_animations_are_one_clear_line() {
    let place = place();
    let fails = |args: &[&str]| place.fails(&[&["animate", "s.toml", "-o", "out"][..], args].concat());
    assert!(fails(&[]).contains("--along LAYER"));
    assert!(fails(&["--along", "trial"]).contains("did you mean \"trail\"?"));
    assert!(fails(&["--along", "trail", "--turntable"]).contains("cannot be used with"));
    assert!(fails(&["--along", "trail", "--fps", "0"]).contains("greater than 0"));
    assert!(fails(&["--along", "trail", "--frames", "9", "--speed", "1e6"]).contains("give at most"));
    assert!(fails(&["--along", "trail", "--frames", "0"]).contains("1..=100000"));
    assert!(fails(&["--sweep", "tau"]).contains("phi"));
    let low = SCENE.replace("-9000, 5000", "-3000, 5000") + "plane = { height_m = -500 }\n";
    place.write("low.toml", &low);
    let line = place.fails(&["animate", "low.toml", "-o", "out", "--sweep", "phi=0:50:10"]);
    assert!(line.contains("frame 0: the eye") && line.contains("under the ground"), "{line}");
    assert!(place.fails(&["animate", "s.toml", "-o", "x.gif", "--turntable"]).contains("written as .mp4"));
    assert!(!place.path("out").exists(), "nothing is begun that cannot be ended");
    place.write("file", "x");
    assert!(place.fails(&["animate", "s.toml", "-o", "file", "--turntable"]).contains("is a file"));
}

#[cfg(unix)]
#[test]
fn the_film_is_made_by_ffmpeg_if_there_is_one() {
    let place = place();
    let bin = place.path("bin");
    std::fs::create_dir(&bin).expect("folder");
    let film = |out: &str, more: &[&str]| -> Output {
        Command::new(env!("CARGO_BIN_EXE_belvedere"))
            .current_dir(place.0.path())
            .env("PATH", &bin)
            .args(
                [
                    &["animate", "s.toml", "-o", out, "--turntable", "--frames", "2", "--fps", "12", "--strict"][..],
                    more,
                ]
                .concat(),
            )
            .output()
            .expect("the program starts")
    };
    let absent = film("a.mp4", &[]);
    let said = String::from_utf8_lossy(&absent.stderr).into_owned();
    assert_eq!(absent.status.code(), Some(1), "the goal is missed: {said}");
    assert!(said.contains("no ffmpeg program") && said.contains("a.frames"), "{said}");
    assert!(place.path("a.frames/frame_00001.png").exists() && !place.path("a.mp4").exists());
    // A stand-in that refuses the first encoder and writes its arguments into the film.
    ffmpeg(
        &bin,
        "case \"$*\" in *libx264*) echo no such encoder >&2; exit 1;; esac\nfor last; do :; done\necho \"$PWD $*\" > \"${last#file:}\"\n",
    );
    let made = film("a.mp4", &["--resume"]);
    assert_eq!(made.status.code(), Some(0), "{}", String::from_utf8_lossy(&made.stderr));
    let arguments = String::from_utf8(super::read(&place.path("a.mp4"))).expect("UTF-8");
    for part in ["a.frames -", "-framerate 12", "-i frame_%05d.png", "-frames:v 2", "mpeg4", " file:/"] {
        assert!(arguments.contains(part), "{part}: {arguments}");
    }
    // To ffmpeg a percent sign in a pattern stands for a number, and a colon ends the name of a protocol.
    let made = film("a%03d:b.mp4", &[]);
    assert_eq!(made.status.code(), Some(0), "{}", String::from_utf8_lossy(&made.stderr));
    let arguments = String::from_utf8(super::read(&place.path("a%03d:b.mp4"))).expect("UTF-8");
    assert!(arguments.contains("a%03d:b.frames -") && arguments.contains("-i frame_%05d.png"), "{arguments}");
    assert!(!film("a.mp4", &[]).status.success(), "an existing film is not replaced unasked");
    ffmpeg(&bin, "echo disk is tired >&2; exit 1\n");
    let broken = film("b.mp4", &[]);
    assert!(String::from_utf8_lossy(&broken.stderr).contains("disk is tired"));
    assert!(!place.path("b.mp4").exists());
    let told = film("n%d:o p.mp4", &[]);
    let told = String::from_utf8_lossy(&told.stderr).into_owned();
    assert!(told.contains("-i 'file:n%%d:o p.frames/frame_%05d.png'") && told.contains("'file:n%d:o p.mp4'"), "{told}");
}

#[cfg(unix)]
fn ffmpeg(bin: &Path, script: &str) -> PathBuf {
    use std::os::unix::fs::PermissionsExt;
    let path = bin.join("ffmpeg");
    std::fs::write(&path, format!("#!/bin/sh\n{script}")).expect("written");
    std::fs::set_permissions(&path, std::fs::Permissions::from_mode(0o755)).expect("runnable");
    path
}

#[test]
fn flags_ask_for_marker_clock_and_profile_and_frames_replace_a_speed() {
    let place = place();
    place.write("s.toml", &format!("{SCENE}[animation]\nalong = 'trail'\nspeed_mps = 1e6\n"));
    let args = ["animate", "s.toml", "-o", "out", "--frames", "3", "--marker", "--clock", "--profile", "--json"];
    let said = place.json(&args);
    assert_eq!(said["drawn"], 3);
    assert!(said["warnings"].to_string().contains("no times along the route"), "{said}");
    let record = record(&place.path("out"));
    for key in ["marker", "clock", "profile"] {
        assert_eq!(record["settings"]["animation"][key], true, "{key}");
    }
    for frame in record["frames"].as_array().expect("frames") {
        assert!(frame["marker"]["pixel"].is_array(), "{frame}");
        assert_eq!(frame["ground"]["from_below"], 0, "{frame}");
        // No clearance where the eye lies beside the ground.
        let clearance = frame["ground"]["clearance_m"].as_f64().unwrap_or(f64::INFINITY);
        assert!(frame["ground"]["needed_m"].as_f64().is_some_and(|needed| clearance >= needed), "{frame}");
    }
    let line = place.fails(&["animate", "s.toml", "-o", "turn", "--turntable", "--marker"]);
    assert!(line.contains("marker follows a walker along a route"), "{line}");
}
