//! What a user says about rays that part, and what can be wrong with it.

use super::Seam;
use crate::map::curved_rays::{CurvedRaysError, TurnSpec};
use glam::DVec3;

/// Turns in ray order, and a fork after them.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct SplitSpec {
    /// Turns of all rays that come this way.
    pub turns: Vec<TurnSpec>,
    /// Where they part.
    pub fork: Option<Box<Fork>>,
}

impl SplitSpec {
    /// These turns with their viewpoints on their way from the eye.
    pub(crate) fn eased(&self, eye: DVec3, share: f64) -> Self {
        let fork = |fork: &Fork| Fork {
            seam: fork.seam,
            sides: [0, 1].map(|i| fork.sides[i].eased(eye, share)),
            merge: fork.merge.map(|merge| Merge { viewpoint: eye.lerp(merge.viewpoint, share), ..merge }),
        };
        Self {
            turns: self.turns.iter().map(|turn| turn.eased(eye, share)).collect(),
            fork: self.fork.as_deref().map(|f| Box::new(fork(f))),
        }
    }
}

/// Rays of the two sides of a seam go different ways.
#[derive(Debug, Clone, PartialEq)]
pub struct Fork {
    /// The seam.
    pub seam: Seam,
    /// The ways of the left and of the right side.
    pub sides: [SplitSpec; 2],
    /// Where both sides go on as from one viewpoint; neither may have a fork of its own then.
    pub merge: Option<Merge>,
}

/// The ways of both sides of a seam become one again, where the rays along the seam meet. For that the last viewpoint of the
/// right side (of the left if that has no turn) moves along the ray of the seam's middle.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Merge {
    /// The common viewpoint after it.
    pub viewpoint: DVec3,
    /// Distance over which the rays bend, before and after the plane where they meet, scene units, > 0.
    pub reach: f64,
}

/// Rays that cannot part, or not meet again, in this way.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum SplitRaysError {
    /// A turn of one side is not valid.
    #[error("{}{error}", if side.is_empty() { String::new() } else { format!("{side} of the seam, ") })]
    Turn {
        /// Which way, like `left` or `right, left`; empty before any fork.
        side: String,
        /// What is wrong with it; turns before the fork are counted.
        error: CurvedRaysError,
    },
    /// The seam's points are one, or not finite.
    #[error("the two points of the seam are {from}, {to}; give two points that are apart")]
    SeamPoints {
        /// First point, shares of the picture.
        from: glam::DVec2,
        /// Second point.
        to: glam::DVec2,
    },
    /// One side holds no pixel.
    #[error("the seam leaves no pixel on its {side} side; move it into the picture")]
    SeamBeside {
        /// `left` or `right`.
        side: &'static str,
    },
    /// A fork with a merge may not fork again.
    #[error("a fork that merges has another fork on its {side} side; merge that one first, or leave one of them out")]
    ForkInMerge {
        /// `left` or `right`.
        side: &'static str,
    },
    /// The reach of a merge is no length.
    #[error("the merge's reach is {reach}, it must be above 0")]
    Reach {
        /// The value.
        reach: f64,
    },
    /// Rays along the seam do not come together.
    #[error(
        "the rays along the seam do not meet behind the fork (left and right are {apart_deg:.2} degrees apart and part further); give both sides a turn back towards each other before the merge"
    )]
    NoMeeting {
        /// Angle between the two planes of seam rays, degrees.
        apart_deg: f64,
    },
    /// Rays of a pixel of the seam meet beside each other.
    #[error(
        "rays along the seam miss each other by up to {off_px:.3} pixels where they meet, {limit:.3} at most; make the two sides mirror each other more closely"
    )]
    UnevenMeeting {
        /// Largest distance along the seam, pixels.
        off_px: f64,
        /// Limit, pixels.
        limit: f64,
    },
}
