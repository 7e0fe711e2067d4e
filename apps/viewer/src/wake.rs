//! The window is told from elsewhere that there is something new.

use eframe::egui::Context;
#[cfg(target_family = "wasm")]
use std::sync::atomic::{AtomicBool, Ordering};

/// On a web page with threads: whether there is something new.
#[cfg(target_family = "wasm")]
static NEWS: AtomicBool = AtomicBool::new(false);

/// Asks for the next frame of the window.
#[derive(Debug, Clone)]
pub(crate) struct Wake(Context);

impl Wake {
    pub(crate) fn new(ctx: &Context) -> Self {
        Self(ctx.clone())
    }

    /// From any thread.
    pub(crate) fn call(&self) {
        // Workers of a page have no part in its window: the page asks them.
        #[cfg(all(target_family = "wasm", target_feature = "atomics"))]
        NEWS.store(true, Ordering::Release);
        #[cfg(not(all(target_family = "wasm", target_feature = "atomics")))]
        self.0.request_repaint();
    }

    /// From the page, often.
    #[cfg(target_family = "wasm")]
    pub(crate) fn pass_on(&self) {
        if NEWS.swap(false, Ordering::AcqRel) {
            self.0.request_repaint();
        }
    }
}
