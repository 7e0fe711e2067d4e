//! Gradual demand for points beside the picture of a film: those that will enter it, and those that have left it.
//!
//! A point in the picture is demanded. If it were demanded in one frame and not in the one before, its ground would move by hundreds
//! of metres at once. So a point beside the picture is demanded as well, along a line of sight that ends above the eye: the farther
//! beside the picture the point lies, the higher. The displacement is thus a continuous function of the camera.

use super::super::visibility_qp::{Candidate, LinesOfSight, StraightSight};
use super::super::{Field, Wedge};
use belvedere_core::DVec2;

/// Angle beside the picture within which points are demanded, radians.
pub(super) const BESIDE: f64 = 15.0 * std::f64::consts::PI / 180.0;
/// Slope by which the line of sight of a point at that angle is raised, rise over run: few slopes of terrain are as steep.
const STEEPEST: f64 = 2.0;

/// Straight lines of sight to one eye; those of points beside the picture end above it.
#[derive(Debug, Clone, Copy)]
pub(super) struct EnteringSight<'a> {
    pub(super) straight: StraightSight,
    pub(super) field: &'a Field,
    pub(super) wedge: Wedge,
}

/// The wedge in which points are demanded, wider than the picture's; `None` if the picture shows all around.
pub(super) fn beside(wedge: &Wedge) -> Option<Wedge> {
    let wider = (wedge.half_angle + BESIDE).min(std::f64::consts::PI);
    (wider > wedge.half_angle && wedge.heading != DVec2::ZERO).then_some(Wedge { half_angle: wider, ..*wedge })
}

impl EnteringSight<'_> {
    /// Height over the eye at which the line of sight of a point ends, scene units; 0 for points in the picture.
    ///
    /// The third power treats near and far ground alike: near ground hides by steep slopes, far ground by gentle ones.
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

/// Candidates of `all` that are not in `asked`.
pub(super) fn others(all: Vec<Candidate>, asked: &[Candidate]) -> Vec<Candidate> {
    let known: std::collections::BTreeSet<u32> = asked.iter().map(|c| c.id).collect();
    all.into_iter().filter(|c| !known.contains(&c.id)).collect()
}
