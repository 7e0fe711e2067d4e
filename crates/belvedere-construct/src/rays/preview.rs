//! Path preview: rays follow a path ahead, round every bend of it.
//!
//! Source: Cui et al. 2010, section 5.3, with the rules of collapse and deployment worked out by us: turns stand where the simplified
//! path turns; a turn that comes into the preview grows from nothing, and the camera swings into the next leg while it
//! passes one, so that nothing jumps. On terrain the turns stand upright and the camera looks down on the path.

mod fit;

use super::approach::approach;
use super::path::{Control, Path};
use super::room::Room;
use super::turns::{Corner, STRAIGHT, TRANSITION, TurnShape, largest, smoothstep, turns};
use crate::ConstructError;
use belvedere_core::map::curved_rays::{Model, Sharpness};
use belvedere_core::{CurvedRays, DVec3, Pinhole, Projection, Stage, View};
use serde::{Deserialize, Serialize};

/// Longest swing of the camera into the next leg, shares of the leg before it, of the preview and of the width of the picture. A
/// longer swing would be gentler, but a camera that looks aside sees the wall of a canyon.
const SWING: [f64; 3] = [0.5, 0.06, 0.5];
/// Point about which the camera swings, share of the path from the position to the turn.
const SWINGS_ABOUT: f64 = 0.5;
/// Height of the position in the picture over terrain, share of the picture's height from its lower edge.
const FOOT: f64 = 0.06;
/// Distance before the position at which rays become those of the far eye, widths of the picture: least and greatest.
const BEFORE: [f64; 2] = [0.08, 0.6];
/// Length of transitions where longer ones do not fit, share of the usual length.
const SHORTEST: f64 = 1e-3;
/// Distance of the near eye from the plane behind which rays are those of the far eye, widths of the picture: least and greatest; and
/// least room behind a position, share of the greatest.
const BACK: [f64; 2] = [0.05, 0.7];
const LEAST_ROOM: f64 = 0.05;
/// Tolerances of the simplified path that are tried, shares of the picture's width.
const TOLERANCES: [f64; 4] = [0.02, 0.04, 0.08, 0.16];
/// Positions at which a tolerance is tried.
const TRIALS: usize = 24;

/// The camera of a preview; lengths in scene units.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Lens {
    /// Distance of the eye behind the position on the path, and of every viewpoint behind its turn, > 0.
    pub behind_m: f64,
    /// Width of the picture there, > 0.
    pub width_m: f64,
    /// Height of the eye over the path, >= 0.
    pub rise_m: f64,
}

impl Lens {
    /// Lens for a preview of length `preview_m`: the eye is as far behind, the picture a quarter as wide; over terrain the eye is a
    /// tenth as high.
    pub fn for_preview(preview_m: f64, over_terrain: bool) -> Self {
        let rise_m = if over_terrain { 0.1 * preview_m } else { 0.0 };
        Self { behind_m: preview_m, width_m: 0.25 * preview_m, rise_m }
    }
}

/// A path, the length of it that is shown ahead, and the camera.
#[derive(Debug, Clone, PartialEq)]
pub struct PathPreview {
    path: Path,
    /// Where the simplified path turns, with both ends.
    controls: Vec<Control>,
    preview_m: f64,
    lens: Lens,
    level: bool,
    tolerance: f64,
    room: Option<Room>,
}

/// The camera at a position.
#[derive(Debug, Clone)]
pub struct Previewed {
    /// The bent view.
    pub view: View,
    /// Figures.
    pub report: PreviewReport,
}

/// Report of a preview.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct PreviewReport {
    /// Position on the path, scene units.
    pub position_m: f64,
    /// Length of the path that is followed from there, scene units: less than wanted where more turns would not fit.
    pub reach_m: f64,
    /// Length that was requested, as far as the path goes, scene units.
    #[serde(default)]
    pub wanted_m: f64,
    /// Turns of the rays.
    pub turns: usize,
    /// Largest distance of the path from the simplified one, scene units.
    pub tolerance_m: f64,
}

impl PathPreview {
    /// Prepares a preview of `points`; `level` = over terrain: turns are upright, heights of the path do not turn rays.
    ///
    /// # Errors
    /// [`ConstructError::Parameter`] for lengths out of range or a path without length.
    pub fn new(
        points: &[DVec3],
        preview_m: f64,
        lens: Lens,
        level: bool,
        image: [u32; 2],
    ) -> Result<Self, ConstructError> {
        let positive = [("preview_m", preview_m), ("behind_m", lens.behind_m), ("width_m", lens.width_m)];
        for (name, value) in positive {
            if !(value > 0.0 && value.is_finite()) {
                return Err(ConstructError::Parameter { name, value, must: "be a number greater than 0" });
            }
        }
        if !(lens.rise_m >= 0.0 && lens.rise_m.is_finite()) {
            let (name, value) = ("rise_m", lens.rise_m);
            return Err(ConstructError::Parameter { name, value, must: "be a number of at least 0" });
        }
        let path = Path::new(points);
        if !(path.length() > 1e-6 * lens.behind_m) {
            let (name, value) = ("the length of the path", path.length());
            return Err(ConstructError::Parameter {
                name,
                value,
                must: "be more than nothing; give a path of two points",
            });
        }
        let mut preview = Self { path, controls: Vec::new(), preview_m, lens, level, tolerance: 0.0, room: None };
        preview.choose_tolerance(image)?;
        preview.with_room(None, image)
    }

    fn with_tolerance(mut self, tolerance: f64) -> Self {
        self.tolerance = tolerance;
        self.controls = self.path.controls(tolerance, 0.5 * self.lens.width_m, self.level);
        self
    }

    /// Length of the path, scene units.
    pub fn length(&self) -> f64 {
        self.path.length()
    }

    /// The camera, as it was given or chosen.
    pub fn lens(&self) -> Lens {
        self.lens
    }

    /// Point of the path at a length along it, scene units.
    pub fn point_at(&self, along_m: f64) -> DVec3 {
        self.path.at(along_m)
    }

    /// Points of the path that a preview from `position_m` shows, as far as `reach_m`, `spacing` apart.
    pub fn samples(&self, position_m: f64, reach_m: f64, spacing: f64) -> Vec<DVec3> {
        let count = (reach_m / spacing).floor().clamp(0.0, 1e6) as usize;
        (1..=count).map(|k| self.path.at(position_m + spacing * k as f64)).collect()
    }

    /// The smallest tolerance with which all of the preview can be followed nearly everywhere; else that which reaches farthest.
    fn choose_tolerance(&mut self, image: [u32; 2]) -> Result<(), ConstructError> {
        let mut best: Option<(f64, f64, Vec<Control>)> = None;
        for share in TOLERANCES {
            *self = self.clone().with_tolerance(share * self.lens.width_m);
            let mut reached = 0.0;
            for k in 0..TRIALS {
                let position = self.path.length() * k as f64 / TRIALS as f64;
                let report = self.at(position, image, None)?.report;
                reached += report.reach_m / self.wanted(position) / TRIALS as f64;
            }
            if best.as_ref().is_none_or(|b| reached > b.0 + 0.02) {
                best = Some((reached, self.tolerance, self.controls.clone()));
            }
            if reached > 0.99 {
                break;
            }
        }
        if let Some((_, tolerance, controls)) = best {
            (self.tolerance, self.controls) = (tolerance, controls);
        }
        Ok(())
    }

    /// Length of path that is to be shown from a position.
    fn wanted(&self, position: f64) -> f64 {
        self.preview_m.min(self.path.length() - position).max(1e-9 * self.path.length())
    }

    /// The view from a position on the path, held at its ends. Depends on nothing but its arguments.
    ///
    /// * `image`: width and height, pixels;
    /// * `far`: farthest drawn depth, scene units.
    ///
    /// # Errors
    /// [`ConstructError::Pinhole`] for an image of no pixels.
    pub fn at(&self, position_m: f64, image: [u32; 2], far: Option<f64>) -> Result<Previewed, ConstructError> {
        let last = self.path.length();
        let position = position_m.clamp(0.0, last * (1.0 - 1e-9));
        let legs = self.legs(position);
        let root = self.root(&legs, position, image, far)?;
        let mut count = legs.turns.len();
        let mut found = None;
        while found.is_none() {
            // Arguments: near plane, length of all transitions, and a further factor on the first one; shares of the usual.
            let rays = |near: f64, length: f64, first_length: f64| {
                let far = Pinhole { near: near * root.near, ..root.clone() };
                let shape = TurnShape { behind: self.lens.behind_m, length, m: Sharpness::Bend };
                let mut corners = legs.turns[..count].to_vec();
                if let Some(corner) = corners.first_mut() {
                    corner.half_length *= first_length;
                }
                let (root, first) = approach(&far, self.back(position, root.near - far.near)).ok()?;
                let ahead = turns(&far, legs.here, &corners, &shape)?;
                CurvedRays::new(&root, Model::Modified, &[vec![first], ahead].concat()).ok()
            };
            // Planes farther before the position are preferred to short transitions, but not where the eye has no room.
            let [most, roomy, least] = self.before(position).map(|before| 1.0 - before / root.near);
            found = largest([SHORTEST, 1.0], |all| rays(most, all, SHORTEST).map(|_| all)).and_then(|all| {
                largest([roomy, least], |near| rays(near, all, 1.0))
                    .or_else(|| largest([SHORTEST, 1.0], |first| rays(roomy, all, first)))
                    .or_else(|| largest([most, roomy], |near| rays(near, all, SHORTEST)))
            });
            if count == 0 {
                break;
            }
            count -= usize::from(found.is_none());
        }
        let wanted_m = self.wanted(position);
        let reach_m = match legs.turns.get(count) {
            Some(turn) => turn.s - position,
            None => wanted_m,
        };
        let root = found.as_ref().map_or(root, |rays| rays.root().clone());
        let stages = found.map(Stage::CurvedRays).into_iter().collect();
        let report =
            PreviewReport { position_m: position, reach_m, wanted_m, turns: count, tolerance_m: self.tolerance };
        Ok(Previewed { view: View::new(root, stages)?, report })
    }

    /// The legs ahead of a position.
    fn legs(&self, position: f64) -> Legs {
        let next = self.controls.partition_point(|c| c.s <= position).clamp(1, self.controls.len() - 1);
        let (from, to) = (self.controls[next - 1], self.controls[next]);
        let lift = |p: DVec3| if self.level { p.truncate().extend(self.eye_height(position)) } else { p };
        let here = lift(from.at.lerp(to.at, (position - from.s) / (to.s - from.s)));
        let direction = |i: usize| (self.controls[i].at - self.controls[i - 1].at).normalize_or(DVec3::Y);
        let mut turns: Vec<Corner> = Vec::new();
        for i in next..self.controls.len() - 1 {
            let Control { s, at, half_length } = self.controls[i];
            if s >= position + self.preview_m {
                break;
            }
            let (before, after) = (direction(i), direction(i + 1));
            if before.angle_between(after) < STRAIGHT {
                continue;
            }
            let edges = [self.controls[i - 1], self.controls[i + 1]].map(|c| c.at.distance(at));
            let shorter = edges[0].min(edges[1]);
            let half_length = half_length.unwrap_or(f64::INFINITY).min(TRANSITION * shorter);
            // A turn enters over at most the leg before it.
            let ramp = (0.3 * self.preview_m).min(shorter);
            let entered = smoothstep((position + self.preview_m - s) / ramp);
            turns.push(Corner { s, at: lift(at), before, after, edges, half_length, entered });
        }
        Legs { here, direction: direction(next), turns }
    }

    /// Distances before the position at which rays may become those of the far eye: greatest, greatest with room for the eye, and least.
    fn before(&self, position: f64) -> [f64; 3] {
        let width = self.lens.width_m.min(self.lens.behind_m);
        let room = self.room(position);
        let [least, most] = BEFORE.map(|share| share * width);
        let roomy = most.min(0.75 * room);
        [most, roomy, least.min(0.2 * room).min(0.5 * roomy)]
    }

    /// Distance of the near eye from the plane behind which rays are those of the far one, `before` before the position.
    fn back(&self, position: f64, before: f64) -> f64 {
        let (room, width) = (self.room(position), self.lens.width_m);
        (room - before).clamp((0.2 * room).max(BACK[0] * width), BACK[1] * width)
    }

    /// Distance behind a position up to which the near eye may stand, scene units.
    fn room(&self, position: f64) -> f64 {
        let most = self.lens.width_m.min(0.5 * self.lens.behind_m);
        let room = self.room.as_ref().map_or(most, |room| room.at(position));
        room.clamp(LEAST_ROOM * most, most)
    }

    /// Height of the eye over terrain: the mean height of the path around the position, plus the rise; more where the path behind is
    /// higher.
    fn eye_height(&self, position: f64) -> f64 {
        const SAMPLES: usize = 33;
        const BEHIND: usize = 9;
        let at = |k: usize| position + self.preview_m * (-0.1 + 0.6 * k as f64 / (SAMPLES - 1) as f64);
        let ahead = (0..SAMPLES).map(|k| self.path.at(at(k)).z).sum::<f64>() / SAMPLES as f64;
        // Where the path descends, the eye stands over the ground behind the position.
        let behind = |k: usize| self.path.at(position - self.lens.width_m * k as f64 / (BEHIND - 1) as f64).z;
        let highest = (0..BEHIND).map(behind).fold(f64::NEG_INFINITY, f64::max);
        ahead + soft_hinge(highest - ahead, self.lens.rise_m) + self.lens.rise_m
    }

    /// Length of the path over which the camera swings into the next leg, from the length of the leg before.
    fn swing(&self, leg: f64) -> f64 {
        (SWING[0] * leg).min(SWING[1] * self.preview_m).min(SWING[2] * self.lens.width_m)
    }

    /// The camera before any turn: behind the position, swinging into the next leg while it comes to a turn.
    fn root(&self, legs: &Legs, position: f64, image: [u32; 2], far: Option<f64>) -> Result<Pinhole, ConstructError> {
        let Lens { behind_m, width_m, rise_m } = self.lens;
        // Rays begin at the position; while the camera swings, their beginning moves on to the turn. The camera swings about a point
        // half-way to the turn: if it swung about the turn, the picture of the ground behind the turn would stay, but the eye would
        // come nearer to the walls.
        let (direction, at, begin) = match legs.turns.first() {
            Some(turn) => {
                let over = self.swing(turn.edges[0]);
                let share = soft_ramp(1.0 - (turn.s - position) / over);
                let direction = turned(turn.before, turn.after, share);
                let about = legs.here.lerp(turn.at, SWINGS_ABOUT);
                let at = about - SWINGS_ABOUT * legs.here.distance(turn.at) * direction;
                let at = if share > 0.0 { at } else { legs.here };
                (direction, at, at.lerp(turn.at, share))
            }
            None => (legs.direction, legs.here, legs.here),
        };
        let eye = at - behind_m * direction;
        let [width, height] = image.map(f64::from);
        let fov_y = 2.0 * (0.5 * width_m / behind_m * height / width).atan();
        let pitch = if self.level { rise_m.atan2(behind_m) - (0.5 - FOOT) * fov_y } else { 0.0 };
        let up = if direction.z.abs() < 0.99 { DVec3::Z } else { DVec3::Y };
        let side = direction.cross(up).normalize();
        let forward = pitch.cos() * direction + pitch.sin() * direction.cross(side);
        let foot = begin - if self.level { rise_m * DVec3::Z } else { DVec3::ZERO };
        let near = (foot - eye).dot(forward);
        let far = far.filter(|far| *far > near);
        let lens = Projection::Perspective { fov_y };
        Ok(Pinhole::look_at(eye, eye + forward, up, lens, image, near, far)?)
    }
}

/// The position, the direction and the turns ahead of it.
struct Legs {
    here: DVec3,
    direction: DVec3,
    turns: Vec<Corner>,
}

/// Direction between two others, at a share of the angle from the first to the second.
fn turned(from: DVec3, to: DVec3, share: f64) -> DVec3 {
    let angle = from.angle_between(to);
    if angle < 1e-9 {
        return to;
    }
    let across = (to - from.dot(to) * from).normalize_or(to);
    let (sin, cos) = (share * angle).sin_cos();
    cos * from + sin * across
}

/// Smooth hinge (C1): 0 for `x` <= 0, `x - round / 2` for `x` >= `round`.
fn soft_hinge(x: f64, round: f64) -> f64 {
    if x <= 0.0 {
        0.0
    } else if x < round {
        0.5 * x * x / round
    } else {
        x - 0.5 * round
    }
}

/// Smooth ramp (C1): 0 for `x` <= 0, 1 for `x` >= 1, linear between but for its ends.
fn soft_ramp(x: f64) -> f64 {
    const ENDS: f64 = 0.2;
    let (x, slope) = (x.clamp(0.0, 1.0), 1.0 / (1.0 - ENDS));
    if x < ENDS {
        0.5 * slope * x * x / ENDS
    } else if x > 1.0 - ENDS {
        1.0 - 0.5 * slope * (1.0 - x) * (1.0 - x) / ENDS
    } else {
        slope * (x - 0.5 * ENDS)
    }
}
