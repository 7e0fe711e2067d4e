//! A displacement of one's own as a stage of a view: drawn, picked and measured like those of scene files.
//!
//! Only [`SpaceMap`] has to be implemented; [`StageMap`] has defaults for all that drawing needs further, which a map may override.

use belvedere::core::map::StageMap;
use belvedere::core::{DMat3, DVec2, DVec3, Miss, Pinhole, SpaceMap, Stage, View};
use belvedere::scene::{BoxLayer, BoxShape, Color, Heightfield, Scene};
use belvedere::{BelvedereError, PictureOptions, Session};
use std::path::Path;

/// Raises points smoothly, the more the farther north they lie: `z' = z + rise * y^2 / (y^2 + reach^2)` for `y > 0`.
#[derive(Debug)]
struct Ramp {
    rise: f64,
    reach: f64,
}

impl Ramp {
    fn raised(&self, y: f64) -> f64 {
        let y = y.max(0.0);
        self.rise * y * y / (y * y + self.reach * self.reach)
    }
}

impl SpaceMap for Ramp {
    fn apply(&self, p: DVec3) -> Result<DVec3, Miss> {
        Ok(p + self.raised(p.y) * DVec3::Z)
    }

    fn invert(&self, p_displaced: DVec3) -> Result<DVec3, Miss> {
        Ok(p_displaced - self.raised(p_displaced.y) * DVec3::Z)
    }

    fn jacobian(&self, p: DVec3) -> Result<DMat3, Miss> {
        let (y, r) = (p.y.max(0.0), self.reach * self.reach);
        let slope = self.rise * 2.0 * y * r / (y * y + r).powi(2);
        Ok(DMat3::from_cols(DVec3::X, DVec3::new(0.0, 1.0, slope), DVec3::Z))
    }
}

impl StageMap for Ramp {}

/// Id of the layer that a view shows at the image of a point, if any.
fn layer_at(session: &Session, point: DVec3) -> Result<Option<String>, BelvedereError> {
    let Ok(image) = session.view().project(point) else { return Ok(None) };
    let seen = session.pick(&[image.pixel.to_array()])?;
    Ok(seen.into_iter().flatten().next().map(|seen| seen.layer))
}

/// The layer that a straight view and one with the ramp show in the direction of a point behind a building; draws the latter.
pub fn run(folder: &Path) -> Result<[Option<String>; 2], Box<dyn std::error::Error>> {
    let ground = Heightfield::measured(DVec2::new(-300.0, 600.0), DVec2::splat(10.0), 61, 61, vec![0.0; 61 * 61])?;
    let building = BoxShape {
        base: DVec3::new(0.0, 100.0, 0.0),
        size: DVec3::new(80.0, 20.0, 20.0),
        yaw: 0.0,
        color: Color::rgb(201, 194, 184),
    };
    let scene = Scene::default().with_terrain("ground", ground).with_layer("building", BoxLayer::new(vec![building]));

    let (eye, target) = (DVec3::new(0.0, 0.0, 30.0), DVec3::new(0.0, 100.0, 40.0));
    let camera = Pinhole::looking(eye, target).fov_y_deg(70.0).image([320, 240]).near(1.0).build()?;
    let straight = Session::from_parts(scene, View::straight(camera.clone()));
    let bent = straight.clone().with_view(View::new(camera, vec![Stage::own(Ramp { rise: 400.0, reach: 400.0 })])?);
    bent.render(&PictureOptions::default())?.write(&folder.join("own_stage.png"), true)?;
    let behind = DVec3::new(0.0, 260.0, 0.0);
    Ok([layer_at(&straight, behind)?, layer_at(&bent, behind)?])
}

#[allow(clippy::print_stdout, reason = "a program, not a library")]
fn main() -> Result<(), Box<dyn std::error::Error>> {
    let [straight, ramp] = run(Path::new("."))?.map(|layer| layer.unwrap_or_else(|| "nothing".into()));
    println!("towards a point behind the building the straight view shows {straight}, the one with the ramp {ramp}");
    Ok(())
}
