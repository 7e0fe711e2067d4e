//! Curved rays that part at a seam of the picture, each side with its own turns, and may merge again.
//!
//! Before the fork all rays share their turns. A fork gives each side of a straight seam turns of its own: the picture is one and
//! smooth within each side, and along the seam as far as the rays run together. After the graph camera (Popescu et al. 2009,
//! "The Graph Camera"), with the transitions of Cui et al. 2010.

mod merge;
mod region;
mod spec;

pub use region::{ImageRegion, Seam};
pub use spec::{Fork, Merge, SplitRaysError, SplitSpec};

use super::curved_rays::{CurvedRays, Model, Sharpness, Turn, TurnSpec};
use super::{Displaced, Miss, SpaceMap};
use crate::{Aabb, Pinhole};
use glam::{DMat3, DVec3};
use region::Side;

/// Rays that part, as the last stage of a view.
///
/// A point that no branch shows in its own part of the image has no image; one that several show has several.
#[derive(Debug, Clone, PartialEq)]
pub struct SplitRays {
    root: Pinhole,
    spec: SplitSpec,
    branches: Vec<Branch>,
}

/// One path through all forks.
#[derive(Debug, Clone, PartialEq)]
pub struct Branch {
    /// The part of the image that it draws.
    pub region: ImageRegion,
    /// Curved rays with all turns of the path, from the eye on.
    pub rays: CurvedRays,
}

const SIDES: [(Side, &str); 2] = [(Side::Left, "left"), (Side::Right, "right")];

impl SplitRays {
    /// The camera whose rays start in `root` and bend and part as `spec` says.
    ///
    /// # Errors
    /// Every [`SplitRaysError`].
    pub fn new(root: &Pinhole, model: Model, spec: &SplitSpec) -> Result<Self, SplitRaysError> {
        let mut out = Self { root: root.clone(), spec: SplitSpec::default(), branches: Vec::new() };
        out.spec = out.grow(model, spec, (&[], ""), &ImageRegion::whole(root.image))?;
        Ok(out)
    }

    /// Adds the branches of a node and returns its specification with every merge replaced by turns.
    ///
    /// * `before`: turns before the node, and its path, like `left, right`.
    fn grow(
        &mut self,
        model: Model,
        node: &SplitSpec,
        (before, way): (&[TurnSpec], &str),
        region: &ImageRegion,
    ) -> Result<SplitSpec, SplitRaysError> {
        let turns: Vec<TurnSpec> = before.iter().chain(&node.turns).copied().collect();
        let Some(fork) = &node.fork else {
            let rays = CurvedRays::within(&self.root, model, &turns, region.corners())
                .map_err(|error| SplitRaysError::Turn { side: way.into(), error })?;
            self.branches.push(Branch { region: region.clone(), rays });
            return Ok(node.clone());
        };
        let turns = self.pinned(model, &turns, way, region)?;
        let fork = match &fork.merge {
            Some(merge) => merge::resolve(&self.root, model, &turns, fork, merge, region)?,
            None => (**fork).clone(),
        };
        let Seam { from, to } = fork.seam;
        let edge = fork.seam.edge(self.root.image).ok_or(SplitRaysError::SeamPoints { from, to })?;
        let mut sides = fork.sides.clone();
        for ((side, name), spec) in SIDES.into_iter().zip(&mut sides) {
            let part = region.cut(edge, side).ok_or(SplitRaysError::SeamBeside { side: name })?;
            let way = if way.is_empty() { name.to_owned() } else { format!("{way}, {name}") };
            *spec = self.grow(model, spec, (&turns, &way), &part)?;
        }
        let own = turns[before.len()..].to_vec();
        Ok(SplitSpec { turns: own, fork: Some(Box::new(Fork { sides, ..fork })) })
    }

    /// Turns before a fork; a sharpness that follows from the corners becomes a number, so that both sides bend alike up to the fork.
    fn pinned(
        &self,
        model: Model,
        turns: &[TurnSpec],
        way: &str,
        region: &ImageRegion,
    ) -> Result<Vec<TurnSpec>, SplitRaysError> {
        let rays = CurvedRays::within(&self.root, model, turns, region.corners())
            .map_err(|error| SplitRaysError::Turn { side: way.into(), error })?;
        let pinned = |(spec, turn): (&TurnSpec, &Turn)| match (spec.m, turn.m) {
            (Sharpness::Left | Sharpness::Mid, Some(m)) if model == Model::Modified => {
                TurnSpec { m: Sharpness::Value(m), ..*spec }
            }
            _ => *spec,
        };
        Ok(turns.iter().zip(rays.turns()).map(pinned).collect())
    }

    /// These rays at a share of their strength. `None` if such turns are not valid.
    pub(crate) fn eased(&self, share: f64) -> Option<Self> {
        Self::new(self.root(), self.model(), &self.spec.eased(self.root().eye, share)).ok()
    }

    /// The pinhole that the rays start in.
    pub fn root(&self) -> &Pinhole {
        &self.root
    }

    /// Shape of the rays in the transitions.
    pub fn model(&self) -> Model {
        self.branches[0].rays.model()
    }

    /// The forks with every rule replaced by its value: seams where they are, merges as turns.
    pub fn spec(&self) -> &SplitSpec {
        &self.spec
    }

    /// The branches, left before right.
    pub fn branches(&self) -> &[Branch] {
        &self.branches
    }

    /// The branch whose part of the image holds the image of a displaced point; the first one behind the eye.
    pub fn branch_of(&self, p_displaced: DVec3) -> &Branch {
        let pixel = self.root.project(p_displaced).ok().map(|(pixel, _)| pixel);
        let here = pixel.and_then(|pixel| self.branches.iter().find(|b| b.region.contains(pixel)));
        here.unwrap_or(&self.branches[0])
    }

    /// All images of `p` with the index of their branch; if none lies inside the picture, those outside it.
    pub fn displace_all(&self, p: DVec3) -> Vec<(usize, Displaced)> {
        let images = |of: &dyn Fn(&CurvedRays) -> Vec<Displaced>| {
            let mut all = Vec::new();
            for (i, branch) in self.branches.iter().enumerate() {
                let shown = |d: &Displaced| std::ptr::eq(self.branch_of(d.point), branch);
                all.extend(of(&branch.rays).into_iter().filter(shown).map(|d| (i, d)));
            }
            all
        };
        let inside = images(&|rays| rays.displace_into_image(p));
        if inside.is_empty() { images(&|rays| rays.displace_all(p)) } else { inside }
    }

    /// Displaced point and segment, of the first branch that shows the point.
    ///
    /// # Errors
    /// [`Miss::OutsideDomain`] if none does.
    pub fn displace(&self, p: DVec3) -> Result<Displaced, Miss> {
        self.displace_all(p).first().map(|(_, d)| *d).ok_or(Miss::OutsideDomain)
    }

    /// The point that is displaced onto `p_displaced`, and its segment.
    ///
    /// # Errors
    /// Those of [`CurvedRays::undisplace`].
    pub fn undisplace(&self, p_displaced: DVec3) -> Result<(DVec3, u32), Miss> {
        self.branch_of(p_displaced).rays.undisplace(p_displaced)
    }

    /// Bound on the distance of an edge's image from the straight one, scene units; infinite across seams.
    pub fn edge_bound(&self, p0: DVec3, p1: DVec3) -> f64 {
        self.branch_of_edge(p0, p1).map_or(f64::INFINITY, |branch| branch.rays.edge_bound(p0, p1))
    }

    /// The branch that is the first to show both ends of an edge; `None` if these differ.
    pub(crate) fn branch_of_edge(&self, p0: DVec3, p1: DVec3) -> Option<&Branch> {
        let [a, b] = [p0, p1].map(|p| self.displace_all(p).first().map(|(i, _)| *i));
        a.filter(|_| a == b).map(|i| &self.branches[i])
    }

    /// A box around the images of every point of `bounds` by every branch, whether it shows them or not.
    pub fn displaced_bounds(&self, bounds: &Aabb) -> Option<Aabb> {
        self.branches.iter().try_fold(Aabb::EMPTY, |all, b| Some(all.union(b.rays.displaced_bounds(bounds)?)))
    }
}

impl SpaceMap for SplitRays {
    fn apply(&self, p: DVec3) -> Result<DVec3, Miss> {
        self.displace(p).map(|d| d.point)
    }

    fn invert(&self, p_displaced: DVec3) -> Result<DVec3, Miss> {
        self.undisplace(p_displaced).map(|(p, _)| p)
    }

    fn jacobian(&self, p: DVec3) -> Result<DMat3, Miss> {
        let (branch, _) = self.displace_all(p).first().copied().ok_or(Miss::OutsideDomain)?;
        self.branches[branch].rays.jacobian(p)
    }
}
