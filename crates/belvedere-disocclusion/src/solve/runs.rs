//! Merges hidden points into parts of features.

use super::super::{Field, PointKind, ReferencePoint};
use super::{UnresolvedReason, UnresolvedRun};
use belvedere_core::DVec2;
use std::collections::BTreeMap;

/// Parts of features, gathered point by point.
pub(super) struct Runs<'a> {
    field: &'a Field,
    /// Points of a line or rim farther apart than this, scene units, belong to different parts: those between them are seen.
    gap_m: f64,
    pub(super) out: Vec<UnresolvedRun>,
    /// Runs inside areas by the squares of the ground in which they lie, of `BLOCK` grid cells per side.
    blocks: BTreeMap<(usize, usize, i64, i64), usize>,
}

/// Grid cells per side of the squares by which hidden points inside areas are gathered.
const BLOCK: f64 = 4.0;

impl<'a> Runs<'a> {
    /// * `spacing`: of the points, cells.
    pub(super) fn new(field: &'a Field, spacing: f64) -> Self {
        Self { field, gap_m: 1.5 * spacing * field.spacing().max_element(), out: Vec::new(), blocks: BTreeMap::new() }
    }

    pub(super) fn put(&mut self, p: &ReferencePoint, reason: UnresolvedReason) {
        self.add((p.layer, p.feature, p.kind, p.along_m, p.grid), reason);
    }

    pub(super) fn add(
        &mut self,
        (layer, feature, kind, along, grid): (usize, usize, PointKind, f64, DVec2),
        reason: UnresolvedReason,
    ) {
        let (x, y) = ((grid.x / BLOCK).floor() as i64, (grid.y / BLOCK).floor() as i64);
        if kind == PointKind::Inside {
            // Points inside an area are gathered by their position.
            let around = (-1..=1).flat_map(|dy| (-1..=1).map(move |dx| (layer, feature, x + dx, y + dy)));
            let mut known = around.filter_map(|block| self.blocks.get(&block).copied());
            let same = |k: &usize| std::mem::discriminant(&self.out[*k].reason) == std::mem::discriminant(&reason);
            if let Some(k) = known.find(same) {
                let run = &mut self.out[k];
                (run.points, run.reason) = (run.points + 1, worse(run.reason, reason));
                self.blocks.insert((layer, feature, x, y), k);
                return;
            }
            self.blocks.insert((layer, feature, x, y), self.out.len());
        }
        let same = |r: &UnresolvedRun| {
            kind != PointKind::Inside
                && (r.layer, r.feature, r.kind) == (layer, feature, kind)
                && (along - r.to_m).abs() <= self.gap_m
                && std::mem::discriminant(&r.reason) == std::mem::discriminant(&reason)
        };
        if let Some(run) = self.out.last_mut().filter(|r| same(r)) {
            (run.to_m, run.points) = (along, run.points + 1);
            run.reason = worse(run.reason, reason);
            return;
        }
        let at = self.field.scene_from_grid(grid).to_array();
        self.out.push(UnresolvedRun { layer, feature, kind, from_m: along, to_m: along, at, points: 1, reason });
    }
}

/// The first of two reasons of one kind, with the larger rise of ground over a line of sight of both.
fn worse(first: UnresolvedReason, next: UnresolvedReason) -> UnresolvedReason {
    use UnresolvedReason::{Between, GivenUp, InsideGuard, Judged, Limits, Smoothed, Written};
    match (first, next) {
        (Smoothed { over_m: a }, Smoothed { over_m: b }) => Smoothed { over_m: a.max(b) },
        (Judged { over_m: a }, Judged { over_m: b }) => Judged { over_m: a.max(b) },
        (Limits { over_m: a }, Limits { over_m: b }) => Limits { over_m: a.max(b) },
        (Written { over_m: a }, Written { over_m: b }) => Written { over_m: a.max(b) },
        (GivenUp { over_m: a }, GivenUp { over_m: b }) => GivenUp { over_m: a.max(b) },
        (Between { over_m: a }, Between { over_m: b }) => Between { over_m: a.max(b) },
        (InsideGuard { over_m: a }, InsideGuard { over_m: b }) => InsideGuard { over_m: a.max(b) },
        _ => first,
    }
}
