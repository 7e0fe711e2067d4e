//! Rows of points, stored coordinate by coordinate.

use belvedere_core::DVec3;

/// Coordinates of points, displaced in place.
pub struct Points<'p> {
    /// To the east.
    pub x: &'p mut [f64],
    /// To the north.
    pub y: &'p mut [f64],
    /// Upwards.
    pub z: &'p mut [f64],
}

/// Applies a map of single points.
pub(super) fn each(points: &mut Points<'_>, map: impl Fn(DVec3) -> Option<DVec3>) -> bool {
    for ((x, y), z) in points.x.iter_mut().zip(points.y.iter_mut()).zip(points.z.iter_mut()) {
        let Some(q) = map(DVec3::new(*x, *y, *z)) else { return false };
        [*x, *y, *z] = q.to_array();
    }
    true
}
