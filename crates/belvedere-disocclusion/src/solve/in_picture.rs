//! What the picture shows.

use belvedere_core::{DVec3, View};

/// Points this share of the picture beside it still count, so that what moves into it is worked for.
const BESIDE: f64 = 0.05;

/// Whether a bent picture shows a place, its margin included; the height does not count, for the ground moves.
pub(super) fn nearly_holds(view: &View, p: DVec3) -> bool {
    let Ok(image) = view.project(p) else { return false };
    let [width, height] = view.pinhole().image.map(f64::from);
    let inside = |x: f64, size: f64, beside: f64| (-beside * size..=(1.0 + beside) * size).contains(&x);
    image.depth >= view.pinhole().near && inside(image.pixel.x, width, BESIDE) && inside(image.pixel.y, height, 1.0)
}

/// Whether a place lies in the picture as it is.
pub(super) fn holds(view: &View, p: DVec3) -> bool {
    view.project(p).is_ok_and(|image| image.depth >= view.pinhole().near && view.pinhole().contains(image.pixel))
}
