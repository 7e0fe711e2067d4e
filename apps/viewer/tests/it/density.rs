//! On a screen with more pixels per point, what is drawn in the picture is as large as on any other.

use crate::screen::Screen;
use crate::{opened, scene, settle};
use belvedere_viewer::Viewer;
use egui_kittest::Harness;

/// Width of the red trail in the window's picture, pixels: the median over its rows.
fn width_of_trail(pixels_per_point: f32) -> f64 {
    let folder = tempfile::tempdir().expect("folder");
    let opening = opened(&[scene(folder.path())]);
    let builder =
        Harness::builder().with_size([420.0, 300.0]).with_pixels_per_point(pixels_per_point).with_max_steps(4);
    let mut harness = builder.renderer(Screen::default()).build_eframe(move |cc| Viewer::new(&cc.egui_ctx, &opening));
    settle(&mut harness);
    let image = harness.render().expect("rendered");
    // At its rims the trail covers pixels in part.
    let covered = |pixel: &image::Rgba<u8>| (f64::from(pixel[0]) - f64::from(pixel[1])) / 167.0;
    let width = |row: image::buffer::Pixels<'_, image::Rgba<u8>>| row.map(covered).filter(|share| *share > 0.25).sum();
    let mut widths: Vec<f64> = image.rows().map(width).filter(|width| *width > 0.0).collect();
    assert!(widths.len() > 30, "no trail: {widths:?}");
    widths.sort_by(f64::total_cmp);
    widths[widths.len() / 2]
}

#[test]
fn a_line_is_twice_as_many_pixels_wide_on_a_screen_of_twice_the_density() {
    let (once, twice) = (width_of_trail(1.0), width_of_trail(2.0));
    let factor = twice / once;
    assert!((1.7..=2.4).contains(&factor), "{once:.1} and {twice:.1} pixels");
}
