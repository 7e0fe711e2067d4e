//! The near part of a preview's camera: an eye close behind the position, whose rays become those of an eye far behind it.
//!
//! The second viewpoint of a turn with parallel planes lies straight behind the first, so that the direction of view stays. Rays
//! leave the near eye at the width that the rays of the far eye have at the planes, and run on as if they came from the far eye. So
//! nothing before the position has to be cut away, and what lies beyond it is seen as from the far eye. Ours.

use crate::ConstructError;
use belvedere_core::map::curved_rays::{Pencil, Sharpness, TurnSpec};
use belvedere_core::{Pinhole, Projection};

/// Planes t0 and t1 before t2, shares of the distance of the near eye from t2.
const PLANES: [f64; 2] = [0.5, 0.25];
/// Nearest drawn depth, share of the distance of the near eye from t2.
const NEAR: f64 = 0.02;

/// The camera at the near eye, and the turn after which rays are those of `far`.
///
/// * `far`: the camera far behind; the last plane of the turn is its near plane;
/// * `back`: distance of the near eye from that plane, scene units, in 0..`far.near`.
///
/// # Errors
/// [`ConstructError::Pinhole`] if `back` is out of range.
pub(super) fn approach(far: &Pinhole, back: f64) -> Result<(Pinhole, TurnSpec), ConstructError> {
    let at = |share: f64| far.eye + (far.near - share * back) * far.forward;
    let [t0, t1] = PLANES.map(at);
    // Distances of t1 from the far and from the near eye.
    let (from_far, from_near) = (far.near - PLANES[1] * back, (1.0 - PLANES[1]) * back);
    let shrunk = from_near / from_far;
    let fov_y = 2.0 * (0.5 * f64::from(far.image[1]) / far.scale_px() / shrunk).atan();
    // Past the planes depths are those from the far eye, shrunk.
    let far_m = far.far.map(|m| m * shrunk);
    let eye = at(1.0);
    let lens = Projection::Perspective { fov_y };
    let near = Pinhole::look_at(eye, eye + back * far.forward, -far.down, lens, far.image, NEAR * back, far_m)?;
    let pencil = Pencil::Parallel { normal: far.forward };
    Ok((near, TurnSpec { viewpoint: far.eye, t0, t1, t2: at(0.0), pencil, m: Sharpness::Bend }))
}
