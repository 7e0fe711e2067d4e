//! A scripted run of mixed actions on the page, after which nothing may be lost.

use super::{application, browser, pack, rests, times};
use crate::chromium::Page;
use crate::server;
use serde_json::{Value, json};
use std::path::Path;

const ACTIONS: u32 = 30;
const KINDS: u32 = 13;
const SEED: u32 = 7;
const SCENE: &str = "window.belvedere?.application.scene() ?? null";
const GROUND: &str = "format = 1\n[camera]\neye = [0, -900, 4000]\nlook_at = [0, 0, 300]\nimage = [320, 240]\n\
    [[layer]]\nkind = 'terrain'\nid = 'ground'\nsource = 'builtin:massif?seed=7&size=65'\n";
const WAY: &str = r#"{"type":"LineString","coordinates":[[1.50,42.50],[1.51,42.51],[1.52,42.50]]}"#;

/// The page, and what must be in it.
struct Run<'a> {
    page: &'a mut Page,
    address: String,
    way: &'a Path,
    /// The scene as it is, and whether it is in a file.
    scene: Value,
    saved: Value,
    /// Scenes before and after it, as far as the page has been loaded once.
    past: Vec<Value>,
    future: Vec<Value>,
    random: u32,
}

impl Run<'_> {
    /// A number below `end`.
    fn draw(&mut self, end: u32) -> u32 {
        self.random = self.random.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
        (self.random >> 8) % end
    }

    fn is_saved(&self) -> bool {
        self.scene == self.saved
    }

    /// The page has this scene, and knows whether it is in a file.
    fn holds(&mut self) {
        let scene = self.scene.clone();
        self.page.wait(SCENE, |shown| *shown == scene);
        let is_changed = self.page.value("belvedere.application.changed()");
        assert_eq!(is_changed, !self.is_saved(), "whether there are changes");
    }

    /// Something is done that makes another scene.
    fn edited(&mut self) {
        let before = self.scene.clone();
        self.scene = self.page.wait(SCENE, |shown| shown.is_string() && *shown != before);
        self.past.push(before);
        self.future.clear();
    }

    fn key(&mut self) {
        let (key, code, number) = [
            ("ArrowLeft", "ArrowLeft", 37),
            ("ArrowUp", "ArrowUp", 38),
            ("ArrowRight", "ArrowRight", 39),
            ("+", "Equal", 187),
        ][self.draw(4) as usize];
        self.page.key(key, code, number, 0);
        self.edited();
    }

    fn slider(&mut self) {
        let degrees = 30 + self.draw(40);
        let set = format!(
            "function () {{ this.value = {degrees}.5; this.dispatchEvent(new Event('input', {{ bubbles: true }})); }}"
        );
        self.page.with("slider", "field of view, degrees", &set);
        self.edited();
        assert!(self.scene.as_str().is_some_and(|text| text.contains(&format!("fov_y_deg = {degrees}.5"))));
        self.touch();
    }

    fn drop_way(&mut self) {
        self.page.drop_files(&[self.way]);
        let layers = |text: &Value| text.as_str().map(|text| text.matches("[[layer]]").count());
        let before = layers(&self.scene).expect("a scene");
        self.edited();
        assert_eq!(layers(&self.scene), Some(before + 1), "{}", self.scene);
    }

    fn undo(&mut self) {
        let Some(before) = self.past.pop() else { return self.key() };
        self.future.push(std::mem::replace(&mut self.scene, before));
        self.page.key("z", "KeyZ", 90, 2);
    }

    fn redo(&mut self) {
        let Some(after) = self.future.pop() else { return self.drop_way() };
        self.past.push(std::mem::replace(&mut self.scene, after));
        self.page.key("y", "KeyY", 89, 2);
    }

    fn save(&mut self) {
        self.page.key("s", "KeyS", 83, 2);
        self.page.wait("belvedere.application.changed()", |changed| *changed == false);
        self.saved = self.scene.clone();
    }

    /// Another scene is asked for, and the question about the changes is answered with no.
    fn open_and_cancel(&mut self) {
        if self.is_saved() {
            self.key();
        }
        self.page.press("File");
        self.page.press("Built-in scenes");
        self.page.press("Massif, curved rays");
        self.page.press("Cancel");
        self.touch();
    }

    /// The page is loaded again, or left and visited again; it asks if something is in no file.
    fn leave(&mut self, how: &str, may_leave: bool) {
        let asks = !self.is_saved();
        self.page.may_leave = may_leave;
        let goes = may_leave || !asks;
        if how == "reload" {
            self.page.reload(asks);
        } else {
            let asked = self.page.asked + u32::from(asks);
            self.page.call("Page.navigate", json!({ "url": "about:blank" }));
            assert_eq!(self.page.asked, asked, "how often it asked");
            let left = self.page.value("location.href === 'about:blank'");
            assert_eq!(left, goes);
            if goes {
                self.page.call("Page.navigate", json!({ "url": self.address }));
            }
        }
        if goes {
            self.page.wait("window.belvedere?.application.is_drawn() ?? false", |drawn| *drawn == true);
            self.touch();
            // The steps are not kept; the scene is.
            (self.past, self.future) = (Vec::new(), Vec::new());
        }
        self.page.may_leave = true;
    }

    /// A browser lets a page ask only after a press; the picture gets the keyboard.
    fn touch(&mut self) {
        self.page.pointer("mousePressed", [500.0, 300.0]);
        self.page.pointer("mouseReleased", [500.0, 300.0]);
    }
}

#[test]
fn in_thirty_mixed_actions_nothing_is_lost() {
    let Some(application) = application() else { return };
    let place = tempfile::tempdir().expect("folder");
    let Some(mut page) = browser(place.path()) else { return };
    let (scene, way, site) = (place.path().join("s.toml"), place.path().join("way.geojson"), place.path().join("site"));
    std::fs::write(&scene, GROUND).expect("scene");
    std::fs::write(&way, WAY).expect("way");
    pack(&application, &[&scene], &site);
    let address = server::serve(site, false);
    page.call(
        "Browser.setDownloadBehavior",
        json!({ "behavior": "allow", "downloadPath": place.path().join("downloads") }),
    );
    page.call("Page.navigate", json!({ "url": address }));
    times(&mut page, rests);
    page.press("Look");
    page.value("document.getElementById('canvas').focus()");
    let scene = page.value(SCENE);
    let (past, future, way) = (Vec::new(), Vec::new(), way.canonicalize().expect("file"));
    let saved = scene.clone();
    let mut run = Run { page: &mut page, address, way: &way, scene, saved, past, future, random: SEED };
    run.touch();
    // Each kind at least twice, in any order.
    let mut actions: Vec<u32> = (0..ACTIONS).map(|i| i % KINDS).collect();
    (1..ACTIONS).rev().for_each(|i| actions.swap(i as usize, run.draw(i + 1) as usize));
    let mut done = Vec::new();
    for action in actions {
        let began = std::time::Instant::now();
        match action {
            0..=2 => run.key(),
            3 => run.slider(),
            4 => run.drop_way(),
            5 | 6 => run.undo(),
            7 => run.redo(),
            8 => run.save(),
            9 => run.open_and_cancel(),
            10 => run.leave("reload", true),
            11 => run.leave("close", true),
            _ => {
                let how = if run.draw(2) == 0 { "reload" } else { "close" };
                run.leave(how, false);
            }
        }
        run.holds();
        done.push((action, began.elapsed().as_millis()));
    }
    eprintln!("browser: {ACTIONS} actions, 0 lost; each with its milliseconds: {done:?}");
    assert_eq!(page.complaints, Vec::<String>::new());
    assert_eq!(page.value("belvedere.application.failure() ?? null"), Value::Null);
}
