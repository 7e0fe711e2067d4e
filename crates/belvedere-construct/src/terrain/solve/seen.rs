//! What of the features the picture is asked to show.

use super::super::qp::{Candidate, LinesOfSight, StraightSight, ViewSight};
use super::super::{Field, LeftOut, ReferencePoint, TerrainSettings, Wedge, in_view};
use super::bent;
use super::memory::{self, Prepared};
use belvedere_core::{Stage, View};

/// What of the features the picture is asked to show.
pub(super) struct Seen<'a> {
    field: &'a Field,
    base: &'a View,
    pub(super) wedge: Wedge,
    guard: f64,
    ahead_m: Option<f64>,
    /// Indices of reference points.
    pub(super) points: Vec<usize>,
    /// Reference points in view that are too near to the eye.
    pub(super) too_near: Vec<usize>,
    /// Dense points and, after them, the reference points.
    pub(super) candidates: Vec<Candidate>,
    pub(super) sight: Box<dyn LinesOfSight + 'a>,
    /// Whether lines of sight do not run straight to the eye: later stages bend them, or the picture is a parallel one.
    bent: bool,
}

impl<'a> Seen<'a> {
    pub(super) fn new(field: &'a Field, prepared: &Prepared, base: &'a View, settings: &TerrainSettings) -> Self {
        let later = |s: &Stage| matches!(s, Stage::SplineBend(_) | Stage::CurvedRays(_));
        let bent = base.pinhole().is_orthographic() || base.stages().iter().any(later);
        let eye = base.pinhole().eye;
        let wedge = if bent { Wedge::all_around(eye.truncate()) } else { Wedge::of_pinhole(base.pinhole()) };
        let sight: Box<dyn LinesOfSight + 'a> = match bent {
            true => Box::new(ViewSight::new(base, field)),
            false => Box::new(StraightSight { eye: field.grid_from_scene(eye.truncate()), z: eye.z }),
        };
        let (guard, ahead_m) = (settings.guard, settings.ahead_m);
        let (points, too_near, candidates) = (Vec::new(), Vec::new(), Vec::new());
        let mut seen = Self { field, base, wedge, guard, ahead_m, points, too_near, candidates, sight, bent };
        (seen.points, seen.too_near) = seen.indices(&prepared.points);
        let offset = prepared.dense.len();
        let candidate = |id: usize, p: &ReferencePoint| Candidate { id: id as u32, grid: p.grid, lift: p.lift };
        let (dense, _) = seen.indices(&prepared.dense);
        let dense = dense.iter().map(|&i| candidate(i, &prepared.dense[i]));
        let points = seen.points.iter().map(|&i| candidate(offset + i, &prepared.points[i]));
        seen.candidates = dense.chain(points).collect();
        seen
    }

    /// Which of the points are asked for, and which would be if they were not too near.
    pub(super) fn indices(&self, points: &[ReferencePoint]) -> (Vec<usize>, Vec<usize>) {
        let near = memory::ahead(self.field, points, self.wedge.eye, self.ahead_m);
        let in_frame = |p: &ReferencePoint| {
            !self.bent || bent::shows(self.base, self.field.scene_from_grid(p.grid).extend(p.ground + p.lift))
        };
        let (inside, outside) = in_view(self.field, points, &self.wedge, self.guard);
        let inside = inside.into_iter().filter(|&i| near[i] && in_frame(&points[i])).collect();
        // The wedge knows no height: most of what lies that near is below the picture.
        let shown = |p: &ReferencePoint| {
            bent::in_frame(self.base, self.field.scene_from_grid(p.grid).extend(p.ground + p.lift))
        };
        let too_near =
            |&(i, why): &(usize, LeftOut)| (why == LeftOut::TooNear && near[i] && shown(&points[i])).then_some(i);
        (inside, outside.iter().filter_map(too_near).collect())
    }
}
