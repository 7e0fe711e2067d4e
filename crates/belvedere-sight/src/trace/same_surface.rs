//! Whether hits of neighbouring rays lie on one surface.

use super::{Part, RayHit};

/// Neighbours farther apart than this share of their depth lie on different surfaces.
const SAME_SURFACE: f64 = 0.02;

/// Whether two hits lie on one surface, whose colours change smoothly.
pub fn same_surface(a: Option<RayHit>, b: Option<RayHit>) -> bool {
    match (a, b) {
        (None, None) => true,
        (Some(a), Some(b)) if a.layer == b.layer => match (a.part, b.part) {
            (Part::Cell(..), Part::Cell(..)) => (a.depth - b.depth).abs() <= SAME_SURFACE * a.depth.min(b.depth),
            (p, q) => p == q,
        },
        _ => false,
    }
}
