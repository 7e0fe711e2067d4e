//! What drawing, picking and measuring ask of a stage, and what each stage answers.

use super::curved_rays::CurvedRays;
use super::earth::EarthCurvature;
use super::relief::Relief;
use super::rigid::RigidMotion;
use super::spline::SplineBend;
use super::split_rays::SplitRays;
use super::strip::Strip;
use super::terrain::TerrainDisocclusion;
use super::{Displaced, Miss, SpaceMap, Stage};
use crate::Aabb;
use glam::{DMat3, DVec3};
use std::fmt::Debug;

/// A map as a stage of a view. All that is answered by default is right for any map that is smooth at the scale of what is drawn, and slower
/// or less thrifty than what a map knows of itself.
pub trait StageMap: SpaceMap + Debug + Send + Sync {
    /// Name of the stage, as scene files write it where they have it.
    fn name(&self) -> &'static str {
        "own"
    }

    /// `apply` with the segment and the fold flag.
    ///
    /// # Errors
    /// Those of [`SpaceMap::apply`].
    fn displace(&self, p: DVec3) -> Result<Displaced, Miss> {
        Ok(Displaced { point: self.apply(p)?, segment: 0, folded: false })
    }

    /// `invert` with the segment of the ray.
    ///
    /// # Errors
    /// Those of [`SpaceMap::invert`].
    fn undisplace(&self, p_displaced: DVec3) -> Result<(DVec3, u32), Miss> {
        Ok((self.invert(p_displaced)?, 0))
    }

    /// This stage at a share of its strength, 0 < share <= 1; towards 0 it becomes the identity. What belongs to the world stays whole.
    ///
    /// `None` where there is no such stage, as with turns that only hold in full. By default `None`.
    fn eased(&self, _share: f64) -> Option<Stage> {
        None
    }

    /// Bound on the distance, in scene units, between the image of the straight edge `p0 p1` and the straight edge between the images of its
    /// ends (the error a renderer makes by not subdividing it). Infinite where no bound is known.
    ///
    /// By default an estimate: half as much again as the largest distance at the quarters, which is a bound for parabolas and cubics.
    fn edge_bound(&self, p0: DVec3, p1: DVec3) -> f64 {
        let (Ok(a), Ok(b)) = (self.apply(p0), self.apply(p1)) else { return f64::INFINITY };
        let off = |t: f64| self.apply(p0.lerp(p1, t)).map_or(f64::INFINITY, |p| p.distance(a.lerp(b, t)));
        1.5 * [0.25, 0.5, 0.75].into_iter().map(off).fold(0.0, f64::max)
    }

    /// Images of both ends of an edge and [`StageMap::edge_bound`]; `None` if an end has no image.
    fn edge(&self, p0: DVec3, p1: DVec3) -> Option<(DVec3, DVec3, f64)> {
        Some((self.apply(p0).ok()?, self.apply(p1).ok()?, self.edge_bound(p0, p1)))
    }

    /// A box that contains the displaced image of every point of `bounds`; `None` if part of it has no image or no bound is known, as by
    /// default: then nothing is culled.
    fn displaced_bounds(&self, _bounds: &Aabb) -> Option<Aabb> {
        None
    }

    /// Whether no point of `bounds` has an image; `false` also where that is not known, as by default.
    fn misses(&self, _bounds: &Aabb) -> bool {
        false
    }

    /// Whether points without image may lie between points that have one, so that edges are looked at between their ends. By default
    /// `true`.
    fn has_border(&self) -> bool {
        true
    }

    /// Whether the stage belongs to the world: it stays in the straight picture, and is no bend. By default `false`.
    fn is_of_world(&self) -> bool {
        false
    }

    /// Whether the stage moves the ground, whose light follows. By default `false`: what bends the picture leaves the light as on the map.
    fn moves_ground(&self) -> bool {
        false
    }

    /// Whether points of a vertical line all move along it, by the same height. By default `false`.
    fn is_upright(&self) -> bool {
        false
    }

    /// Whether heights may point anywhere after the stage, or change their length. By default `true`.
    fn turns_heights(&self) -> bool {
        true
    }

    /// How a rigid body turns that the stage carries as a whole, with its foot at `foot`. By default the rotation nearest to the derivative.
    ///
    /// # Errors
    /// Those of [`SpaceMap::jacobian`].
    fn rotation_of_body(&self, foot: DVec3) -> Result<DMat3, Miss> {
        nearest_rotation(self.jacobian(foot)?).ok_or(Miss::OutsideDomain)
    }
}

/// The rotation nearest to a matrix of positive determinant: Higham's iteration, the mean of a matrix and its inverse transposed, again and
/// again. `None` where the determinant is not positive.
///
/// Source: Higham, Computing the polar decomposition, 1986.
fn nearest_rotation(m: DMat3) -> Option<DMat3> {
    let mut q = m;
    for _ in 0..64 {
        if !(q.determinant() > 0.0) {
            return None;
        }
        let next = 0.5 * (q + q.inverse().transpose());
        let change = (next - q).to_cols_array().into_iter().fold(0.0f64, |most, v| most.max(v.abs()));
        q = next;
        if change < 1e-14 {
            break;
        }
    }
    q.is_finite().then_some(q)
}

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

impl StageMap for Strip {
    fn name(&self) -> &'static str {
        "strip"
    }
    fn eased(&self, share: f64) -> Option<Stage> {
        self.eased(share).map(Stage::Strip)
    }
    fn edge_bound(&self, p0: DVec3, p1: DVec3) -> f64 {
        self.edge_bound(p0, p1)
    }
    // Both the ends and their bound need the same feet.
    fn edge(&self, p0: DVec3, p1: DVec3) -> Option<(DVec3, DVec3, f64)> {
        self.edge(p0, p1)
    }
    fn displaced_bounds(&self, bounds: &Aabb) -> Option<Aabb> {
        self.displaced_bounds(bounds)
    }
    fn misses(&self, bounds: &Aabb) -> bool {
        self.misses(bounds)
    }
    fn turns_heights(&self) -> bool {
        false
    }
    // The derivative stretches along one horizontal direction.
    fn rotation_of_body(&self, foot: DVec3) -> Result<DMat3, Miss> {
        let [x, y] = self.jacobian(foot).map(|j| [j.x_axis, j.y_axis])?;
        Ok(DMat3::from_rotation_z((x.y - y.x).atan2(x.x + y.y)))
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
