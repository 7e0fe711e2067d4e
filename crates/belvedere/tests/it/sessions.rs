//! Sessions from memory and from text, and the frames of an animation.

use belvedere::core::{DVec2, DVec3, Pinhole, Projection, View};
use belvedere::cpu::ExactRenderer;
use belvedere::scene::{Heightfield, LayerKind, Scene};
use belvedere::{BelvedereError, OpenOptions, PictureOptions, RendererName, Session};
use std::path::Path;
use std::sync::Arc;

fn hills() -> Scene {
    let heights = (0..40 * 40).map(|i| 50.0 * ((i % 40) as f32 / 5.0).sin()).collect();
    let ground = Heightfield::measured(DVec2::new(0.0, 390.0), DVec2::splat(10.0), 40, 40, heights).unwrap();
    Scene::default()
        .with_terrain("ground", ground)
        .with_line("path", &[DVec2::new(20.0, 50.0), DVec2::new(350.0, 300.0)])
}

fn view(height: f64) -> View {
    let (eye, lens) = (DVec3::new(200.0, -200.0, height), Projection::Perspective { fov_y: 0.8 });
    View::straight(Pinhole::look_at(eye, DVec3::new(200.0, 200.0, 0.0), DVec3::Z, lens, [64, 48], 1.0, None).unwrap())
}

#[test]
fn layers_from_memory_are_drawn_and_recorded() {
    let session = Session::from_parts(hills(), view(200.0));
    let picture = session.render(&PictureOptions::default()).unwrap();
    assert!(picture.frame.id.contains(&1) && picture.frame.id.contains(&2), "ground and path");
    assert!(picture.sidecar.scene.is_none() && picture.sidecar.inputs.is_empty());
    let LayerKind::Line(line) = &session.scene().layers[1].kind else { panic!("a line") };
    assert!(line.features[0].points.len() > 2 && session.scene().layers[1].must_see, "laid on the ground");
    let higher = session.clone().with_view(view(400.0)).render(&PictureOptions::default()).unwrap();
    let alone = Session::from_parts(hills(), view(400.0)).render(&PictureOptions::default()).unwrap();
    assert!(higher.frame.color == alone.frame.color && higher.frame.color != picture.frame.color);
}

#[test]
fn a_session_draws_with_the_renderer_that_it_is_given() {
    let session = Session::from_parts(hills(), view(200.0));
    let exact = PictureOptions { renderer: RendererName::EXACT, ..PictureOptions::default() };
    let asked = session.render(&exact).unwrap().frame.color;
    let given = session.clone().with_renderer(Arc::new(ExactRenderer)).render(&PictureOptions::default()).unwrap();
    assert!(given.frame.color == asked);
    let usual = session.render(&PictureOptions::default()).unwrap().frame.color;
    assert!(usual != asked, "edges are sampled in other ways");
}

#[test]
fn an_eye_under_ground_is_an_error_with_numbers() {
    let lens = Projection::Perspective { fov_y: 0.8 };
    let under =
        Pinhole::look_at(DVec3::new(80.0, 80.0, 0.0), DVec3::ZERO, DVec3::Z, lens, [64, 48], 1.0, None).unwrap();
    let refused = Session::from_parts(hills(), View::straight(under)).render(&PictureOptions::default());
    let Err(BelvedereError::UnderGround { eye_m, ground_m }) = refused else { panic!("{refused:?}") };
    assert!(eye_m == 0.0 && ground_m > 40.0);
}

#[test]
fn frames_of_an_animation_are_sessions() {
    let text = "format = 1\n[camera]\neye = [0.0, -100.0, 20.0]\nlook_at = [0.0, 0.0, 0.0]\n\
        [animation]\nturntable = { deg_per_s = 90.0 }\nfps = 10.0\n";
    let session = Session::from_text(Path::new("turn.toml"), text, &OpenOptions::default()).unwrap();
    let eye = |time_s| session.frame_at(time_s).unwrap().view().pinhole().eye;
    assert!(eye(0.0).distance(DVec3::new(0.0, -100.0, 20.0)) < 1e-9);
    assert!(eye(1.0).distance(DVec3::new(100.0, 0.0, 20.0)) < 1e-9, "{}", eye(1.0));
    assert_eq!(eye(1.04), eye(1.0), "the nearest frame");
    assert_eq!(eye(1e9), eye(3.9), "the last frame");
    let still = Session::from_parts(hills(), view(200.0)).frame_at(0.0);
    assert!(matches!(still, Err(BelvedereError::NoAnimation)));
}

#[test]
fn the_record_of_a_picture_is_of_what_was_read() {
    let folder = tempfile::tempdir().unwrap();
    let (dem, scene) = (folder.path().join("dem.asc"), folder.path().join("s.toml"));
    let text = "format = 1\n[camera]\neye = [50.0, -100.0, 80.0]\nlook_at = [50.0, 50.0, 0.0]\nimage = [32, 24]\n\
        [[layer]]\nid = 'ground'\nkind = 'terrain'\nsource = 'dem.asc'\n";
    let grid = "ncols 2\nnrows 2\nxllcorner 0\nyllcorner 0\ncellsize 100\n1 2\n3 4\n";
    std::fs::write(&dem, grid).unwrap();
    std::fs::write(&scene, text).unwrap();
    let session = Session::open(&scene, &OpenOptions::default()).unwrap();
    std::fs::write(&dem, "something else").unwrap();
    std::fs::remove_file(&scene).unwrap();
    let inputs = session.render(&PictureOptions::default()).unwrap().sidecar.inputs;
    let found: Vec<(&Path, u64, &str)> =
        inputs.iter().map(|i| (i.path.as_path(), i.bytes, i.sha256.as_str())).collect();
    let hash = |text: &str| belvedere::io::sha256(text.as_bytes());
    let [of_scene, of_dem] = [hash(text), hash(grid)];
    let [scene, dem] = ["s.toml", "dem.asc"].map(Path::new);
    assert_eq!(found, [(scene, text.len() as u64, &*of_scene), (dem, grid.len() as u64, &*of_dem)]);
}

#[test]
fn pictures_without_the_bend_show_the_representation_of_the_nearest_section() {
    let text = "format = 1\ncrs = 'local'\n[representations]\nback = ['map']\nfront = ['relief']\n\
        [camera]\neye = [0.0, -5200.0, 3600.0]\nlook_at = [0.0, 0.0, 0.0]\nimage = [32, 24]\n\
        [[layer]]\nid = 'map'\nkind = 'terrain'\nsource = 'builtin:massif?seed=7&size=65'\n\
        [[layer]]\nid = 'relief'\nkind = 'terrain'\nsource = 'builtin:massif?seed=7&size=65'\n\
        [[stage]]\nkind = 'spline_bend'\n[stage.presets]\nversion = 1\nunits = 'distance'\n\
        [[stage.presets.presets]]\nphi = 33\ns = 0.4\ne = 1.6\ncontrol = [[0, -0.22], [0.45, -0.12], [0.80, 0.05], [0.98, 0.62]]\n\
        tags = [{ u = 0.5, delta = 0.05 }]\nsections = ['front', 'back']\n";
    let session = Session::from_text(Path::new("land.toml"), text, &OpenOptions::default()).unwrap();
    let straight = PictureOptions { straight: true, ..PictureOptions::default() };
    let ids = session.render(&straight).unwrap().frame.id;
    assert!(ids.contains(&2) && !ids.contains(&1), "relief alone");
}
