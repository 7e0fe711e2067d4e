//! The lens of a preview, fitted to the surroundings of its path, and the room for its eye.

use super::{Lens, PathPreview, TOLERANCES, TRIALS};
use crate::ConstructError;
use crate::rays::room::{Room, Surroundings, vessels};
use crate::rays::{Target, TargetSight};
use belvedere_core::DVec3;
use belvedere_scene::Scene;
use belvedere_sight::Obstacles;

/// Widths that are tried, shares of the usual one; and the numbers of positions and of samples of the path by which they are judged.
const NARROWER: [f64; 3] = [1.0, 0.7, 0.5];
const POSITIONS: u32 = 5;
const SAMPLES: f64 = 60.0;
/// Height of the samples over the path, share of the eye's height: rivers are drawn in valleys that a coarse model has filled.
const LIFT: f64 = 0.01;
/// Gain of the visible share for which another width or tolerance is taken.
const WORTH: f64 = 0.03;
/// Least width of the corridor, and the height over the path at which it is measured, widths of the picture.
const CORRIDOR: f64 = 0.5;
const EYE: f64 = 0.25;
/// Distance of the positions at which room is sought, widths of the picture, and their greatest number; range of the number of
/// further positions for every turn, while the camera swings, and their greatest number in all.
const ROOM_SPACING: f64 = 0.05;
const MOST_ROOMS: f64 = 200.0;
const SWING_ROOMS: [usize; 2] = [4, 24];
const MOST_SWING_ROOMS: usize = 800;

impl PathPreview {
    /// Prepares a preview with a fitted camera: of several widths and tolerances the ones with which most of the path ahead is seen
    /// in `scene`, from positions all along it. `usual` is the widest.
    ///
    /// # Errors
    /// As [`PathPreview::new`].
    pub fn fitted(
        scene: &Scene,
        points: &[DVec3],
        preview_m: f64,
        usual: Lens,
        level: bool,
        image: [u32; 2],
    ) -> Result<Self, ConstructError> {
        let wide = Self::new(points, preview_m, usual, level, image)?;
        let usual = wide.fitting(scene);
        let first = Self::new(points, preview_m, usual, level, image)?.standing_in(scene, image)?;
        let mut best = (first.seen_ahead(scene, image)?, first.clone());
        for narrower in NARROWER {
            for share in TOLERANCES {
                let (width_m, rise_m) = (narrower * usual.width_m, narrower * usual.rise_m);
                let lens = Lens { width_m, rise_m, ..usual };
                let next = Self { lens, ..first.clone() }.with_tolerance(share * width_m).standing_in(scene, image)?;
                let seen = next.seen_ahead(scene, image)?;
                // The wider picture is preferred, for it shows where the path runs.
                if seen > best.0 + WORTH {
                    best = (seen, next);
                }
            }
        }
        Ok(best.1)
    }

    /// Share of the path ahead that is seen, on the average over positions along it.
    fn seen_ahead(&self, scene: &Scene, image: [u32; 2]) -> Result<f64, ConstructError> {
        let mut sum = 0.0;
        for k in 0..POSITIONS {
            let position = self.length() * (f64::from(k) + 0.3) / f64::from(POSITIONS);
            let wanted = self.wanted(position);
            let lift = if self.level { LIFT * self.lens.rise_m * DVec3::Z } else { DVec3::ZERO };
            let ahead = self.samples(position, wanted, wanted / SAMPLES);
            let target = Target::points(ahead.into_iter().map(|p| p + lift));
            sum += TargetSight::new(scene, &target).share(&self.at(position, image, None)?.view, 0.0);
        }
        Ok(sum / f64::from(POSITIONS))
    }

    /// The widest lens, up to that of this preview, whose picture is not much wider than the corridor that the path follows.
    fn fitting(&self, scene: &Scene) -> Lens {
        const NARROWER: f64 = 0.8;
        const TRIED: i32 = 16;
        let (obstacles, vessels) = (Obstacles::new(scene), vessels(scene, &self.path));
        let is_empty = obstacles.grounds().is_empty() && obstacles.solid_bounds().is_empty();
        if vessels.is_empty() && (is_empty || !self.level) {
            return self.lens;
        }
        let lens = |k: i32| {
            let share = NARROWER.powi(k);
            Lens { width_m: share * self.lens.width_m, rise_m: share * self.lens.rise_m, ..self.lens }
        };
        let is_wide = |lens: &Lens| {
            let obstacles = (!is_empty).then_some(&obstacles);
            let around = Surroundings { obstacles, vessels: &vessels, path: &self.path, width: lens.width_m };
            let place = |k: usize| {
                let s = self.path.length() * (k as f64 + 0.5) / TRIALS as f64;
                let way = self.path.at(s + 0.1 * lens.width_m) - self.path.at(s - 0.1 * lens.width_m);
                let right = way.cross(DVec3::Z).normalize_or(DVec3::X);
                match self.level {
                    true => vec![(self.path.at(s) + EYE * lens.width_m * DVec3::Z, right)],
                    // A vessel may be flat: its width is that of both directions.
                    false => {
                        [right, way.cross(right).normalize_or(DVec3::Z)].map(|side| (self.path.at(s), side)).to_vec()
                    }
                }
            };
            lens.width_m * CORRIDOR > around.corridor(&(0..TRIALS).flat_map(place).collect::<Vec<_>>())
        };
        (0..TRIED).map(lens).find(|lens| !is_wide(lens)).unwrap_or(self.lens)
    }

    /// The same preview with the eye kept clear of ground and walls.
    ///
    /// # Errors
    /// As [`PathPreview::at`].
    pub fn standing_in(self, scene: &Scene, image: [u32; 2]) -> Result<Self, ConstructError> {
        self.with_room(Some(scene), image)
    }

    pub(super) fn with_room(mut self, scene: Option<&Scene>, image: [u32; 2]) -> Result<Self, ConstructError> {
        let width = self.lens.width_m;
        let count = (self.path.length() / (ROOM_SPACING * width)).ceil().clamp(1.0, MOST_ROOMS);
        let mut positions: Vec<f64> = (0..=count as usize).map(|k| self.path.length() * k as f64 / count).collect();
        let per_turn = (MOST_SWING_ROOMS / self.controls.len()).clamp(SWING_ROOMS[0], SWING_ROOMS[1]);
        for pair in self.controls.windows(2) {
            let over = self.swing(pair[0].at.distance(pair[1].at));
            // The direction is that of the next leg from the turn itself on.
            positions.extend((0..=per_turn + 1).map(|k| pair[1].s + over * (k as f64 / per_turn as f64 - 1.0)));
        }
        positions.sort_by(f64::total_cmp);
        let within = positions.into_iter().filter(|s| (0.0..=self.path.length()).contains(s));
        let camera = |position: f64| Ok((position, self.root(&self.legs(position), position, image, None)?));
        let cameras = within.map(camera).collect::<Result<Vec<_>, ConstructError>>()?;
        let obstacles = scene.map(Obstacles::new);
        let obstacles = obstacles.as_ref().filter(|o| !(o.grounds().is_empty() && o.solid_bounds().is_empty()));
        let vessels = scene.map_or_else(Vec::new, |scene| vessels(scene, &self.path));
        let around = Surroundings { obstacles, vessels: &vessels, path: &self.path, width };
        self.room = Some(Room::new(&cameras, &around, width.min(0.5 * self.lens.behind_m)));
        Ok(self)
    }
}
