//! Target tracking: the second viewpoint moves sideways just as far as is needed to keep a moving target in sight.
//!
//! Source: Cui et al. 2010, section 5.2: one number f in -1..=1 per frame, searched from where it is, changed at most at a set
//! speed. The paper compares boxes in the image; here lines of sight to points of the target's box decide, for boxes of walls and
//! ground hide everything. Planes, steps and speeds are not given by the paper: ours.

use super::{PlannedBend, Sidestep, Target, TargetSight};
use crate::ConstructError;
use belvedere_core::{DVec3, View};
use belvedere_scene::Scene;
use belvedere_sight::TreeMemory;
use serde::{Deserialize, Serialize};

/// Directions of f > 0 across the view that a search tries, degrees from the right of the picture upwards; the first is that of the paper.
const DIRECTIONS_DEG: [f64; 4] = [0.0, 90.0, 45.0, 135.0];
/// Shares from here on count as the whole target.
pub(super) const WHOLE: f64 = 0.999;
/// Time for which a target must have been clear, with twice the margin, before the rays straighten again, seconds.
const CLEAR_FOR_S: f64 = 0.25;
/// Least height of the second viewpoint above the ground, metres, unless the eye itself is lower.
const LEAST_HEIGHT_M: f64 = 2.0;
/// Gain of the visible share for which rays bend further where the whole target cannot be shown.
const WORTH: f64 = 0.05;

/// Parameters; the defaults are those of the scene file.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct TrackingOptions {
    /// Distance of plane t0 from the eye, scene units, > 0; half the target's by default.
    pub z0: Option<f64>,
    /// Distance of the second viewpoint from the eye at f = 1, scene units, > 0; half the target's distance by default.
    pub a: Option<f64>,
    /// Step of the search for f, in (0, 1].
    pub f_step: f64,
    /// Largest change of f per second, > 0.
    pub cap_per_s: f64,
    /// Margin around the target that must be clear as well, pixels, >= 0.
    pub grow_px: f64,
}

impl Default for TrackingOptions {
    fn default() -> Self {
        Self { z0: None, a: None, f_step: 0.05, cap_per_s: 1.5, grow_px: 8.0 }
    }
}

impl TrackingOptions {
    pub(super) fn check(&self) -> Result<(), ConstructError> {
        let parameters = [
            ("z0", self.z0.unwrap_or(1.0), f64::INFINITY, "be a number greater than 0"),
            ("a", self.a.unwrap_or(1.0), f64::INFINITY, "be a number greater than 0"),
            ("f_step", self.f_step, 1.0, "lie in (0, 1]"),
            ("cap_per_s", self.cap_per_s, f64::INFINITY, "be a number greater than 0"),
        ];
        for (name, value, most, must) in parameters {
            if !(value > 0.0 && value <= most && value.is_finite()) {
                return Err(ConstructError::Parameter { name, value, must });
            }
        }
        if !(self.grow_px >= 0.0 && self.grow_px.is_finite()) {
            let (name, value) = ("grow_px", self.grow_px);
            return Err(ConstructError::Parameter { name, value, must: "be a number of at least 0" });
        }
        Ok(())
    }
}

/// Memory between frames. The same inputs and memory give the same result.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct TrackingMemory {
    f: f64,
    /// Sign of the last motion: the side that is searched first.
    side: f64,
    /// Value of f that is aimed at: kept while it shows the target, for else f would turn round half-way.
    goal: f64,
    /// Time for which the straight rays have shown the target with twice the margin, seconds.
    clear_s: f64,
    /// Right direction of the camera in the frame before.
    right: Option<DVec3>,
    /// Direction of f > 0 across the view, degrees from the right of the picture upwards.
    direction_deg: f64,
    /// Bend that a plan sets for the next frame.
    planned: Option<PlannedBend>,
    /// Trees over what may hide the target.
    pub(super) trees: TreeMemory,
}

impl TrackingMemory {
    /// Sets the bend of the next frame; with `None` the tracker searches for one.
    pub fn follow(&mut self, bend: Option<PlannedBend>) {
        self.planned = bend;
    }

    /// The memory before the first frame, but for the trees.
    pub(super) fn begun_again(&self) -> Self {
        Self { trees: self.trees.clone(), ..Self::default() }
    }

    pub(super) fn keep_side(&mut self, right: DVec3) {
        self.right = Some(right);
    }
}

/// The camera of one frame.
#[derive(Debug, Clone)]
pub struct Tracked {
    /// The bent view; `base` itself where f is 0.
    pub view: View,
    /// Figures.
    pub report: TrackingReport,
}

/// Report of the tracking in one frame.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct TrackingReport {
    /// Position of the second viewpoint, -1 (left) ..= 1 (right), in units of `a`.
    pub f: f64,
    /// Value of f that it moves towards.
    pub goal: f64,
    /// Direction of f > 0 across the view, degrees from the right of the picture upwards; 0 unless only that shows the target.
    #[serde(default)]
    pub direction_deg: f64,
    /// Share of the target that straight rays show.
    pub visible_straight: f64,
    /// Share that the picture shows.
    pub visible: f64,
    /// Cameras that were tried.
    pub tried: usize,
}

/// The camera of a frame that keeps `target` in sight.
///
/// * `base`: the camera, with other stages but curved rays if need be;
/// * `time_step_s`: seconds since the frame before; `None` for a picture of its own, which takes the goal at once, as the first
///   frame of a film does.
///
/// # Errors
/// [`ConstructError::Parameter`], [`ConstructError::Rays`].
pub fn track_target(
    scene: &Scene,
    base: &View,
    target: &Target,
    options: &TrackingOptions,
    time_step_s: Option<f64>,
    memory: &mut TrackingMemory,
) -> Result<Tracked, ConstructError> {
    options.check()?;
    let trees = memory.trees.clone();
    let sight = TargetSight::remembering(scene, target, &trees);
    let mut search = Search::new(base, target, options, &sight, memory);
    let straight = search.share(0.0, 0.0);
    let planned = memory.planned.take();
    let goal = match planned {
        Some(bend) => {
            search.direction_deg = bend.direction_deg;
            search.begin_at(bend.start);
            bend.f
        }
        None => {
            let goal = search.goal(memory, time_step_s);
            let may_turn = memory.f == 0.0 || time_step_s.is_none();
            if may_turn { search.in_other_directions(goal) } else { goal }
        }
    };
    memory.direction_deg = search.direction_deg;
    let before = memory.f;
    // A film begins where its first frame wants to be.
    let is_first = memory.right.is_none();
    memory.f = match time_step_s.filter(|_| !is_first && planned.is_none()) {
        Some(dt) => before + (goal - before).clamp(-options.cap_per_s * dt, options.cap_per_s * dt),
        None => goal,
    };
    if memory.f != before {
        memory.side = (memory.f - before).signum();
    }
    (memory.goal, memory.right) = (goal, Some(search.right));
    let view = search.view(memory.f)?;
    let visible = search.share(memory.f, 0.0);
    let direction_deg = search.direction_deg;
    let report =
        TrackingReport { f: memory.f, goal, direction_deg, visible_straight: straight, visible, tried: search.tried };
    Ok(Tracked { view, report })
}

/// The cameras of one frame.
pub(super) struct Search<'a> {
    base: &'a View,
    sight: &'a TargetSight<'a>,
    options: &'a TrackingOptions,
    right: DVec3,
    /// Distance of the second viewpoint at f = 1.
    reach: f64,
    /// Distance and extent of the target, scene units.
    depth: f64,
    extent: f64,
    /// Distances of t0, t1, t2 from the eye; `None` if the target is too near for a bend.
    planes: Option<[f64; 3]>,
    direction_deg: f64,
    tried: usize,
}

impl<'a> Search<'a> {
    pub(super) fn new(
        base: &'a View,
        target: &Target,
        options: &'a TrackingOptions,
        sight: &'a TargetSight<'a>,
        memory: &TrackingMemory,
    ) -> Self {
        let pinhole = base.pinhole();
        // The bend follows the other stages, and so does the target it is made for.
        let center = base.displace(target.center()).map_or(target.center(), |d| d.point);
        let depth = (center - pinhole.eye).dot(pinhole.forward);
        // Passing overhead turns the camera's right round; the viewpoint stays on its side.
        let turned = memory.right.is_some_and(|before| before.dot(pinhole.right) < 0.0);
        let right = if turned { -pinhole.right } else { pinhole.right };
        let direction_deg = if memory.f == 0.0 { DIRECTIONS_DEG[0] } else { memory.direction_deg };
        let reach = options.a.unwrap_or(0.5 * depth);
        let extent = target.extent();
        let mut out = Self { base, sight, options, right, reach, depth, extent, planes: None, direction_deg, tried: 0 };
        out.begin_at(PlannedBend::START);
        out
    }

    /// Sets where rays begin to bend, as a share of the target's distance, unless the options state a distance.
    pub(super) fn begin_at(&mut self, start: f64) {
        let z0 = self.options.z0.unwrap_or(start * self.depth);
        self.planes = planes(self.depth, self.extent, self.base.pinhole().near, z0);
    }

    pub(super) fn right(&self) -> DVec3 {
        self.right
    }

    fn view(&self, f: f64) -> Result<View, ConstructError> {
        self.view_in(f, self.direction_deg)
    }

    fn view_in(&self, f: f64, direction_deg: f64) -> Result<View, ConstructError> {
        match self.planes {
            Some(planes) if f != 0.0 => Sidestep { offset: self.offset(f, direction_deg), planes }.view(self.base),
            _ => Ok(self.base.clone()),
        }
    }

    /// Vector from the eye to the second viewpoint.
    fn offset(&self, f: f64, direction_deg: f64) -> DVec3 {
        let (sin, cos) = direction_deg.to_radians().sin_cos();
        let across = if direction_deg == 0.0 { self.right } else { cos * self.right - sin * self.base.pinhole().down };
        f * self.reach * across
    }

    /// Whether the second viewpoint stands above the ground; one that goes level may stay as low as the eye.
    fn stands(&self, f: f64, direction_deg: f64) -> bool {
        let eye = self.base.pinhole().eye;
        let viewpoint = eye + self.offset(f, direction_deg);
        self.sight.height_above_ground(viewpoint) >= LEAST_HEIGHT_M.min(self.sight.height_above_ground(eye))
    }

    /// Share of the target that is seen with f in a direction, degrees; 0 if such a camera is not possible.
    pub(super) fn seen(&self, (f, direction_deg): (f64, f64), grow_px: f64) -> f64 {
        let view = self.view_in(f, direction_deg).ok().filter(|_| f == 0.0 || self.stands(f, direction_deg));
        view.map_or(0.0, |view| self.sight.share(&view, grow_px))
    }

    /// `goal`, or where going sideways does not show the whole target, where going up or aslant shows more.
    fn in_other_directions(&mut self, goal: f64) -> f64 {
        let mut best = (self.share(goal, 0.0), goal, self.direction_deg);
        for direction in DIRECTIONS_DEG {
            if best.0 >= WHOLE || self.planes.is_none() {
                break;
            }
            self.direction_deg = direction;
            let f = self.nearest(0.0, 1.0);
            let share = self.share(f, 0.0);
            if share > best.0 + WORTH {
                best = (share, f, direction);
            }
        }
        self.direction_deg = best.2;
        best.1
    }

    /// Share of the target that is seen; 0 if such a camera is not possible.
    fn share(&mut self, f: f64, grow_px: f64) -> f64 {
        self.tried += 1;
        self.seen((f, self.direction_deg), grow_px)
    }

    /// Value of f to aim at: 0 where straight rays show the target; the present one where it does; else that of the nearest camera
    /// that shows it.
    fn goal(&mut self, memory: &mut TrackingMemory, time_step_s: Option<f64>) -> f64 {
        let grow = self.options.grow_px;
        let film = time_step_s.is_some();
        let margin = if film && memory.f != 0.0 { 2.0 * grow } else { grow };
        let clear = self.share(0.0, margin) >= WHOLE;
        memory.clear_s = if clear { memory.clear_s + time_step_s.unwrap_or(CLEAR_FOR_S) } else { 0.0 };
        if self.planes.is_none() || (clear && memory.f == 0.0) {
            return 0.0;
        }
        let is_seen = self.share(memory.f, grow) >= WHOLE;
        let rested = memory.clear_s >= CLEAR_FOR_S;
        // In a film the rays do not straighten while something would hide the target half-way.
        if rested && (!film || !is_seen || self.shows_all_the_way(memory.f, 0.0)) {
            return 0.0;
        }
        if is_seen {
            return memory.f;
        }
        if memory.goal != memory.f && self.share(memory.goal, grow) >= WHOLE {
            return memory.goal;
        }
        self.nearest(memory.f, if memory.side < 0.0 { -1.0 } else { 1.0 })
    }

    fn shows_all_the_way(&mut self, from: f64, to: f64) -> bool {
        let steps = ((to - from).abs() / self.options.f_step).ceil() as usize;
        (1..steps).all(|k| self.share(from + (to - from) * k as f64 / steps as f64, 0.0) >= WHOLE)
    }

    /// The nearest camera that shows the whole target; where none does, that which shows most.
    ///
    /// * `first`: the side that is tried first.
    fn nearest(&mut self, from: f64, first: f64) -> f64 {
        let mut best = (self.share(from, 0.0), from);
        let steps = (2.0 / self.options.f_step).ceil() as usize;
        for (k, side) in (1..=steps).flat_map(|k| [(k, first), (k, -first)]) {
            let before = from + side * self.options.f_step * (k - 1) as f64;
            if before.abs() >= 1.0 && before.signum() == side {
                continue;
            }
            // Each side ends at 1 exactly.
            let f = (before + side * self.options.f_step).clamp(-1.0, 1.0);
            if self.share(f, self.options.grow_px) >= WHOLE {
                return f;
            }
            let share = self.share(f, 0.0);
            if share > best.0 + WORTH {
                best = (share, f);
            }
        }
        if best.0 > 0.0 { best.1 } else { 0.0 }
    }
}

/// Distances of t0, t1, t2 from the eye for a target at `depth`: t2 stays before the target, by its radius.
fn planes(depth: f64, radius: f64, near: f64, z0: f64) -> Option<[f64; 3]> {
    if !(depth > 2.0 * near) {
        return None;
    }
    let least = depth / 20.0;
    let last = depth - 2.0 * radius;
    let first = z0.min(last - least).max(1.001 * near);
    let end = (first + 0.25 * depth).min(last);
    (end - first >= 0.999 * least).then_some([first, 0.5 * (first + end), end])
}
