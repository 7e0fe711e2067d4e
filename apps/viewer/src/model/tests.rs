use super::*;
use belvedere::placed::Place;
use std::time::Duration;

const SCENE: &str = r#"
format = 1
crs = "local"
[camera]
eye = [6000.0, -5200.0, 3600.0]
look_at = [0.0, 0.0, 300.0]
[[layer]]
kind = "terrain"
id = "ground"
source = "builtin:massif?seed=7&size=129"
[[stage]]
kind = "spline_bend"
presets = "progressive"
"#;

/// The next picture.
fn next(model: &mut Model) -> Vec<f32> {
    let answer = model.painter.answer_within(Duration::from_secs(60)).expect("an answer");
    model.take(answer);
    let shown = model.shown.as_ref().expect("a picture");
    shown.bent.as_ref().or(shown.straight.as_ref()).expect("a frame").depth.clone()
}

/// Number of pixels that are finite in one of the pictures only.
fn apart(a: &[f32], b: &[f32]) -> usize {
    a.iter().zip(b).filter(|(a, b)| a.is_finite() != b.is_finite()).count()
}

#[test]
fn the_picture_goes_from_bent_to_straight_by_way_of_pictures_between() {
    let image = [160, 90];
    let source = belvedere::scene_file::parse(std::path::Path::new("s.toml"), SCENE).expect("scene");
    let mut model = Model::new(Editor::new(source.document, Place::default()), || ());
    let mut now = 0.0;
    model.order(image, now);
    let bent = next(&mut model);
    (model.look.bent, model.quality) = (false, Some(Quality::FULL));
    let mut between = Vec::new();
    while model.shown.as_ref().is_some_and(|shown| shown.straight.is_none()) {
        now += 0.1;
        model.order(image, now);
        between.push(next(&mut model));
        assert!(between.len() < 20, "it never arrives");
    }
    let straight = between.pop().expect("pictures");
    let whole = apart(&bent, &straight);
    assert!(whole > 300, "{whole}");
    assert!(between.len() >= 4, "{}", between.len());
    let way: Vec<usize> = between.iter().map(|picture| apart(picture, &straight)).collect();
    assert!(way.windows(2).all(|pair| pair[1] <= pair[0] + whole / 10), "{way:?} of {whole}");
    assert!(way[1] < whole && way[way.len() - 2] > 0, "{way:?} of {whole}");
}
