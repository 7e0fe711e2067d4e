//! The planar pinhole camera, perspective or orthographic.

use super::ImageBox;
use crate::plain::number;
use crate::{Aabb, Miss};
use glam::{DVec2, DVec3};

/// How a [`Pinhole`] maps view space onto the image.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Projection {
    /// Full vertical field of view in radians, in (0, pi).
    Perspective {
        /// Full vertical field of view, radians.
        fov_y: f64,
    },
    /// Parallel rays; `height` scene units fill the image from top to bottom.
    Orthographic {
        /// Height of the picture in scene units, > 0.
        height: f64,
    },
}

/// A pinhole camera with square pixels and the principal point at the image centre.
///
/// Fields are consistent by construction ([`Pinhole::look_at`]): `right`, `down`, `forward` are orthonormal and right-handed.
#[derive(Debug, Clone, PartialEq)]
pub struct Pinhole {
    /// Eye, scene coordinates.
    pub eye: DVec3,
    /// Unit vector towards larger pixel x.
    pub right: DVec3,
    /// Unit vector towards larger pixel y.
    pub down: DVec3,
    /// Unit vector along the optical axis.
    pub forward: DVec3,
    /// Perspective or orthographic.
    pub projection: Projection,
    /// Width and height in pixels, each in 1..=65535.
    pub image: [u32; 2],
    /// Nearest drawn depth, scene units, > 0.
    pub near: f64,
    /// Farthest drawn depth, scene units; `None` = no limit.
    pub far: Option<f64>,
}

/// What is wrong with the range of depths.
fn depths(near: f64, far: f64) -> String {
    let near_text = number(near);
    if !(near > 0.0) {
        format!("camera near is {near_text}, it must be greater than 0")
    } else {
        format!("camera far is {}, it must be greater than near = {near_text}", number(far))
    }
}

/// Camera parameters that are not valid.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum PinholeError {
    /// A parameter is NaN or infinite.
    #[error("camera {name} is not a finite number ({value}); give finite values")]
    NotFinite {
        /// Which parameter.
        name: &'static str,
        /// The value.
        value: f64,
    },
    /// Eye and look-at coincide.
    #[error("camera eye and look_at are the same point (distance {}); move one of them", number(*distance))]
    EyeIsTarget {
        /// Distance in scene units.
        distance: f64,
    },
    /// The camera looks along `up`.
    #[error(
        "camera looks along its up direction (sine of the angle {}, at least 1e-6 needed); tilt the view or give another up", number(*sine)
    )]
    AlongUp {
        /// Sine of the angle between forward and up.
        sine: f64,
    },
    /// Field of view out of range.
    #[error("camera fov_y_deg is {fov_deg}, it must lie strictly between 0 and 180")]
    FieldOfView {
        /// Offending value, degrees.
        fov_deg: f64,
    },
    /// Orthographic height out of range.
    #[error("camera ortho_height_m is {height}, it must be greater than 0")]
    OrthoHeight {
        /// Offending value, scene units.
        height: f64,
    },
    /// A side of the image is outside 1..=65535 pixels.
    #[error("camera image is {width} x {height} pixels, each side must be in 1..=65535")]
    ImageSize {
        /// Width in pixels.
        width: u32,
        /// Height in pixels.
        height: u32,
    },
    /// `near` and `far` do not satisfy 0 < near < far.
    #[error("{}", depths(*near, *far))]
    Range {
        /// Near depth, scene units.
        near: f64,
        /// Far depth, scene units.
        far: f64,
    },
}

impl Pinhole {
    /// Camera at `eye` looking at `look_at`, upright with respect to `up`.
    ///
    /// `fwd = unit(look_at - eye)`, `right = unit(fwd x up)`, `down = fwd x right`.
    ///
    /// # Errors
    /// Every [`PinholeError`].
    ///
    /// ```
    /// use belvedere_core::{DVec3, Pinhole, Projection};
    /// let camera = Pinhole::look_at(
    ///     DVec3::ZERO, DVec3::Y, DVec3::Z,
    ///     Projection::Perspective { fov_y: 45f64.to_radians() }, [1280, 720], 1.0, None,
    /// )?;
    /// let (pixel, depth) = camera.project(DVec3::new(0.0, 100.0, 0.0)).unwrap();
    /// assert_eq!((pixel.x, pixel.y, depth), (640.0, 360.0, 100.0));
    /// # Ok::<(), belvedere_core::PinholeError>(())
    /// ```
    pub fn look_at(
        eye: DVec3,
        look_at: DVec3,
        up: DVec3,
        projection: Projection,
        image: [u32; 2],
        near: f64,
        far: Option<f64>,
    ) -> Result<Self, PinholeError> {
        for (name, v) in [("eye", eye), ("look_at", look_at), ("up", up)] {
            if let Some(value) = v.to_array().into_iter().find(|c| !c.is_finite()) {
                return Err(PinholeError::NotFinite { name, value });
            }
        }
        check_projection(projection)?;
        let [width, height] = image;
        if !(1..=65535).contains(&width) || !(1..=65535).contains(&height) {
            return Err(PinholeError::ImageSize { width, height });
        }
        let far_or_inf = far.unwrap_or(f64::INFINITY);
        if !(near > 0.0 && near.is_finite() && near < far_or_inf) {
            return Err(PinholeError::Range { near, far: far_or_inf });
        }
        let distance = (look_at - eye).length();
        // At smaller distances the direction is lost in the rounding of the coordinates.
        let resolution = 4.0 * f64::EPSILON * eye.abs().max(look_at.abs()).max_element();
        if distance <= resolution {
            return Err(PinholeError::EyeIsTarget { distance });
        }
        let forward = (look_at - eye) / distance;
        let across = forward.cross(up.normalize_or_zero());
        if across.length() < 1e-6 {
            return Err(PinholeError::AlongUp { sine: across.length() });
        }
        let right = across.normalize();
        Ok(Self { eye, right, down: forward.cross(right), forward, projection, image, near, far })
    }

    /// Pixels per unit tangent (perspective: `H / (2 tan(fov/2))`) or per scene unit (orthographic).
    pub fn scale_px(&self) -> f64 {
        let h = f64::from(self.image[1]);
        match self.projection {
            Projection::Perspective { fov_y } => h / (2.0 * (0.5 * fov_y).tan()),
            Projection::Orthographic { height } => h / height,
        }
    }

    /// Image centre, pixels.
    pub fn center_px(&self) -> DVec2 {
        DVec2::new(f64::from(self.image[0]), f64::from(self.image[1])) * 0.5
    }

    /// Whether `pixel` lies on the image (edges included).
    pub fn contains(&self, pixel: DVec2) -> bool {
        let [w, h] = self.image.map(f64::from);
        (0.0..=w).contains(&pixel.x) && (0.0..=h).contains(&pixel.y)
    }

    /// Pixel and depth of `p`, undisplaced.
    ///
    /// # Errors
    /// [`Miss::BehindEye`] unless the depth is positive; [`Miss::OutsideDomain`] if the pixel is not a finite number.
    pub fn project(&self, p: DVec3) -> Result<(DVec2, f64), Miss> {
        let v = p - self.eye;
        let depth = v.dot(self.forward);
        if !(depth > 0.0) {
            return Err(Miss::BehindEye);
        }
        let lateral = DVec2::new(v.dot(self.right), v.dot(self.down)) * self.scale_px();
        let lateral = if self.is_orthographic() { lateral } else { lateral / depth };
        let pixel = self.center_px() + lateral;
        if pixel.is_finite() && depth.is_finite() { Ok((pixel, depth)) } else { Err(Miss::OutsideDomain) }
    }

    /// Derivative of the pixel with respect to `p`: rows d(pixel.x), d(pixel.y); pixels per scene unit.
    ///
    /// # Errors
    /// As [`Pinhole::project`].
    pub fn jacobian(&self, p: DVec3) -> Result<[DVec3; 2], Miss> {
        let (pixel, depth) = self.project(p)?;
        let (scale, offset) = (self.scale_px(), pixel - self.center_px());
        let row = |axis: DVec3, offset: f64| {
            if self.is_orthographic() { scale * axis } else { (scale * axis - offset * self.forward) / depth }
        };
        Ok([row(self.right, offset.x), row(self.down, offset.y)])
    }

    /// Whether two pinholes have the same rays: everything but `near` and `far` is equal.
    pub fn has_same_rays(&self, other: &Self) -> bool {
        let key = |p: &Self| (p.eye, p.right, p.down, p.forward, p.projection, p.image);
        key(self) == key(other)
    }

    /// The straight ray of `pixel`: its point at depth 0, scene coordinates, and its change per unit of depth.
    pub fn line(&self, pixel: DVec2) -> (DVec3, DVec3) {
        let lateral = (pixel - self.center_px()) / self.scale_px();
        let across = lateral.x * self.right + lateral.y * self.down;
        if self.is_orthographic() { (self.eye + across, self.forward) } else { (self.eye, self.forward + across) }
    }

    /// The point of `pixel`'s straight ray at `depth`, scene coordinates; not finite if the input is not.
    pub fn unproject(&self, pixel: DVec2, depth: f64) -> DVec3 {
        let lateral = (pixel - self.center_px()) / self.scale_px();
        let lateral = if self.is_orthographic() { lateral } else { lateral * depth };
        self.eye + depth * self.forward + lateral.x * self.right + lateral.y * self.down
    }

    /// Whether rays are parallel.
    pub fn is_orthographic(&self) -> bool {
        matches!(self.projection, Projection::Orthographic { .. })
    }

    /// Conservative image of a box: pixel and depth range, or `None` if part of it is not in front of the near plane.
    pub fn image_box(&self, bounds: &Aabb) -> Option<ImageBox> {
        let mut out = ImageBox::EMPTY;
        for corner in bounds.corners() {
            let (pixel, depth) = self.project(corner).ok()?;
            if depth < self.near {
                return None;
            }
            out = out.including(pixel, depth);
        }
        Some(out)
    }
}

fn check_projection(projection: Projection) -> Result<(), PinholeError> {
    match projection {
        Projection::Perspective { fov_y } if !(fov_y > 0.0 && fov_y < std::f64::consts::PI) => {
            Err(PinholeError::FieldOfView { fov_deg: fov_y.to_degrees() })
        }
        Projection::Orthographic { height } if !(height > 0.0 && height.is_finite()) => {
            Err(PinholeError::OrthoHeight { height })
        }
        _ => Ok(()),
    }
}
