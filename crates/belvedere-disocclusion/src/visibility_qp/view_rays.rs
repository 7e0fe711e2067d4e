//! Lines of sight behind the later stages of a view.

use super::problem::LinesOfSight;
use crate::Field;
use belvedere_core::{DVec2, DVec3, View};

/// A chord leaves the ray that it stands for by less than this in height, metres, but where the ray has a kink; the usual margin is twenty times that.
const BOW: f64 = 0.05;
/// Largest such distance in plan, cells.
const BOW_PLAN: f64 = 0.02;
/// Chords are halved at most this often.
const HALVINGS: u32 = 9;
/// Halves of a chord leave the ray by a quarter of what it does; by this factor more where only one half is bent, evenly.
const UNEVEN: f64 = 2.0;
/// Chords to begin with.
const PIECES: usize = 8;

/// Rays of a view from the displaced ground to the eye: the inverse of its spline and curved rays. Heights are those
/// after the curvature of the earth, as in a [`Field`] that was built with its drop.
#[derive(Debug, Clone)]
pub struct ViewSight {
    later: View,
    north_west: DVec2,
    spacing: DVec2,
}

impl ViewSight {
    /// Lines of sight over `field` of the stages of `view` that follow the terrain.
    pub fn new(view: &View, field: &Field) -> Self {
        let stages = view.stages().iter().filter(|s| !s.is_upright()).cloned().collect();
        // A part of a chain in its order is a chain.
        let later =
            View::new(view.pinhole().clone(), stages).unwrap_or_else(|_| View::straight(view.pinhole().clone()));
        Self { later, north_west: field.north_west(), spacing: field.spacing() }
    }

    fn scene(&self, grid: DVec2, z: f64) -> DVec3 {
        DVec3::new(self.north_west.x + grid.x * self.spacing.x, self.north_west.y - grid.y * self.spacing.y, z)
    }

    fn grid(&self, p: DVec3) -> (DVec2, f64) {
        (DVec2::new((p.x - self.north_west.x) / self.spacing.x, (self.north_west.y - p.y) / self.spacing.y), p.z)
    }

    /// Appends the ray between two depths, its far end excluded.
    fn halve(
        &self,
        at: &dyn Fn(f64) -> Option<DVec3>,
        (w0, a): (f64, DVec3),
        (w1, b): (f64, DVec3),
        halvings: u32,
        out: &mut Vec<(DVec2, f64)>,
    ) {
        let w = 0.5 * (w0 + w1);
        if halvings < HALVINGS
            && let Some(m) = at(w)
        {
            let off = m - 0.5 * (a + b);
            let bow = ((off.truncate() / self.spacing).length() / BOW_PLAN).max(off.z.abs() / BOW);
            if bow > 1.0 {
                let bent = 0.25 * UNEVEN * bow > 1.0;
                if bent {
                    self.halve(at, (w0, a), (w, m), halvings + 1, out);
                }
                out.push(self.grid(m));
                if bent {
                    self.halve(at, (w, m), (w1, b), halvings + 1, out);
                }
            }
        }
    }
}

impl LinesOfSight for ViewSight {
    fn trace(&self, grid: DVec2, z: f64, out: &mut Vec<(DVec2, f64)>) {
        if let Some(end) = self.straight() {
            out.extend([(grid, z), end]);
            return;
        }
        let p = self.scene(grid, z);
        let Ok(image) = self.later.project(p) else { return };
        let ray = self.later.ray(image.pixel);
        let near = self.later.pinhole().near.min(image.depth);
        let at = |w: f64| if w >= image.depth { Some(p) } else { ray.at(w).ok().map(|r| r.point) };
        let depth = |k: usize| image.depth + (near - image.depth) * k as f64 / PIECES as f64;
        out.push((grid, z));
        let mut from = (image.depth, p);
        for k in 1..=PIECES {
            // Beyond the domain of a stage there is nothing that could hide the point.
            let Some(to) = at(depth(k)) else { break };
            self.halve(&at, from, (depth(k), to), 0, out);
            out.push(self.grid(to));
            from = (depth(k), to);
        }
    }

    fn straight(&self) -> Option<(DVec2, f64)> {
        let pinhole = self.later.pinhole();
        (self.later.stages().is_empty() && !pinhole.is_orthographic()).then(|| self.grid(pinhole.eye))
    }
}
