//! Draws heights and a path from memory as a picture file.

use belvedere::core::{DVec2, DVec3, Pinhole, Projection, View};
use belvedere::scene::{Heightfield, Scene};
use belvedere::{PictureOptions, Session};
use std::path::Path;

/// Draws `hills.png` and its record into `folder`.
pub fn run(folder: &Path) -> Result<(), Box<dyn std::error::Error>> {
    // 200 x 200 nodes, 25 m apart, row 0 in the north.
    let height = |i: usize| (120.0 * ((i % 200) as f32 / 14.0).sin() * ((i / 200) as f32 / 18.0).cos()) + 120.0;
    let heights = (0..200 * 200).map(height).collect();
    let ground = Heightfield::measured(DVec2::new(0.0, 4975.0), DVec2::splat(25.0), 200, 200, heights)?;
    let path = [DVec2::new(500.0, 600.0), DVec2::new(2600.0, 2400.0), DVec2::new(4300.0, 4500.0)];
    let scene = Scene::default().with_terrain("ground", ground).with_line("path", &path);

    let (eye, target) = (DVec3::new(2500.0, -2500.0, 1800.0), DVec3::new(2500.0, 2200.0, 100.0));
    let lens = Projection::Perspective { fov_y: 45f64.to_radians() };
    let camera = Pinhole::look_at(eye, target, DVec3::Z, lens, [480, 270], 1.0, None)?;

    let picture = Session::from_parts(scene, View::straight(camera)).render(&PictureOptions::default())?;
    picture.write(&folder.join("hills.png"), true)?;
    Ok(())
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    run(Path::new("."))
}
