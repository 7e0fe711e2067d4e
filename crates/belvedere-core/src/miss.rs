//! Points without image.

/// Why a point has no image. An answer, not an error.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Miss {
    /// The (displaced) point does not lie in front of the eye.
    BehindEye,
    /// The point lies where the map is not defined.
    OutsideDomain,
}
