//! A renderer of a program's own goes through every verb of the facade.

use belvedere::picture::{AuxBuffer, PictureOptions};
use belvedere::request::{Disocclude, Measure, RendererName, Reveal};
use belvedere::scene::Progress;
use belvedere::scene_file::{AnimationDoc, TurntableDoc};
use belvedere::vectors::VectorContent;
use belvedere::verbs::animate::{AnimateRequest, animate};
use belvedere::verbs::disocclude::{DisoccludeFiles, disocclude};
use belvedere::verbs::measure::measure;
use belvedere::verbs::reveal::{Setting, drafts, reveal};
use belvedere::{CameraPicture, OpenOptions, Picture, Session, renderers};
use belvedere_testkit::synthetic::Marcher;
use std::path::Path;
use std::sync::Arc;

const NAME: &str = "marcher";

/// Names the testkit's marcher, and writes small hills with a route.
fn prepared(folder: &Path) -> [String; 2] {
    renderers::register(NAME, || Arc::new(Marcher { fault: 1.0 }));
    let height = |row: usize, column: usize| {
        let [x, y] = [column, row].map(|k| k as f64 / 60.0);
        100.0 + 400.0 * (9.0 * y).sin().powi(2) * (0.4 + x)
    };
    let row = |r: usize| (0..60).map(|c| format!("{:.2} ", height(r, c))).collect::<String>() + "\n";
    let header = "ncols 60\nnrows 60\nxllcorner 500000\nyllcorner 5000000\ncellsize 100\nNODATA_value -9999\n";
    let [dem, way, scene] = ["hills.asc", "way.geojson", "hills.toml"].map(|name| folder.join(name));
    std::fs::write(&dem, header.to_owned() + &(0..60).map(row).collect::<String>()).expect("a file");
    let crs = r#""crs": {"type": "name", "properties": {"name": "EPSG:32632"}}"#;
    let line = format!(r#"{{"type": "LineString", {crs}, "coordinates": [[500900, 5002600], [505000, 5003000]]}}"#);
    std::fs::write(&way, line).expect("a file");
    let text = r#"format = 1
renderer = "marcher"
[camera]
eye = [503000.0, 4997000.0, 1400.0]
look_at = [503000.0, 5003000.0, 200.0]
image = [96, 54]
[[layer]]
kind = "terrain"
id = "ground"
source = "hills.asc"
source_crs = "EPSG:32632"
[[layer]]
kind = "line"
id = "way"
source = "way.geojson"
must_see = true
[[stage]]
kind = "spline_bend"
presets = "progressive"
"#;
    std::fs::write(&scene, text).expect("a file");
    [dem, way].map(|path| path.display().to_string())
}

fn opened(folder: &Path) -> Session {
    Session::open(&folder.join("hills.toml"), &OpenOptions::default()).expect("the scene is right")
}

/// Whether most of a picture has the two colours of the marcher, and its record the name.
fn is_marched(picture: &Picture) -> bool {
    let own = |color: &&[u8; 3]| [Marcher::GROUND, Marcher::SKY].contains(*color);
    let count = picture.frame.color.iter().filter(own).count();
    picture.sidecar.renderer == NAME && 2 * count > picture.frame.color.len()
}

#[test]
fn pictures_of_every_kind_are_drawn_by_it() {
    let folder = tempfile::tempdir().expect("a folder");
    prepared(folder.path());
    let session = opened(folder.path());
    let usual = PictureOptions::default();
    let kinds: [(&str, PictureOptions); 7] = [
        ("as the scene says", usual.clone()),
        ("straight", PictureOptions { straight: true, ..usual.clone() }),
        ("compared", PictureOptions { compare: true, ..usual.clone() }),
        ("with its ghost", PictureOptions { ghost: true, ..usual.clone() }),
        ("with buffers", PictureOptions { aux: vec![AuxBuffer::Depth, AuxBuffer::World], ..usual.clone() }),
        ("as vectors", PictureOptions { vectors: VectorContent::OverRaster, ..usual.clone() }),
        ("by name", PictureOptions { renderer: NAME.into(), ..usual.clone() }),
    ];
    for (what, options) in kinds {
        let picture = session.render(&options).unwrap_or_else(|e| panic!("{what}: {e}"));
        assert!(is_marched(&picture), "{what}: {}", picture.sidecar.renderer);
        assert!(picture.straight.is_some() == options.compare, "{what}");
        if options.vectors != VectorContent::Nothing {
            let vectors = picture.vectors.as_ref().expect("vectors");
            assert!(format!("{vectors:?}").contains("way"), "the route is a line of its own");
        }
    }
    let heat = session.render(&PictureOptions { heatmap: true, ..usual.clone() }).expect("a heat map");
    assert!(heat.sidecar.overlay.heatmap_max.is_some_and(|most| most > 1.0), "its world points are read");
    let camera = Some(CameraPicture::Overhead);
    let camera = session.render(&PictureOptions { camera, ..usual.clone() }).expect("the camera from above");
    assert_eq!(camera.sidecar.renderer, NAME);
    let bands =
        session.render_to(&PictureOptions { band_rows: Some(16), ..usual.clone() }, &folder.path().join("b.png"), true);
    assert!(bands.is_err_and(|e| e.to_string().contains("this renderer")), "it draws no rows, and says so");
    let other = session.render(&PictureOptions { renderer: RendererName::CPU, ..usual }).expect("the rasteriser");
    assert_eq!(other.sidecar.renderer, "cpu");
}

#[test]
fn measures_and_picks_are_those_of_the_other_renderers() {
    let folder = tempfile::tempdir().expect("a folder");
    prepared(folder.path());
    let session = opened(folder.path());
    let shares = [NAME.into(), RendererName::CPU, RendererName::EXACT].map(|name| {
        let found = measure(&session, &Measure { renderer: name.clone(), ..Measure::default() }, &Progress::silent())
            .expect("a measure");
        assert_eq!(found.renderer, name.as_str());
        assert!(found.measures.largest_difference.is_some_and(|by| by < 0.06), "{name}: the two methods differ");
        found.visible.expect("a route is required")
    });
    assert!(shares.iter().all(|share| (share - shares[0]).abs() < 1e-9), "{shares:?}: judged by lines of sight");
    let options = PictureOptions { aux: vec![AuxBuffer::Depth, AuxBuffer::World], ..PictureOptions::default() };
    let frame = session.render(&options).expect("a picture").frame;
    let pixels: Vec<[f64; 2]> =
        (0..96).step_by(7).flat_map(|x| (0..54).step_by(7).map(move |y| [x as f64 + 0.5, y as f64 + 0.5])).collect();
    let picked = belvedere::pick::pick(&session, &pixels, &Progress::silent()).expect("picks");
    let mut judged = 0;
    for (pixel, picked) in pixels.iter().zip(&picked.pixels) {
        let Some(picked) = picked.as_ref().filter(|picked| picked.layer == "ground") else { continue };
        let depth = f64::from(frame.depth[pixel[1] as usize * 96 + pixel[0] as usize]);
        judged += usize::from((depth / picked.depth - 1.0).abs() < 0.01);
    }
    let ground = picked.pixels.iter().flatten().filter(|picked| picked.layer == "ground").count();
    // The steps of the marcher are long: it passes through some crests.
    assert!(ground > 30 && judged * 4 >= ground * 3, "{judged} of {ground} pixels have the depth that is picked");
}

#[test]
fn verbs_that_search_and_films_are_drawn_by_it() {
    let folder = tempfile::tempdir().expect("a folder");
    let [dem, way] = prepared(folder.path());
    let stated = belvedere::request::Stated::in_crs("EPSG:32632");
    let asked = Reveal {
        data: dem.clone(),
        features: vec![way.clone()],
        stated: stated.clone(),
        size: Some([96, 54]),
        renderer: NAME.into(),
        ..Reveal::default()
    };
    let found = reveal(&asked, &Setting::default()).expect("a picture");
    assert!(is_marched(&found.picture), "reveal");
    let sheet = drafts(&asked, 2, &Setting::default()).expect("drafts");
    let (_, _, colors) = sheet.sheet();
    let marched = colors.iter().filter(|color| [Marcher::GROUND, Marcher::SKY].contains(*color)).count();
    assert!(2 * marched > colors.len(), "drafts: {marched} of {}", colors.len());
    let place = |text: &str| Some(text.parse().expect("a place"));
    let moved = Disocclude {
        data: dem,
        features: vec![way],
        stated,
        eye: place("503000,5000100,700"),
        look: place("503000,5003000"),
        ..Disocclude::default()
    };
    let ground = disocclude(&moved, &OpenOptions::default()).expect("ground");
    let files = DisoccludeFiles { out: folder.path().join("out.tif"), ..DisoccludeFiles::default() };
    ground.write(&files, true, &Progress::silent()).expect("files");
    let motion =
        AnimationDoc { turntable: Some(TurntableDoc { deg_per_s: 90.0 }), frames: Some(2), ..AnimationDoc::default() };
    let request = AnimateRequest { animation: motion, out: folder.path().join("film"), ..AnimateRequest::default() };
    let film = animate(&opened(folder.path()), &request, &Progress::silent()).expect("a film");
    assert_eq!((film.manifest.settings.renderer.as_str(), film.drawn), (NAME, 2));
}

#[test]
fn an_unknown_name_is_told_with_the_nearest_one() {
    let folder = tempfile::tempdir().expect("a folder");
    prepared(folder.path());
    let session = opened(folder.path());
    let refused = session.render(&PictureOptions { renderer: "exakt".into(), ..PictureOptions::default() });
    let said = refused.map(|_| ()).map_err(|e| e.to_string());
    assert_eq!(said, Err("there is no renderer \"exakt\"; did you mean \"exact\"?".into()));
    let scene = folder.path().join("hills.toml");
    let text = std::fs::read_to_string(&scene).expect("the scene").replace("\"marcher\"", "\"marchers\"");
    std::fs::write(&scene, text).expect("a file");
    let refused = Session::open(&scene, &OpenOptions::default()).map(|_| ()).map_err(|e| e.to_string());
    assert!(
        refused.as_ref().is_err_and(|e| e.contains("no renderer \"marchers\"; did you mean \"marcher\"?")),
        "{refused:?}"
    );
}
