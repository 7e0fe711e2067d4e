//! Errors of edges that are drawn straight, for renderers that evaluate every vertex once.

use super::View;
use crate::map::SpaceMap;
use crate::map::curved_rays::{self, Turn};
use crate::map::earth::EarthCurvature;
use crate::map::spline::{self, SplineBend};
use crate::{Aabb, DVec2, DVec3, Pinhole, Stage};

/// Bound on the error of an edge that bends and is drawn straight.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct EdgeError {
    /// The larger of the errors across the image and in depth, both in pixels: in depth a pixel is what it is across the image there.
    /// Infinite if no bound is known, or if an end of an edge that bends lies behind the eye.
    pub px: f64,
    /// The distance in displaced space, scene units; infinite if no bound is known.
    pub length: f64,
}

impl EdgeError {
    /// Of an edge that does not bend.
    pub const NONE: Self = Self { px: 0.0, length: 0.0 };
    /// Where no bound is known.
    pub const UNKNOWN: Self = Self { px: f64::INFINITY, length: f64::INFINITY };
}

/// Bounds on the error of edges in a view that bends by one turn of curved rays alone, or by one spline bend, over flat or curved earth.
#[derive(Debug)]
pub struct Edges<'a> {
    view: &'a View,
    pinhole: &'a Pinhole,
    scale_px: f64,
    bend: Bend<'a>,
}

#[derive(Debug)]
enum Bend<'a> {
    /// A turn, its shift across the image, pixels at depth 1, and along the axis.
    Turn { turn: &'a Turn, across: DVec2, along: f64 },
    /// A spline bend after the curvature of the earth, if any.
    Spline { earth: Option<&'a EarthCurvature>, spline: &'a SplineBend },
}

/// End of an edge: what the bend needs to know of it, its image and depth.
#[derive(Debug, Clone, Copy)]
pub struct EdgePoint {
    p: DVec3,
    end: End,
    /// Image, pixels from the centre, and depth.
    off: DVec2,
    depth: f64,
}

#[derive(Debug, Clone, Copy)]
enum End {
    Turn(curved_rays::EdgeEnd),
    Spline(spline::EdgeEnd),
}

impl View {
    /// Error bounds for edges drawn by a record; `None` if there is no such record, or if other stages bend edges too.
    pub fn edges(&self, record: usize) -> Option<Edges<'_>> {
        let pinhole = self.pinhole();
        let scale_px = pinhole.scale_px();
        let bend = match self.stages() {
            [Stage::CurvedRays(rays)] => {
                let turn = rays.turns().get(record)?;
                let across = DVec2::new(turn.shift.dot(pinhole.right), turn.shift.dot(pinhole.down)) * scale_px;
                Bend::Turn { turn, across, along: turn.shift.dot(pinhole.forward) }
            }
            [Stage::SplineBend(spline)] if record == 0 => Bend::Spline { earth: None, spline },
            [Stage::EarthCurvature(earth), Stage::SplineBend(spline)] if record == 0 => {
                Bend::Spline { earth: Some(earth), spline }
            }
            _ => return None,
        };
        Some(Edges { view: self, pinhole, scale_px, bend })
    }
}

impl Edges<'_> {
    /// End of an edge at `p`; `None` if it has no image.
    pub fn point(&self, p: DVec3) -> Option<EdgePoint> {
        let (end, v) = match &self.bend {
            Bend::Turn { turn, .. } => {
                let end = turn.edge_end(p)?;
                (End::Turn(end), turn.displaced_end(&end))
            }
            Bend::Spline { earth, spline } => {
                let end = spline.edge_end(earth.map_or(Ok(p), |earth| earth.apply(p)).ok()?);
                (End::Spline(end), spline.image_of(&end) - self.pinhole.eye)
            }
        };
        let depth = v.dot(self.pinhole.forward);
        let lateral = DVec2::new(v.dot(self.pinhole.right), v.dot(self.pinhole.down)) * self.scale_px;
        let off = if self.pinhole.is_orthographic() { lateral } else { lateral / depth };
        (depth > 0.0 && off.is_finite()).then_some(EdgePoint { p, end, off, depth })
    }

    /// [`EdgeError::px`] of an edge, as by [`View::edge_error_in`].
    pub fn error_px(&self, p0: &EdgePoint, p1: &EdgePoint) -> f64 {
        let (offs, depth) = ([p0.off, p1.off], p0.depth.min(p1.depth));
        match (&self.bend, &p0.end, &p1.end) {
            (Bend::Turn { turn, across, along }, End::Turn(a), End::Turn(b)) => {
                let Some(delta) = turn.edge_delta(a, b) else { return f64::INFINITY };
                self.moved_px(delta * *across, delta * along, &offs, depth)
            }
            (Bend::Spline { earth, spline }, End::Spline(a), End::Spline(b)) => {
                let fallen = earth.map_or(0.0, |earth| earth.edge_bound(p0.p, p1.p));
                let carried = if fallen > 0.0 { fallen * spline.stretch_between(a, b) } else { 0.0 };
                self.blurred_px(carried + spline.bound_between(a, b), &offs, depth)
            }
            _ => f64::INFINITY,
        }
    }

    /// Bound on [`Edges::error_px`] of every edge inside a box; infinite where unknown.
    pub fn box_error_px(&self, bounds: &Aabb) -> f64 {
        let seen = || {
            let image = self.view.image_box(bounds)?;
            let [min, max] = [image.min, image.max].map(|px| px - self.pinhole.center_px());
            Some(([min, DVec2::new(min.x, max.y), DVec2::new(max.x, min.y), max], image.depth_min))
        };
        match &self.bend {
            Bend::Turn { turn, across, along } => match turn.box_delta(bounds) {
                Some(0.0) => 0.0,
                Some(delta) if self.view.records() == 1 => seen()
                    .map_or(f64::INFINITY, |(offs, depth)| self.moved_px(delta * *across, delta * along, &offs, depth)),
                _ => f64::INFINITY,
            },
            Bend::Spline { earth: None, spline } => match spline.box_bound(bounds) {
                0.0 => 0.0,
                error => seen().map_or(f64::INFINITY, |(offs, depth)| self.blurred_px(error, &offs, depth)),
            },
            Bend::Spline { .. } => f64::INFINITY,
        }
    }

    /// [`EdgeError::px`] of a move by `across` (pixels at depth 1) and `along` the axis, of images in the hull of `offs` (pixels from the
    /// centre), `depth` or farther.
    fn moved_px(&self, across: DVec2, along: f64, offs: &[DVec2], depth: f64) -> f64 {
        if self.pinhole.is_orthographic() {
            return across.length();
        }
        let px = offs.iter().map(|off| (across - along * *off).length_squared()).fold(0.0, f64::max).sqrt();
        seen_from(px.max(along.abs() * self.scale_px), depth - along.abs())
    }

    /// The same for a move by at most `error` scene units to any side.
    fn blurred_px(&self, error: f64, offs: &[DVec2], depth: f64) -> f64 {
        if self.pinhole.is_orthographic() {
            return error * self.scale_px;
        }
        let off = offs.iter().map(|off| off.length_squared()).fold(0.0, f64::max);
        seen_from(error * (self.scale_px * self.scale_px + off).sqrt(), depth - error)
    }
}

/// `px` at depth 1 as seen at `depth`; infinite behind the eye, unless nothing moves.
pub(super) fn seen_from(px: f64, depth: f64) -> f64 {
    if px == 0.0 {
        0.0
    } else if depth > 0.0 {
        px / depth
    } else {
        f64::INFINITY
    }
}
