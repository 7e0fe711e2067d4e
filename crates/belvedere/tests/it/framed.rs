//! Pictures of targets: all that is drawn lies inside, and cameras that are given stay.

use belvedere::scene_file::LightDoc;
use belvedere::verbs::appearance::Appearance;
use belvedere::verbs::reveal::Viewpoint;
use belvedere::verbs::reveal_target::{TargetAnswer, TargetRequest, reveal_target};
use belvedere::{OpenOptions, PictureOptions};

fn request(file: &str, see: &str, image: [u32; 2]) -> TargetRequest {
    let light = LightDoc { sky: Some("white".into()), ..LightDoc::default() };
    let appearance = Appearance { light: Some(light), no_mark: true, ..Appearance::default() };
    let mut picture = PictureOptions::default();
    picture.quality.samples = 1;
    let transfer = file.contains("engine").then(|| "solid".into());
    TargetRequest {
        files: vec![file.into()],
        see: see.into(),
        transfer,
        image: Some(image),
        appearance,
        picture,
        ..TargetRequest::default()
    }
}

fn revealed(request: &TargetRequest) -> TargetAnswer {
    reveal_target(request, &OpenOptions::default()).expect("revealed")
}

/// Shares of the picture beside what is drawn: left, above, right, below.
fn margins(found: &TargetAnswer) -> [f64; 4] {
    let frame = &found.picture.frame;
    let is_drawn = |x: usize, y: usize| frame.color[y * frame.width + x].iter().any(|c| *c < 235);
    let column = |x: &usize| (0..frame.height).any(|y| is_drawn(*x, y));
    let row = |y: &usize| (0..frame.width).any(|x| is_drawn(x, *y));
    let ends = |mut all: std::ops::Range<usize>, is: &dyn Fn(&usize) -> bool| {
        let count = all.len() as f64;
        let first = all.clone().find(is).expect("something is drawn");
        [first as f64 / count, 1.0 - (all.rfind(is).expect("something is drawn") + 1) as f64 / count]
    };
    let [[left, right], [above, below]] = [ends(0..frame.width, &column), ends(0..frame.height, &row)];
    [left, above, right, below]
}

#[test]
fn bent_and_straight_models_lie_inside_with_even_margins_in_tall_and_wide_pictures() {
    for (file, see, image) in [
        ("builtin:engine", "80,92,62", [192, 108]),
        ("builtin:engine", "80,92,62", [90, 180]),
        ("builtin:dna?pairs=14", "resi 5", [108, 192]),
    ] {
        let found = revealed(&request(file, see, image));
        let beside = margins(&found);
        let [left, above, right, below] = beside;
        assert!(beside.iter().all(|m| *m > 0.0), "{file} {image:?}: {beside:?}");
        assert!((left - right).abs() < 0.035 && (above - below).abs() < 0.035, "{file} {image:?}: {beside:?}");
        assert!(beside.iter().any(|m| *m < 0.065), "{file} {image:?} fills its picture: {beside:?}");
        let refit = found.refit.expect("framed again");
        assert_eq!(refit.outside[1], 0.0, "{refit:?}");
        if image == [192, 108] {
            assert!(found.report.visible == 1.0 && found.report.visible_straight == 0.0, "{:?}", found.report);
            assert!(
                refit.outside[0] > 0.05 && refit.turned_deg > 1.0,
                "the bend moved much out of the frame: {refit:?}"
            );
        }
    }
}

#[test]
fn a_camera_that_is_given_stays_and_a_field_of_view_that_is_given_too() {
    let viewpoint = Viewpoint { eye: [80.0, -300.0, 60.0], target: [80.0, 90.0], target_height: Some(60.0) };
    let free = request("builtin:engine", "80,92,62", [96, 54]);
    let given = revealed(&TargetRequest { viewpoint: Some(viewpoint), ..free.clone() });
    assert_eq!(given.refit, None);
    let eye = given.session.view().pinhole().eye;
    assert!(eye.distance(viewpoint.eye.into()) < 1e-9, "{eye}");
    let ahead = given.session.view().pinhole().forward;
    assert!(ahead.y > 1.0 - 1e-9, "{ahead}");
    let narrow = revealed(&TargetRequest { fov_y_deg: Some(36.0), ..free });
    let [before, after] = narrow.refit.expect("turned").fov_y_deg;
    assert!((before - 36.0).abs() < 1e-9 && (after - 36.0).abs() < 1e-9, "{before} {after}");
}
