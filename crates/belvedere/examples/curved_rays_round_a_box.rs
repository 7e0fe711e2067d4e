//! A camera whose rays bend over a building, so that it sees the ground behind.

use belvedere::core::map::curved_rays::{Model, Pencil, Sharpness, TurnSpec};
use belvedere::core::{CurvedRays, DVec2, DVec3, Pinhole, Stage, View};
use belvedere::scene::{BoxLayer, BoxShape, Color, Heightfield, LayerKind, Scene};
use belvedere::{BelvedereError, PictureOptions, Session};
use std::path::Path;

/// Id of the layer that a view shows at the image of a point, if any.
fn layer_at(session: &Session, point: DVec3) -> Result<Option<String>, BelvedereError> {
    let Ok(image) = session.view().project(point) else { return Ok(None) };
    let seen = session.pick(&[image.pixel.to_array()])?;
    Ok(seen.into_iter().flatten().next().map(|seen| seen.layer))
}

/// The layer that a straight and a bent view show in the direction of a point behind the building; draws the bent one.
pub fn run(folder: &Path) -> Result<[Option<String>; 2], Box<dyn std::error::Error>> {
    let ground = Heightfield::measured(DVec2::new(-200.0, 400.0), DVec2::splat(10.0), 41, 61, vec![0.0; 41 * 61])?;
    let building = BoxShape {
        base: DVec3::new(0.0, 100.0, 0.0),
        size: DVec3::new(80.0, 20.0, 60.0),
        yaw: 0.0,
        color: Color::rgb(201, 194, 184),
    };
    let building = LayerKind::Boxes(BoxLayer::new(vec![building]));
    let scene = Scene::default().with_terrain("ground", ground).with_layer("building", building);

    let eye = DVec3::new(0.0, 0.0, 30.0);
    let target = DVec3::new(0.0, 70.0, 60.0);
    let camera = Pinhole::looking(eye, target).fov_y_deg(70.0).image([320, 240]).near(1.0).build()?;
    // Between the planes y = 60 and y = 80 the rays turn downwards; behind them they run as if they came from 100 m higher up.
    let turn = TurnSpec {
        viewpoint: eye + DVec3::new(0.0, 0.0, 100.0),
        t0: DVec3::new(0.0, 60.0, 0.0),
        t1: DVec3::new(0.0, 70.0, 0.0),
        t2: DVec3::new(0.0, 80.0, 0.0),
        pencil: Pencil::Parallel { normal: -DVec3::Y },
        m: Sharpness::Bend,
    };
    let rays = CurvedRays::new(&camera, Model::Modified, &[turn])?;

    let straight = Session::from_parts(scene, View::straight(camera.clone()));
    let bent = straight.clone().with_view(View::new(camera, vec![Stage::CurvedRays(rays)])?);
    bent.render(&PictureOptions::default())?.write(&folder.join("round_a_box.png"), true)?;
    let behind = DVec3::new(0.0, 260.0, 0.0);
    Ok([layer_at(&straight, behind)?, layer_at(&bent, behind)?])
}

#[allow(clippy::print_stdout, reason = "a program, not a library")]
fn main() -> Result<(), Box<dyn std::error::Error>> {
    let [straight, bent] = run(Path::new("."))?.map(|layer| layer.unwrap_or_else(|| "nothing".into()));
    println!("towards a point behind the building the straight view shows {straight}, the bent one {bent}");
    Ok(())
}
