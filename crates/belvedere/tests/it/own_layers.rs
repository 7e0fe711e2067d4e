//! A kind of layer that only this test knows goes through the verbs like those of the program.

use belvedere::core::map::curved_rays::{Model, Pencil, Sharpness, TurnSpec};
use belvedere::core::{CurvedRays, DVec2, DVec3, Pinhole, Projection, Stage, View};
use belvedere::export::{ExportOptions, export};
use belvedere::pick::pick;
use belvedere::scene::{
    BoxLayer, BoxShape, Color, Heightfield, LayerContent, Mesh, MeshColors, MeshLayer, NodeState, OwnLayer, Progress,
    Scene,
};
use belvedere::vectors::VectorContent;
use belvedere::verbs::check::check;
use belvedere::verbs::measure::MeasureOptions;
use belvedere::{PictureOptions, RendererName, Session};

/// Two sails, 60 m high.
#[derive(Debug)]
struct Sails;

impl LayerContent for Sails {
    fn kind(&self) -> &'static str {
        "sails"
    }

    fn surface(&self) -> MeshLayer {
        let sail =
            |x: f64| [[x, 400.0, 100.0], [x + 60.0, 400.0, 100.0], [x + 30.0, 400.0, 160.0]].map(DVec3::from_array);
        let corners: Vec<DVec3> = [440.0, 510.0].into_iter().flat_map(sail).collect();
        let triangles = vec![[0, 1, 2], [3, 4, 5]];
        let mesh = Mesh::in_parts(&corners, triangles, MeshColors::Layer, vec![0, 1]).expect("finite corners");
        let names = vec!["fore".into(), "main".into()];
        MeshLayer { names, ..MeshLayer::new(mesh, Color::rgb(220, 40, 40)) }
    }

    fn count(&self) -> Option<usize> {
        Some(2)
    }
}

/// Level ground, a wall, and the sails behind it.
fn scene() -> Scene {
    let ground = Heightfield::new(
        DVec2::new(0.0, 1000.0),
        DVec2::splat(100.0),
        11,
        11,
        vec![100.0; 121],
        vec![NodeState::Measured; 121],
    );
    let wall = BoxShape {
        base: DVec3::new(505.0, 250.0, 100.0),
        size: DVec3::new(300.0, 10.0, 80.0),
        yaw: 0.0,
        color: Color::rgb(120, 120, 130),
    };
    let mut scene = Scene::default()
        .with_terrain("ground", ground.expect("a ground"))
        .with_layer("wall", BoxLayer::new(vec![wall]))
        .with_layer("boat", OwnLayer::new(Sails));
    scene.layers[2].must_see = true;
    scene
}

fn pinhole() -> Pinhole {
    let lens = Projection::Perspective { fov_y: 0.7 };
    let (eye, target) = (DVec3::new(505.0, 20.0, 130.0), DVec3::new(505.0, 400.0, 340.0));
    Pinhole::look_at(eye, target, DVec3::Z, lens, [120, 80], 1.0, None).expect("a camera")
}

/// Rays that rise over the wall and come down behind it.
fn over_the_wall() -> View {
    let plane = |y: f64| DVec3::new(505.0, y, 130.0);
    let spec = TurnSpec {
        viewpoint: DVec3::new(505.0, 20.0, 320.0),
        t0: plane(160.0),
        t1: plane(200.0),
        t2: plane(240.0),
        pencil: Pencil::Parallel { normal: -DVec3::Y },
        m: Sharpness::Bend,
    };
    let rays = CurvedRays::new(&pinhole(), Model::Modified, &[spec]).expect("the turn is valid");
    View::new(pinhole(), vec![Stage::CurvedRays(rays)]).expect("one stage is in order")
}

#[test]
fn it_is_drawn_alike_by_both_renderers_where_it_is_picked() {
    let session = Session::from_parts(scene(), over_the_wall());
    let frames = [RendererName::CPU, RendererName::EXACT].map(|renderer| {
        session.render(&PictureOptions { renderer, ..PictureOptions::default() }).expect("a picture").frame
    });
    let own = frames.each_ref().map(|frame| frame.id.iter().filter(|id| **id == 3).count());
    assert!(own[0] > 100 && own[0].abs_diff(own[1]) * 50 < own[0], "{own:?} pixels of the sails");
    let at = frames[0].id.iter().rposition(|id| *id == 3).expect("a pixel of the sails");
    let [x, y] = [at % 120, at / 120].map(|v| v as f64 + 0.5);
    let picked = pick(&session, &[[x, y]], &Progress::silent()).expect("a pick").pixels;
    let picked = picked[0].as_ref().expect("the sails");
    assert_eq!(picked.layer, "boat");
    assert!(["fore", "main"].contains(&picked.feature.as_deref().unwrap_or_default()), "{:?}", picked.feature);
    assert!((picked.point[1] - 400.0).abs() < 0.01, "{:?}", picked.point);
}

#[test]
fn it_is_measured_straight_and_bent() {
    let session = Session::from_parts(scene(), over_the_wall());
    let found = session.measure(&MeasureOptions::default()).expect("a measure");
    let [straight, bent] =
        [found.visible_straight, found.visible_bent].map(|share| share.expect("a surface is required"));
    assert!(straight < 0.05 && bent > 0.9, "{straight} {bent}");
    assert!(found.measures.largest_difference.is_some_and(|by| by < 0.1), "{:?}", found.measures.largest_difference);
}

#[test]
fn it_is_exported_and_counted_and_named_where_it_is_refused() {
    let session = Session::from_parts(scene(), View::straight(pinhole()));
    let made = export(&session, &ExportOptions::default()).expect("a file");
    let text = String::from_utf8_lossy(&made.glb);
    assert!(text.contains("boat"), "the file names the layer");
    assert!(made.report.triangles > 200, "{}", made.report.triangles);
    let checked = check(&session).expect("it can be drawn");
    let boat = checked.layers.iter().find(|layer| layer.id == "boat").expect("the layer");
    assert_eq!((boat.kind, boat.count), ("sails", 2));
    let alone =
        Session::from_parts(Scene::default().with_layer("boat", OwnLayer::new(Sails)), View::straight(pinhole()));
    let refused = alone.render(&PictureOptions { vectors: VectorContent::Alone, ..PictureOptions::default() });
    let said = refused.map(|_| ()).map_err(|e| e.to_string());
    assert!(said.as_ref().is_err_and(|e| e.contains("boat (sails)")), "{said:?}");
}
