//! The properties that every displacement and every camera of the project must have, as tests.
//!
//! Describe a map once as a [`MapCase`] and let [`space_map_laws!`](crate::space_map_laws) write the tests:
//!
//! ```
//! use belvedere_core::{Aabb, DVec3, EarthCurvature};
//! use belvedere_testkit::laws::{Continuity, MapCase, Similarity};
//!
//! fn earth() -> MapCase<EarthCurvature> {
//!     let make = |s: &Similarity| EarthCurvature {
//!         eye: s.point(DVec3::ZERO), radius: s.length(6.371e6), refraction: 0.13,
//!     };
//!     let region = Aabb::of([DVec3::new(-9e3, -9e3, 0.0), DVec3::new(9e3, 9e3, 3e3)]);
//!     MapCase::new("earth", region, make)
//!         .continuity(Continuity::Smooth)
//!         .upright()
//!         .identity_at_zero_strength(|| EarthCurvature { eye: DVec3::ZERO, radius: 6.371e6, refraction: 1.0 })
//! }
//! belvedere_testkit::space_map_laws!(earth_laws, super::earth());
//! # fn main() {
//! #     let case = earth();
//! #     belvedere_testkit::laws::map_round_trips(&case);
//! #     belvedere_testkit::laws::map_jacobian_matches_differences(&case);
//! #     belvedere_testkit::laws::map_is_identity_at_zero_strength(&case);
//! #     belvedere_testkit::laws::map_moves_with_its_parameters(&case);
//! # }
//! ```
//!
//! Every failure prints the seed and the inputs; [`MapCase::seed`] replays it.

mod camera;
mod map;
pub mod renderer;

pub use camera::{
    CameraCase, camera_depth_rises_along_rays, camera_jacobian_matches_differences, camera_moves_with_its_parameters,
    camera_never_gives_nan, camera_round_trips,
};
pub use map::{
    Joint, MapCase, map_has_its_continuity, map_is_identity_at_zero_strength, map_jacobian_matches_differences,
    map_keeps_orientation, map_moves_with_its_parameters, map_never_gives_nan, map_round_trips,
};

use crate::Random;
use belvedere_core::{DMat3, DVec3};

/// A movement of the whole scene: `p -> scale * rotation * p + translation`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Similarity {
    /// Factor of all lengths, > 0.
    pub scale: f64,
    /// Proper rotation.
    pub rotation: DMat3,
    /// Shift, scene units after scaling.
    pub translation: DVec3,
}

impl Similarity {
    /// No movement.
    pub const IDENTITY: Self = Self { scale: 1.0, rotation: DMat3::IDENTITY, translation: DVec3::ZERO };

    /// Moved position.
    pub fn point(&self, p: DVec3) -> DVec3 {
        self.scale * (self.rotation * p) + self.translation
    }

    /// Turned direction, same length.
    pub fn direction(&self, v: DVec3) -> DVec3 {
        self.rotation * v
    }

    /// Moved difference of positions.
    pub fn vector(&self, v: DVec3) -> DVec3 {
        self.scale * (self.rotation * v)
    }

    /// Scaled length.
    pub fn length(&self, length: f64) -> f64 {
        self.scale * length
    }

    /// A random movement: shift up to `reach`, scale in 0.2..5, rotation about the vertical only if `upright`.
    pub fn random(random: &mut Random, reach: f64, upright: bool) -> Self {
        let rotation = if upright { DMat3::from_rotation_z(random.range(-3.0, 3.0)) } else { random.rotation() };
        Self {
            scale: (random.range(-1.6, 1.6)).exp(),
            rotation,
            translation: reach * DVec3::new(random.range(-1.0, 1.0), random.range(-1.0, 1.0), random.range(-1.0, 1.0)),
        }
    }
}

/// The continuity class that a map declares, along lines that cross its joints.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Continuity {
    /// Continuous, with kinks.
    C0,
    /// Continuous first derivative.
    C1,
    /// Continuous second derivative.
    C2,
    /// No joints at all.
    Smooth,
}

impl Continuity {
    /// Highest derivative that must not jump (2 is the highest that is measured).
    fn order(self) -> usize {
        match self {
            Self::C0 => 0,
            Self::C1 => 1,
            Self::C2 | Self::Smooth => 2,
        }
    }
}

/// Coordinates that are known to occur in input files.
pub fn hostile_points() -> Vec<DVec3> {
    let values = [0.0, -0.0, 1.0, -1.0, 1e-320, 1e-30, 1e30, -1e30, 1e300, f64::MAX, f64::INFINITY, f64::NAN];
    let mut points: Vec<DVec3> = values.iter().map(|&v| DVec3::splat(v)).collect();
    for &v in &values {
        points.extend([DVec3::new(v, 0.0, 0.0), DVec3::new(0.0, v, 0.0), DVec3::new(0.0, 0.0, v)]);
        points.extend([DVec3::new(v, -v, 1.0), DVec3::new(5.0, v, -v)]);
    }
    points
}

/// The laws of a [`SpaceMap`](belvedere_core::SpaceMap) by the names of their tests.
pub mod space_map {
    pub use super::map::{
        map_has_its_continuity as has_its_continuity, map_is_identity_at_zero_strength as is_identity_at_zero_strength,
        map_jacobian_matches_differences as jacobian_matches_differences, map_keeps_orientation as keeps_orientation,
        map_moves_with_its_parameters as moves_with_its_parameters, map_never_gives_nan as never_gives_nan,
        map_round_trips as round_trips,
    };
}

/// Writes one test per law of [`SpaceMap`](belvedere_core::SpaceMap) into a module.
///
/// `space_map_laws!(name, super::case())`: `case` returns a [`MapCase`]; the expression is evaluated inside the new module.
/// `space_map_laws!(name, super::case(), [round_trips, never_gives_nan])` tests these laws only, for a map that cannot declare the others.
#[macro_export]
macro_rules! space_map_laws {
    ($name:ident, $case:expr) => {
        $crate::space_map_laws!(
            $name,
            $case,
            [
                round_trips,
                keeps_orientation,
                jacobian_matches_differences,
                is_identity_at_zero_strength,
                has_its_continuity,
                never_gives_nan,
                moves_with_its_parameters
            ]
        );
    };
    ($name:ident, $case:expr, [$($law:ident),+]) => {
        mod $name {
            $(
                #[test]
                fn $law() {
                    $crate::laws::space_map::$law(&$case);
                }
            )+
        }
    };
}

/// Writes one test per law of a camera into a module.
///
/// `camera_laws!(name, super::case())`: `case` returns a [`CameraCase`]; the expression is evaluated inside the new module.
#[macro_export]
macro_rules! camera_laws {
    ($name:ident, $case:expr) => {
        mod $name {
            #[test]
            fn round_trips() {
                $crate::laws::camera_round_trips(&$case);
            }
            #[test]
            fn depth_rises_along_rays() {
                $crate::laws::camera_depth_rises_along_rays(&$case);
            }
            #[test]
            fn jacobian_matches_differences() {
                $crate::laws::camera_jacobian_matches_differences(&$case);
            }
            #[test]
            fn never_gives_nan() {
                $crate::laws::camera_never_gives_nan(&$case);
            }
            #[test]
            fn moves_with_its_parameters() {
                $crate::laws::camera_moves_with_its_parameters(&$case);
            }
        }
    };
}

/// Writes one test per law of a renderer into a module.
///
/// `renderer_laws!(name, super::renderer())`: `renderer` returns a [`belvedere_scene::Renderer`]; the expression is evaluated inside the new
/// module, anew for each law. This is the contract that makes a renderer one of the program's: whatever asks, it draws what lines of sight
/// say that is there.
#[macro_export]
macro_rules! renderer_laws {
    ($name:ident, $renderer:expr) => {
        $crate::renderer_laws!(
            $name,
            $renderer,
            [
                draws_what_a_ray_meets,
                fills_its_buffers,
                is_deterministic,
                draws_into_an_old_frame,
                draws_rows_as_the_whole,
                ends_when_it_is_cancelled
            ]
        );
    };
    ($name:ident, $renderer:expr, [$($law:ident),+]) => {
        mod $name {
            $(
                #[test]
                fn $law() {
                    $crate::laws::renderer::$law(&$renderer);
                }
            )+
        }
    };
}
