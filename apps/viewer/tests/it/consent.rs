//! A scene whose files lie outside its folder.

use crate::{app, opened, press, settle};
use belvedere::Trust;
use belvedere_viewer::Opening;
use eframe::egui::{Key, Modifiers};
use egui_kittest::kittest::Queryable;

#[test]
fn a_scene_whose_files_lie_elsewhere_is_opened_once_the_user_agrees_and_then_always() {
    let folder = tempfile::tempdir().expect("folder");
    ["scenes", "data"].iter().for_each(|name| std::fs::create_dir(folder.path().join(name)).expect("folder"));
    let data = folder.path().join("data/a.obj");
    std::fs::write(&data, "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n").expect("file");
    let path = folder.path().join("scenes/s.toml");
    let text = "format = 1\ntitle = 'From elsewhere'\n[camera]\neye = [0, -4, 1]\nlook_at = [0, 0, 0]\nimage = [64, 48]\n\
        [[layer]]\nid = 'a'\nkind = 'mesh'\nsource = '../data/a.obj'\n";
    std::fs::write(&path, text).expect("scene");
    let trust = Trust::in_file(folder.path().join("settings/trusted.json"));
    let opening = Opening { trust: trust.clone(), ..opened(std::slice::from_ref(&path)) };

    let mut harness = asked(&opening);
    press(&mut harness, "Do not open");
    settle(&mut harness);
    assert!(harness.query_by_label("Do not open").is_none());
    assert_ne!(harness.state().document().title, "From elsewhere");
    assert!(trust.list().is_empty());

    let mut harness = asked(&opening);
    harness.get_by_label(&data.canonicalize().expect("file").display().to_string());
    press(&mut harness, "Allow this file");
    settle(&mut harness);
    assert_eq!(harness.state().document().title, "From elsewhere");
    assert!(harness.query_by_label("Dismiss 1").is_none(), "it is drawn without complaint");
    harness.key_press_modifiers(Modifiers::COMMAND, Key::S);
    (0..2).for_each(|_| harness.step());
    let list = trust.list();
    assert!(list.len() == 1 && list[0].files == [data.canonicalize().expect("file")], "{list:?}");
    let saved = belvedere::scene_file::read(&path).expect("saved").document;
    assert!(format!("{:?}", saved.layer).contains("\"../data/a.obj\""), "{:?}", saved.layer);

    let mut again = app(&opening);
    settle(&mut again);
    assert_eq!(again.state().document().title, "From elsewhere");
}

/// The application when it asks.
fn asked(opening: &Opening) -> egui_kittest::Harness<'static, belvedere_viewer::Viewer> {
    let mut harness = app(opening);
    let began = std::time::Instant::now();
    while harness.query_by_label("Do not open").is_none() {
        assert!(began.elapsed() < crate::PATIENCE, "no question");
        harness.step();
        std::thread::sleep(std::time::Duration::from_millis(5));
    }
    harness.step(); // A new window is measured before it is shown.
    harness
}
