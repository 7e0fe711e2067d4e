//! Controls of our own: each shows a value and returns the user's edit.

pub(crate) mod curve;
pub(crate) mod overhead;
pub(crate) mod ruler;
pub(crate) mod strip;

use eframe::egui::{AsIdSalt, EventFilter, Key, Response, Ui, UiBuilder};

/// Steps of the arrow keys, right and up, on a handle that has the focus, which a click gives it.
pub(crate) fn nudged(ui: &Ui, response: &Response) -> Option<[f64; 2]> {
    if response.clicked() {
        response.request_focus();
    }
    if !response.has_focus() {
        return None;
    }
    // The arrow keys move the handle and not the focus.
    let filter = EventFilter { horizontal_arrows: true, vertical_arrows: true, ..EventFilter::default() };
    ui.memory_mut(|memory| memory.set_focus_lock_filter(response.id, filter));
    let keys = [
        (Key::ArrowLeft, [-1.0, 0.0]),
        (Key::ArrowRight, [1.0, 0.0]),
        (Key::ArrowUp, [0.0, 1.0]),
        (Key::ArrowDown, [0.0, -1.0]),
    ];
    ui.input(|input| keys.into_iter().find(|(key, _)| input.key_pressed(*key)).map(|(_, step)| step))
}

/// A part of a panel whose controls keep their identities whatever appears or vanishes above it, and with them focus and clicks under way.
///
/// * `salt`: unique within the parent.
pub(crate) fn steady<R>(ui: &mut Ui, salt: impl AsIdSalt, add: impl FnOnce(&mut Ui) -> R) -> R {
    let scope_id = ui.scope_id().with(("steady", salt));
    ui.scope_builder(UiBuilder::new().scope_id(scope_id), add).inner
}
