//! Wakes the window from other threads.

use eframe::egui::Context;
#[cfg(target_family = "wasm")]
use std::sync::atomic::{AtomicBool, Ordering};

/// On a web page with threads: whether a frame was requested.
#[cfg(target_family = "wasm")]
static NEWS: AtomicBool = AtomicBool::new(false);

/// Asks for the next frame of the window.
#[derive(Debug, Clone)]
pub(crate) struct Wake(Context);

impl Wake {
    pub(crate) fn new(ctx: &Context) -> Self {
        Self(ctx.clone())
    }

    /// Requests a frame; callable from any thread.
    pub(crate) fn call(&self) {
        // Web workers cannot reach the window: the page polls this flag.
        #[cfg(all(target_family = "wasm", target_feature = "atomics"))]
        NEWS.store(true, Ordering::Release);
        #[cfg(all(target_family = "wasm", not(target_feature = "atomics")))]
        self.now();
        #[cfg(not(target_family = "wasm"))]
        self.0.request_repaint();
    }

    /// Requests a frame; on the page's own thread only.
    #[cfg(target_family = "wasm")]
    pub(crate) fn now(&self) {
        self.0.request_repaint();
        crate::browser::page::call("wake", &[]);
    }

    /// Requests a frame if a worker has asked for one; the page calls this often.
    #[cfg(target_family = "wasm")]
    pub(crate) fn pass_on(&self) {
        if NEWS.swap(false, Ordering::AcqRel) {
            self.now();
        }
    }
}
