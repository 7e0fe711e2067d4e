//! What a screen reader is told: each control has a role and a name, and no two are called the same.

use crate::layers::alone;
use crate::{app, opened, press, settle};
use belvedere_viewer::{Opening, Viewer};
use eframe::egui::accesskit::Role;
use egui_kittest::Harness;
use egui_kittest::kittest::NodeT;
use std::collections::BTreeSet;
use std::path::{Path, PathBuf};

type Window = Harness<'static, Viewer>;

/// Roles of what a user acts on.
const CONTROLS: [Role; 11] = [
    Role::Button,
    Role::DefaultButton,
    Role::CheckBox,
    Role::RadioButton,
    Role::Slider,
    Role::SpinButton,
    Role::ComboBox,
    Role::TextInput,
    Role::MultilineTextInput,
    Role::ColorWell,
    Role::Link,
];

/// Buttons that each window has in its bar; the name of the window tells which.
const OF_WINDOWS: [&str; 2] = ["Close window", "Hide"];

/// Role and name of each control on the screen.
fn controls(harness: &Window) -> Vec<(Role, String)> {
    let nodes = harness.root().children_recursive().collect::<Vec<_>>();
    let of = |node: &egui_kittest::Node<'_>| {
        let node = node.accesskit_node();
        let role = node.role();
        CONTROLS.contains(&role).then(|| (role, node.label().unwrap_or_default().trim().to_owned()))
    };
    nodes.iter().filter_map(of).collect()
}

/// Notes controls without a name, and those that share role and name.
fn look(harness: &mut Window, place: &str, wrong: &mut BTreeSet<String>) {
    // Headings unfold in a few frames.
    (0..12).for_each(|_| harness.step());
    let all = controls(harness);
    assert!(all.len() > 5, "{place}: {all:?}");
    for (i, (role, name)) in all.iter().enumerate() {
        if name.is_empty() {
            wrong.insert(format!("{place}: a {role:?} without a name after {:?}", i.checked_sub(1).map(|i| &all[i])));
        } else if !OF_WINDOWS.contains(&name.as_str()) && all[..i].contains(&(*role, name.clone())) {
            wrong.insert(format!("{place}: two {role:?} are called {name:?}"));
        }
    }
}

/// A scene of ground, a line, an area and a spline.
fn everything(folder: &Path) -> PathBuf {
    let layer = |kind: &str, id: &str, source: &str| {
        format!("[[layer]]\nkind = \"{kind}\"\nid = \"{id}\"\nsource = \"{source}\"\n")
    };
    let massif = "builtin:massif?seed=7&size=129";
    let layers = [layer("terrain", "ground", massif), layer("line", "trail", massif), layer("area", "lake", massif)];
    let text = format!(
        "format = 1\ntitle = \"All\"\ncrs = \"local\"\n[camera]\neye = [6000.0, -5200.0, 3600.0]\nlook_at = [0.0, 0.0, 300.0]\n\
         image = [64, 36]\n{}[[stage]]\nkind = \"spline_bend\"\npresets = \"progressive\"\n",
        layers.concat()
    );
    let path = folder.join("all.toml");
    std::fs::write(&path, text).expect("scene");
    path
}

#[test]
fn controls_of_all_panels_and_menus_have_names_of_their_own() {
    let folder = tempfile::tempdir().expect("folder");
    let mut wrong = BTreeSet::new();
    let opening = opened(&[everything(folder.path())]);
    // Tall enough for all of a panel, since what is scrolled out of sight is not told.
    let builder = Harness::builder().with_size([640.0, 2400.0]).with_max_steps(4);
    let mut harness = builder.build_eframe(move |cc| Viewer::new(&cc.egui_ctx, &opening));
    settle(&mut harness);
    for layer in ["ground", "trail", "lake"] {
        press(&mut harness, &format!("Style of {layer}"));
        (0..12).for_each(|_| harness.step());
    }
    look(&mut harness, "Layers", &mut wrong);
    for panel in ["Look", "Spline", "Terrain", "Export"] {
        press(&mut harness, panel);
        look(&mut harness, panel, &mut wrong);
    }
    press(&mut harness, "Terrain");
    // No picture is waited for: not all bends go together.
    press(&mut harness, "The ground makes way");
    look(&mut harness, "Terrain that makes way", &mut wrong);
    press(&mut harness, "Curved rays");
    press(&mut harness, "Add a turn");
    look(&mut harness, "Curved rays", &mut wrong);
    press(&mut harness, "Along a path");
    look(&mut harness, "Along a path", &mut wrong);
    for menu in ["File", "Edit", "Places", "View", "Help"] {
        press(&mut harness, menu);
        look(&mut harness, menu, &mut wrong);
        harness.key_press(eframe::egui::Key::Escape);
        harness.step();
    }
    press(&mut harness, "Help");
    press(&mut harness, "Keys and pointer");
    look(&mut harness, "Keys", &mut wrong);
    // The help names the commands of the menus.
    harness.key_press(eframe::egui::Key::F1);
    harness.step();
    press(&mut harness, "File");
    press(&mut harness, "Open…");
    look(&mut harness, "Files", &mut wrong);
    assert!(wrong.is_empty(), "\n{}", wrong.into_iter().collect::<Vec<_>>().join("\n"));
}

#[test]
fn controls_of_molecules_and_volumes_have_names_of_their_own() {
    let folder = tempfile::tempdir().expect("folder");
    let mut wrong = BTreeSet::new();
    for (unit, layer) in [
        ("angstrom", "kind = \"molecule\"\nsource = \"builtin:dna?pairs=2&seed=7\"\nstyle = { color = \"#8090a0\" }\n"),
        ("voxel", "kind = \"volume\"\nsource = \"builtin:engine\"\n"),
    ] {
        let mut harness = app(&opened(&[alone(folder.path(), unit, layer)]));
        settle(&mut harness);
        press(&mut harness, "Style of it");
        look(&mut harness, unit, &mut wrong);
    }
    assert!(wrong.is_empty(), "\n{}", wrong.into_iter().collect::<Vec<_>>().join("\n"));
}

#[test]
fn controls_of_the_welcome_and_of_a_phone_have_names_of_their_own() {
    let mut wrong = BTreeSet::new();
    let mut harness = app(&Opening::default());
    settle(&mut harness);
    look(&mut harness, "Welcome", &mut wrong);
    harness.set_size(eframe::egui::vec2(390.0, 844.0));
    settle(&mut harness);
    look(&mut harness, "Welcome on a phone", &mut wrong);
    assert!(wrong.is_empty(), "\n{}", wrong.into_iter().collect::<Vec<_>>().join("\n"));
}
