//! Steadiness of pictures while the camera tilts: a town in three representations, from the horizon to the map.

use belvedere::io::{Limits, Samples, png};
use belvedere::picture::PictureOptions;
use belvedere::scene::Progress;
use belvedere::scene_file::{AnimationDoc, SweepDoc};
use belvedere::verbs::animate::{AnimateRequest, animate, frame_name};
use belvedere::{OpenOptions, Session};
use std::path::Path;

const TOWN: &str = r#"
format = 1
crs = "local"
[representations]
loa0 = ["town"]
loa1 = ["blocks"]
loa2 = ["quarters"]
[[layer]]
id = "town"
kind = "city"
source = "builtin:town?seed=7&size=500"
[[layer]]
id = "blocks"
kind = "city"
source = "builtin:town?seed=7&size=500"
loa = 1
[[layer]]
id = "quarters"
kind = "city"
source = "builtin:town?seed=7&size=500"
loa = 2
[camera]
eye = [-60.0, -450.0, 165.0]
look_at = [0.0, -50.0, 0.0]
image = [160, 90]
[[stage]]
kind = "spline_bend"
presets = "demo"
"#;

/// Largest mean difference between neighbouring frames, and largest ratio to the differences before and after it.
const LARGEST: f64 = 0.03;
const OUTSTANDING: f64 = 1.6;
/// Differences below this stand out from nothing.
const NOTHING: f64 = 0.002;

fn frame(folder: &Path, index: usize) -> Vec<u8> {
    let raster = png::read(&folder.join(frame_name(index)), &Limits::default()).expect("a frame");
    match raster.samples {
        Samples::U8(samples) => samples,
        other => panic!("a frame of {other:?}"),
    }
}

#[test]
fn nothing_pops_between_the_horizon_and_the_map() {
    let folder = tempfile::tempdir().expect("folder");
    let session = Session::from_text(Path::new("town.toml"), TOWN, &OpenOptions::default()).expect("scene");
    let animation = AnimationDoc { sweep: Some(SweepDoc { phi_deg: [0.0, 90.0, 0.25] }), ..AnimationDoc::default() };
    let picture = PictureOptions { no_mark: true, ..PictureOptions::default() };
    let out = folder.path().join("frames");
    let request = AnimateRequest { animation, picture, out: out.clone(), ..AnimateRequest::default() };
    let made = animate(&session, &request, &Progress::silent()).expect("frames");
    assert_eq!(made.drawn, 361);
    let mut before = frame(&out, 0);
    let mut changes = Vec::new();
    for index in 1..made.drawn {
        let next = frame(&out, index);
        let sum: u64 = before.iter().zip(&next).map(|(a, b)| u64::from(a.abs_diff(*b))).sum();
        changes.push(sum as f64 / (255.0 * next.len() as f64));
        before = next;
    }
    let largest = changes.iter().copied().fold(0.0, f64::max);
    assert!(largest > NOTHING && largest < LARGEST, "neighbours differ by up to {largest}");
    for (i, three) in changes.windows(3).enumerate() {
        let usual = three[0].max(three[2]).max(NOTHING);
        let phi = 0.25 * (i + 2) as f64;
        assert!(three[1] < OUTSTANDING * usual, "at {phi} degrees the picture leaps: {three:?}");
    }
}
