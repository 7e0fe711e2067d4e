//! The application on a web page.

pub(crate) mod page;

use crate::mirror::{self, Mirror};
use crate::{Opening, Viewer};
use belvedere::io::fs;
use std::path::PathBuf;
use wasm_bindgen::prelude::{JsValue, wasm_bindgen};
use web_sys::HtmlCanvasElement;

/// The application on a canvas.
#[wasm_bindgen]
pub struct Application {
    runner: eframe::WebRunner,
}

#[wasm_bindgen]
impl Application {
    /// An application that is not on the page yet.
    #[wasm_bindgen(constructor)]
    pub fn new() -> Self {
        Self { runner: eframe::WebRunner::new() }
    }

    /// Writes a file into the memory file system; to be called before the start.
    pub fn put(&self, path: &str, bytes: Vec<u8>) -> Result<(), JsValue> {
        fs::write(path, bytes).map_err(|e| e.to_string().into())
    }

    /// Starts the application on a canvas of the page.
    ///
    /// * `open`: names of the files to open; empty = the first built-in scene.
    /// * `left`: what [`Application::left`] gave before; its scene comes instead, if its files are there.
    pub async fn start(
        &self,
        canvas: HtmlCanvasElement,
        open: Vec<String>,
        left: Option<String>,
    ) -> Result<(), JsValue> {
        let opening = Opening {
            files: open.into_iter().map(PathBuf::from).collect(),
            left,
            language: Opening::usual_language(),
            ..Opening::default()
        };
        let make: eframe::AppCreator<'static> = Box::new(move |cc| {
            cc.egui_ctx.enable_accesskit();
            let tell = |update: &str| drop(page::call("mirror", &[&update.into()]));
            let rest = |time: f64| drop(page::call("rest_for", &[&time.into()]));
            cc.egui_ctx.add_plugin(Mirror::new(tell, rest));
            Ok(Box::new(Viewer::new(&cc.egui_ctx, &opening)))
        });
        self.runner.start(canvas, eframe::WebOptions::default(), make).await
    }

    /// Requests a frame if the workers have made something new; to be called often where there are workers.
    pub fn attend(&self) {
        if let Some(viewer) = self.runner.app_mut::<Viewer>() {
            viewer.wake().pass_on();
        }
    }

    /// Numbers of pictures and their times as JSON, for measurements.
    pub fn times(&self) -> Option<String> {
        self.runner.app_mut::<Viewer>().map(|viewer| viewer.times().to_string())
    }

    /// Whether there is a picture.
    pub fn is_drawn(&self) -> bool {
        self.runner.app_mut::<Viewer>().is_some_and(|viewer| viewer.is_drawn())
    }

    /// State of the scene and the window as text, to be given to the next start; `None` if it is the same as at the last call.
    pub fn left(&self) -> Option<String> {
        self.runner.app_mut::<Viewer>()?.left()
    }

    /// Number of scenes that came in place of others; `None` while one is on its way.
    pub fn scene_number(&self) -> Option<u32> {
        self.runner.app_mut::<Viewer>()?.scene_number()
    }

    /// Names of the files that the scene reads.
    pub fn needs(&self) -> Vec<String> {
        let files = self.runner.app_mut::<Viewer>().map(|viewer| viewer.needs()).unwrap_or_default();
        files.into_iter().filter_map(|file| file.into_os_string().into_string().ok()).collect()
    }

    /// Says that the browser did not keep a file: there is no room for it, or it refuses.
    pub fn not_kept(&self, is_full: bool) {
        if let Some(mut viewer) = self.runner.app_mut::<Viewer>() {
            viewer.tell_not_kept(is_full);
            viewer.wake().now();
        }
    }

    /// Says that the browser did not keep the scene: there is no room for it, or it refuses.
    pub fn not_remembered(&self, is_full: bool) {
        if let Some(mut viewer) = self.runner.app_mut::<Viewer>() {
            viewer.tell_not_remembered(is_full);
            viewer.wake().now();
        }
    }

    /// Asks an element of the tree of accessibility for an action.
    ///
    /// * `id`: of the element. `action`: `click`, `focus`, `text` or `number`; the last two set a value.
    pub fn act(&self, id: &str, action: &str, text: Option<String>, number: Option<f64>) {
        if let Some(viewer) = self.runner.app_mut::<Viewer>()
            && mirror::ask(id, action, text, number).is_some()
        {
            viewer.wake().now();
        }
    }

    /// The current scene as the text of a scene file.
    pub fn scene(&self) -> Option<String> {
        let viewer = self.runner.app_mut::<Viewer>()?;
        belvedere::output::document_toml(viewer.document()).ok()
    }

    /// Whether the scene has changes that are in no file.
    pub fn changed(&self) -> bool {
        self.runner.app_mut::<Viewer>().is_some_and(|viewer| viewer.is_changed())
    }

    /// The view as the end of the page's address.
    pub fn view(&self) -> Option<String> {
        self.runner.app_mut::<Viewer>()?.view()
    }

    /// Shows the view of an address; nothing happens if it names none.
    pub fn go(&self, address: &str) {
        if let Some(mut viewer) = self.runner.app_mut::<Viewer>() {
            viewer.go(address);
        }
    }

    /// Message of the panic that stopped the application.
    pub fn failure(&self) -> Option<String> {
        self.runner.panic_summary().map(|summary| summary.message())
    }
}

impl Default for Application {
    fn default() -> Self {
        Self::new()
    }
}
