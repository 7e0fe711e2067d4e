//! Errors of edges that are drawn straight, for renderers that evaluate every vertex once.

use super::View;
use crate::map::curved_rays::{EdgeEnd, Turn};
use crate::{Aabb, DVec2, DVec3, Pinhole};

/// Bounds on the error of edges drawn by one record of a view whose only bend is curved rays.
#[derive(Debug)]
pub struct Edges<'a> {
    view: &'a View,
    turn: &'a Turn,
    pinhole: &'a Pinhole,
    scale_px: f64,
    /// The turn's shift across the image, pixels at depth 1, and along the axis.
    shift: (DVec2, f64),
}

/// End of an edge with its phi, image and depth.
#[derive(Debug, Clone, Copy)]
pub struct EdgePoint {
    end: EdgeEnd,
    /// Image, pixels from the centre, and depth.
    off: DVec2,
    depth: f64,
}

impl View {
    /// Error bounds for edges drawn by a record; `None` if there is no such turn, or if other stages bend edges too.
    pub fn edges(&self, record: usize) -> Option<Edges<'_>> {
        let [crate::Stage::CurvedRays(rays)] = self.stages() else { return None };
        let (turn, pinhole) = (rays.turns().get(record)?, self.pinhole());
        let scale_px = pinhole.scale_px();
        let across = DVec2::new(turn.shift.dot(pinhole.right), turn.shift.dot(pinhole.down)) * scale_px;
        Some(Edges { view: self, turn, pinhole, scale_px, shift: (across, turn.shift.dot(pinhole.forward)) })
    }
}

impl Edges<'_> {
    /// End of an edge at `p`; `None` if it has no image.
    pub fn point(&self, p: DVec3) -> Option<EdgePoint> {
        let end = self.turn.edge_end(p)?;
        let v = self.turn.displaced_end(&end);
        let depth = v.dot(self.pinhole.forward);
        let lateral = DVec2::new(v.dot(self.pinhole.right), v.dot(self.pinhole.down)) * self.scale_px;
        let off = if self.pinhole.is_orthographic() { lateral } else { lateral / depth };
        (depth > 0.0 && off.is_finite()).then_some(EdgePoint { end, off, depth })
    }

    /// [`View::edge_error_px_in`] of an edge.
    pub fn error_px(&self, p0: &EdgePoint, p1: &EdgePoint) -> f64 {
        let Some(delta) = self.turn.edge_delta(&p0.end, &p1.end) else { return f64::INFINITY };
        self.moved_px(delta, &[p0.off, p1.off], p0.depth.min(p1.depth))
    }

    /// Bound on [`Edges::error_px`] of every edge inside a box; infinite where unknown.
    pub fn box_error_px(&self, bounds: &Aabb) -> f64 {
        match self.turn.box_delta(bounds) {
            Some(0.0) => 0.0,
            Some(delta) if self.view.records() == 1 => {
                let Some(image) = self.view.image_box(bounds) else { return f64::INFINITY };
                let [min, max] = [image.min, image.max].map(|px| px - self.pinhole.center_px());
                let offs = [min, DVec2::new(min.x, max.y), DVec2::new(max.x, min.y), max];
                self.moved_px(delta, &offs, image.depth_min)
            }
            _ => f64::INFINITY,
        }
    }

    /// Bound in pixels on the move by `delta` times the shift, of images in the hull of `offs` (pixels from the centre), `depth` or farther.
    fn moved_px(&self, delta: f64, offs: &[DVec2], depth: f64) -> f64 {
        let (across, along) = (delta * self.shift.0, delta * self.shift.1);
        if self.pinhole.is_orthographic() {
            return across.length();
        }
        let px = offs.iter().map(|off| (across - along * *off).length_squared()).fold(0.0, f64::max).sqrt();
        let depth = depth - along.abs();
        if px == 0.0 {
            0.0
        } else if depth > 0.0 {
            px / depth
        } else {
            f64::INFINITY
        }
    }
}
