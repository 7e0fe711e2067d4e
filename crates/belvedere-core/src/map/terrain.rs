//! Skeleton.

use super::{Miss, SpaceMap};
use crate::Aabb;
use glam::{DMat3, DVec3};

/// Skeleton of the stage.
#[derive(Debug, Clone, PartialEq)]
pub struct TerrainDisocclusion {}

impl TerrainDisocclusion {
    /// See [`crate::Stage::edge_bound`].
    pub fn edge_bound(&self, _p0: DVec3, _p1: DVec3) -> f64 {
        0.0
    }

    /// See [`crate::Stage::displaced_bounds`].
    pub fn displaced_bounds(&self, bounds: &Aabb) -> Option<Aabb> {
        Some(*bounds)
    }
}

impl SpaceMap for TerrainDisocclusion {
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
