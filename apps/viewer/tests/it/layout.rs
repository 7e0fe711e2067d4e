//! How much of the window the picture gets, on screens of any shape.

use crate::{opened, press, scene};
use belvedere_viewer::{Opening, Viewer};
use egui_kittest::Harness;
use egui_kittest::kittest::Queryable;

fn sized(opening: &Opening, size: [f32; 2]) -> Harness<'static, Viewer> {
    let opening = opening.clone();
    let builder = Harness::builder().with_size(size).with_max_steps(4);
    let mut harness = builder.build_eframe(move |cc| Viewer::new(&cc.egui_ctx, &opening));
    crate::settle(&mut harness);
    harness
}

#[test]
fn the_picture_fills_what_the_panel_leaves() {
    let folder = tempfile::tempdir().expect("folder");
    let opening = opened(&[scene(folder.path())]);
    for (size, least) in [([800.0, 600.0], 0.6), ([1200.0, 760.0], 0.6), ([1920.0, 500.0], 0.6), ([640.0, 1000.0], 0.6)]
    {
        let mut harness = sized(&opening, size);
        let share = |harness: &Harness<'_, Viewer>| harness.get_by_label("Picture").rect().area() / (size[0] * size[1]);
        let with_panel = share(&harness);
        assert!(with_panel >= least, "{size:?}: {with_panel}");
        press(&mut harness, "Panel");
        assert!(share(&harness) > 0.94, "{size:?}: {}", share(&harness));
    }
}

#[test]
fn on_a_phone_the_picture_fills_the_screen_and_the_panel_is_a_sheet() {
    let folder = tempfile::tempdir().expect("folder");
    let mut harness = sized(&opened(&[scene(folder.path())]), [390.0, 844.0]);
    let picture = harness.get_by_label("Picture").rect();
    assert_eq!(picture.size(), eframe::egui::vec2(390.0, 844.0));
    assert!(harness.query_by_label("Curved rays").is_none(), "the panel is folded");
    press(&mut harness, "Show the panel");
    harness.step();
    let sheet = harness.get_by_label("Curved rays").rect();
    assert!(sheet.top() > 400.0 && sheet.bottom() < 844.0, "{sheet:?}");
    assert_eq!(harness.get_by_label("Picture").rect(), picture, "the picture keeps its size");
    press(&mut harness, "Hide the panel");
    assert!(harness.query_by_label("Curved rays").is_none());
}
