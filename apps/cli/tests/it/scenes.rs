//! Ready scenes, the schema, and `show`, whose output opens to the same view.

use super::{BARE, Place};

fn scenes() -> Vec<std::path::PathBuf> {
    let folder = belvedere_testkit::workspace_root().join("scenes");
    let mut found: Vec<_> = std::fs::read_dir(folder)
        .expect("folder of scenes")
        .map(|e| e.expect("entry").path())
        .filter(|p| p.extension().is_some_and(|e| e == "toml"))
        .collect();
    found.sort();
    found
}

#[test]
fn every_ready_scene_opens() {
    let found = scenes();
    assert!(found.len() >= 8, "{found:?}");
    for scene in found {
        let text = std::fs::read_to_string(&scene).expect("scene");
        let scene = scene.to_str().expect("UTF-8");
        let place = Place::new();
        if text.contains("builtin:") {
            place.ok(&["check", scene]);
        } else if let Some(readme) = belvedere_testkit::data("README.md") {
            let root = readme.parent().and_then(|p| p.to_str()).expect("folder");
            place.ok(&["check", scene, "--allow-root", root]);
        }
    }
}

#[test]
fn the_committed_schema_is_fresh() {
    let committed = belvedere_testkit::workspace_root().join("docs/scene.schema.json");
    let fresh = Place::new().ok(&["schema"]);
    let committed = std::fs::read_to_string(committed).unwrap_or_default();
    assert!(committed == fresh, "run: belvedere schema -o docs/scene.schema.json --overwrite");
}

#[test]
fn shown_scenes_open_to_the_same_view() {
    let camera = BARE.replace("look_at = [0.0, 1.0, 0.0]", "heading_deg = 30\npitch_deg = 12.5");
    let spline = "[[stage]]\nkind = 'spline_bend'\npresets = 'demo'\nplane = { height_m = -200 }\n";
    let rays = "[[stage]]\nkind = 'curved_rays'\n[[stage.turn]]\nviewpoint = [-70, 20, 3]\nt0 = [500, 866, -200]\nt1 = [600, 1039, -230]\nt2 = [700, 1212, -270]\nnormal = [0.5, 0.866, -0.2]\nm = 'mid'\n";
    let split = "[[stage]]\nkind = 'curved_rays'\n[[stage.split.left.turn]]\nviewpoint = [-70, 20, 3]\nt0 = [500, 866, -200]\nt1 = [600, 1039, -230]\nt2 = [700, 1212, -270]\nnormal = [0.5, 0.866, -0.2]\n[[stage.split.right.turn]]\nviewpoint = [70, -20, 3]\nt0 = [500, 866, -200]\nt1 = [600, 1039, -230]\nt2 = [700, 1212, -270]\nnormal = [0.5, 0.866, -0.2]\n";
    let massif = "[[layer]]\nid = 'g'\nkind = 'terrain'\nsource = 'builtin:massif?size=65'\n";
    let standing = BARE.replace("eye = [0.0, 0.0, 0.0]", "eye = { x = 100, y = 200, above_ground_m = 300 }");
    for scene in [
        format!("{camera}{spline}"),
        format!("{camera}{rays}"),
        format!("{camera}{split}"),
        format!("{camera}{spline}{split}"),
        format!("{camera}{spline}{rays}"),
        format!("{standing}{massif}[[stage]]\nkind = 'spline_bend'\npresets = 'progressive'\n"),
        format!("earth = 'curved'\n{camera}{rays}"),
    ] {
        let place = Place::new();
        place.write("s.toml", &scene);
        place.write("p.json", "[[400, 700, -200], [900, 1500, 100], [3000, 4000, 50]]");
        place.ok(&["show", "s.toml", "-o", "shown.toml"]);
        place.ok(&["show", "s.toml", "-o", "shown.json"]);
        let project = |scene: &str| place.ok(&["project", scene, "--points", "p.json"]);
        assert_eq!(project("s.toml"), project("shown.toml"), "{scene}");
        assert_eq!(project("s.toml"), project("shown.json"), "{scene}");
        assert_eq!(place.ok(&["show", "shown.toml"]), place.ok(&["show", "s.toml"]), "{scene}");
    }
}
