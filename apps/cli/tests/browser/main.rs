//! The application in a browser: packed, served, loaded, dragged. Needs the application built by apps/viewer/web/build in
//! $BELVEDERE_WEB_APP, and Chromium; with BELVEDERE_REQUIRE_BROWSER=1 it fails where they are missing.
#![cfg(target_os = "linux")]
#![allow(clippy::print_stderr)]

mod chromium;
mod mixed;
mod server;

use chromium::{PAGE, Page};
use serde_json::{Value, json};
use std::path::{Path, PathBuf};
use std::process::Command;
use std::time::{Duration, Instant};

/// How long the picture is dragged.
const DRAG: Duration = Duration::from_secs(10);
/// How long the page is watched at rest, and the share of a core that it may take then.
const AT_REST: Duration = Duration::from_secs(5);
const MOST_AT_REST: f64 = 0.02;
const TIMES: &str = "window.belvedere?.application.times() ?? null";

/// Folder of the application; `None`, said loudly, where it was not built.
fn application() -> Option<PathBuf> {
    let required = std::env::var("BELVEDERE_REQUIRE_BROWSER").is_ok_and(|v| v == "1");
    let folder = std::env::var_os("BELVEDERE_WEB_APP").map(PathBuf::from);
    if folder.is_none() {
        assert!(!required, "BELVEDERE_WEB_APP is not set and BELVEDERE_REQUIRE_BROWSER=1");
        eprintln!(
            "SKIPPED: the browser is not tried; BELVEDERE_WEB_APP names no application (apps/viewer/web/build makes it)"
        );
    }
    folder
}

fn browser(place: &Path) -> Option<Page> {
    let page = Page::open(&place.join("profile"));
    if page.is_none() {
        let required = std::env::var("BELVEDERE_REQUIRE_BROWSER").is_ok_and(|v| v == "1");
        assert!(!required, "there is no Chromium and BELVEDERE_REQUIRE_BROWSER=1");
        eprintln!("SKIPPED: the browser is not tried; there is no Chromium");
    }
    page
}

/// Packs files; answers the report.
fn pack(application: &Path, files: &[&Path], out: &Path) -> Value {
    pack_with(application, files, out, false)
}

/// The same, for many threads if asked.
fn pack_with(application: &Path, files: &[&Path], out: &Path, threads: bool) -> Value {
    let mut command = Command::new(env!("CARGO_BIN_EXE_belvedere"));
    command.arg("pack").args(files).arg("-o").arg(out).arg("--app").arg(application).arg("--json");
    command.args(threads.then_some("--all-cores"));
    let output = command.output().expect("the program starts");
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    serde_json::from_slice(&output.stdout).expect("a report")
}

fn times(page: &mut Page, passes: impl Fn(&Value) -> bool) -> Value {
    let parsed = |text: &Value| text.as_str().and_then(|text| serde_json::from_str::<Value>(text).ok());
    let text = page.wait(TIMES, |text| parsed(text).is_some_and(|times| passes(&times)));
    parsed(&text).expect("times")
}

fn rests(times: &Value) -> bool {
    times["rests"] == true
}

#[test]
fn the_built_in_scene_is_drawn_and_dragged() {
    drawn_and_dragged(false);
}

#[test]
fn the_built_in_scene_is_drawn_and_dragged_by_many_threads() {
    drawn_and_dragged(true);
}

fn drawn_and_dragged(isolated: bool) {
    let place = tempfile::tempdir().expect("folder");
    let Some(application) = application() else { return };
    let Some(mut page) = browser(place.path()) else { return };
    let site = place.path().join("site");
    if isolated && !application.join("threads").is_dir() {
        eprintln!("SKIPPED: many threads are not tried; the application was built without them");
        return;
    }
    let report = pack_with(&application, &[], &site, isolated);
    assert!(!site.join("threads").exists(), "a folder holds one application");
    let began = Instant::now();
    let address = server::serve(site, isolated);
    page.call("Page.navigate", json!({ "url": address }));
    times(&mut page, |times| times["pictures"].as_u64() > Some(0));
    let threads = page.value("belvedere.threads");
    assert_eq!(threads.as_u64() > Some(0), isolated, "{threads} threads");
    let first_ms = began.elapsed().as_millis();
    page.with("button", "Two side streets", "function () {}");
    page.press("Close window");
    times(&mut page, rests);
    std::thread::sleep(Duration::from_millis(500));
    let load = page.load_at_rest(AT_REST);
    assert!(load < MOST_AT_REST, "the page works {:.1} % of the time at rest", 100.0 * load);
    let before = page.screenshot();
    let middle = PAGE.map(|n| f64::from(n) / 2.0);
    page.pointer("mouseMoved", middle);
    page.pointer("mousePressed", middle);
    let dragged = Instant::now();
    while dragged.elapsed() < DRAG {
        let angle = 2.0 * dragged.elapsed().as_secs_f64();
        page.pointer("mouseMoved", [middle[0] + 120.0 * angle.sin(), middle[1] + 40.0 * (1.3 * angle).sin()]);
        std::thread::sleep(Duration::from_millis(16));
    }
    page.pointer("mouseReleased", [middle[0] + 90.0, middle[1]]);
    let times = times(&mut page, rests);
    let rest_ms = times["rest_to_full_picture_ms"].as_array().and_then(|all| all.last()?.as_f64()).expect("a rest");
    assert!(page.screenshot() != before, "the picture does not follow the pointer");
    // What was done is there again when the page is loaded again.
    let left = page.value("belvedere.application.scene()");
    page.reload(true);
    page.wait("window.belvedere?.application.scene() ?? null", |scene| *scene == left);
    let mut each: Vec<f64> =
        times["input_to_picture_ms"].as_array().expect("times").iter().filter_map(Value::as_f64).collect();
    each.sort_by(f64::total_cmp);
    assert!(each.len() > 20, "{} pictures in a drag of {DRAG:?}", each.len());
    assert_eq!(page.complaints, Vec::<String>::new());
    assert_eq!(page.value("belvedere.application.failure() ?? null"), Value::Null);
    eprintln!(
        "browser, {threads} workers: application {} bytes; first picture {first_ms} ms after the address; {} pictures in {DRAG:?}, input to picture \
         median {:.0} ms, 95 % {:.0} ms; in full {rest_ms:.0} ms after the last change; {:.2} % of a core at rest",
        report["application_bytes"],
        each.len(),
        each[each.len() / 2],
        each[each.len() * 95 / 100],
        100.0 * load
    );
}

#[test]
fn a_packed_terrain_and_its_route_are_drawn_as_the_command_line_draws_them() {
    let Some(application) = application() else { return };
    let names = ["rmnp/rmnp_dem.tif", "rmnp/continental-div-trail_clip.geojson"];
    let [Some(dem), Some(route)] = names.map(belvedere_testkit::data) else { return };
    let place = tempfile::tempdir().expect("folder");
    let Some(mut page) = browser(place.path()) else { return };
    let site = place.path().join("site");
    let report = pack(&application, &[&dem, &route], &site);
    let files = report["bundle"]["files"].as_array().expect("files");
    assert!(files.len() >= 3, "scene, ground and route: {files:?}");
    let text = std::fs::read_to_string(site.join(report["bundle"]["open"][0].as_str().expect("scene"))).expect("scene");
    assert!(!text.contains(dem.parent().and_then(Path::to_str).expect("folder")), "it tells where it was made: {text}");
    // What is packed is a scene like any other.
    let picture = place.path().join("p.png");
    let scene = site.join(report["bundle"]["open"][0].as_str().expect("scene"));
    let drawn =
        Command::new(env!("CARGO_BIN_EXE_belvedere")).arg("render").arg(&scene).arg("-o").arg(&picture).output();
    let drawn = drawn.expect("the program starts");
    assert!(drawn.status.success(), "{}", String::from_utf8_lossy(&drawn.stderr));
    let address = server::serve(site, true);
    page.call("Page.navigate", json!({ "url": address }));
    times(&mut page, rests);
    let shown = page.value("belvedere.application.scene()");
    assert_eq!(shown.as_str().expect("scene"), text, "the page shows another scene");
    assert_eq!(page.complaints, Vec::<String>::new());
}

#[test]
fn files_that_are_dropped_on_the_page_are_opened_and_what_is_saved_is_downloaded() {
    let Some(application) = application() else { return };
    let names = ["cases/dem.tif", "cases/route.gpx"];
    let [Some(dem), Some(route)] = names.map(belvedere_testkit::data) else { return };
    // The browser takes no path that climbs ("..").
    let [dem, route] = [dem, route].map(|path| path.canonicalize().expect("test data"));
    let place = tempfile::tempdir().expect("folder");
    let Some(mut page) = browser(place.path()) else { return };
    let site = place.path().join("site");
    pack(&application, &[], &site);
    let address = server::serve(site, false);
    page.call("Page.navigate", json!({ "url": address }));
    times(&mut page, rests);
    page.drop_files(&[&dem, &route]);
    let opened = |scene: &Value| scene.as_str().is_some_and(|text| text.contains("dem.tif"));
    let scene = page.wait("belvedere.application.scene()", opened);
    assert!(scene.as_str().is_some_and(|text| text.contains("must_see = true") && text.contains("route.gpx")));
    times(&mut page, rests);
    let downloads = place.path().join("downloads");
    page.call("Browser.setDownloadBehavior", json!({ "behavior": "allow", "downloadPath": downloads }));
    page.key("s", "KeyS", 83, 2);
    let saved = downloads.join("scene.toml");
    let began = Instant::now();
    while !saved.exists() {
        assert!(began.elapsed() < DRAG, "nothing is downloaded; {:?}", page.complaints);
        times(&mut page, |_| true);
    }
    assert_eq!(std::fs::read_to_string(&saved).expect("scene"), scene.as_str().expect("scene"));
    // The browser keeps the files for the tab, until it is told to forget them.
    page.reload(false);
    page.wait("window.belvedere?.application.scene() ?? null", |shown| *shown == scene);
    times(&mut page, rests);
    page.press("File");
    page.press("Forget my files");
    let words = |page: &mut Page| page.accessible().into_iter().map(|(_, name, _)| name).collect::<Vec<_>>().join("\n");
    let says = |page: &mut Page, what: &str| {
        let began = Instant::now();
        while !words(page).contains(what) {
            assert!(began.elapsed() < DRAG, "it does not say {what}: {}", words(page));
            std::thread::sleep(Duration::from_millis(50));
        }
    };
    says(&mut page, "has forgotten your files");
    page.reload(false);
    says(&mut page, "any more: dem.tif, route.gpx.");
    page.drop_files(&[&dem]);
    says(&mut page, "any more: route.gpx.");
    page.drop_files(&[&route]);
    page.wait("window.belvedere?.application.scene() ?? null", |shown| *shown == scene);
    times(&mut page, rests);
    // Another scene needs none of them.
    page.press("File");
    page.press("Built-in scenes");
    page.press("Massif, a bent panorama");
    let kept = "new Promise((done) => { const open = indexedDB.open('belvedere'); open.onsuccess = () => { \
        const keys = open.result.transaction('files').objectStore('files').getAllKeys(); \
        keys.onsuccess = () => { open.result.close(); done(keys.result.length); }; }; })";
    page.wait(kept, |count| *count == 0);
    assert_eq!(page.complaints, Vec::<String>::new());
}
