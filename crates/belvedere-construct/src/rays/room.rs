//! How much room there is around a path: behind every position for an eye, and to both sides for a picture.

use super::path::Path;
use belvedere_core::{DVec3, Pinhole};
use belvedere_sight::Obstacles;

/// How far an eye may stand behind each position of a path, scene units.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Room {
    spacing: f64,
    behind: Vec<f64>,
}

/// Distances that are tried, and the distance of the eye from ground and walls, shares of the width of the picture.
const STEPS: u32 = 24;
const MARGIN: f64 = 0.04;
/// Without obstacles: how far the eye may be from the path, over the point that it stands behind, share of the width of the picture.
const ASIDE: f64 = 0.1;

/// What an eye may not stand in.
pub(super) struct Surroundings<'a> {
    /// Ground and walls, if there are any.
    pub(super) obstacles: Option<&'a Obstacles<'a>>,
    pub(super) path: &'a Path,
    /// Width of the picture at the position, scene units.
    pub(super) width: f64,
}

impl Room {
    /// Room up to `most` behind positions that are `spacing` apart; from one to the next it changes by at most their distance.
    ///
    /// * `cameras`: for every position the camera far behind it, whose near plane holds the position.
    pub(super) fn new(cameras: &[Pinhole], spacing: f64, around: &Surroundings<'_>, most: f64) -> Self {
        let mut behind: Vec<f64> = cameras.iter().map(|far| around.free_behind(far, most)).collect();
        for i in 1..behind.len() {
            behind[i] = behind[i].min(behind[i - 1] + spacing);
        }
        for i in (1..behind.len()).rev() {
            behind[i - 1] = behind[i - 1].min(behind[i] + spacing);
        }
        Self { spacing, behind }
    }

    /// The room at a position, held at the ends.
    pub(super) fn at(&self, position: f64) -> f64 {
        let last = self.behind.len() - 1;
        let x = (position / self.spacing).clamp(0.0, last as f64);
        let i = (x as usize).min(last.saturating_sub(1));
        let next = self.behind[(i + 1).min(last)];
        self.behind[i] + (x - i as f64) * (next - self.behind[i])
    }
}

impl Surroundings<'_> {
    /// Width of the corridor at points beside which `right` points, up to the width of the picture: that which most of them have.
    pub(super) fn corridor(&self, places: &[(DVec3, DVec3)]) -> f64 {
        let step = 0.5 * self.width / f64::from(STEPS);
        let mut widths: Vec<f64> = places
            .iter()
            .map(|(at, right)| {
                let side = |sign: f64| {
                    let to = |k: u32| *at + sign * f64::from(k) * step * *right;
                    let is_free = |k: &u32| self.is_free(to(*k - 1), to(*k));
                    step * f64::from((1..=STEPS).take_while(is_free).last().unwrap_or(0))
                };
                side(-1.0) + side(1.0)
            })
            .collect();
        widths.sort_by(f64::total_cmp);
        widths.get(widths.len() / 2).copied().unwrap_or(self.width)
    }

    /// How far one can go back from the near plane of a camera towards its eye.
    fn free_behind(&self, far: &Pinhole, most: f64) -> f64 {
        let at = |back: f64| far.eye + (far.near - back) * far.forward;
        let step = most / f64::from(STEPS);
        let is_free = |k: &u32| self.is_free(at(step * f64::from(*k - 1)), at(step * f64::from(*k)));
        step * f64::from((1..=STEPS).take_while(is_free).last().unwrap_or(0))
    }

    fn is_free(&self, from: DVec3, to: DVec3) -> bool {
        let margin = MARGIN * self.width;
        match self.obstacles {
            Some(obstacles) => {
                let is_over_ground = obstacles.grounds().is_empty() || obstacles.above_ground(to).is_some();
                is_over_ground
                    && obstacles.min_gap(from, to, margin, margin) >= margin
                    && obstacles.boxes().near(from, to, margin, &mut |_, _| false)
            }
            None => self.path.distance_in_plan(to) < ASIDE * self.width,
        }
    }
}
