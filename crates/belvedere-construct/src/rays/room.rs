//! Room around a path: behind every position for an eye, and to both sides for a picture.

use super::path::Path;
use belvedere_core::{DVec3, Pinhole};
use belvedere_scene::{Scene, VolumeLayer};
use belvedere_sight::Obstacles;

/// Distance behind each position of a path up to which an eye may stand, scene units.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Room {
    positions: Vec<f64>,
    behind: Vec<f64>,
}

/// Number of distances that are tried; and least distance of the eye from ground and walls, share of the width of the picture.
const DISTANCES: u32 = 24;
const MARGIN: f64 = 0.04;
/// Without obstacles: greatest distance of the eye from the path in plan, share of the width of the picture.
const ASIDE: f64 = 0.1;
/// Opacity per reference step below which a volume is clear; number of positions at which a path is tested for running through clear
/// voxels, and share of them that must be clear.
const CLEAR: f64 = 0.1;
const LOOKED_AT: u32 = 64;
const MOSTLY: f64 = 0.5;

/// Obstacles and volumes that an eye must keep clear of.
pub(super) struct Surroundings<'a> {
    /// Ground and walls, if there are any.
    pub(super) obstacles: Option<&'a Obstacles<'a>>,
    /// Volumes through whose clear parts the path runs.
    pub(super) vessels: &'a [&'a VolumeLayer],
    pub(super) path: &'a Path,
    /// Width of the picture at the position, scene units.
    pub(super) width: f64,
}

impl Room {
    /// Room behind positions up to `most`, scene units: no more than behind the positions before and after, so that it holds between
    /// them too; from one position to the next it changes by at most their distance.
    ///
    /// * `cameras`: by rising position the camera far behind it, whose near plane holds the position; at least one.
    pub(super) fn new(cameras: &[(f64, Pinhole)], around: &Surroundings<'_>, most: f64) -> Self {
        let positions: Vec<f64> = cameras.iter().map(|(s, _)| *s).collect();
        let free: Vec<f64> = cameras.iter().map(|(_, far)| around.free_behind(far, most)).collect();
        let beside = |i: usize| &free[i.saturating_sub(1)..(i + 2).min(free.len())];
        let mut behind: Vec<f64> =
            (0..free.len()).map(|i| beside(i).iter().copied().fold(f64::INFINITY, f64::min)).collect();
        let apart = |i: usize| positions[i] - positions[i - 1];
        for i in 1..behind.len() {
            behind[i] = behind[i].min(behind[i - 1] + apart(i));
        }
        for i in (1..behind.len()).rev() {
            behind[i - 1] = behind[i - 1].min(behind[i] + apart(i));
        }
        Self { positions, behind }
    }

    /// The room at a position, held at the ends.
    pub(super) fn at(&self, position: f64) -> f64 {
        let next = self.positions.partition_point(|s| *s <= position).min(self.positions.len() - 1);
        let before = next.saturating_sub(1);
        let length = self.positions[next] - self.positions[before];
        let share = if length > 0.0 { ((position - self.positions[before]) / length).clamp(0.0, 1.0) } else { 0.0 };
        self.behind[before] + share * (self.behind[next] - self.behind[before])
    }
}

impl Surroundings<'_> {
    /// Width of the corridor across the path, up to the width of the picture: the median over points, each given with its direction
    /// to the right.
    pub(super) fn corridor(&self, places: &[(DVec3, DVec3)]) -> f64 {
        let step = 0.5 * self.width / f64::from(DISTANCES);
        let mut widths: Vec<f64> = places
            .iter()
            .map(|(at, right)| {
                let side = |sign: f64| {
                    let to = |k: u32| *at + sign * f64::from(k) * step * *right;
                    let is_free = |k: &u32| self.is_free(to(*k - 1), to(*k));
                    step * f64::from((1..=DISTANCES).take_while(is_free).last().unwrap_or(0))
                };
                side(-1.0) + side(1.0)
            })
            .collect();
        widths.sort_by(f64::total_cmp);
        widths.get(widths.len() / 2).copied().unwrap_or(self.width)
    }

    /// Free distance back from the near plane of a camera towards its eye, scene units.
    fn free_behind(&self, far: &Pinhole, most: f64) -> f64 {
        let at = |back: f64| far.eye + (far.near - back) * far.forward;
        let step = most / f64::from(DISTANCES);
        let is_free = |k: &u32| self.is_free(at(step * f64::from(*k - 1)), at(step * f64::from(*k)));
        step * f64::from((1..=DISTANCES).take_while(is_free).last().unwrap_or(0))
    }

    fn is_free(&self, from: DVec3, to: DVec3) -> bool {
        let margin = MARGIN * self.width;
        if !self.vessels.iter().all(|layer| is_clear_around(layer, to, margin)) {
            return false;
        }
        match self.obstacles {
            Some(obstacles) => {
                let is_over_ground = obstacles.grounds().is_empty() || obstacles.above_ground(to).is_some();
                is_over_ground
                    && obstacles.min_gap(from, to, margin, margin) >= margin
                    && obstacles.boxes().near(from, to, margin, &mut |_, _| false)
            }
            None => !self.vessels.is_empty() || self.path.distance_in_plan(to) < ASIDE * self.width,
        }
    }
}

/// The volumes of a scene through whose clear parts a path runs: vessels, bores.
pub(super) fn vessels<'a>(scene: &'a Scene, path: &Path) -> Vec<&'a VolumeLayer> {
    let at = |k: u32| path.at(path.length() * (f64::from(k) + 0.5) / f64::from(LOOKED_AT));
    let runs_through = |layer: &&VolumeLayer| {
        let clear = |k: &u32| opacity(layer, at(*k)).is_some_and(|opacity| opacity < CLEAR);
        (0..LOOKED_AT).filter(clear).count() as f64 >= MOSTLY * f64::from(LOOKED_AT)
    };
    let volumes = scene.layers.iter().filter_map(|layer| layer.kind.volume());
    volumes.filter(runs_through).collect()
}

/// Opacity of a volume at a position per reference step; `None` outside it.
fn opacity(layer: &VolumeLayer, p: DVec3) -> Option<f64> {
    layer.volume.at(layer.volume.lattice_from_scene(p)).map(|value| layer.transfer.opacity(value))
}

fn is_clear_around(layer: &VolumeLayer, p: DVec3, margin: f64) -> bool {
    let is_clear = |p: DVec3| opacity(layer, p).is_none_or(|opacity| opacity < CLEAR);
    is_clear(p) && DVec3::AXES.into_iter().all(|a| is_clear(p + margin * a) && is_clear(p - margin * a))
}
