//! Selection of the points that a picture can show, in plan, and the check of its eye.

use crate::{Field, ReferencePoint};
use belvedere_core::{DVec2, DVec3, Pinhole, Projection};

/// Points nearer than this many guards to the eye are left out.
pub(crate) const NEAREST_GUARDS: f64 = 3.0;

/// An eye from which nothing can be solved.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum EyeError {
    /// Below the ground.
    #[error("eye at ({x:.1}, {y:.1}, {z:.1}) is {:.1} m below the ground, which is {ground:.1} m high there; raise it", ground - z)]
    UnderGround {
        /// x of the eye.
        x: f64,
        /// y of the eye.
        y: f64,
        /// Height of the eye.
        z: f64,
        /// Height of the ground there.
        ground: f64,
    },
    /// NaN or infinite.
    #[error("eye ({x}, {y}, {z}) is not finite; give finite coordinates")]
    NotFinite {
        /// x of the eye.
        x: f64,
        /// y of the eye.
        y: f64,
        /// Height of the eye.
        z: f64,
    },
}

/// Whether lines of sight can start at `eye` (scene coordinates): above the ground, or beside the terrain.
///
/// # Errors
/// [`EyeError`].
pub fn check_eye(field: &Field, eye: DVec3) -> Result<(), EyeError> {
    let DVec3 { x, y, z } = eye;
    if !eye.is_finite() {
        return Err(EyeError::NotFinite { x, y, z });
    }
    match field.surface_at(field.grid_from_scene(eye.truncate())) {
        Some(ground) if ground >= z => Err(EyeError::UnderGround { x, y, z, ground }),
        _ => Ok(()),
    }
}

/// The part of the map that a picture shows, in plan: the ground moves up and down, so nothing is cut by height.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Wedge {
    /// Eye, scene x and y.
    pub eye: DVec2,
    /// Direction of view, scene x and y; zero if the wedge is all around.
    pub heading: DVec2,
    /// Largest angle to the heading, radians; pi = all around.
    pub half_angle: f64,
    /// Least distance to the eye in plan, scene units.
    pub near: f64,
    /// Largest distance to the eye in plan, scene units; may be infinite.
    pub far: f64,
}

impl Wedge {
    /// All around `eye`.
    pub fn all_around(eye: DVec2) -> Self {
        Self { eye, heading: DVec2::ZERO, half_angle: std::f64::consts::PI, near: 0.0, far: f64::INFINITY }
    }

    /// Everything that a perspective camera might show at any height; all around for a parallel one, and for one that
    /// sees the ground straight below or the sky straight above itself.
    pub fn of_pinhole(camera: &Pinhole) -> Self {
        let all = Self::all_around(camera.eye.truncate());
        let Projection::Perspective { fov_y } = camera.projection else { return all };
        let half_height = (0.5 * fov_y).tan();
        let half_width = half_height * f64::from(camera.image[0]) / f64::from(camera.image[1]);
        // Straight up and down in view space.
        let vertical = DVec2::new(camera.right.z, camera.down.z) / camera.forward.z;
        if vertical.x.abs() <= half_width && vertical.y.abs() <= half_height {
            return all;
        }
        let heading = camera.forward.truncate();
        let corner = |x: f64, y: f64| {
            let ray = camera.forward + x * half_width * camera.right + y * half_height * camera.down;
            heading.angle_to(ray.truncate()).abs()
        };
        let half_angle = corner(-1.0, -1.0).max(corner(1.0, -1.0)).max(corner(-1.0, 1.0)).max(corner(1.0, 1.0));
        Self { heading, half_angle, far: camera.far.unwrap_or(f64::INFINITY), ..all }
    }

    /// Whether a scene position is in it.
    pub fn contains(&self, p: DVec2) -> bool {
        let to = p - self.eye;
        let distance = to.length();
        let around = self.half_angle >= std::f64::consts::PI || self.heading == DVec2::ZERO;
        distance >= self.near
            && distance <= self.far
            && (around || distance == 0.0 || self.heading.angle_to(to).abs() <= self.half_angle)
    }
}

/// Why a reference point is left out in this view.
#[derive(Debug, Clone, Copy, PartialEq, Eq, serde::Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "snake_case")]
pub enum LeftOut {
    /// Outside the wedge.
    OutOfView,
    /// So near to the eye that the ground around it is the eye's own: nearer than three guards.
    TooNear,
}

/// Indices of the points that are in view, and the others with the reason.
pub fn in_view(
    field: &Field,
    points: &[ReferencePoint],
    wedge: &Wedge,
    guard: f64,
) -> (Vec<usize>, Vec<(usize, LeftOut)>) {
    let eye = field.grid_from_scene(wedge.eye);
    let (mut seen, mut left_out) = (Vec::new(), Vec::new());
    for (i, p) in points.iter().enumerate() {
        if !wedge.contains(field.scene_from_grid(p.grid)) {
            left_out.push((i, LeftOut::OutOfView));
        } else if (p.grid - eye).length() < NEAREST_GUARDS * guard {
            left_out.push((i, LeftOut::TooNear));
        } else {
            seen.push(i);
        }
    }
    (seen, left_out)
}
