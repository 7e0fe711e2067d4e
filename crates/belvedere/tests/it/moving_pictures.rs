//! Pictures while the camera moves, and at rest after it.

use belvedere::live::{LiveSession, Order, Pace, Quality, Shown, Sides};
use belvedere::picture::PictureOptions;
use belvedere::placed::Place;
use belvedere::scene::Progress;
use belvedere::scene_file::{Document, PointDoc, SourceDocument, parse};
use belvedere::{OpenOptions, Session};
use std::path::Path;
use std::sync::Arc;

/// Steep ground with a route 30 m before an eye 8 m above it, under a bend.
const CLOSE: &str = r#"
format = 1
crs = "local"
[camera]
eye = [-2180.0, -2130.0, 0.0]
look_at = [-1400.0, -1300.0, 0.0]
image = [320, 180]
[[layer]]
kind = "terrain"
id = "ground"
source = "builtin:massif?seed=7&size=513"
[[layer]]
kind = "line"
id = "trail"
source = "builtin:massif?seed=7&size=513"
must_see = true
[[stage]]
kind = "spline_bend"
presets = "progressive"
"#;
/// A molecule of 1,900 atoms.
const MOLECULE: &str = r#"
format = 1
unit = "angstrom"
[camera]
eye = [0.0, -220.0, 20.0]
look_at = [0.0, 0.0, 0.0]
image = [320, 180]
[[layer]]
id = "dna"
kind = "molecule"
source = "builtin:dna?pairs=48&seed=7"
"#;
/// Most triangles per pixel of a moving picture in the least detail, beside those of the coarsest meshes.
const PER_PIXEL: f64 = 0.75;
const MESHES: u64 = 45_000;

fn document(text: &str) -> Document {
    parse(Path::new("s.toml"), text).expect("scene").document
}

/// The document with the eye 8 m above the ground.
fn grounded(mut document: Document) -> Document {
    let session = Session::from_document(SourceDocument::new(document.clone()), &OpenOptions::default());
    let session = session.unwrap_or_else(|_| panic!("the scene opens"));
    let ground = session.scene().terrain().expect("ground");
    for (point, above) in [(Some(&mut document.camera.eye), 8.0), (document.camera.look_at.as_mut(), 0.0)] {
        let Some(PointDoc::Scene(p)) = point else { panic!("a point of the scene") };
        p[2] = ground.height_at([p[0], p[1]].into()).expect("ground there") + above;
    }
    document
}

fn show(live: &mut LiveSession, document: &Document, pace: Pace) -> Shown {
    let (document, image) = (Arc::new(document.clone()), document.camera.image);
    let order =
        Order { document, place: Place::default(), image, pace, sides: Sides::Bent, bend: 1.0, overhead: false };
    live.show(&order, &Progress::silent()).expect("picture")
}

#[test]
fn moving_pictures_of_the_least_quality_draw_few_triangles() {
    for (name, document) in [("close", grounded(document(CLOSE))), ("molecule", document(MOLECULE))] {
        let mut live = LiveSession::default();
        let count = |shown: &Shown| shown.bent.as_ref().expect("frame").stats.triangles_drawn;
        let full = show(&mut live, &document, Pace::Moving { quality: Some(Quality::FULL) });
        let least = show(&mut live, &document, Pace::Moving { quality: Some(Quality::LEAST) });
        let frame = least.bent.as_ref().expect("frame");
        let [w, h] = Quality::LEAST.size(document.camera.image);
        assert_eq!((frame.width, frame.height), (w as usize, h as usize), "{name}");
        // A few blocks of ground are drawn however small the picture is.
        let most = MESHES + (PER_PIXEL * f64::from(1280 * 720) * Quality::LEAST.width().powi(2)) as u64;
        assert!(count(&least) <= most, "{name}: {} triangles, {most} are possible", count(&least));
        assert!(count(&least) < count(&full) / 2, "{name}: {} of {}", count(&least), count(&full));
    }
}

#[test]
fn the_picture_at_rest_after_a_motion_is_that_of_the_command_line() {
    let mut document = grounded(document(CLOSE));
    let mut live = LiveSession::default();
    show(&mut live, &document, Pace::Resting);
    for step in 0..4 {
        let PointDoc::Scene(eye) = &mut document.camera.eye else { panic!("a point of the scene") };
        eye[0] += 3.0;
        eye[2] += 2.0;
        let quality = [None, Some(Quality::LEAST)][step % 2];
        let shown = show(&mut live, &document, Pace::Moving { quality });
        assert!(shown.quality != Quality::FULL);
    }
    let rest = show(&mut live, &document, Pace::Resting);
    let session = Session::from_document(SourceDocument::new(document), &OpenOptions::default()).expect("session");
    let alone = session.render(&PictureOptions::default()).expect("picture");
    assert!(rest.bent.expect("frame").color == alone.frame.color, "the motion changed the picture at rest");
    assert_eq!(rest.quality, Quality::FULL);
}
