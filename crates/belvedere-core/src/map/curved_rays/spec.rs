//! Specification of a curved ray camera, and its errors.

use crate::plain::number;
use glam::{DVec2, DVec3};
use serde::de::{Deserializer, Error, Visitor};
use serde::{Deserialize, Serialize};

/// Shape of the rays inside the transitions.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "snake_case")]
pub enum Model {
    /// Conic arcs of constant sharpness m per turn (Cui et al. 2010, modified model).
    #[default]
    Modified,
    /// Quadratic Bezier arcs (Cui et al. 2010, original model).
    Original,
    /// Broken rays that bend at t1: the C0 camera that the paper compares with.
    C0,
    /// Curvature-continuous rays; ours, beyond the paper.
    C2,
    /// Conic arcs with `m = 1 / cos(beta / 2)`: circles about the common line for far viewpoints; ours.
    Circular,
}

/// How the three planes of a turn belong together.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Pencil {
    /// They share a line, outside the picture.
    Line {
        /// A point of the line, scene coordinates.
        point: DVec3,
        /// Its direction, any length but 0.
        dir: DVec3,
    },
    /// They are parallel.
    Parallel {
        /// Common normal, any length but 0, either sign.
        normal: DVec3,
    },
}

/// Sharpness m of a turn in the modified model: small = wide arc, large = nearly a kink.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "snake_case")]
pub enum Sharpness {
    /// The ray through the bend point (the point given for t1) is exactly the paper's Bezier arc.
    #[default]
    Bend,
    /// The ray through the left image edge at half height is: nearest to the paper's own choice.
    Left,
    /// Geometric mean of the extremes over the four image corners.
    Mid,
    /// A number in 0.2..=20.
    #[serde(untagged)]
    Value(f64),
}

impl<'de> Deserialize<'de> for Sharpness {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct SharpnessVisitor;
        impl Visitor<'_> for SharpnessVisitor {
            type Value = Sharpness;

            fn expecting(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
                f.write_str("a number in [0.2, 20], \"bend\", \"left\" or \"mid\"")
            }

            fn visit_f64<E: Error>(self, m: f64) -> Result<Sharpness, E> {
                Ok(Sharpness::Value(m))
            }

            fn visit_i64<E: Error>(self, m: i64) -> Result<Sharpness, E> {
                Ok(Sharpness::Value(m as f64))
            }

            fn visit_u64<E: Error>(self, m: u64) -> Result<Sharpness, E> {
                Ok(Sharpness::Value(m as f64))
            }

            fn visit_str<E: Error>(self, rule: &str) -> Result<Sharpness, E> {
                match rule {
                    "bend" => Ok(Sharpness::Bend),
                    "left" => Ok(Sharpness::Left),
                    "mid" => Ok(Sharpness::Mid),
                    _ => Err(E::unknown_variant(rule, &["bend", "left", "mid"])),
                }
            }
        }
        deserializer.deserialize_any(SharpnessVisitor)
    }
}

/// One turn: from viewpoint `j - 1` to viewpoint `j` through planes t0, t1, t2.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct TurnSpec {
    /// Viewpoint after the turn, scene coordinates.
    pub viewpoint: DVec3,
    /// A point of plane t0, where rays begin to bend.
    pub t0: DVec3,
    /// A point of plane t1: the bend point.
    pub t1: DVec3,
    /// A point of plane t2, where rays are straight again.
    pub t2: DVec3,
    /// Common line or common normal of the planes.
    pub pencil: Pencil,
    /// Sharpness; used by [`Model::Modified`] only.
    pub m: Sharpness,
}

impl TurnSpec {
    /// Largest distance between a point of this turn, or of its common line, and that of another, scene units.
    pub(crate) fn distance(&self, other: &Self) -> f64 {
        let pairs = [(self.viewpoint, other.viewpoint), (self.t0, other.t0), (self.t1, other.t1), (self.t2, other.t2)];
        let line = match (self.pencil, other.pencil) {
            (Pencil::Line { point, .. }, Pencil::Line { point: other, .. }) => point.distance(other),
            (Pencil::Line { point, .. }, Pencil::Parallel { .. }) => point.distance(self.t1),
            (Pencil::Parallel { .. }, Pencil::Line { point, .. }) => point.distance(other.t1),
            (Pencil::Parallel { .. }, Pencil::Parallel { .. }) => 0.0,
        };
        pairs.into_iter().map(|(a, b)| a.distance(b)).fold(line, f64::max)
    }

    /// This turn with its viewpoint interpolated from the eye (`share` 0) to its own (1).
    pub(crate) fn eased(self, eye: DVec3, share: f64) -> Self {
        Self { viewpoint: eye.lerp(self.viewpoint, share), ..self }
    }
}

/// The nearest valid value for a parameter that is not.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub enum Remedy {
    /// Move one point.
    MovePoint {
        /// Its name in the scene file.
        name: &'static str,
        /// Nearest valid position found, scene coordinates.
        to: DVec3,
    },
    /// Move t0, t1 and t2 together.
    MovePlanes {
        /// Smallest shift found, scene units.
        by: DVec3,
    },
    /// Give the planes another normal.
    Normal {
        /// Nearest valid normal found.
        normal: DVec3,
    },
    /// Bring t0 and t2 of both turns nearer to their t1.
    Shrink {
        /// Largest factor found for the distances from t1, in 0..1.
        factor: f64,
    },
    /// Lower the near distance.
    Near {
        /// Largest valid value, scene units.
        near: f64,
    },
    /// Exchange t0 and t2.
    SwapPlanes,
    /// Choose a bend point that the picture's rays bend around.
    BendInPicture,
    /// Choose another model of rays.
    OtherModel,
    /// Give the turn other values: no change of a single parameter makes it valid.
    Turn {
        /// The nearest valid turn found.
        turn: Box<TurnSpec>,
    },
    /// No valid turn was found.
    Rebuild,
}

impl std::fmt::Display for Remedy {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let point = |p: DVec3| format!("[{}, {}, {}]", p.x, p.y, p.z);
        match self {
            Self::MovePoint { name, to } => write!(f, "the nearest valid {name} is {}", point(*to)),
            Self::MovePlanes { by } => write!(f, "move t0, t1 and t2 by at least {}", point(*by)),
            Self::Normal { normal } => write!(f, "the nearest valid plane normal is {}", point(*normal)),
            Self::Shrink { factor } => {
                write!(f, "multiply the distances of t0 and t2 from t1 by at most {factor} in both turns")
            }
            Self::Near { near } => write!(f, "near may be at most {near}, or move t0 away from the eye"),
            Self::SwapPlanes => write!(f, "exchange t0 and t2"),
            Self::BendInPicture => write!(f, "move t1 into the picture, or give m as a number"),
            Self::OtherModel => write!(f, "no t2 parts them"),
            Self::Turn { turn } => {
                let [viewpoint, t0, t1, t2] = [turn.viewpoint, turn.t0, turn.t1, turn.t2].map(point);
                write!(f, "the nearest valid turn has viewpoint {viewpoint}, t0 {t0}, t1 {t1}, t2 {t2}, ")?;
                match turn.pencil {
                    Pencil::Line { point: at, dir } => write!(f, "line.point {}, line.dir {}", point(at), point(dir)),
                    Pencil::Parallel { normal } => write!(f, "normal {}", point(normal)),
                }
            }
            Self::Rebuild => {
                write!(f, "place t0, t1, t2 in this order ahead of both viewpoints, or use parallel planes")
            }
        }
    }
}

impl CurvedRaysError {
    /// How the camera becomes valid; `None` where the error says so itself.
    pub fn remedy(&self) -> Option<&Remedy> {
        match self {
            Self::PlaneOrder { remedy, .. }
            | Self::PreviousPastBend { remedy, .. }
            | Self::PreviousPastStart { remedy, .. }
            | Self::ViewpointPastBend { remedy, .. }
            | Self::BendNotMet { remedy, .. }
            | Self::LineInPicture { remedy, .. }
            | Self::EndNotReached { remedy, .. }
            | Self::RaysCross { remedy, .. }
            | Self::TurnsOverlap { remedy, .. }
            | Self::NearPastStart { remedy, .. } => Some(remedy),
            _ => None,
        }
    }
}

/// A viewpoint in words.
fn eye(viewpoint: usize) -> String {
    if viewpoint == 0 { "the eye".into() } else { format!("viewpoint {viewpoint}") }
}

/// Errors of a curved ray camera. Turns and viewpoints are counted from 1; viewpoint 0 is the eye.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum CurvedRaysError {
    /// The root camera is orthographic, but curved rays start at an eye.
    #[error("curved rays need a perspective camera, the root camera is orthographic; set projection = \"perspective\"")]
    Orthographic,
    /// A parameter is NaN or infinite.
    #[error("turn {turn}: {name} is not a finite number ({value}); give finite values")]
    NotFinite {
        /// Turn, from 1.
        turn: usize,
        /// Which parameter.
        name: &'static str,
        /// The value.
        value: f64,
    },
    /// A coordinate is so large that rounding spoils the geometry.
    #[error("turn {turn}: {name} has the coordinate {value:e}, beyond +-{limit:e}; give scene coordinates")]
    TooLarge {
        /// Turn, from 1.
        turn: usize,
        /// Which parameter.
        name: &'static str,
        /// The value.
        value: f64,
        /// Limit, scene units.
        limit: f64,
    },
    /// A direction of length 0.
    #[error("turn {turn}: {name} has length 0; give a direction")]
    ZeroDirection {
        /// Turn, from 1.
        turn: usize,
        /// Which parameter.
        name: &'static str,
    },
    /// Sharpness out of range.
    #[error(
        "turn {turn}: m is {m}, it must lie in 0.2..=20; use a number in that range or \"bend\", \"left\", \"mid\""
    )]
    Sharpness {
        /// Turn, from 1.
        turn: usize,
        /// The value.
        m: f64,
    },
    /// A plane's point lies on the common line.
    #[error(
        "turn {turn}: {name} lies on the common line of the planes (distance {}, more than {} needed), so its plane is not defined; move it away from the line", number(*distance), number(*limit)
    )]
    PointOnLine {
        /// Turn, from 1.
        turn: usize,
        /// Which point.
        name: &'static str,
        /// Distance, scene units.
        distance: f64,
        /// Limit, scene units.
        limit: f64,
    },
    /// The bend point lies on t0 or t2 (but not on both, which is a turn of width 0 and allowed).
    #[error(
        "turn {turn}: plane {name} passes through the bend point t1 (distance {}, more than {} needed); move {name} away from t1, or put both t0 and t2 onto it for a sharp bend", number(*distance), number(*limit)
    )]
    BendOnPlane {
        /// Turn, from 1.
        turn: usize,
        /// Which plane.
        name: &'static str,
        /// Distance, scene units.
        distance: f64,
        /// Limit, scene units.
        limit: f64,
    },
    /// t0 and t2 are one plane, apart from t1.
    #[error(
        "turn {turn}: t0 and t2 are the same plane, {} from the bend point t1; put them on either side of t1", number(*distance)
    )]
    SamePlanes {
        /// Turn, from 1.
        turn: usize,
        /// Distance of the bend point, scene units.
        distance: f64,
    },
    /// A viewpoint lies on t1.
    #[error(
        "turn {turn}: {} lies on plane t1 (distance {}, more than {} needed); move it back from the plane", eye(*viewpoint), number(*distance), number(*limit)
    )]
    ViewpointOnBend {
        /// Turn, from 1.
        turn: usize,
        /// Viewpoint, from 0.
        viewpoint: usize,
        /// Distance, scene units.
        distance: f64,
        /// Limit, scene units.
        limit: f64,
    },
    /// Planes in the wrong order or behind both viewpoints.
    #[error(
        "turn {turn}: rays must meet t0, t1, t2 in this order, they lie {}, {}, {} ahead of {} along its axis; {remedy}", number(*t0), number(*t1), number(*t2), eye(*viewpoint)
    )]
    PlaneOrder {
        /// Turn, from 1.
        turn: usize,
        /// Viewpoint before the turn, from 0.
        viewpoint: usize,
        /// Signed distance of plane t0 along the axis, scene units.
        t0: f64,
        /// Same for t1.
        t1: f64,
        /// Same for t2.
        t2: f64,
        /// Nearest valid value.
        remedy: Remedy,
    },
    /// Section 7, row 1: the viewpoint before the turn is past t1.
    #[error("turn {turn}: {} is {} past plane t1, it must lie before it; {remedy}", eye(*viewpoint), number(*past))]
    PreviousPastBend {
        /// Turn, from 1.
        turn: usize,
        /// Viewpoint before the turn, from 0.
        viewpoint: usize,
        /// Distance past the plane, scene units.
        past: f64,
        /// Nearest valid value.
        remedy: Remedy,
    },
    /// Row 1: the viewpoint before the turn is past t0.
    #[error("turn {turn}: {} is {} past plane t0, it must lie before it; {remedy}", eye(*viewpoint), number(*past))]
    PreviousPastStart {
        /// Turn, from 1.
        turn: usize,
        /// Viewpoint before the turn, from 0.
        viewpoint: usize,
        /// Distance past the plane, scene units.
        past: f64,
        /// Nearest valid value.
        remedy: Remedy,
    },
    /// Row 2: the viewpoint after the turn is past t1, the picture would be mirrored.
    #[error("turn {turn}: viewpoint {turn} is {} past plane t1, which would mirror the picture; {remedy}", number(*past))]
    ViewpointPastBend {
        /// Turn, from 1.
        turn: usize,
        /// Distance past the plane, scene units.
        past: f64,
        /// Nearest valid value.
        remedy: Remedy,
    },
    /// Row 3: rays of the picture do not meet t1.
    #[error("turn {turn}: the ray of pixel ({}, {}) does not meet plane t1 ahead of {} (slope towards it {}, more than 0 needed); {remedy}", pixel.x, pixel.y, eye(*viewpoint), number(*slope))]
    BendNotMet {
        /// Turn, from 1.
        turn: usize,
        /// Viewpoint before the turn, from 0.
        viewpoint: usize,
        /// Image corner.
        pixel: DVec2,
        /// Cosine between the ray and the plane's normal.
        slope: f64,
        /// Nearest valid value.
        remedy: Remedy,
    },
    /// Row 3: the common line cuts the picture.
    #[error("turn {turn}: the common line lies inside the picture, the ray of pixel ({}, {}) passes it on the far side by {}; {remedy}", pixel.x, pixel.y, number(*beyond))]
    LineInPicture {
        /// Turn, from 1.
        turn: usize,
        /// Image corner.
        pixel: DVec2,
        /// Distance beyond the line within t1, scene units.
        beyond: f64,
        /// Nearest valid value.
        remedy: Remedy,
    },
    /// Row 4: a ray never reaches t2.
    #[error("turn {turn}: the ray of pixel ({}, {}) never reaches plane t2 (sigma = {sigma:.6}, it must be below {limit:.6}); {remedy}, or move the viewpoint back", pixel.x, pixel.y)]
    EndNotReached {
        /// Turn, from 1.
        turn: usize,
        /// Image corner, or the pixel of the bend point.
        pixel: DVec2,
        /// Value of both plane forms where the ray meets t1.
        sigma: f64,
        /// Value of t2's form at the viewpoint.
        limit: f64,
        /// Nearest valid value.
        remedy: Remedy,
    },
    /// Rays of the original model cross their neighbours.
    #[error("turn {turn}: rays of the original model cross near the pixel ({}, {}) (from sigma = {sigma:.6} on): they would show places twice, once mirrored; {remedy}, or set model = \"modified\", whose rays never cross", pixel.x, pixel.y)]
    RaysCross {
        /// Turn, from 1.
        turn: usize,
        /// Image corner.
        pixel: DVec2,
        /// Value of both plane forms where the first ray that crosses another meets t1.
        sigma: f64,
        /// Nearest valid value.
        remedy: Remedy,
    },
    /// Row 5: a turn begins before the one before has ended.
    #[error("turn {turn} begins at depth {} before turn {} has ended at depth {} on the ray of pixel ({}, {}); {remedy}", number(*start), turn - 1, number(*end), pixel.x, pixel.y)]
    TurnsOverlap {
        /// The later turn, from 1.
        turn: usize,
        /// Image corner.
        pixel: DVec2,
        /// Depth of t2 of the earlier turn.
        end: f64,
        /// Depth of t0 of the later turn.
        start: f64,
        /// Nearest valid value.
        remedy: Remedy,
    },
    /// Row 6: rays bend nearer than the near plane.
    #[error("turn 1 begins at depth {} on the ray of pixel ({}, {}), not beyond near = {near}; {remedy}", number(*start), pixel.x, pixel.y)]
    NearPastStart {
        /// Image corner.
        pixel: DVec2,
        /// Near distance of the camera, scene units.
        near: f64,
        /// Depth of t0.
        start: f64,
        /// Nearest valid value.
        remedy: Remedy,
    },
}
