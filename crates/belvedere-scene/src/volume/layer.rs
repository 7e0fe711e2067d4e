//! A volume and how it is drawn.

use super::{BRICK, TransferFunction, Volume};
use belvedere_core::{Aabb, DVec2, DVec3};
use rayon::prelude::*;
use serde::{Deserialize, Serialize};
use std::sync::Arc;

/// Default distance between samples along a ray, voxel edges.
const DEFAULT_STEP: f64 = 0.5;

/// How samples of a volume are coloured.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "snake_case")]
pub enum VolumeModel {
    /// By the transfer function, shaded by the gradient of the values in light that comes from the eye along the ray.
    #[default]
    Shaded,
    /// By the transfer function alone.
    Plain,
}

/// A volume layer.
#[derive(Debug, Clone)]
pub struct VolumeLayer {
    /// The voxels. Shared, so that copies of a scene do not copy them.
    pub volume: Arc<Volume>,
    /// Colours and opacities.
    pub transfer: TransferFunction,
    /// Distance between samples along a ray, voxel edges, > 0.
    pub step: f64,
    /// Shading.
    pub model: VolumeModel,
}

impl VolumeLayer {
    /// A volume in the usual style: shaded, two samples to a voxel.
    pub fn new(volume: impl Into<Arc<Volume>>, transfer: TransferFunction) -> Self {
        Self { volume: volume.into(), transfer, step: DEFAULT_STEP, model: VolumeModel::default() }
    }

    /// Distance between samples, scene units.
    pub fn step_length(&self) -> f64 {
        self.step * self.volume.voxel_edge()
    }

    /// Distance that opacities are stated for, scene units.
    pub fn reference_length(&self) -> f64 {
        self.transfer.reference_step() * self.volume.voxel_edge()
    }

    /// Positions of voxels that represent the visible part, scene units: the most opaque voxel of each visible brick, of an even selection
    /// of these bricks. Empty if nothing is visible.
    ///
    /// * `most`: largest number of positions, > 0.
    pub fn visible_voxels(&self, most: usize) -> Vec<DVec3> {
        let dims = self.volume.dims();
        let visible = self.visible_bricks();
        let every = visible.len().div_ceil(most.max(1)).max(1);
        let voxel = |brick: &[usize; 3]| {
            let span = |a: usize| brick[a] * BRICK..(brick[a] * BRICK + BRICK + 1).min(dims[a]);
            let mut best = (0.0, [0; 3]);
            for z in span(2) {
                for y in span(1) {
                    for x in span(0) {
                        let value = self.volume.values().at((z * dims[1] + y) * dims[0] + x);
                        let opacity = self.transfer.opacity(f64::from(value));
                        if opacity > best.0 {
                            best = (opacity, [x, y, z]);
                        }
                    }
                }
            }
            let (opacity, at) = best;
            (opacity > 0.0).then(|| self.volume.scene_from_lattice(DVec3::from_array(at.map(|n| n as f64))))
        };
        visible.iter().step_by(every).filter_map(voxel).collect()
    }

    /// Positions of visible voxels, scene units, whose convex hull holds every voxel of an opacity above 0; empty if there is none.
    ///
    /// Of each row of a slice the first and the last visible voxel, and of these the corners of the hull of the slice.
    pub fn outline(&self) -> Vec<DVec3> {
        let (dims, bricks) = (self.volume.dims(), self.volume.bricks().dims());
        let number = |brick: [usize; 3]| (brick[2] * bricks[1] + brick[1]) * bricks[0] + brick[0];
        let mut holds_any = vec![false; bricks.iter().product()];
        self.visible_bricks().into_iter().for_each(|brick| holds_any[number(brick)] = true);
        let is_seen = |at: [usize; 3]| {
            let brick = std::array::from_fn(|a| (at[a] / BRICK).min(bricks[a] - 1));
            let value = self.volume.values().at((at[2] * dims[1] + at[1]) * dims[0] + at[0]);
            holds_any[number(brick)] && self.transfer.opacity(f64::from(value)) > 0.0
        };
        let of_slice = |z: usize| {
            let ends = |y: usize| {
                let first = (0..dims[0]).find(|&x| is_seen([x, y, z]))?;
                let last = (first..dims[0]).rev().find(|&x| is_seen([x, y, z]))?;
                Some([y, first, last].map(|n| n as f64))
            };
            let rows: Vec<[f64; 3]> = (0..dims[1]).filter_map(ends).collect();
            let low = lower_hull(rows.iter().map(|[y, first, _]| DVec2::new(*y, *first)));
            let high = lower_hull(rows.iter().map(|[y, _, last]| DVec2::new(*y, -last)));
            let all = low.into_iter().chain(high.into_iter().map(|p| DVec2::new(p.x, -p.y)));
            all.map(|p| self.volume.scene_from_lattice(DVec3::new(p.y, p.x, z as f64))).collect::<Vec<_>>()
        };
        (0..dims[2]).into_par_iter().flat_map_iter(of_slice).collect()
    }

    /// Smallest box around the bricks in which anything is visible, scene coordinates; empty where nothing is.
    pub fn visible_bounds(&self) -> Aabb {
        let most = DVec3::from_array(self.volume.dims().map(|n| (n - 1) as f64));
        let corners = self.visible_bricks().into_iter().flat_map(|brick| {
            let min = DVec3::from_array(brick.map(|b| (b * BRICK) as f64));
            Aabb { min, max: (min + BRICK as f64).min(most) }.corners()
        });
        Aabb::of(corners.map(|q| self.volume.scene_from_lattice(q)))
    }

    /// The bricks in which anything is visible.
    fn visible_bricks(&self) -> Vec<[usize; 3]> {
        let bricks = self.volume.bricks();
        let [bx, by, _] = bricks.dims();
        let seen = |(_, [lo, hi]): &(usize, &[f32; 2])| self.transfer.most_opaque(f64::from(*lo), f64::from(*hi)) > 0.0;
        let visible = bricks.ranges().iter().enumerate().filter(seen);
        visible.map(|(i, _)| [i % bx, i / bx % by, i / bx / by]).collect()
    }
}

/// The corners of the hull of points with rising x that face towards lower y (Andrew 1979).
fn lower_hull(points: impl Iterator<Item = DVec2>) -> Vec<DVec2> {
    let mut out: Vec<DVec2> = Vec::new();
    for p in points {
        while let [.., before, last] = out[..]
            && (last - before).perp_dot(p - last) <= 0.0
        {
            out.pop();
        }
        out.push(p);
    }
    out
}

#[cfg(test)]
mod tests;
