//! Places beside the picture of a film: what will come into it, and what has left it, is asked for by degrees.
//!
//! A place is asked for as long as it is in the picture. Asked for in one frame and not in the one before, it would move its ground
//! by all that it takes at once: hundreds of metres. So a place beside the picture is asked for as well, along a line of sight that
//! ends the higher over the eye the farther the place lies beside: what it takes is a continuous function of the camera.

use super::super::visibility_qp::{Candidate, LinesOfSight, StraightSight};
use super::super::{Field, Wedge};
use belvedere_core::DVec2;

/// How far beside the picture places are asked for, radians.
pub(super) const BESIDE: f64 = 15.0 * std::f64::consts::PI / 180.0;
/// Slope by which lines of sight are turned up there: few slopes are as steep.
const STEEPEST: f64 = 2.0;

/// Straight lines to one eye, which end over it for places beside the picture.
#[derive(Debug, Clone, Copy)]
pub(super) struct EnteringSight<'a> {
    pub(super) straight: StraightSight,
    pub(super) field: &'a Field,
    pub(super) wedge: Wedge,
}

/// Where places are asked for by degrees; `None` if the picture shows all around.
pub(super) fn beside(wedge: &Wedge) -> Option<Wedge> {
    let wider = (wedge.half_angle + BESIDE).min(std::f64::consts::PI);
    (wider > wedge.half_angle && wedge.heading != DVec2::ZERO).then_some(Wedge { half_angle: wider, ..*wedge })
}

impl EnteringSight<'_> {
    /// How far over the eye the line of sight of a place ends, scene units; 0 in the picture.
    ///
    /// The third power lets near and far ground give way alike: the former hides by steep slopes, the latter by gentle ones.
    fn over_eye(&self, grid: DVec2) -> f64 {
        let to = self.field.scene_from_grid(grid) - self.wedge.eye;
        let outside = self.wedge.heading.angle_to(to).abs() - self.wedge.half_angle;
        if outside > 0.0 { to.length() * STEEPEST * (outside / BESIDE).powi(3) } else { 0.0 }
    }
}

impl LinesOfSight for EnteringSight<'_> {
    fn trace(&self, grid: DVec2, z: f64, out: &mut Vec<(DVec2, f64)>) {
        let StraightSight { eye, z: top } = self.straight;
        out.extend([(grid, z), (eye, top + self.over_eye(grid))]);
    }

    fn straight(&self) -> Option<(DVec2, f64)> {
        self.straight.straight()
    }
}

/// Candidates that are not in `asked`.
pub(super) fn others(all: Vec<Candidate>, asked: &[Candidate]) -> Vec<Candidate> {
    let known: std::collections::BTreeSet<u32> = asked.iter().map(|c| c.id).collect();
    all.into_iter().filter(|c| !known.contains(&c.id)).collect()
}
