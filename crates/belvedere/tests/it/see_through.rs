//! The opacity of solids in the application: a layer is not read again for it, and the picture at rest is that of the command line.

use belvedere::live::{LiveSession, Order, Pace, Quality, Shown, Sides};
use belvedere::picture::PictureOptions;
use belvedere::placed::Place;
use belvedere::scene::{Frame, Mesh, Progress};
use belvedere::scene_file::{Document, SourceDocument, parse};
use belvedere::{OpenOptions, Session};
use std::path::Path;
use std::sync::Arc;

const TOWN: &str = r#"
format = 1
crs = "local"
[camera]
eye = [-60.0, -380.0, 75.0]
look_at = [0.0, 0.0, 0.0]
image = [160, 90]
[[layer]]
id = "town"
kind = "city"
source = "builtin:town?seed=7&size=500"
[[stage]]
kind = "spline_bend"
presets = "progressive"
"#;

fn document(opacity: f64) -> Document {
    let mut document = parse(Path::new("s.toml"), TOWN).expect("scene").document;
    *document.layer[0].opacity_mut().expect("a solid") = opacity;
    document
}

fn show(live: &mut LiveSession, document: &Document, pace: Pace) -> Shown {
    let (document, image) = (Arc::new(document.clone()), document.camera.image);
    let order =
        Order { document, place: Place::default(), image, pace, sides: Sides::Bent, bend: 1.0, overhead: false };
    live.show(&order, &Progress::silent()).expect("picture")
}

fn mesh(shown: &Shown) -> &Mesh {
    &shown.session.scene().layers[0].kind.triangles().expect("a mesh").mesh
}

fn drawn(document: &Document) -> Frame {
    let source = SourceDocument::new(document.clone());
    let session = Session::from_document(source, &OpenOptions::default()).expect("session");
    session.render(&PictureOptions::default()).expect("picture").frame
}

#[test]
fn a_layer_is_not_read_again_for_another_opacity() {
    let (whole, pale, mut live) = (document(1.0), document(0.4), LiveSession::default());
    let first = show(&mut live, &whole, Pace::Resting);
    let second = show(&mut live, &pale, Pace::Resting);
    assert!(mesh(&first).is_surface_of(mesh(&second)), "the town was made again");
    let moving = show(&mut live, &pale, Pace::Moving { quality: Some(Quality::LEAST) });
    assert_eq!(moving.session.scene().layers[0].kind.opacity(), 0.4);
    let [first, second] = [first, second].map(|shown| shown.bent.expect("frame").color);
    assert!(first != second && second == drawn(&pale).color && first == drawn(&whole).color);
    let again = show(&mut live, &whole, Pace::Resting);
    assert!(again.bent.expect("frame").color == first);
}
