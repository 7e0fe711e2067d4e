//! Bad scenes: one line with place, measured value and remedy; exit 2.

use super::{BARE, Place};

/// `scene` fails, and says exactly `expected` after `belvedere: s.toml:`.
fn refuses(scene: &str, expected: &str) {
    let place = Place::new();
    place.write("s.toml", scene);
    let line = place.fails(&["check", "s.toml"]);
    assert_eq!(line.strip_prefix("belvedere: s.toml:").unwrap_or(&line), expected);
}

fn with(key: &str) -> String {
    format!("{BARE}{key}\n")
}

#[test]
fn unknown_keys_name_the_nearest() {
    refuses(&BARE.replace("look_at", "lookat"), "4: camera: unknown key \"lookat\"; did you mean \"look_at\"?");
    refuses(&with("fov = 30"), "5: camera: unknown key \"fov\"; did you mean \"fov_y_deg\"?");
    refuses(&format!("titel = 'x'\n{BARE}"), "1: unknown key \"titel\"; did you mean \"title\"?");
    refuses(
        &with("[[layer]]\nid = 'a'\nkind = 'terain'\nsource = 'x.tif'"),
        "7: layer 1: \"terain\" is not a kind that exists here; did you mean \"terrain\"?",
    );
    refuses(
        &with("[[layer]]\nid = 'a'\nkind = 'terrain'\nsorce = 'x.tif'"),
        "8: layer 1: unknown key \"sorce\"; did you mean \"source\"?",
    );
    refuses(
        &with("[[layer]]\nid = 'a'\nkind = 'line'\nsource = 'x'\nstyle = { colour = '#fff' }"),
        "9: layer 1.style: unknown key \"colour\"; did you mean \"color\"?",
    );
    refuses(
        &with("[[stage]]\nkind = 'spline'\npresets = 'map'"),
        "6: stage 1: \"spline\" is not a kind that exists here; did you mean \"spline_bend\"?",
    );
}

#[test]
fn wrong_types_and_numbers_name_their_line() {
    refuses(&with("near = 'x'"), "5: camera.near: a number was expected, found the text \"x\"");
    refuses(&with("near = nan"), "5: nan is not a finite number; give finite numbers");
    refuses(&with("far = inf"), "5: inf is not a finite number; give finite numbers");
    refuses(
        "format = 1\n[camera]\neye = [0, 0]\nlook_at = [0, 1, 0]\n",
        "3: camera.eye: a list of 3 was expected, found a list of 2",
    );
    refuses("format = 1\n", "1: key \"camera\" is missing; add it");
    refuses("format = 2\n", "1: format is the number 2, this program reads format 1; use a newer version");
    refuses(&with("[[layer]]\nkind = 'terrain'\nsource = 'x'"), "5: layer 1: key \"id\" is missing; add it");
}

#[test]
fn degenerate_cameras_say_what_is_wrong() {
    refuses(
        &BARE.replace("[0.0, 1.0, 0.0]", "[0.0, 0.0, 0.0]"),
        "4: camera eye and look_at are the same point (distance 0); move one of them",
    );
    refuses(&with("fov_y_deg = 0"), "5: camera fov_y_deg is 0, it must lie strictly between 0 and 180");
    refuses(&with("fov_y_deg = 180"), "5: camera fov_y_deg is 180, it must lie strictly between 0 and 180");
    refuses(&with("image = [0, 720]"), "5: camera image is 0 x 720 pixels, each side must be in 1..=65535");
    refuses(&with("far = 0.5"), "5: camera far is 0.5, it must be greater than near = 1");
    refuses(
        &with("image = [1.5, 9]"),
        "5: camera.image.0: a whole number of at least 0 was expected, found the number 1.5",
    );
    refuses(&with("near = 0"), "5: camera near is 0, it must be greater than 0");
    refuses(
        &with("heading_deg = 10"),
        "5: camera has look_at and heading_deg/pitch_deg; give either look_at or both angles",
    );
    refuses(&with("projection = 'orthographic'"), "5: an orthographic camera needs ortho_height_m; add it");
    refuses(
        "format = 1\n[camera]\neye = { x = 0, y = 0, above_ground_m = 2 }\nlook_at = [0, 1, 0]\n",
        "3: camera eye: above_ground_m needs a terrain layer; add one, or give the height",
    );
    let nadir = BARE.replace("[0.0, 1.0, 0.0]", "[0.0, 0.0, -1.0]");
    let place = Place::new();
    place.write("s.toml", &nadir);
    assert!(place.fails(&["check", "s.toml"]).contains("camera looks along its up direction"));
}

#[test]
fn stages_are_checked_with_their_line() {
    let turn = "[[stage]]\nkind = 'curved_rays'\nturn = []\n";
    let spline = "[[stage]]\nkind = 'spline_bend'\npresets = 'map'\n";
    refuses(
        &with(&format!("{turn}{spline}")),
        "9: stage spline_bend cannot follow stage curved_rays; the order is earth, terrain_disocclusion, ground_moves, strip, tube or unroll, relief, spline_bend, curved_rays, each at most once",
    );
    let relief = |key: &str| with(&format!("[[stage]]\nkind = 'relief'\n{key}"));
    refuses(&relief("oblique = 9"), "7: oblique is 9, it must be in 0..=5");
    refuses(&relief("exaggeration = [1, 0]"), "7: exaggeration is 0, it must be in 0.01..=100");
    refuses(
        &relief("range_m = [9, 2]"),
        "7: range_m is [9, 2]; the background must begin farther away than the foreground ends",
    );
    refuses(
        &relief("range_tag = 1"),
        "7: range_tag needs a stage spline_bend after the relief; add one, or give range_m",
    );
    refuses(
        &relief(&format!("range_tag = 1\n{spline}plane = {{ height_m = -200 }}\n")),
        "7: range_tag is 1, the presets of the spline stage have 0 tag points at this viewing angle; give one of them, or range_m",
    );
    refuses(
        &relief("range_tag = 1\nrange_m = [1, 2]"),
        "7: range_m and range_tag both say where the background begins; leave one out",
    );
    refuses(&relief("levelling = 0.5"), "7: levelling needs terrain over a level reference plane");
    refuses(&with(turn), "7: curved_rays has no turn; give at least one [[stage.turn]]");
    refuses(
        &with("[[stage]]\nkind = 'terrain_disocclusion'\nmode = 'qp'"),
        "6: terrain_disocclusion needs a layer of kind terrain; add one, or remove the stage",
    );
    let crossed = "[[stage]]\nkind = 'curved_rays'\n[[stage.turn]]\nviewpoint = [5, 0, 0]\nt0 = [0, 60, 0]\nt1 = [0, 50, 0]\nt2 = [0, 40, 0]\nnormal = [0, 1, 0]";
    let place = Place::new();
    place.write("s.toml", &with(crossed));
    let line = place.fails(&["check", "s.toml"]);
    assert!(line.starts_with("belvedere: s.toml:") && line.contains("t0"), "{line}");
    for (m, why) in [
        ("'midd'", "\"midd\" is not one of the choices; did you mean \"mid\"?"),
        ("true", "a number in [0.2, 20], \"bend\", \"left\" or \"mid\" was expected, found true"),
    ] {
        place.write("s.toml", &with(&format!("{crossed}\nm = {m}")));
        let line = place.fails(&["check", "s.toml"]);
        assert!(line.contains(&format!(":13: stage 1.turn.0.m: {why}")), "{line}");
    }
}

#[test]
fn rays_that_cannot_part_say_on_which_side() {
    let stage = "[[stage]]\nkind = 'curved_rays'\n";
    let turn = |side: &str, normal: &str| {
        format!(
            "[[stage.split.{side}.turn]]\nviewpoint = [5, 0, 0]\nt0 = [0, 40, 0]\nt1 = [0, 50, 0]\nt2 = [0, 60, 0]\n{normal}"
        )
    };
    let normal = "normal = [0, 1, 0]\n";
    refuses(
        &with(&format!("{stage}{}{}", turn("left", ""), turn("right", normal))),
        "9: split.left, turn 1: neither line nor normal is given; give the common line of the planes, or the normal of parallel planes",
    );
    refuses(
        &with(&format!("{stage}split.seam = [[0.5, 0], [0.5, 0]]\n{}{}", turn("left", normal), turn("right", normal))),
        "7: the two points of the seam are [0.5, 0], [0.5, 0]; give two points that are apart",
    );
    refuses(
        &with(&format!("{stage}split.seam = [[3, 0], [3, 1]]\n{}{}", turn("left", normal), turn("right", normal))),
        "7: the seam leaves no pixel on its right side; move it into the picture",
    );
    let place = Place::new();
    let backwards = turn("right", normal).replace("[0, 40, 0]", "[0, 70, 0]");
    place.write("s.toml", &with(&format!("{stage}{}{backwards}", turn("left", normal))));
    let line = place.fails(&["check", "s.toml"]);
    assert!(line.contains("right of the seam, ") && line.contains("t0"), "{line}");
}

#[test]
fn files_stay_in_their_folder() {
    let layer = |source: &str| with(&format!("[[layer]]\nid = 'g'\nkind = 'terrain'\nsource = '{source}'"));
    refuses(
        &layer("../x.tif"),
        "8: layer \"g\": path \"../x.tif\" leaves the folder of the scene file; use a path below that folder, or allow a folder with --allow-root DIR, or for good with: belvedere trust SCENE",
    );
    refuses(
        &layer("file:///etc/passwd"),
        "8: layer \"g\": path \"file:///etc/passwd\" is a file: address; download it and give the path of the file",
    );
    refuses(&layer("CON"), "8: layer \"g\": path \"CON\" names the device CON; give the path of a file");
    let place = Place::new();
    place.write("s.toml", &layer("gone.tif"));
    let line = place.fails(&["check", "s.toml"]);
    assert!(line.contains("path \"gone.tif\" is not there (looked in "), "{line}");
}

#[test]
fn constructors_are_read_and_refused() {
    refuses(
        &with("[constructor]\nkind = 'target_tracking'"),
        "6: constructor: target_tracking needs target, the layer, part or box to keep in view",
    );
    refuses(
        &with("[constructor]\nkind = 'auto_probe'\nturns = 9"),
        "7: constructor: turns is 9, it must be a whole number in 1..=6",
    );
    refuses(
        &with("[[stage]]\nkind = 'spline_bend'\npresets = 'demo'\n[constructor]\nkind = 'auto_probe'"),
        "9: constructor: auto_probe looks for free space where things stand, not where a spline bend carries them; remove the spline_bend stage",
    );
    refuses(
        &with("[constructor]\nkind = 'auto_probe'\nreach_m = 0"),
        "7: constructor: reach_m is 0, it must be greater than 0",
    );
    let turn = "[[stage]]\nkind = 'curved_rays'\n[[stage.turn]]\nviewpoint = [30, 0, 0]\nt0 = [0, 40, 0]\nt1 = [0, 50, 0]\n\
                t2 = [0, 60, 0]\nnormal = [0, 1, 0]\n[constructor]\nkind = 'target_tracking'\ntarget = 'x'";
    refuses(
        &with(turn),
        "14: constructor: it builds the curved rays itself; remove the curved_rays stage, or set kind = \"manual\"",
    );
    refuses(&with("[animation]\nalong = 'x'\nframes = 0"), "7: animation: frames is 0, it must be at least 1");
}

#[test]
fn documents_have_limits() {
    let place = Place::new();
    place.write("deep.json", &format!("{}{}", "[".repeat(100_000), "]".repeat(100_000)));
    assert!(place.fails(&["check", "deep.json"]).contains("nested more than 64 deep"));
    place.write("twice.json", "{\"camera\": 1,\n\"camera\": 2}");
    assert!(place.fails(&["check", "twice.json"]).ends_with("twice.json:2: key \"camera\" is given twice; keep one"));
    std::fs::write(place.path("big.toml"), vec![b'#'; (16 << 20) + 1]).expect("written");
    assert!(place.fails(&["check", "big.toml"]).contains("at most 16777216 are read"));
    std::fs::write(place.path("latin.toml"), b"title = \"\xe9\"").expect("written");
    assert!(place.fails(&["check", "latin.toml"]).contains("byte 9 is not UTF-8"));
    assert!(place.fails(&["check", "gone.toml"]).contains("gone.toml"));
}

#[test]
fn arguments_are_checked_in_one_line() {
    let place = Place::new();
    assert!(place.fails(&["fly"]).contains("there is no verb \"fly\""));
    assert!(place.fails(&[]).contains("a verb is missing"));
    assert!(place.fails(&["render", "s.toml", "-o", "x.png", "--size", "big"]).contains("1280x720"));
    let help = place.ok(&["--help"]);
    assert!(!help.contains("migrate"), "what does not exist yet is in the help");
}

#[test]
fn rays_that_are_not_valid_are_mended_and_everything_else_stays_as_it_is_written() {
    let turn = |m: &str| {
        format!(
            "[[stage]] # the bend\nkind = 'curved_rays'\n[[stage.turn]]\nviewpoint = [60, 200, 20]\nt0 = [0, -40, 0]\nt1 = [0, -20, 0]\nt2 = [0, -60, 0]\nnormal = [1, 0.2, 0]\nm = {m}\n"
        )
    };
    let place = Place::new();
    let scene = BARE.replace("[0.0, 0.0, 0.0]", "[0.0, -100.0, 20.0]").replace("[0.0, 1.0, 0.0]", "[0.0, 0.0, 5.0]");
    for m in ["40", "'bend'"] {
        let text = format!("# As it was sent.\n{scene}{}", turn(m));
        place.write("s.toml", &text);
        place.fails(&["check", "s.toml"]);
        let said = place.ok(&["check", "s.toml", "--mend", "good.toml", "--overwrite"]);
        assert!(said.contains("mended: turn 1") && said.contains("valid"), "{said}");
        let made = String::from_utf8(super::read(&place.path("good.toml"))).expect("text");
        assert!(made.starts_with("# As it was sent.\n") && made.contains("[[stage]] # the bend"), "{made}");
        let lines = |text: &str| text.lines().map(str::to_owned).collect::<Vec<_>>();
        let (before, after) = (lines(&text), lines(&made));
        let differ = before.iter().zip(&after).filter(|(a, b)| a != b).count();
        assert!(before.len() == after.len() && (1..=7).contains(&differ), "{made}");
        place.ok(&["check", "good.toml"]);
        place.ok(&["render", "good.toml", "-o", "good.png", "--size", "16x9", "--overwrite"]);
        // What is valid stays, byte by byte.
        assert!(place.ok(&["check", "good.toml", "--mend", "again.toml", "--overwrite"]).contains("nothing to mend"));
        assert_eq!(super::read(&place.path("again.toml")), made.as_bytes());
    }
    // What rays do not cause is told as ever, and nothing is written.
    place.write("s.toml", &format!("{scene}{}", turn("40")).replace("viewpoint", "viewpiont"));
    assert!(place.fails(&["check", "s.toml", "--mend", "none.toml"]).contains("viewpiont"));
    assert!(!place.path("none.toml").exists());
}

#[test]
fn the_file_of_a_film_is_checked() {
    refuses(
        &with("[animation]\ncamera = 'gone.json'"),
        "6: animation: path \"gone.json\" is not there (looked in .); check the name, or allow its folder with --allow-root DIR, or for good with: belvedere trust SCENE",
    );
}
