//! Skeleton.

use super::{Miss, SpaceMap};
use crate::Aabb;
use glam::{DMat3, DVec3};

/// Skeleton of the stage.
#[derive(Debug, Clone, PartialEq)]
pub struct CurvedRays {}

impl CurvedRays {
    /// See [`crate::Stage::edge_bound`].
    pub fn edge_bound(&self, _p0: DVec3, _p1: DVec3) -> f64 {
        0.0
    }

    /// See [`crate::Stage::displaced_bounds`].
    pub fn displaced_bounds(&self, bounds: &Aabb) -> Option<Aabb> {
        Some(*bounds)
    }

    /// Number of turns.
    pub fn turn_count(&self) -> usize {
        0
    }

    /// Displaced point and segment: the first cell in ray order inside the image, the sequential plane test outside it.
    pub fn displace(&self, p: DVec3) -> Result<super::Displaced, Miss> {
        Ok(super::Displaced { point: self.apply(p)?, segment: 0, folded: false })
    }

    /// Segment of the ray that passes through a displaced point.
    pub fn segment_at(&self, _p_displaced: DVec3) -> u32 {
        0
    }

    /// All images of `p`, in ray order: a point in two overlapping cells is truly visible twice.
    pub fn displace_all(&self, p: DVec3) -> Vec<super::Displaced> {
        self.displace(p).into_iter().collect()
    }

    /// Displacement by the record of turn `record` (0-based) alone, whatever the cell: for drawing once per record.
    pub fn displace_in(&self, _record: usize, p: DVec3) -> Result<super::Displaced, Miss> {
        self.displace(p)
    }

    /// Signed distances of `p` to the two planes that cut record `record` from its neighbours;
    /// drawing keeps what is positive for both (infinite at the ends of the chain).
    pub fn record_margins(&self, _record: usize, _p: DVec3) -> [f64; 2] {
        [f64::INFINITY; 2]
    }
}

impl SpaceMap for CurvedRays {
    fn apply(&self, p: DVec3) -> Result<DVec3, Miss> {
        Ok(p)
    }

    fn invert(&self, p_displaced: DVec3) -> Result<DVec3, Miss> {
        Ok(p_displaced)
    }

    fn jacobian(&self, _p: DVec3) -> Result<DMat3, Miss> {
        Ok(DMat3::IDENTITY)
    }
}
