//! Implementations of [`StageMap`] for the built-in stages.

use super::curved_rays::CurvedRays;
use super::earth::EarthCurvature;
use super::ground_moves::GroundMoves;
use super::relief::Relief;
use super::rigid::RigidMotion;
use super::spline::SplineBend;
use super::split_rays::SplitRays;
use super::stage::bow;
use super::straighten::{Dimension, Shape, Straightened, Strip, Tube};
use super::terrain::TerrainDisocclusion;
use super::unroll::{Seam, Unroll};
use super::{Displaced, Miss, SpaceMap, Stage, StageMap};
use crate::Aabb;
use glam::{DMat3, DVec3};

impl StageMap for EarthCurvature {
    fn name(&self) -> &'static str {
        "earth"
    }
    fn eased(&self, _: f64) -> Option<Stage> {
        Some(Stage::EarthCurvature(*self))
    }
    fn edge_bound(&self, p0: DVec3, p1: DVec3) -> f64 {
        self.edge_bound(p0, p1)
    }
    fn displaced_bounds(&self, bounds: &Aabb) -> Option<Aabb> {
        self.displaced_bounds(bounds)
    }
    fn has_border(&self) -> bool {
        false
    }
    fn is_of_world(&self) -> bool {
        true
    }
    fn is_upright(&self) -> bool {
        true
    }
    fn turns_heights(&self) -> bool {
        false
    }
    fn rotation_of_body(&self, _: DVec3) -> Result<DMat3, Miss> {
        Ok(DMat3::IDENTITY)
    }
}

impl StageMap for TerrainDisocclusion {
    fn name(&self) -> &'static str {
        "terrain_disocclusion"
    }
    fn eased(&self, share: f64) -> Option<Stage> {
        self.eased(share).map(Stage::TerrainDisocclusion)
    }
    fn edge_bound(&self, p0: DVec3, p1: DVec3) -> f64 {
        self.edge_bound(p0, p1)
    }
    fn displaced_bounds(&self, bounds: &Aabb) -> Option<Aabb> {
        self.displaced_bounds(bounds)
    }
    fn has_border(&self) -> bool {
        false
    }
    fn moves_ground(&self) -> bool {
        true
    }
    fn is_upright(&self) -> bool {
        true
    }
    fn turns_heights(&self) -> bool {
        false
    }
    fn rotation_of_body(&self, _: DVec3) -> Result<DMat3, Miss> {
        Ok(DMat3::IDENTITY)
    }
}

impl StageMap for GroundMoves {
    fn name(&self) -> &'static str {
        "ground_moves"
    }
    fn eased(&self, share: f64) -> Option<Stage> {
        self.eased(share).map(Stage::GroundMoves)
    }
    fn edge_bound(&self, p0: DVec3, p1: DVec3) -> f64 {
        self.edge_bound(p0, p1)
    }
    fn displaced_bounds(&self, bounds: &Aabb) -> Option<Aabb> {
        self.displaced_bounds(bounds)
    }
    fn has_border(&self) -> bool {
        false
    }
    fn moves_ground(&self) -> bool {
        true
    }
    fn turns_heights(&self) -> bool {
        false
    }
    fn rotation_of_body(&self, foot: DVec3) -> Result<DMat3, Miss> {
        Ok(DMat3::from_rotation_z(self.turn_at(foot.truncate())))
    }
}

impl From<Strip> for Stage {
    fn from(map: Strip) -> Self {
        Self::Strip(map)
    }
}

impl From<Tube> for Stage {
    fn from(map: Tube) -> Self {
        Self::Tube(map)
    }
}

impl<D: Dimension> StageMap for Straightened<D>
where
    Stage: From<Self>,
{
    fn name(&self) -> &'static str {
        D::SHAPE.name()
    }
    fn eased(&self, share: f64) -> Option<Stage> {
        self.eased(share).map(Stage::from)
    }
    // Without bounds over edges an estimate, as by default.
    fn edge_bound(&self, p0: DVec3, p1: DVec3) -> f64 {
        if self.is_whole() { self.edge_bound(p0, p1) } else { bow(self, p0, p1) }
    }
    // One search for the feet serves both ends and their bound.
    fn edge(&self, p0: DVec3, p1: DVec3) -> Option<(DVec3, DVec3, f64)> {
        if self.is_whole() {
            return self.edge(p0, p1);
        }
        Some((self.apply(p0).ok()?, self.apply(p1).ok()?, bow(self, p0, p1)))
    }
    fn displaced_bounds(&self, bounds: &Aabb) -> Option<Aabb> {
        self.displaced_bounds(bounds)
    }
    fn misses(&self, bounds: &Aabb) -> bool {
        self.misses(bounds)
    }
    fn may_hold(&self, way: [DVec3; 3]) -> Option<bool> {
        Some(self.may_hold(way))
    }
    fn points_within(&self, bounds: &Aabb) -> Vec<DVec3> {
        self.points_within(bounds)
    }
    fn turns_heights(&self) -> bool {
        D::SHAPE == Shape::Tube
    }
    // The derivative stretches along the line and turns.
    fn rotation_of_body(&self, foot: DVec3) -> Result<DMat3, Miss> {
        self.rotation_at(foot)
    }
}

impl StageMap for Unroll {
    fn name(&self) -> &'static str {
        "unroll"
    }
    fn edge_bound(&self, p0: DVec3, p1: DVec3) -> f64 {
        self.edge_bound(p0, p1)
    }
    fn displaced_bounds(&self, bounds: &Aabb) -> Option<Aabb> {
        self.displaced_bounds(bounds)
    }
    fn misses(&self, bounds: &Aabb) -> bool {
        self.misses(bounds)
    }
    fn seam(&self) -> Option<Seam> {
        Some(self.seam())
    }
    fn turns_heights(&self) -> bool {
        self.is_sphere()
    }
}

impl StageMap for Relief {
    fn name(&self) -> &'static str {
        "relief"
    }
    fn eased(&self, share: f64) -> Option<Stage> {
        Some(Stage::Relief(self.eased(share)))
    }
    fn edge_bound(&self, p0: DVec3, p1: DVec3) -> f64 {
        self.edge_bound(p0, p1)
    }
    fn displaced_bounds(&self, bounds: &Aabb) -> Option<Aabb> {
        self.displaced_bounds(bounds)
    }
    fn has_border(&self) -> bool {
        false
    }
    // It moves bodies without turning them.
    fn rotation_of_body(&self, _: DVec3) -> Result<DMat3, Miss> {
        Ok(DMat3::IDENTITY)
    }
}

impl StageMap for SplineBend {
    fn name(&self) -> &'static str {
        "spline_bend"
    }
    fn displace(&self, p: DVec3) -> Result<Displaced, Miss> {
        Ok(Displaced { point: self.apply(p)?, segment: 0, folded: self.is_folded(p) })
    }
    fn eased(&self, share: f64) -> Option<Stage> {
        self.eased(share).map(Stage::SplineBend)
    }
    fn edge_bound(&self, p0: DVec3, p1: DVec3) -> f64 {
        self.edge_bound(p0, p1)
    }
    fn edge(&self, p0: DVec3, p1: DVec3) -> Option<(DVec3, DVec3, f64)> {
        self.edge(p0, p1)
    }
    fn displaced_bounds(&self, bounds: &Aabb) -> Option<Aabb> {
        self.displaced_bounds(bounds)
    }
    fn has_border(&self) -> bool {
        false
    }
    fn rotation_of_body(&self, foot: DVec3) -> Result<DMat3, Miss> {
        Ok(self.rotation_at(foot))
    }
}

impl StageMap for RigidMotion {
    fn name(&self) -> &'static str {
        "body"
    }
    fn edge_bound(&self, _: DVec3, _: DVec3) -> f64 {
        0.0
    }
    fn displaced_bounds(&self, bounds: &Aabb) -> Option<Aabb> {
        Some(Aabb::of(bounds.corners().map(|p| self.carry(p))))
    }
    fn has_border(&self) -> bool {
        false
    }
    fn turns_heights(&self) -> bool {
        false
    }
    fn rotation_of_body(&self, _: DVec3) -> Result<DMat3, Miss> {
        Ok(self.rotation())
    }
}

impl StageMap for CurvedRays {
    fn name(&self) -> &'static str {
        "curved_rays"
    }
    fn displace(&self, p: DVec3) -> Result<Displaced, Miss> {
        self.displace(p)
    }
    fn undisplace(&self, p_displaced: DVec3) -> Result<(DVec3, u32), Miss> {
        self.undisplace(p_displaced)
    }
    fn eased(&self, share: f64) -> Option<Stage> {
        self.eased(share).map(Stage::CurvedRays)
    }
    fn edge_bound(&self, p0: DVec3, p1: DVec3) -> f64 {
        self.edge_bound(p0, p1)
    }
    fn displaced_bounds(&self, bounds: &Aabb) -> Option<Aabb> {
        self.displaced_bounds(bounds)
    }
    fn has_border(&self) -> bool {
        false
    }
    fn turns_heights(&self) -> bool {
        false
    }
}

impl StageMap for SplitRays {
    fn name(&self) -> &'static str {
        "curved_rays"
    }
    fn displace(&self, p: DVec3) -> Result<Displaced, Miss> {
        self.displace(p)
    }
    fn undisplace(&self, p_displaced: DVec3) -> Result<(DVec3, u32), Miss> {
        self.undisplace(p_displaced)
    }
    fn eased(&self, share: f64) -> Option<Stage> {
        self.eased(share).map(Stage::SplitRays)
    }
    fn edge_bound(&self, p0: DVec3, p1: DVec3) -> f64 {
        self.edge_bound(p0, p1)
    }
    fn displaced_bounds(&self, bounds: &Aabb) -> Option<Aabb> {
        self.displaced_bounds(bounds)
    }
    fn has_border(&self) -> bool {
        false
    }
    fn turns_heights(&self) -> bool {
        false
    }
}
