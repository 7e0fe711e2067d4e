//! Water on the terrain: lakes stay level, and rivers that are named do not run uphill.

use super::super::{Field, Hierarchy};
use super::lakes::{Lakes, Water};
use crate::rivers::{RiverLine, Rivers};
use belvedere_core::DVec2;
use belvedere_scene::{Heightfield, NodeState};

/// Distance from rivers within which the change of detail fades to zero, nodes.
const FADE: usize = 4;

/// Lakes and rivers.
#[derive(Debug, Clone, Default)]
pub(super) struct Waters {
    pub(super) lakes: Lakes,
    pub(super) rivers: Rivers,
}

impl Waters {
    /// * `terrain`: the heights that rivers are measured on, spikes included.
    pub(super) fn new(areas: &[Water], lines: &[RiverLine], terrain: &Heightfield, field: &Field) -> Self {
        let lines = lines.iter().map(|line| line.mapped(|p| Some(field.grid_from_scene(p))));
        let height = |i: usize| (terrain.states()[i] != NodeState::Void).then(|| f64::from(terrain.heights()[i]));
        let rivers = Rivers::new(lines, field.nodes(), height);
        Self { lakes: Lakes::new(areas, field), rivers }
    }

    pub(super) fn is_empty(&self) -> bool {
        self.lakes.is_empty() && self.rivers.is_empty()
    }

    /// The displacement of every node of the terrain: that of a solver's grid and the change of detail, level on lakes and downhill along
    /// rivers.
    pub(super) fn whole(&self, grid: &Hierarchy, u: &[f64], detail: Option<&[f64]>) -> Vec<f64> {
        let mut whole = grid.prolong(u);
        if let Some(detail) = detail {
            whole.iter_mut().zip(detail).for_each(|(u, d)| *u += d);
        }
        self.lakes.level(grid, &mut whole);
        if !self.rivers.is_empty() {
            self.rivers.settle(&mut whole, |u| self.lakes.sink(u));
        }
        whole
    }

    /// Sets the change of detail to zero on lakes and rivers, and fades it out towards rivers.
    pub(super) fn clear(&self, detail: &mut [f64], field: &Field) {
        self.lakes.clear(detail);
        if self.rivers.is_empty() {
            return;
        }
        let (cols, rows) = (field.cols(), field.rows());
        let mut share = vec![1.0f64; detail.len()];
        for n in self.rivers.nodes().map(|n| n as usize) {
            let at = [n % cols, n / cols];
            let near = |v: usize, most: usize| v.saturating_sub(FADE)..(v + FADE + 1).min(most);
            for row in near(at[1], rows) {
                for col in near(at[0], cols) {
                    let away = DVec2::new(col as f64 - at[0] as f64, row as f64 - at[1] as f64).length();
                    let slot = &mut share[row * cols + col];
                    *slot = slot.min(away / FADE as f64);
                }
            }
        }
        detail.iter_mut().zip(share).for_each(|(d, share)| *d *= share);
    }
}
