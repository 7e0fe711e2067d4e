//! Layers that a scene hides.

use belvedere::scene_file::parse;
use belvedere::{BelvedereError, OpenOptions, PictureOptions, Session};
use std::path::Path;

const SCENE: &str = "[camera]\neye = [6000, -5200, 3600]\nlook_at = [0, 0, 300]\nimage = [160, 90]\n\
    [[layer]]\nkind = 'terrain'\nid = 'ground'\nsource = 'builtin:massif?seed=7&size=65'\n\
    [[layer]]\nkind = 'line'\nid = 'trail'\nsource = 'builtin:massif?seed=7&size=65'\nmust_see = true\n\
    [[layer]]\nkind = 'boxes'\nid = 'tower'\n[[layer.boxes]]\nbase = [0.0, 0.0, 0.0]\nsize = [2000.0, 2000.0, 4000.0]\n";

/// Number of pixels of each layer, and whether anything must be seen.
fn drawn(hidden: &str) -> Result<([usize; 3], bool), BelvedereError> {
    let source = parse(Path::new("s.toml"), &format!("format = 1\nhidden = [{hidden}]\n{SCENE}"))?;
    let session = Session::from_document(source, &OpenOptions::default())?;
    let id = session.render(&PictureOptions::default())?.frame.id;
    let required = session.scene().layers.iter().any(|layer| layer.must_see);
    Ok(([1, 2, 3].map(|layer| id.iter().filter(|id| **id == layer).count()), required))
}

#[test]
fn a_hidden_layer_is_not_drawn_hides_nothing_and_is_not_required() {
    let ([ground, trail, tower], required) = drawn("").expect("picture");
    assert!(ground > 0 && trail > 0 && tower > 0 && required);
    let ([more, more_trail, none], _) = drawn("'tower'").expect("picture");
    assert!(none == 0 && more > ground && more_trail >= trail, "{more} {more_trail}");
    let ([_, none, _], required) = drawn("'trail'").expect("picture");
    assert!(none == 0 && !required);
    let ([none, line, solid], _) = drawn("'ground'").expect("picture");
    assert!(none == 0 && line > 0 && solid >= tower, "lines still lie on the ground: {none} {line} {solid}");
    let unknown = drawn("'towr'").expect_err("no such layer").to_string();
    assert!(unknown.contains("towr") && unknown.contains("tower"), "{unknown}");
}
