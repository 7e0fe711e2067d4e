//! The inset with the deformation curve as a user meets it: in bent pictures that ask for it, recorded, and nowhere else.

use super::light_and_tints::pixels;
use super::{BARE, Place, read};
use serde_json::Value;

const STREET: &str = "format = 1\ncrs = 'local'\n[[layer]]\nid = 'towers'\nkind = 'boxes'\nsource = 'builtin:street?seed=7'\n\
                      [camera]\neye = [-693.0, 693.0, 170.0]\nlook_at = [0.0, 0.0, 12.0]\nimage = [320, 240]\n\
                      [[stage]]\nkind = 'spline_bend'\npresets = 'progressive'\n";

#[test]
fn the_inset_is_drawn_in_pictures_that_a_spline_bends_and_recorded() {
    let place = Place::new();
    place.write("plain.toml", STREET);
    place.write("inset.toml", &format!("{STREET}[overlay]\ninset = 'curve'\n"));
    let draw = |scene: &str, out: &str, more: &[&str]| {
        place.ok(&[&["render", scene, "-o", out][..], more].concat());
        let record: Value =
            serde_json::from_slice(&read(&place.path(&format!("{out}.json")))).expect("a record beside the picture");
        (pixels(&read(&place.path(out))), record["overlay"]["inset"].clone())
    };
    let (plain, none) = draw("plain.toml", "plain.png", &[]);
    let (inset, curve) = draw("inset.toml", "inset.png", &[]);
    assert!(none.is_null() && curve == "curve" && plain != inset, "{none} {curve}");
    let (_, small) = draw("inset.toml", "small.png", &["--size", "120x90"]);
    let (_, unbent) = draw("inset.toml", "straight.png", &["--straight"]);
    assert!(small.is_null() && unbent.is_null(), "no room, and no bend: {small} {unbent}");
}

#[test]
fn other_insets_are_refused_with_their_line() {
    let place = Place::new();
    place.write("s.toml", &format!("{BARE}[overlay]\ninset = 'map'\n"));
    let line = place.fails(&["check", "s.toml"]);
    assert!(line.contains("map") && line.contains("curve"), "{line}");
}
