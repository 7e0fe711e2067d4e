//! Stage `ground_moves` as a user meets it: drawn, told, combined with other stages, and refused with its line.

use super::{BARE, Place};
use serde_json::{Value, json};

/// Ground, a road that must be seen, a lake, and stages.
fn scene(stages: &str) -> String {
    format!(
        "format = 1\ncrs = \"local\"\n\
         [camera]\neye = [-6500.0, -7000.0, 4200.0]\nlook_at = [-3000.0, -3000.0, 1200.0]\nimage = [160, 90]\n\
         [[layer]]\nkind = \"terrain\"\nid = \"ground\"\nsource = \"builtin:massif?seed=7&size=65\"\n\
         [[layer]]\nkind = \"line\"\nid = \"road\"\nsource = \"builtin:massif?seed=7&size=65\"\nmust_see = true\n\
         [[layer]]\nkind = \"area\"\nid = \"lake\"\nsource = \"builtin:massif?seed=7&size=65\"\nstyle = {{ water = true }}\n\
         {stages}\n"
    )
}

/// Three moves of different kinds.
const MOVES: &str = "[[stage]]\nkind = 'ground_moves'\n\
    [[stage.move]]\nkind = 'raise'\nat = [-3500, -3500]\nby_m = 400\nreach_m = 2500\n\
    [[stage.move]]\nkind = 'shift'\nat = [-1500, -4500]\nshift_m = [500, -200]\ncore_m = 400\nreach_m = 2200\n\
    [[stage.move]]\nkind = 'turn'\nat = [-4500, -1500]\nangle_deg = 30\nreach_m = 2200\n";

fn number(value: &Value) -> f64 {
    value.as_f64().unwrap_or_else(|| panic!("{value} is no number"))
}

fn points(answer: &Value, key: &str) -> Vec<[f64; 3]> {
    let all = answer["points"].as_array().unwrap_or_else(|| panic!("{answer}"));
    all.iter().map(|point| [0, 1, 2].map(|i| number(&point[key][i]))).collect()
}

#[test]
fn moved_ground_is_drawn_and_its_record_says_how_far() {
    let place = Place::new();
    place.write("s.toml", &scene(MOVES));
    place.ok(&["render", "s.toml", "-o", "a.png"]);
    let record: Value = serde_json::from_slice(&super::read(&place.path("a.png.json"))).expect("JSON");
    assert_eq!(record["stages"], json!(["ground_moves"]));
    let moved = &record["moved"];
    assert!((number(&moved["height_m"]) - 400.0).abs() < 60.0, "{moved}");
    assert!((number(&moved["plan_m"]) - 540.0).abs() < 80.0 && number(&moved["least_determinant"]) > 0.05, "{moved}");
    assert_eq!(moved["moves"].as_array().map(Vec::len), Some(3), "{moved}");
    for route in moved["routes"].as_array().expect("routes") {
        assert!((number(&route["moved_length_m"]) / number(&route["length_m"]) - 1.0).abs() <= 0.0301, "{route}");
    }
    assert!(number(&record["displacement"]["max_m"]) > 300.0, "{}", record["displacement"]);
    assert!(record["note"].as_str().is_some_and(|n| n.starts_with("bent view (ground_moves)")), "{}", record["note"]);
    place.ok(&["render", "s.toml", "-o", "b.png", "--straight"]);
    let straight: Value = serde_json::from_slice(&super::read(&place.path("b.png.json"))).expect("JSON");
    assert!(straight["moved"].is_null() && straight["stages"] == json!([]));
}

#[test]
fn moves_do_what_they_say_and_what_is_resolved_opens_to_the_same_view() {
    let place = Place::new();
    place.write("s.toml", &scene(MOVES));
    place.write(
        "p.json",
        "[[-3500, -3500, 900], [-1500, -4500, 700], [-4500, -1500, 800], [-4300, -1500, 800], [4000, 4000, 500]]",
    );
    let moved = points(&place.json(&["displace", "s.toml", "--points", "p.json"]), "displaced");
    let near = |got: [f64; 3], expected: [f64; 3], within: f64| {
        assert!((0..3).all(|i| (got[i] - expected[i]).abs() < within), "{got:?}, expected {expected:?}");
    };
    near(moved[0], [-3500.0, -3500.0, 1300.0], 30.0);
    near(moved[1], [-1000.0, -4700.0, 700.0], 30.0);
    near(moved[2], [-4500.0, -1500.0, 800.0], 20.0);
    near(moved[3], [-4500.0 + 173.2, -1400.0, 800.0], 20.0);
    near(moved[4], [4000.0, 4000.0, 500.0], 1e-9);
    place.ok(&["show", "s.toml", "-o", "shown.toml"]);
    let project = |scene: &str| place.ok(&["project", scene, "--points", "p.json"]);
    assert_eq!(project("s.toml"), project("shown.toml"));
    assert_eq!(place.ok(&["show", "shown.toml"]), place.ok(&["show", "s.toml"]));
}

#[test]
fn moved_ground_is_one_chain_with_splines_and_rays() {
    let spline = "[[stage]]\nkind = 'spline_bend'\npresets = 'progressive'\n";
    let rays = "[[stage]]\nkind = 'curved_rays'\n[[stage.turn]]\nviewpoint = [-6300, -6400, 4500]\n\
        t0 = [-4600, -4800, 2500]\nt1 = [-4300, -4500, 2300]\nt2 = [-4000, -4200, 2100]\nnormal = [1, 1, -0.6]\n";
    for stages in
        [MOVES.to_owned(), format!("{MOVES}{spline}"), format!("{MOVES}{rays}"), format!("{MOVES}{spline}{rays}")]
    {
        let place = Place::new();
        place.write("s.toml", &scene(&stages));
        place.write("pixels.json", "[[40, 70], [80, 70], [80, 50], [120, 60], [60, 45], [100, 80]]");
        let picked = place.json(&["pick", "s.toml", "--pixels", "pixels.json"]);
        let seen: Vec<&Value> =
            picked["pixels"].as_array().expect("pixels").iter().filter(|one| one["layer"] == "ground").collect();
        assert!(seen.len() > 3, "{stages}\n{picked}");
        let world: Vec<&Value> = seen.iter().map(|one| &one["point"]).collect();
        place.write("p.json", &json!(world).to_string());
        let back = place.json(&["project", "s.toml", "--points", "p.json"]);
        let pixels = [[40.0, 70.0], [80.0, 70.0], [80.0, 50.0], [120.0, 60.0], [60.0, 45.0], [100.0, 80.0]];
        for point in back["points"].as_array().expect("points") {
            let at = [number(&point["pixel"][0]), number(&point["pixel"][1])];
            let is_one = pixels.iter().any(|p: &[f64; 2]| (p[0] - at[0]).hypot(p[1] - at[1]) < 0.01);
            assert!(is_one, "{at:?} is no pixel that was picked: {stages}");
        }
    }
}

/// `scene` fails, and says `expected` on this line.
fn refuses(scene: &str, expected: &str) {
    let place = Place::new();
    place.write("s.toml", scene);
    let line = place.fails(&["check", "s.toml"]);
    assert!(line.strip_prefix("belvedere: s.toml:").is_some_and(|l| l.contains(expected)), "{line}\n{expected}");
}

#[test]
fn moves_that_cannot_be_say_why() {
    let bare = |keys: &str| format!("{BARE}[[stage]]\nkind = 'ground_moves'\n[[stage.move]]\n{keys}\n");
    refuses(&format!("{BARE}[[stage]]\nkind = 'ground_moves'\n"), "there is no move; give at least one");
    refuses(&bare("kind = 'raise'\nat = [0, 0]\nreach_m = 9"), "8: a move of kind raise needs by_m");
    refuses(&bare("kind = 'raise'\nby_m = 3\nreach_m = 9"), "8: a move of kind raise needs at");
    refuses(
        &bare("kind = 'turn'\nat = [0, 0]\nangle_deg = 9\nby_m = 4\nreach_m = 9"),
        "11: a move of kind turn has no by_m; remove it",
    );
    refuses(
        &bare("kind = 'turn'\nat = [0, 0]\nangle_deg = 300\nreach_m = 9"),
        "move 1: angle_deg is 300, it must be in -170..=170",
    );
    refuses(
        &bare("kind = 'shift'\nat = [0, 0]\nshift_m = [1, 1]\ncore_m = 9\nreach_m = 9"),
        "move 1: core_m is 9, it must be in 0..=8.1",
    );
    refuses(
        &bare("kind = 'widen'\nby_m = 9\nreach_m = 90"),
        "a move of kind widen needs along or path, neither is given",
    );
    refuses(&bare("kind = 'widen'\nby_m = 9\npath = [[1, 1]]\nreach_m = 90"), "the line has 0 points");
    refuses(
        &bare("kind = 'straighten'\npath = [[0, 0], [9, 9]]\nfrom_m = 5\nto_m = 4\nreach_m = 90"),
        "from_m must be at least 0 and below to_m",
    );
    refuses(&bare("kind = 'widen'\nalong = 'x'\nby_m = 9\nreach_m = 90"), "there is no such layer");
    refuses(&bare("kind = 'lift'\nreach_m = 90"), "lift");
    let rivers = MOVES.replace("kind = 'ground_moves'\n", "kind = 'ground_moves'\nrivers = ['raod']\n");
    refuses(&scene(&rivers), "there is no layer \"raod\" (did you mean \"road\"?)");
}
