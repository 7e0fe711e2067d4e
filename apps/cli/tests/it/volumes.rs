//! Layers of voxels, from the file to picture, pick and record.

use super::Place;

/// A bright ball of radius 9 in 24^3 voxels, as text in NRRD.
fn ball() -> String {
    let value = |i: i32| {
        let [x, y, z] = [i % 24, i / 24 % 24, i / 576].map(|v| f64::from(v) - 11.5);
        (20.0 * (9.0 - (x * x + y * y + z * z).sqrt()) + 100.0).clamp(0.0, 200.0).round()
    };
    let values: String = (0..24 * 24 * 24).map(|i| format!("{} ", value(i))).collect();
    format!("NRRD0004\ntype: uchar\ndimension: 3\nsizes: 24 24 24\nencoding: ascii\n\n{values}")
}

const SCENE: &str = "format = 1
crs = 'local'
unit = 'voxel'
[[layer]]
id = 'ball'
kind = 'volume'
source = 'ball.nrrd'
transfer = 'ball.toml'
transform = { translate = [-11.5, 88.5, -11.5] }
[[layer]]
id = 'wall'
kind = 'boxes'
boxes = [{ base = [0, 140, -40], size = [30, 4, 80], color = '#204080' }]
[camera]
eye = [0, 0, 0]
look_at = [0, 100, 0]
image = [64, 48]
fov_y_deg = 30
";

const TRANSFER: &str = "points = [
  { value = 90, color = '#000000', opacity = 0 },
  { value = 110, color = '#ff4020', opacity = 0.9 },
]
";

const TURN: &str = "[[stage]]
kind = 'curved_rays'
[[stage.turn]]
viewpoint = [-60, 10, 0]
t0 = [0, 90, 0]
t1 = [0, 100, 0]
t2 = [0, 112, 0]
normal = [0, -1, 0]
";

fn place() -> Place {
    let place = Place::new();
    place.write("ball.nrrd", &ball());
    place.write("ball.toml", TRANSFER);
    place.write("s.toml", SCENE);
    place.write("bent.toml", &format!("{SCENE}{TURN}"));
    place
}

#[test]
fn a_volume_is_drawn_straight_and_bent_by_both_renderers_and_recorded() {
    let place = place();
    for scene in ["s.toml", "bent.toml"] {
        for renderer in ["cpu", "exact"] {
            let out = format!("{renderer}_{scene}.png");
            place.ok(&["render", scene, "-o", &out, "--renderer", renderer, "--aux", "id,depth,world"]);
            let text = std::fs::read_to_string(place.path(&format!("{renderer}_{scene}.png.json"))).expect("a record");
            let record: serde_json::Value = serde_json::from_str(&text).expect("JSON");
            let volume = &record["volumes"][0];
            assert_eq!(volume["layer"], "ball");
            assert_eq!(volume["transfer"], "ball.toml");
            assert_eq!(volume["dims"], serde_json::json!([24, 24, 24]));
            assert!(record["stats"]["samples"].as_u64().expect("a count") > 1000, "{}", record["stats"]);
            let inputs: Vec<&str> =
                record["inputs"].as_array().expect("a list").iter().filter_map(|f| f["path"].as_str()).collect();
            assert!(inputs.iter().any(|p| p.ends_with("ball.nrrd")) && inputs.iter().any(|p| p.ends_with("ball.toml")));
        }
        let ids = ["cpu", "exact"].map(|r| std::fs::read(place.path(&format!("{r}_{scene}.id.npy"))).expect("ids"));
        assert_eq!(ids[0].len(), ids[1].len());
        // Of 3072 pixels: those at the rims of ball and wall may differ.
        let other = ids[0].iter().zip(&ids[1]).filter(|(a, b)| a != b).count();
        assert!(other < 60 && ids[0].iter().filter(|id| **id == 1).count() > 150, "{scene}: {other} ids differ");
    }
}

#[test]
fn a_volume_is_picked_where_it_hides_half_of_what_lies_behind() {
    let place = place();
    place.write("p.json", "[[32.0, 24.0], [32.0, 4.0], [42.0, 24.0], [2.0, 2.0]]");
    for scene in ["s.toml", "bent.toml"] {
        let picked = place.json(&["pick", scene, "--pixels", "p.json"]);
        let first = &picked["pixels"][0];
        assert_eq!(first["layer"], "ball", "{picked}");
        // The surface of the ball faces the eye at y = 100 - 9.
        let [depth, y] = [first["depth"].as_f64(), first["point"][1].as_f64()].map(|v| v.expect("a number"));
        assert!((y - 91.0).abs() < 1.5 && (depth - y).abs() < 0.3, "{first}");
        assert_eq!(picked["pixels"][3], serde_json::Value::Null);
    }
    // Beside the ball the wall is seen; rays that turned see what lies beside the ball.
    assert_eq!(place.json(&["pick", "s.toml", "--pixels", "p.json"])["pixels"][1]["layer"], "wall");
}

#[test]
fn other_verbs_know_volumes() {
    let place = place();
    let check = place.ok(&["check", "s.toml"]);
    assert!(check.contains("ball (volume): 13824"), "{check}");
    let info = place.json(&["info", "ball.nrrd", "--json"]);
    assert_eq!(
        (&info["files"][0]["kind"], &info["files"][0]["dims"]),
        (&"volume".into(), &serde_json::json!([24, 24, 24]))
    );
    place.ok(&["show", "s.toml"]);
    place.ok(&["check", "s.toml", "--json"]);
    let info = place.json(&["info", "builtin:engine", "--json"]);
    assert_eq!(info["files"][0]["layers"], serde_json::json!(["engine"]));
}

#[test]
fn colour_maps_of_paraview_are_transfer_functions() {
    let place = place();
    let map = r#"[{"ColorSpace":"RGB","Name":"mine","NanColor":[1,1,0],"Points":[90,0,0.5,0,110,0.9,0.5,0],"RGBPoints":[90,0,0,0,110,1,0.25,0.125]}]"#;
    place.write("ball.json", map);
    place.write("p.toml", &SCENE.replace("ball.toml", "ball.json"));
    for scene in ["s", "p"] {
        place.ok(&["render", &format!("{scene}.toml"), "-o", &format!("{scene}.png")]);
    }
    let [a, b] = ["s", "p"].map(|s| {
        let text = std::fs::read_to_string(place.path(&format!("{s}.png.json"))).expect("a record");
        let record: serde_json::Value = serde_json::from_str(&text).expect("JSON");
        record["volumes"][0]["points"].clone()
    });
    assert_eq!(a, b);
}

#[test]
fn mistakes_are_told_in_one_line() {
    let place = place();
    for (from, to, wanted) in [
        ("'ball.toml'", "'ct-bon'", "did you mean \"ct-bone\""),
        ("'ball.toml'", "'none.toml'", "is not there"),
        ("kind = 'volume'", "kind = 'volume'\nstep = 0", "step is 0, it must be in 0.01..=8"),
        ("kind = 'volume'", "kind = 'volume'\ntype = 'int9'", "type \"int9\" is not known"),
        ("transform = { translate", "transform = { scale = 0, translate", "scale is 0"),
    ] {
        place.write("bad.toml", &SCENE.replace(from, to));
        let error = place.fails(&["check", "bad.toml"]);
        assert!(error.contains(wanted) && error.contains("bad.toml:"), "{error}");
    }
    place.write("ball.toml", &TRANSFER.replace("opacity = 0.9", "opacity = 9"));
    assert!(place.fails(&["check", "s.toml"]).contains("opacity 9"));
}
