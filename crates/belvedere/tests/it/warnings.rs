//! The same ground, eye and route give the same warnings, whichever verb they come by.

use belvedere::live::{LiveSession, Order, Pace, Sides};
use belvedere::placed::Place;
use belvedere::request::{Disocclude, Reveal, Stated};
use belvedere::scene::Progress;
use belvedere::scene_file::AnimationDoc;
use belvedere::verbs::animate::{AnimateRequest, animate};
use belvedere::verbs::disocclude::disocclude;
use belvedere::verbs::reveal::{RevealFiles, Setting, Technique, reveal};
use belvedere::{OpenOptions, PictureOptions, Session, Warning, places};
use std::path::Path;
use std::sync::Arc;

const EYE: [f64; 3] = [500_900.0, 5_000_050.0, 130.0];
const LOOK: [f64; 2] = [500_900.0, 5_001_500.0];

/// Low hills, a wall, a route behind it and one sample that stands out by 900 m.
fn data(folder: &Path) -> Reveal {
    let height = |c: usize, r: usize| match (c, r) {
        (70, 20) => 1000.0,
        (_, 40..46) => 220.0,
        _ => 100.0 + 5.0 * ((c * 7 + r * 3) as f64 / 9.0).sin(),
    };
    let row = |r: usize| (0..90).map(|c| format!("{:.2} ", height(c, r))).collect::<String>() + "\n";
    let header = "ncols 90\nnrows 90\nxllcorner 500000\nyllcorner 5000000\ncellsize 20\nNODATA_value -9999\n";
    let [dem, route] = ["dem.asc", "route.geojson"].map(|name| folder.join(name));
    std::fs::write(&dem, header.to_owned() + &(0..90).map(row).collect::<String>()).unwrap();
    let line = r#"{"type": "LineString", "crs": {"type": "name", "properties": {"name": "EPSG:32632"}},
        "coordinates": [[500500, 5001300], [500900, 5001350], [501300, 5001300]]}"#;
    std::fs::write(&route, line).unwrap();
    let text = |path: &Path| path.display().to_string();
    Reveal { data: text(&dem), features: vec![text(&route)], stated: Stated::in_crs("EPSG:32632"), ..Reveal::default() }
}

/// Warnings of the solver, in order.
fn solved(warnings: impl IntoIterator<Item = Warning>) -> Vec<String> {
    let of_solver = warnings.into_iter().filter(|w| w.subject() == Some("terrain_disocclusion"));
    let mut out: Vec<String> = of_solver.map(|w| w.to_string()).collect();
    out.sort();
    out
}

#[test]
fn every_verb_gives_the_same_warnings_for_the_same_thing() {
    let folder = tempfile::tempdir().unwrap();
    let [out, scene] = ["out.png", "scene.toml"].map(|name| folder.path().join(name));
    let [x, y, z] = EYE;
    let asked = Reveal {
        eye: Some(places::Place::of([x, y], Some(z))),
        look: Some(places::Place::of(LOOK, None)),
        size: Some([96, 64]),
        technique: Some(Technique::Terrain),
        ..data(folder.path())
    };
    let answer = reveal(&asked, &Setting::default()).unwrap();
    let revealed = solved(answer.session.warnings());
    assert!(revealed.iter().any(|w| w.contains("spikes")), "{revealed:#?}");
    answer.write(&RevealFiles { out, scene: Some(scene.clone()), ..RevealFiles::default() }, true).unwrap();

    let options = OpenOptions { allow_roots: vec![folder.path().to_owned()], ..OpenOptions::default() };
    let opened = Session::open(&scene, &options).unwrap();
    assert_eq!(solved(opened.warnings()), revealed, "render");
    let picture = opened.render(&PictureOptions::default()).unwrap();
    assert_eq!(solved(picture.sidecar.warnings.clone()), revealed, "its record");

    let animation = AnimationDoc { frames: Some(2), ..AnimationDoc::default() };
    let films = AnimateRequest { animation, out: folder.path().join("film"), ..AnimateRequest::default() };
    let turned = Session::from_text(&scene, &with_a_turn(&scene), &options).unwrap();
    assert_eq!(solved(turned.warnings()), revealed, "animate");
    animate(&turned, &films, &Progress::silent()).unwrap();

    let document = Arc::new(opened.resolved().cloned().unwrap());
    let place = Place { scene: None, ..Place::default() };
    let mut live = LiveSession::default();
    let mut order =
        Order { document, place, image: [96, 64], pace: Pace::Resting, sides: Sides::Bent, bend: 1.0, overhead: false };
    order.place.roots.allowed = vec![folder.path().to_owned()];
    for what in ["the application", "the application, again"] {
        let shown = live.show(&order, &Progress::silent()).unwrap();
        assert_eq!(solved(shown.session.warnings()), revealed, "{what}");
    }

    let Reveal { data: dem, features, stated, .. } = data(folder.path());
    let request = Disocclude {
        data: dem,
        features,
        stated,
        eye: Some(places::Place::of([EYE[0], EYE[1]], Some(EYE[2]))),
        look: Some(places::Place::of(LOOK, None)),
        fov: Some(60.0),
        ..Disocclude::default()
    };
    let alone = solved(disocclude(&request, &OpenOptions::default()).unwrap().session.warnings());
    let spikes = |warnings: &[String]| warnings.iter().find(|w| w.contains("spikes")).cloned();
    assert_eq!(spikes(&alone), spikes(&revealed), "disocclude");
}

/// The scene with a turntable.
fn with_a_turn(scene: &Path) -> String {
    std::fs::read_to_string(scene).unwrap() + "\n[animation]\nturntable = { deg_per_s = 2.0 }\nfps = 2.0\n"
}
