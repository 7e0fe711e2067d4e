//! Tests whether a point lies in the picture.

use belvedere_core::{DVec3, View};

/// Margin beside the picture within which points still count, share of its width.
const BESIDE: f64 = 0.05;

/// Whether a bent picture shows a point, with that margin at its sides and its whole height above and below, for the ground moves.
pub(super) fn nearly_holds(view: &View, p: DVec3) -> bool {
    let Ok(image) = view.project(p) else { return false };
    let [width, height] = view.pinhole().image.map(f64::from);
    let inside = |x: f64, size: f64, beside: f64| (-beside * size..=(1.0 + beside) * size).contains(&x);
    image.depth >= view.pinhole().near && inside(image.pixel.x, width, BESIDE) && inside(image.pixel.y, height, 1.0)
}

/// Whether a point lies in the picture, without a margin.
pub(super) fn holds(view: &View, p: DVec3) -> bool {
    view.project(p).is_ok_and(|image| image.depth >= view.pinhole().near && view.pinhole().contains(image.pixel))
}

#[cfg(test)]
mod tests {
    use super::*;
    use belvedere_core::{DVec2, Pinhole, Projection};

    #[test]
    fn the_margin_is_as_wide_on_both_sides_and_as_high_above_as_below() {
        let lens = Projection::Perspective { fov_y: 0.6 };
        let eye = Pinhole::look_at(DVec3::ZERO, DVec3::Y, DVec3::Z, lens, [400, 200], 1.0, None).expect("a camera");
        let view = View::straight(eye.clone());
        let held = |x: f64, y: f64| nearly_holds(&view, eye.unproject(DVec2::new(x, y), 50.0));
        let beside = BESIDE * 400.0;
        for (x, y, inside) in [
            (-0.9 * beside, 100.0, true),
            (400.0 + 0.9 * beside, 100.0, true),
            (-1.1 * beside, 100.0, false),
            (400.0 + 1.1 * beside, 100.0, false),
            (200.0, -190.0, true),
            (200.0, 390.0, true),
            (200.0, -210.0, false),
            (200.0, 410.0, false),
        ] {
            assert_eq!(held(x, y), inside, "pixel {x}, {y}");
        }
    }
}
