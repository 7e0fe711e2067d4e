//! The application on a web page.

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
    pub async fn start(&self, canvas: HtmlCanvasElement, open: Vec<String>) -> Result<(), JsValue> {
        let opening = Opening {
            files: open.into_iter().map(PathBuf::from).collect(),
            language: Opening::usual_language(),
            ..Opening::default()
        };
        let make: eframe::AppCreator<'static> = Box::new(move |cc| Ok(Box::new(Viewer::new(&cc.egui_ctx, &opening))));
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
