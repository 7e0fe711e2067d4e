//! Specification of rays that part at seams, and its errors.

use super::Seam;
use crate::map::curved_rays::{CurvedRaysError, TurnSpec};
use glam::DVec3;

/// Turns in ray order, and a fork after them.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct SplitSpec {
    /// Turns that all rays of this node share.
    pub turns: Vec<TurnSpec>,
    /// The fork after these turns; `None` if the rays do not part.
    pub fork: Option<Box<Fork>>,
}

impl SplitSpec {
    /// These turns with their viewpoints interpolated from the eye (`share` 0) to their own (1).
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

/// Rays of the two sides of a seam have different turns.
#[derive(Debug, Clone, PartialEq)]
pub struct Fork {
    /// The seam.
    pub seam: Seam,
    /// Turns of the left and of the right side.
    pub sides: [SplitSpec; 2],
    /// Merge of both sides at one viewpoint; then neither may have a fork of its own.
    pub merge: Option<Merge>,
}

/// Both sides of a seam turn to one viewpoint, where the rays along the seam meet. For that the last viewpoint of the
/// right side (of the left if that has no turn) moves along the ray of the seam's middle.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Merge {
    /// The common viewpoint after the merge, scene coordinates.
    pub viewpoint: DVec3,
    /// Distance over which the rays bend, before and after the plane where they meet, scene units, > 0.
    pub reach: f64,
}

/// Errors of a specification of rays that part.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum SplitRaysError {
    /// A turn of one side is not valid.
    #[error("{}{error}", if side.is_empty() { String::new() } else { format!("{side} of the seam, ") })]
    Turn {
        /// Path to the turn, like `left` or `right, left`; empty before any fork.
        side: String,
        /// Its error; turn numbers include the turns before the fork.
        error: CurvedRaysError,
    },
    /// The seam's points coincide, or are not finite.
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
    /// The reach of a merge is not > 0, or not finite.
    #[error("the merge's reach is {reach}, it must be above 0")]
    Reach {
        /// The value.
        reach: f64,
    },
    /// The rays along the seam do not meet behind the fork.
    #[error(
        "the rays along the seam do not meet behind the fork (left and right are {apart_deg:.2} degrees apart and part further); give both sides a turn back towards each other before the merge"
    )]
    NoMeeting {
        /// Angle between the two planes of seam rays, degrees.
        apart_deg: f64,
    },
    /// The two rays of a seam pixel miss each other by more than the limit.
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
