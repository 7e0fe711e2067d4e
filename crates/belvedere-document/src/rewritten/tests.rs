use super::{is_json, rewritten};
use crate::{CameraDoc, ConstructorDoc, ConstructorKind, Document, LayerDoc, LightDoc, PointDoc, StageDoc};
use std::path::Path;

fn read(text: &str) -> Document {
    crate::parse(Path::new("scene"), text).expect("a scene").document
}

/// The text after an edit; it states the edited document.
fn edited(text: &str, change: impl FnOnce(&mut Document)) -> String {
    let mut document = read(text);
    change(&mut document);
    let new = rewritten(text, &document).expect("a text");
    assert_eq!(read(&new), document);
    new
}

/// A drag: the camera is stated by coordinates.
fn drag(document: &mut Document) {
    let camera = &mut document.camera;
    (camera.eye, camera.look_at) =
        (PointDoc::Scene([10.5, -5200.0, 3600.0]), Some(PointDoc::Scene([0.0, 1.25, 300.0])));
    (camera.heading_deg, camera.pitch_deg) = (None, None);
}

const COMMENTED: &str = r##"# My own note: must stay.
format = 1
title = "Hill"   # and this one

# The camera of 2021.
[camera] # by hand
eye = [0, -5_200.0, 3.6e3] # on the ridge
look_at = [
    0.0, # x
    0.0, # y
    300.0,
]
near = 1.0

[[layer]] # the ground
kind = "terrain"
id = 'ground'
source = "builtin:massif?seed=7&size=129"

# The path home
[[layer]]
id = "trail" # as on the map
kind = "line"
source = "builtin:massif?seed=7&size=129"
style = { color = "#102030", width_px = 2 } # thin

# The end.
"##;

#[test]
fn only_the_edited_values_change_and_every_other_byte_stays() {
    let text = COMMENTED;
    assert_eq!(edited(text, |_| ()), text, "nothing was edited");
    assert_eq!(edited(text, |d| d.title = "Berg \"1\"".into()), text.replace("\"Hill\"", "'Berg \"1\"'"));
    let moved =
        text.replace("[0, -5_200.0, 3.6e3]", "[10.5, -5_200.0, 3.6e3]").replace("    0.0, # y", "    1.25, # y");
    assert_eq!(edited(text, drag), moved);
    let styled = |d: &mut Document| {
        if let LayerDoc::Line(line) = &mut d.layer[1] {
            line.style.color = "#405060".into();
        }
    };
    assert_eq!(edited(text, styled), text.replace("#102030", "#405060"));
    let sized = edited(text, |d| d.camera.image = [640, 480]);
    assert_eq!(sized, text.replace("near = 1.0\n", "near = 1.0\nimage = [640, 480]\n"));
}

#[test]
fn comments_stay_where_keys_and_layers_come_and_go() {
    let text = "# top\nformat = 1\n[camera]\neye = [0, 0, 10] # here\n# to the north\nheading_deg = 0 # exactly\npitch_deg = 10\n# a town\n[[layer]]\nkind = 'mesh'\nid = 'a'\nsource = 'a.obj' # old\n# a church\n[[layer]]\nkind = 'mesh'\nid = 'b'\nsource = 'b.obj'\n[layer.style] # its look\ncolor = '#112233'\n# end\n";
    let moved = edited(text, drag);
    let lines = ["# top", "# to the north", "# exactly", "# a town", "# a church", "# end"];
    assert!(lines.iter().all(|line| moved.lines().any(|other| other == *line)), "{moved}");
    assert!(moved.contains("eye = [10.5, -5200.0, 3600.0] # here\n"), "{moved}");
    let swapped = edited(text, |d| d.layer.swap(0, 1));
    let order =
        ["# a church", "id = 'b'", "[layer.style] # its look", "color", "# a town", "id = 'a'", "# old", "# end"];
    let at: Vec<usize> = order.iter().map(|words| swapped.find(words).expect(words)).collect();
    assert!(at.is_sorted(), "{swapped}");
    assert_eq!(edited(&swapped, |d| d.layer.swap(0, 1)), text, "back again");
    let fewer = edited(text, |d| drop(d.layer.remove(0)));
    assert!(fewer.contains("# a church\n[[layer]]\nkind = 'mesh'\nid = 'b'") && !fewer.contains("a.obj"), "{fewer}");
    let more = edited(text, |d| d.light = Some(LightDoc { shadows: true, ..LightDoc::default() }));
    assert!(more.starts_with(text.trim_end_matches("# end\n")) && more.contains("[light]\nshadows = true\n"), "{more}");
    let first = edited("# only\n[camera]\neye = [0, 0, 1]\nlook_at = [0, 1, 0]\n", |d| d.title = "t".into());
    assert!(first.contains("title = \"t\"\n") && first.contains("# only\n[camera]\n"), "{first}");
}

#[test]
fn line_ends_and_byte_order_marks_stay() {
    let text = format!("\u{feff}{}", COMMENTED.replace('\n', "\r\n"));
    let new = edited_marked(&text, |d| d.camera.image = [640, 480]);
    assert_eq!(new, text.replace("near = 1.0\r\n", "near = 1.0\r\nimage = [640, 480]\r\n"));
}

/// As [`edited`], of a text with a byte order mark.
fn edited_marked(text: &str, change: impl FnOnce(&mut Document)) -> String {
    let mut document = read(text.trim_start_matches('\u{feff}'));
    change(&mut document);
    rewritten(text, &document).expect("a text")
}

#[test]
fn json_keeps_its_order_and_whatever_was_not_edited() {
    let text = "{\n    \"camera\": { \"look_at\": [0, 0, 3e2], \"eye\": [0.0, -5200, 3600] },\n    \"title\" : \"H\\u00fcgel\",\n    \"layer\": [\n        {\"id\": \"a\", \"kind\": \"mesh\", \"source\": \"a.obj\"},\n        {\"kind\": \"mesh\", \"id\": \"b\", \"source\": \"b.obj\"}\n    ],\n    \"format\": 1\n}\n";
    assert!(is_json(text));
    assert_eq!(edited(text, |_| ()), text);
    assert_eq!(edited(text, |d| d.title = "Berg".into()), text.replace("\"H\\u00fcgel\"", "\"Berg\""));
    let moved = text.replace("[0.0, -5200,", "[10.5, -5200,").replace("[0, 0, 3e2]", "[0, 1.25, 3e2]");
    assert_eq!(edited(text, drag), moved);
    let sized = edited(text, |d| d.camera.image = [640, 480]);
    assert_eq!(sized, text.replace("3600] }", "3600], \"image\": [640, 480] }"));
    let swapped = edited(text, |d| d.layer.swap(0, 1));
    assert!(swapped.find("\"b.obj\"") < swapped.find("\"a.obj\""), "{swapped}");
    assert_eq!(edited(&swapped, |d| d.layer.swap(0, 1)), text, "back again");
    let fewer = edited(text, |d| drop(d.layer.remove(1)));
    assert_eq!(fewer, text.replace(",\n        {\"kind\": \"mesh\", \"id\": \"b\", \"source\": \"b.obj\"}", ""));
    let lit = edited(text, |d| d.light = Some(LightDoc { shadows: true, ..LightDoc::default() }));
    assert_eq!(
        lit,
        text.replace("\"format\": 1\n", "\"format\": 1,\n    \"light\": {\n      \"shadows\": true\n    }\n")
    );
}

/// Edits as the window makes them, and the keys that they may touch.
type Edit = (&'static str, fn(&mut Document), &'static [&'static str]);

const CAMERA: &[&str] = &[
    "eye",
    "look_at",
    "heading_deg",
    "pitch_deg",
    "x",
    "y",
    "lon",
    "lat",
    "height_m",
    "above_ground_m",
    "[camera.eye]",
    "[camera.look_at]",
];

const EDITS: [Edit; 9] = [
    ("drag", drag, CAMERA),
    ("title", |d| d.title = "Another title".into(), &["title"]),
    ("size", |d| d.camera.image = [333, 187], &["image"]),
    (
        "light",
        |d| d.light = Some(LightDoc { azimuth_deg: Some(12.5), ..d.light.clone().unwrap_or_default() }),
        &["azimuth_deg", "light"],
    ),
    ("hidden", |d| d.hidden.push(d.layer[0].id().to_owned()), &["hidden"]),
    ("must see", |d| d.layer.iter_mut().for_each(|l| l.set_must_see(true)), &["must_see"]),
    ("stages", |d| d.stage.clear(), &[]),
    ("constructor", |d| d.constructor = Some(ConstructorDoc::of(ConstructorKind::AutoProbe)), &[]),
    ("turned over", |d| d.layer.reverse(), &[]),
];

#[test]
fn ready_scenes_keep_all_that_the_window_does_not_edit() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../scenes");
    let mut count = 0;
    for entry in std::fs::read_dir(folder).expect("scenes").flatten() {
        let text = std::fs::read_to_string(entry.path()).expect("text");
        let json = serde_json::to_string_pretty(&read(&text)).expect("JSON");
        for (name, change, keys) in EDITS {
            let what = format!("{name} of {}", entry.path().display());
            for text in [&text, &json] {
                let new = edited(text, change);
                if keys.is_empty() {
                    continue;
                }
                // A comma comes behind what was the last value.
                let bare = |line: &str| line.trim_end_matches(',').to_owned();
                let there: Vec<String> = new.lines().map(bare).collect();
                for line in text.lines().filter(|line| !there.contains(&bare(line))) {
                    let key =
                        line.trim().trim_start_matches('"').split(['=', '"', ':']).next().unwrap_or_default().trim();
                    let is_value = is_json(text) && key.starts_with(|c: char| c.is_ascii_digit() || c == '-');
                    assert!(keys.contains(&key) || is_value, "{what} lost {line:?}:\n{new}");
                }
            }
            count += 1;
        }
    }
    assert!(count > 200, "{count}");
}

#[test]
fn points_and_stages_change_their_form() {
    let text = "format = 1\n[camera]\neye = { x = 1, y = 2, above_ground_m = 3 } # a rule\nlook_at = [0, 1, 0]\n[[stage]]\nkind = 'spline_bend'\n# above\npresets = 'progressive' # to be changed\n";
    let moved = edited(text, drag);
    assert!(moved.contains("eye = [10.5, -5200.0, 3600.0] # a rule\n"), "{moved}");
    let inline = |document: &mut Document| {
        let StageDoc::SplineBend(stage) = &mut document.stage[0] else { panic!("a spline") };
        let presets = belvedere_core::presets::PresetDocument::builtin("progressive").expect("built in");
        stage.presets = crate::PresetsDoc::Inline(Box::new(presets));
    };
    let new = edited(text, inline);
    assert!(new.contains("\n# above\n# to be changed\n[stage.presets]\n"), "{new}");
    let table = "format = 1\n[camera]\nlook_at = [0, 1, 0]\n[camera.eye] # a rule\nx = 1\ny = 2\nabove_ground_m = 3\n";
    edited(table, drag);
    let dotted = "format = 1\ncamera.eye = [0, 0, 1] # here\ncamera.look_at = [0, 1, 0]\n";
    let moved = edited(dotted, drag);
    assert!(moved.starts_with("format = 1\ncamera.eye = [10.5, -5200.0, 3600.0] # here\n"), "{moved}");
    let one = CameraDoc { heading_deg: Some(1.0), look_at: None, ..read(dotted).camera };
    edited(dotted, |d| d.camera = one);
}
