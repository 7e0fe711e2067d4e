//! Evidence of what a file of heights shows: lines of sight over its samples, which anybody can check against the file alone.

use super::super::points::{PointKind, judged_points, required_features};
use super::memory::CHECK_CELLS;
use super::written::{SightOverFile, WrittenGround};
use super::{TerrainSolver, drop_at};
use crate::DisocclusionError;
use crate::visibility_qp::LinesOfSight;
use belvedere_core::{DVec2, View};
use belvedere_scene::Scene;
use rayon::prelude::*;
use serde::Serialize;

/// Longest piece of a line on a curved earth, scene units: the ground falls away from its chord by less than 2 cm.
const LONGEST_M: f64 = 1000.0;

/// A line of sight from a point that must be seen to the eye.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct CertifiedLine {
    /// Index of the layer in the scene.
    pub layer: usize,
    /// Index of the feature in its layer.
    pub feature: usize,
    /// Kind of point.
    pub kind: PointKind,
    /// What it stands for: metres of a line, square metres of an area, 1 for a point.
    pub amount: f64,
    /// Column, row (0, 0 is the first sample) and height of the ends of its straight pieces, from the point to the eye.
    pub line: Vec<[f64; 3]>,
}

impl TerrainSolver {
    /// Lines of sight of the points by which [`TerrainSolver::judge_written`] judges a file, hidden or not; of many points one of so many.
    ///
    /// * `ground`: with the cells cut from north-west to south-east;
    /// * `most`: lines at most, about, >= 1.
    ///
    /// # Errors
    /// [`DisocclusionError::Field`].
    pub fn lines_over_file(
        &self,
        (scene, view): (&Scene, &View),
        ground: &WrittenGround<'_>,
        most: usize,
    ) -> Result<Vec<CertifiedLine>, DisocclusionError> {
        let field = ground.field(view)?;
        let features: Vec<_> =
            required_features(scene).iter().map(|f| f.mapped(&|line| ground.grid.image_of(&field, line))).collect();
        let (all, _) = judged_points(&features, &field, &self.settings, CHECK_CELLS);
        let sight = SightOverFile::new(ground.grid, view);
        let mut points = sight.in_view(&field, &all, view, &self.settings);
        points.retain(|p| p.amount > 0.0);
        let every = points.len().div_ceil(most.max(1)).max(1);
        // The field sinks with the curvature of the earth, the file does not.
        let drop = |index: DVec2| {
            view.earth().and_then(|earth| Some(drop_at(earth, ground.grid.scene(index)?))).unwrap_or_default()
        };
        let line_of = |k: usize| {
            let p = &points[k];
            let surface = field.surface_at(p.grid)?;
            let mut chain = Vec::new();
            sight.trace(p.grid, surface + p.lift, &mut chain);
            let mut line: Vec<[f64; 3]> = Vec::with_capacity(chain.len());
            for pair in chain.windows(2) {
                let [(a, z_a), (b, z_b)] = [pair[0], pair[1]];
                let pieces = match view.earth() {
                    Some(_) => ((b - a) * ground.grid.spacing).length().div_euclid(LONGEST_M) + 1.0,
                    None => 1.0,
                };
                let at = |i: f64| (a.lerp(b, i / pieces), z_a + (z_b - z_a) * i / pieces);
                line.extend((0..pieces as usize).map(|i| at(i as f64)).map(|(g, z)| [g.x, g.y, z + drop(g)]));
            }
            let (eye, z) = *chain.last()?;
            line.push([eye.x, eye.y, z + drop(eye)]);
            let amount = p.amount * every as f64;
            Some(CertifiedLine { layer: p.layer, feature: p.feature, kind: p.kind, amount, line })
        };
        let chosen: Vec<usize> = (0..points.len()).step_by(every).collect();
        Ok(chosen.into_par_iter().filter_map(line_of).collect())
    }
}
