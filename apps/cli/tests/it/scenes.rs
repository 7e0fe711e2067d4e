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
        } else if text.contains("terrain_disocclusion") {
            // Minutes of solving: `terrain::andorra_is_shown_with_a_progressive_bend_and_terrain` opens one, and the facade's comparison
            // of its renderers opens all on a coarser grid.
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
    let page = Place::new().ok(&["schema", "keys"]);
    let committed =
        std::fs::read_to_string(belvedere_testkit::workspace_root().join("docs/scene-keys.md")).expect("a page");
    assert!(committed == page, "run: belvedere schema keys -o docs/scene-keys.md --overwrite");
    assert!(page.contains("| `fov_y_deg` | number |") && page.contains("`kind = \"spline_bend\"`"));
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
        // A scene that names a preset by its angle is warned about where its numbers alone are not.
        let project = |scene: &str| place.json(&["project", scene, "--points", "p.json"])["points"].clone();
        assert_eq!(project("s.toml"), project("shown.toml"), "{scene}");
        assert_eq!(project("s.toml"), project("shown.json"), "{scene}");
        assert_eq!(place.ok(&["show", "shown.toml"]), place.ok(&["show", "s.toml"]), "{scene}");
    }
}

#[test]
fn sections_show_representations_and_unknown_ones_are_named() {
    let scene = |sections: &str| {
        format!(
            "{}[representations]\ntown = ['towers']\n[[layer]]\nid = 'towers'\nkind = 'boxes'\nboxes = [{{ base = [0, 400, 0], size = [40, 40, 60] }}]\n\
             [[layer]]\nid = 'far'\nkind = 'boxes'\nboxes = [{{ base = [0, 900, 0], size = [200, 40, 60] }}]\n\
             [[stage]]\nkind = 'spline_bend'\nplane = {{ height_m = 0 }}\n[stage.presets]\nversion = 1\n[[stage.presets.presets]]\nphi = 0\ns = 100\ne = 1100\n\
             control = [[0, 0], [0.3, 0], [0.6, 0], [1, 0]]\ntags = [{{ u = 0.5 }}]\nsections = {sections}\n",
            BARE.replace("eye = [0.0, 0.0, 0.0]", "eye = [0.0, 0.0, 90.0]")
                .replace("look_at = [0.0, 1.0, 0.0]", "look_at = [0, 500, 40]")
        )
    };
    let seen = |sections: &str| {
        let place = Place::new();
        place.write("s.toml", &scene(sections));
        place.write("p.json", "[[640, 300], [560, 330]]");
        let _ = place.ok(&["render", "s.toml", "-o", "a.png", "--size", "160x90", "--thresholds", "1"]);
        let picked = place.json(&["pick", "s.toml", "--pixels", "p.json"]);
        [0, 1].map(|i| picked["pixels"][i]["layer"].as_str().unwrap_or("-").to_owned())
    };
    // A section may name a representation or a layer.
    assert_eq!(seen("['town', 'far']"), ["towers", "far"]);
    assert_eq!(seen("['far', 'town']"), ["-", "-"]);
    let place = Place::new();
    place.write("s.toml", &scene("['town', 'farr']"));
    let line = place.fails(&["check", "s.toml"]);
    assert!(
        line.contains("section \"farr\" is neither a representation nor a layer") && line.contains("\"far\"?"),
        "{line}"
    );
    place.write("s.toml", &scene("['town', 'far']").replace("['towers']", "['tower']"));
    let line = place.fails(&["check", "s.toml"]);
    assert!(line.contains("representation \"town\": there is no layer \"tower\"; did you mean \"towers\"?"), "{line}");
}

#[test]
fn relief_lies_flat_behind_the_transition_of_its_tag() {
    let place = Place::new();
    let scene = belvedere_testkit::workspace_root().join("scenes/canyon_map.toml");
    // Pairs of places 100 m one over the other: before, within and behind the transition.
    place.write(
        "p.json",
        "[[0, -4500, 100], [0, -4500, 200], [50, -2000, 100], [50, -2000, 200], [0, 6000, 100], [0, 6000, 200]]",
    );
    let out = place.ok(&["displace", scene.to_str().expect("UTF-8"), "--points", "p.json"]);
    let out: serde_json::Value = serde_json::from_str(&out).expect("JSON");
    let at = |i: usize| -> Vec<f64> {
        let point = out["points"][i]["displaced"].as_array().expect("three numbers");
        point.iter().map(|v| v.as_f64().expect("a number")).collect()
    };
    let apart = |i: usize| at(i).iter().zip(at(i + 1)).map(|(a, b)| (a - b).powi(2)).sum::<f64>().sqrt();
    assert!((apart(0) - 100.0).abs() < 1e-6, "{}", apart(0));
    assert!((20.0..80.0).contains(&apart(2)), "{}", apart(2));
    assert!((apart(4) - 1.0).abs() < 1e-6, "{}", apart(4));
}

#[test]
fn pictures_of_sections_are_those_of_the_library_and_of_the_application() {
    let place = Place::new();
    let scene = belvedere_testkit::workspace_root().join("scenes/town_sections.toml");
    place.ok(&["render", scene.to_str().expect("UTF-8"), "-o", "town.png", "--size", "160x90"]);
    let options = belvedere::OpenOptions { image: Some([160, 90]), ..belvedere::OpenOptions::default() };
    let session = belvedere::Session::open(&scene, &options).expect("scene");
    let picture = session.render(&belvedere::PictureOptions::default()).expect("picture");
    picture.write(&place.path("library.png"), false).expect("written");
    let [written, drawn] =
        ["town.png", "library.png"].map(|name| super::light_and_tints::pixels(&super::read(&place.path(name))));
    assert!(drawn == written, "another picture");
}
