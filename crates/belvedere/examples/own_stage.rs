//! A displacement of one's own, and the law that makes it a camera: what a pixel's ray meets is seen at that pixel.
//!
//! Renderers draw the stages of [`belvedere::core::Stage`]; research code implements [`SpaceMap`] and has everything that is
//! computed from a map: projection, rays, depth.

use belvedere::core::map::Miss;
use belvedere::core::{DMat3, DVec2, DVec3, Pinhole, Projection, SpaceMap};

/// Lowers what lies farther from the eye, smoothly: `z' = z - drop * s^2 / (s^2 + reach^2)` with `s = y` ahead of the eye.
struct Ramp {
    drop: f64,
    reach: f64,
}

impl Ramp {
    fn lowered(&self, y: f64) -> f64 {
        let s = y.max(0.0);
        self.drop * s * s / (s * s + self.reach * self.reach)
    }
}

impl SpaceMap for Ramp {
    fn apply(&self, p: DVec3) -> Result<DVec3, Miss> {
        Ok(p - self.lowered(p.y) * DVec3::Z)
    }

    fn invert(&self, p: DVec3) -> Result<DVec3, Miss> {
        Ok(p + self.lowered(p.y) * DVec3::Z)
    }

    fn jacobian(&self, p: DVec3) -> Result<DMat3, Miss> {
        let (s, r) = (p.y.max(0.0), self.reach * self.reach);
        let slope = self.drop * 2.0 * s * r / (s * s + r).powi(2);
        Ok(DMat3::from_cols(DVec3::X, DVec3::new(0.0, 1.0, -slope), DVec3::Z))
    }
}

/// Largest distance, in pixels, between a pixel and the image of what its ray meets at several depths; and the least determinant of
/// the map there, which must be above 0.
pub fn run() -> Result<[f64; 2], Box<dyn std::error::Error>> {
    let map = Ramp { drop: 300.0, reach: 2000.0 };
    let lens = Projection::Perspective { fov_y: 0.8 };
    let camera =
        Pinhole::look_at(DVec3::new(0.0, 0.0, 400.0), DVec3::Y * 3000.0, DVec3::Z, lens, [640, 360], 1.0, None)?;
    let (mut worst, mut least) = (0.0f64, f64::INFINITY);
    for i in 0..1000u32 {
        let pixel = DVec2::new(f64::from(i * 37 % 640), f64::from(i * 91 % 360));
        let depth = 10.0 + 5.0 * f64::from(i);
        let point = map.invert(camera.unproject(pixel, depth)).map_err(|miss| format!("{miss:?}"))?;
        let displaced = map.apply(point).map_err(|miss| format!("{miss:?}"))?;
        let (image, _) = camera.project(displaced).map_err(|miss| format!("{miss:?}"))?;
        worst = worst.max(image.distance(pixel));
        least = least.min(map.jacobian(point).map_err(|miss| format!("{miss:?}"))?.determinant());
    }
    Ok([worst, least])
}

#[allow(clippy::print_stdout, reason = "a program, not a library")]
fn main() -> Result<(), Box<dyn std::error::Error>> {
    let [worst, least] = run()?;
    println!("rays and projection agree within {worst:e} pixels; the least determinant is {least}");
    Ok(())
}
