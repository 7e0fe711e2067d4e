//! Builder of pinholes: parameters that are not set have defaults.

use super::{Pinhole, PinholeError, Projection};
use glam::DVec3;

/// Builder of a pinhole, see [`Pinhole::looking`].
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PinholeBuilder {
    eye: DVec3,
    target: DVec3,
    up: DVec3,
    projection: Projection,
    image: [u32; 2],
    near: f64,
    far: Option<f64>,
}

impl Pinhole {
    /// Builder of a camera at `eye` that looks at `target` (scene coordinates). Defaults: up is +Z, vertical field of view 45 degrees,
    /// 1280 x 720 pixels, near depth a thousandth of the distance, no far depth.
    ///
    /// ```
    /// use belvedere_core::{DVec3, Pinhole};
    /// let camera = Pinhole::looking(DVec3::new(0.0, 0.0, 30.0), DVec3::Y * 100.0).fov_y_deg(70.0).image([320, 240]).build()?;
    /// assert_eq!(camera.image, [320, 240]);
    /// # Ok::<(), belvedere_core::PinholeError>(())
    /// ```
    pub fn looking(eye: DVec3, target: DVec3) -> PinholeBuilder {
        PinholeBuilder {
            eye,
            target,
            up: DVec3::Z,
            projection: Projection::Perspective { fov_y: 45f64.to_radians() },
            image: [1280, 720],
            near: 1e-3 * eye.distance(target),
            far: None,
        }
    }
}

impl PinholeBuilder {
    /// Direction that is up in the picture.
    #[must_use]
    pub fn up(self, up: DVec3) -> Self {
        Self { up, ..self }
    }

    /// A perspective with this full vertical field of view, degrees.
    #[must_use]
    pub fn fov_y_deg(self, fov_y_deg: f64) -> Self {
        Self { projection: Projection::Perspective { fov_y: fov_y_deg.to_radians() }, ..self }
    }

    /// A parallel projection whose picture is this high, scene units.
    #[must_use]
    pub fn parallel(self, height: f64) -> Self {
        Self { projection: Projection::Orthographic { height }, ..self }
    }

    /// Width and height of the picture, pixels.
    #[must_use]
    pub fn image(self, image: [u32; 2]) -> Self {
        Self { image, ..self }
    }

    /// Nearest drawn depth, scene units.
    #[must_use]
    pub fn near(self, near: f64) -> Self {
        Self { near, ..self }
    }

    /// Farthest drawn depth, scene units.
    #[must_use]
    pub fn far(self, far: f64) -> Self {
        Self { far: Some(far), ..self }
    }

    /// Builds the pinhole.
    ///
    /// # Errors
    /// Those of [`Pinhole::look_at`].
    pub fn build(self) -> Result<Pinhole, PinholeError> {
        let Self { eye, target, up, projection, image, near, far } = self;
        Pinhole::look_at(eye, target, up, projection, image, near, far)
    }
}
