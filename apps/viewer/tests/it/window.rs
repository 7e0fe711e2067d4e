//! The application in a real window on a virtual display, driven by a moving pointer.

use belvedere::{OpenOptions, Session, core::Stage};
use serde_json::Value;
use std::io::{BufRead, BufReader};
use std::path::PathBuf;
use std::process::{Child, Command, Stdio};
use std::time::{Duration, Instant};

/// Longest time of any step on a machine without a GPU.
const PATIENCE: Duration = Duration::from_secs(60);

/// The program under test.
const PROGRAM: &str = env!("CARGO_BIN_EXE_belvedere-view");

/// A temporary folder.
struct Folder(tempfile::TempDir);

impl Folder {
    fn new() -> Self {
        Self(tempfile::tempdir().expect("temporary folder"))
    }

    fn path(&self, name: &str) -> PathBuf {
        self.0.path().join(name)
    }
}

/// A virtual display that ends when it is dropped.
struct Display {
    server: Child,
    name: String,
}

impl Display {
    /// Opens a display; prints why and returns `None` where there is no display server.
    #[allow(clippy::print_stderr)]
    fn open() -> Option<Self> {
        let required = std::env::var("BELVEDERE_REQUIRE_DISPLAY").is_ok_and(|v| v == "1");
        let started = Command::new("Xvfb")
            .args(["-displayfd", "1", "-screen", "0", "1440x900x24", "-nolisten", "tcp"])
            .stdout(Stdio::piped())
            .stderr(Stdio::null())
            .spawn();
        let has_pointer = Command::new("xdotool").arg("version").output().is_ok();
        let (Ok(mut server), true) = (started, has_pointer) else {
            assert!(!required, "Xvfb or xdotool is missing and BELVEDERE_REQUIRE_DISPLAY=1");
            eprintln!("SKIPPED: the window is not tried; it needs Xvfb and xdotool");
            return None;
        };
        let mut number = String::new();
        BufReader::new(server.stdout.take().expect("output")).read_line(&mut number).expect("number of the display");
        Some(Self { server, name: format!(":{}", number.trim()) })
    }

    fn pointer(&self, args: &[&str]) {
        let status = Command::new("xdotool").env("DISPLAY", &self.name).args(args).stdout(Stdio::null()).status();
        assert!(status.expect("xdotool").success(), "{args:?}");
    }

    fn click(&self, x: u32, y: u32) {
        self.pointer(&["mousemove", &x.to_string(), &y.to_string(), "sleep", "0.4", "click", "1", "sleep", "1.2"]);
    }

    fn drag(&self, [x0, y0]: [u32; 2], [x1, y1]: [u32; 2]) {
        self.pointer(&["mousemove", &x0.to_string(), &y0.to_string(), "sleep", "0.2", "mousedown", "1"]);
        for k in 1..=6 {
            let at = |a: u32, b: u32| (f64::from(a) + (f64::from(b) - f64::from(a)) * f64::from(k) / 6.0).round();
            self.pointer(&["mousemove", &at(x0, x1).to_string(), &at(y0, y1).to_string(), "sleep", "0.1"]);
        }
        self.pointer(&["mouseup", "1", "sleep", "0.4"]);
    }
}

impl Drop for Display {
    fn drop(&mut self) {
        let _ = self.server.kill();
        let _ = self.server.wait();
    }
}

fn window(place: &Folder, display: &Display, args: &[&str]) -> Child {
    let program = Command::new(PROGRAM)
        .current_dir(place.path(""))
        .args(args)
        .env("DISPLAY", &display.name)
        .env("XDG_RUNTIME_DIR", place.path(""))
        .env("XDG_STATE_HOME", place.path("state"))
        .env("LIBGL_ALWAYS_SOFTWARE", "1")
        .env("BELVEDERE_VIEW_TIMES", place.path("times.json"))
        .env_remove("WAYLAND_DISPLAY")
        .stderr(Stdio::inherit())
        .spawn();
    program.expect("the program starts")
}

/// The recovery file, as soon as it passes a test.
fn written(place: &Folder, what: &str, passes: impl Fn(&Value) -> bool) -> Value {
    let began = Instant::now();
    loop {
        let text = std::fs::read_to_string(place.path("state/belvedere/state-0.json")).unwrap_or_default();
        if let Ok(state) = serde_json::from_str::<Value>(&text)
            && passes(&state)
        {
            return state;
        }
        assert!(began.elapsed() < PATIENCE, "not {what}: {}", text.replace(char::is_whitespace, ""));
        std::thread::sleep(Duration::from_millis(50));
    }
}

const SCENE: &str = "format = 1\ncrs = \"local\"\n[camera]\neye = [6000.0, -5200.0, 3600.0]\nlook_at = [0.0, 0.0, 300.0]\nimage = [320, 180]\n\
    [[layer]]\nkind = \"terrain\"\nid = \"ground\"\nsource = \"builtin:massif?seed=7&size=129\"\n";

#[test]
fn a_preset_is_made_in_a_window_saved_and_drawn_and_a_killed_window_comes_back() {
    let Some(display) = Display::open() else { return };
    let place = Folder::new();
    std::fs::write(place.path("scene.toml"), SCENE).expect("written");
    let mut program = window(&place, &display, &["scene.toml"]);
    written(&place, "open", |state| state["document"]["layer"][0]["id"] == "ground");
    std::thread::sleep(Duration::from_secs(10)); // The panel can be used from the first picture on.
    let mut operations = 0;
    let mut click = |x, y| {
        operations += 1;
        display.click(x, y);
    };
    click(33, 60); // the panel of splines
    click(70, 140); // the first picture of a preset
    written(&place, "bent", |state| state["document"]["stage"][0]["presets"] == "progressive");
    std::thread::sleep(Duration::from_secs(3)); // The angle of the camera is told when the bent picture is there.
    click(144, 406); // for the angle of this camera
    let state = written(&place, "captured", |state| state["document"]["stage"][0]["presets"]["presets"].is_array());
    let far = |state: &Value| state["document"]["stage"][0]["presets"]["presets"][0]["control"][3][1].as_f64();
    let before = far(&state);
    display.drag([243, 542], [243, 516]); // the far end of the curve is raised
    operations += 1;
    written(&place, "raised", |state| far(state) > before);
    display.click(18, 12); // the menu of files
    display.click(30, 117); // save
    operations += 1;
    written(&place, "saved", |state| state["changed"] == false);
    assert!(operations <= 15, "{operations} operations");

    let saved = Session::open(&place.path("scene.toml"), &OpenOptions::default()).expect("what was saved opens");
    assert!(matches!(saved.view().stages(), [Stage::SplineBend(_)]), "{:?}", saved.view());

    // The camera is moved, then the program is killed: a new instance starts with that camera.
    display.drag([800, 500], [900, 520]);
    let state = written(&place, "moved", |state| state["changed"] == true);
    program.kill().expect("killed");
    program.wait().expect("gone");
    std::fs::copy(place.path("state/belvedere/state-0.json"), place.path("left.json")).expect("copied");
    let mut again = window(&place, &display, &[]);
    let age = |name: &str| place.path(name).metadata().and_then(|m| m.modified()).expect("time");
    let began = Instant::now();
    while age("state/belvedere/state-0.json") <= age("left.json") {
        assert!(began.elapsed() < PATIENCE, "the new window writes nothing down");
        std::thread::sleep(Duration::from_millis(50));
    }
    let back = written(&place, "back", |state| state["document"]["layer"][0]["id"] == "ground");
    assert_eq!(back["document"]["camera"], state["document"]["camera"]);
    std::thread::sleep(Duration::from_secs(10)); // Its first picture is there before it ends, on a busy machine, too.
    display.click(18, 12);
    display.click(30, 172); // quit
    std::thread::sleep(Duration::from_secs(2));
    assert!(again.try_wait().expect("status").is_none(), "it ended with changes that are in no file");
    display.click(700, 455); // discard changes
    let began = Instant::now();
    while again.try_wait().expect("status").is_none() {
        assert!(began.elapsed() < PATIENCE, "it does not end");
        std::thread::sleep(Duration::from_millis(50));
    }
    assert!(!place.path("state/belvedere/state-0.json").exists(), "what ended as it should leaves nothing");
    let times: Value = serde_json::from_slice(&std::fs::read(place.path("times.json")).expect("file")).expect("times");
    assert!(times["first_picture_ms"].as_f64().is_some_and(|ms| ms < 60_000.0), "{times}");
}

#[test]
fn without_a_display_one_line_says_what_to_do() {
    let place = Folder::new();
    let out = Command::new(PROGRAM)
        .current_dir(place.path(""))
        .env("XDG_STATE_HOME", place.path("state"))
        .env_remove("DISPLAY")
        .env_remove("WAYLAND_DISPLAY")
        .env_remove("WAYLAND_SOCKET")
        .output()
        .expect("the program starts");
    let text = String::from_utf8_lossy(&out.stderr);
    assert_eq!((out.status.code(), text.lines().count()), (Some(2), 1), "{text}");
    assert!(text.contains("no window can be opened") && text.contains("use render"), "{text}");
}
