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

    /// Gives it a file; before it starts.
    pub fn put(&self, path: &str, bytes: Vec<u8>) -> Result<(), JsValue> {
        fs::write(path, bytes).map_err(|e| e.to_string().into())
    }

    /// Puts it on the page.
    ///
    /// * `open`: names of the files to open; empty = the first built-in scene.
    pub async fn start(&self, canvas: HtmlCanvasElement, open: Vec<String>) -> Result<(), JsValue> {
        let opening = Opening { files: open.into_iter().map(PathBuf::from).collect(), ..Opening::default() };
        let make: eframe::AppCreator<'static> = Box::new(move |cc| Ok(Box::new(Viewer::new(&cc.egui_ctx, &opening))));
        self.runner.start(canvas, eframe::WebOptions::default(), make).await
    }

    /// Shows what its workers have made; to be called often where there are some.
    pub fn attend(&self) {
        if let Some(viewer) = self.runner.app_mut::<Viewer>() {
            viewer.wake().pass_on();
        }
    }

    /// What it has drawn and how long that took, as JSON; for whoever measures.
    pub fn times(&self) -> Option<String> {
        self.runner.app_mut::<Viewer>().map(|viewer| viewer.times().to_string())
    }

    /// The scene as it is, as the text of a scene file.
    pub fn scene(&self) -> Option<String> {
        let viewer = self.runner.app_mut::<Viewer>()?;
        belvedere::output::document_toml(viewer.document()).ok()
    }

    /// What went wrong so badly that it stands still.
    pub fn failure(&self) -> Option<String> {
        self.runner.panic_summary().map(|summary| summary.message())
    }
}

impl Default for Application {
    fn default() -> Self {
        Self::new()
    }
}
