//! Films drawn in parts into one folder, as several processes do, are the film that one process draws.

use belvedere::scene::Progress;
use belvedere::scene_file::{AnimationDoc, TurntableDoc};
use belvedere::verbs::animate::{AnimateRequest, Animation, Part, animate, frame_name};
use belvedere::{BelvedereError, OpenOptions, Session};
use std::path::Path;

const SCENE: &str = r#"
format = 1
crs = "local"
[camera]
eye = [6000.0, -5200.0, 3600.0]
look_at = [0.0, 0.0, 300.0]
image = [48, 27]
[[layer]]
kind = "terrain"
id = "ground"
source = "builtin:massif?seed=7&size=65"
[[layer]]
kind = "line"
id = "trail"
source = "builtin:massif?seed=7&size=65"
must_see = true
"#;
/// Names of points of a file beside the scene.
const NAMED: &str = "[[layer]]\nkind = 'point'\nid = 'summits'\nsource = 'summits.geojson'\nstyle = { labels = true, label_px = 7.0 }\n";
const SPLINE: &str = "[[stage]]\nkind = 'spline_bend'\npresets = 'progressive'\n";
const TERRAIN: &str = "[[stage]]\nkind = 'terrain_disocclusion'\n";
const FRAMES: u32 = 7;

fn along() -> AnimationDoc {
    AnimationDoc { along: Some("trail".into()), frames: Some(FRAMES), marker: Some(true), ..AnimationDoc::default() }
}

fn turning() -> AnimationDoc {
    let turntable = Some(TurntableDoc { deg_per_s: 0.0 });
    AnimationDoc { turntable, frames: Some(FRAMES), ..AnimationDoc::default() }
}

/// Each call opens the scene anew, as another process does.
fn draw(stage: &str, animation: &AnimationDoc, out: &Path, part: Option<Part>) -> Result<Animation, BelvedereError> {
    let options = OpenOptions { unsolved: true, ..OpenOptions::default() };
    let session = Session::from_text(&out.with_file_name("scene.toml"), &format!("{SCENE}{stage}"), &options)?;
    let resume = part.is_none();
    let request =
        AnimateRequest { animation: animation.clone(), out: out.to_owned(), resume, part, ..AnimateRequest::default() };
    animate(&session, &request, &Progress::silent())
}

/// Every file of a folder by name.
fn files(folder: &Path) -> Vec<(String, Vec<u8>)> {
    let entries = std::fs::read_dir(folder).expect("folder").map(|entry| entry.expect("entry").path());
    let mut files: Vec<_> = entries
        .map(|path| {
            (path.file_name().expect("name").to_string_lossy().into_owned(), std::fs::read(path).expect("file"))
        })
        .collect();
    files.sort();
    files
}

fn parts_are_the_whole(stage: &str, animation: &AnimationDoc) {
    parts_are_the_whole_in(tempfile::tempdir().expect("folder").path(), stage, animation);
}

fn parts_are_the_whole_in(folder: &Path, stage: &str, animation: &AnimationDoc) {
    let (whole, parted) = (folder.join("one"), folder.join("parted"));
    assert_eq!(draw(stage, animation, &whole, None).expect("whole").drawn, FRAMES as usize);
    for part in [3..=4, 0..=2, 5..=6] {
        draw(stage, animation, &parted, Some(part)).expect("part");
    }
    // A worker that is started again finds its frames drawn; one whose frame was lost draws that one.
    assert_eq!(draw(stage, animation, &parted, Some(0..=2)).expect("again").drawn, 0);
    std::fs::remove_file(parted.join(frame_name(4))).expect("frame");
    assert_eq!(draw(stage, animation, &parted, Some(3..=4)).expect("again").drawn, 1);
    assert_eq!(draw(stage, animation, &parted, None).expect("collected").drawn, 0);
    assert!(files(&whole) == files(&parted), "{stage}: parts differ from the whole");
}

/// Twelve summits in three rows.
fn write_summits(folder: &Path) {
    let point = |i: i32| {
        let [x, y] = [1500 * (i % 4) - 2200, 2000 * (i / 4) - 2000];
        format!(
            r#"{{"type": "Feature", "properties": {{"name": "P{i}"}}, "geometry": {{"type": "Point", "coordinates": [{x}, {y}]}}}}"#
        )
    };
    let points = (0..12).map(point).collect::<Vec<_>>().join(", ");
    let text = format!(r#"{{"type": "FeatureCollection", "features": [{points}]}}"#);
    std::fs::write(folder.join("summits.geojson"), text).expect("summits");
}

#[test]
fn names_of_a_film_in_parts_and_of_a_frame_alone_are_those_of_the_film_in_one() {
    for (stage, animation) in [(SPLINE, along()), (TERRAIN, turning())] {
        let scene = format!("{NAMED}{stage}");
        let folder = tempfile::tempdir().expect("folder");
        write_summits(folder.path());
        let (whole, bare) = (folder.path().join("whole"), folder.path().join("bare"));
        draw(&scene, &animation, &whole, None).expect("whole");
        draw(stage, &animation, &bare, None).expect("without names");
        let last = FRAMES as usize - 1;
        let read = |out: &Path| std::fs::read(out.join(frame_name(last))).expect("frame");
        assert!(read(&whole) != read(&bare), "the names are seen");
        let alone = folder.path().join("alone");
        draw(&scene, &animation, &alone, Some(last..=last)).expect("the last frame alone");
        assert!(read(&whole) == read(&alone), "{stage}: a frame alone differs");
        parts_are_the_whole_in(folder.path(), &scene, &animation);
    }
}

#[test]
fn a_film_along_a_route_in_parts_is_the_film_in_one() {
    parts_are_the_whole(SPLINE, &along());
}

#[test]
fn a_turn_over_ground_that_makes_way_in_parts_is_the_turn_in_one() {
    parts_are_the_whole(TERRAIN, &turning());
}

#[test]
fn missing_parts_are_drawn_when_the_others_are_collected() {
    let folder = tempfile::tempdir().expect("folder");
    let out = folder.path().join("film");
    draw(SPLINE, &turning(), &out, Some(0..=3)).expect("part");
    assert_eq!(draw(SPLINE, &turning(), &out, None).expect("collected").drawn, 3);
}

#[test]
fn parts_of_another_film_or_beyond_its_end_are_refused() {
    let folder = tempfile::tempdir().expect("folder");
    let out = folder.path().join("film");
    draw(SPLINE, &turning(), &out, Some(0..=1)).expect("part");
    let words = |result: Result<Animation, BelvedereError>| result.expect_err("refused").to_string();
    let other = words(draw("", &turning(), &out, Some(0..=1)));
    assert!(other.contains("the scene has changed"), "{other}");
    let wider = words(draw("", &turning(), &out, Some(0..=4)));
    assert!(wider.contains("the scene has changed"), "{wider}");
    let beyond = words(draw(SPLINE, &turning(), &out, Some(5..=7)));
    assert_eq!(beyond, "the part 5:7 is not in 0:6; frames are counted from 0");
    let chained = words(draw(TERRAIN, &along(), &folder.path().join("other"), Some(0..=1)));
    assert!(chained.contains("in one part"), "{chained}");
}

#[test]
fn frames_of_others_are_not_replaced_and_a_film_is_made_anew_in_parts() {
    let folder = tempfile::tempdir().expect("folder");
    let out = folder.path().join("film");
    std::fs::create_dir(&out).expect("folder");
    std::fs::write(out.join(frame_name(1)), "theirs").expect("file");
    let kept = draw(SPLINE, &turning(), &out, Some(0..=3)).expect_err("kept").to_string();
    assert!(kept.contains("holds frames without their record"), "{kept}");
    assert_eq!(std::fs::read(out.join(frame_name(1))).expect("file"), b"theirs");
    std::fs::remove_file(out.join(frame_name(1))).expect("file");

    draw(SPLINE, &turning(), &out, None).expect("a film");
    let session = Session::from_text(Path::new("scene.toml"), SCENE, &OpenOptions::default()).expect("scene");
    let part = |part, overwrite| {
        let request =
            AnimateRequest { animation: turning(), out: out.clone(), part, overwrite, ..AnimateRequest::default() };
        animate(&session, &request, &Progress::silent())
    };
    assert!(part(Some(0..=3), false).is_err(), "another film is there");
    part(Some(0..=3), true).expect("anew");
    part(Some(4..=6), true).expect("anew");
    assert_eq!(draw("", &turning(), &out, None).expect("collected").drawn, 0);
}
