use super::*;
use crate::scene_file::parse;
use std::path::Path;

fn order(text: &str, pace: Pace) -> Order {
    let document = Arc::new(parse(Path::new("s.toml"), text).expect("scene").document);
    let (place, image) = (Place::default(), [160, 90]);
    Order { document, place, image, pace, sides: Sides::Bent, bend: 1.0, overhead: false }
}

const MOVING: Pace = Pace::Moving { quality: None };

#[test]
fn a_preview_goes_along_its_path_while_it_is_played() {
    let text = |position: f64| {
        format!(
            "{}position_m = {position}\n",
            include_str!("../../../../scenes/canyon_preview.toml").replace("position_m = 4500.0\n", "")
        )
    };
    let mut live = LiveSession::default();
    let progress = Progress::silent();
    let rest = live.show(&order(&text(4500.0), Pace::Resting), &progress).expect("picture");
    let eye = |shown: &Shown| shown.session.view().pinhole().eye;
    let mut last = eye(&rest);
    for position in [4700.0, 4900.0] {
        let shown = live.show(&order(&text(position), MOVING), &progress).expect("picture");
        assert!(shown.session.view().is_bent() && shown.waits.is_none());
        assert!(eye(&shown).distance(last) > 10.0, "the camera stands still");
        last = eye(&shown);
    }
    // A picture at rest equals that of a session without memory.
    let settled = live.show(&order(&text(4900.0), Pace::Resting), &progress).expect("picture");
    let alone = LiveSession::default().show(&order(&text(4900.0), Pace::Resting), &progress).expect("picture");
    let color = |shown: &Shown| shown.bent.as_ref().map(|frame| frame.color.clone());
    assert!(color(&settled) == color(&alone), "what was remembered changes the picture");
}

#[test]
fn a_section_that_names_another_layer_is_drawn_as_in_a_new_session() {
    let text = |section: &str| {
        format!(
            "format = 1\n[camera]\neye = [-120.0, -900.0, 330.0]\nlook_at = [0.0, -100.0, 0.0]\n\
                 [[layer]]\nid = 'town'\nkind = 'city'\nsource = 'builtin:town?seed=7&size=800'\n\
                 [[layer]]\nid = 'blocks'\nkind = 'city'\nloa = 1\nsource = 'builtin:town?seed=7&size=800'\n\
                 [[stage]]\nkind = 'spline_bend'\npresets = {{ version = 1, units = 'distance', presets = [{{ phi = 40, s = -0.5, e = 2, \
                 control = [[0, 0], [0.3, 0], [0.7, 0], [1, 0]], tags = [{{ u = 0.5, delta = 0.05 }}], \
                 sections = ['{section}', 'blocks'] }}] }}\n"
        )
    };
    let progress = Progress::silent();
    let mut live = LiveSession::default();
    let color = |shown: Shown| shown.bent.map(|frame| frame.color);
    let first = color(live.show(&order(&text("blocks"), Pace::Resting), &progress).expect("picture"));
    let edited = color(live.show(&order(&text("town"), Pace::Resting), &progress).expect("picture"));
    let alone = LiveSession::default().show(&order(&text("town"), Pace::Resting), &progress).expect("picture");
    assert!(edited == color(alone) && edited != first, "the section still shows what it showed before");
}

#[test]
fn a_moving_picture_does_not_wait_for_the_ground() {
    let text = |x: f64| {
        format!(
            "format = 1\n[camera]\neye = [{x}, -5200.0, 3600.0]\nlook_at = [0.0, 0.0, 300.0]\n\
                 [[layer]]\nkind = 'terrain'\nid = 'ground'\nsource = 'builtin:massif?seed=7&size=257'\n\
                 [[layer]]\nkind = 'line'\nid = 'trail'\nsource = 'builtin:massif?seed=7&size=257'\nmust_see = true\n\
                 [[stage]]\nkind = 'terrain_disocclusion'\n"
        )
    };
    let mut live = LiveSession::default();
    let progress = Progress::silent();
    let first = live.show(&order(&text(6000.0), MOVING), &progress).expect("picture");
    let second = live.show(&order(&text(6010.0), MOVING), &progress).expect("picture");
    assert!(first.waits.is_some() && second.waits.is_some(), "somebody waited for the solver");
    let rest = live.show(&order(&text(6010.0), Pace::Resting), &progress).expect("picture");
    assert!(rest.session.view().is_bent());
    let moved = live.show(&order(&text(6020.0), MOVING), &progress).expect("picture");
    assert!(moved.waits.is_none() && moved.session.view().is_bent(), "the ground that there is is left out");
}
