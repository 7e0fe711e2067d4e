//! The native window.

use crate::{Opening, Viewer};
use eframe::egui::ViewportBuilder;

/// A window that cannot be opened.
#[derive(Debug, thiserror::Error)]
#[error("no window can be opened: {reason}; on a machine without a display use render, reveal or pack")]
pub struct WindowError {
    reason: String,
}

/// Opens the window and returns when it is closed.
///
/// # Errors
/// [`WindowError`] where there is no display, or no OpenGL on it.
pub fn run(opening: &Opening) -> Result<(), WindowError> {
    let viewport = ViewportBuilder::default()
        .with_title("Belvedere")
        .with_app_id("belvedere")
        .with_inner_size([1440.0, 860.0])
        .with_drag_and_drop(true);
    let options = eframe::NativeOptions { viewport, ..eframe::NativeOptions::default() };
    let opening = opening.clone();
    let make: eframe::AppCreator<'_> = Box::new(move |cc| Ok(Box::new(Viewer::new(&cc.egui_ctx, &opening))));
    eframe::run_native("belvedere", options, make).map_err(|e| WindowError { reason: e.to_string() })
}
