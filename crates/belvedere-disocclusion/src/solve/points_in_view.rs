//! Reference and candidate points that a picture must show.

use super::super::visibility_qp::{Candidate, LinesOfSight, RememberedLines, StraightSight, ViewSight};
use super::super::{Field, LeftOut, ReferencePoint, TerrainSettings, Wedge, in_view};
use super::entering::{self, EnteringSight};
use super::in_picture;
use super::memory::{self, Prepared};
use belvedere_core::View;

/// Reference and candidate points that a picture must show.
pub(super) struct PointsInView<'a> {
    field: &'a Field,
    pub(super) base: &'a View,
    pub(super) wedge: Wedge,
    guard: f64,
    ahead_m: Option<f64>,
    /// Indices of reference points.
    pub(super) points: Vec<usize>,
    /// Reference points in view that are too near to the eye.
    pub(super) too_near: Vec<usize>,
    /// Dense points and, after them, the reference points.
    pub(super) candidates: Vec<Candidate>,
    /// In films, the same for points beside the picture.
    pub(super) entering: Vec<Candidate>,
    pub(super) sight: Box<dyn LinesOfSight + 'a>,
    /// Whether lines of sight do not run straight to the eye: later stages bend them, or the picture is a parallel one.
    bent: bool,
}

impl<'a> PointsInView<'a> {
    /// * `film`: also demands points beside the picture, gradually.
    pub(super) fn new(
        field: &'a Field,
        prepared: &Prepared,
        base: &'a View,
        settings: &TerrainSettings,
        film: bool,
    ) -> Self {
        let bent = base.pinhole().is_orthographic() || !base.stages().iter().all(|s| s.is_upright());
        let eye = base.pinhole().eye;
        let wedge = if bent { Wedge::all_around(eye.truncate()) } else { Wedge::of_pinhole(base.pinhole()) };
        let straight = StraightSight { eye: field.grid_from_scene(eye.truncate()), z: eye.z };
        let wider = entering::beside(&wedge).filter(|_| film);
        let sight: Box<dyn LinesOfSight + 'a> = match (bent, &wider) {
            (true, _) => Box::new(RememberedLines::new(ViewSight::new(base, field))),
            (false, Some(_)) => Box::new(EnteringSight { straight, field, wedge }),
            (false, None) => Box::new(straight),
        };
        let (guard, ahead_m) = (settings.guard, settings.ahead_m);
        let (points, too_near, candidates, entering) = (Vec::new(), Vec::new(), Vec::new(), Vec::new());
        let mut in_view =
            Self { field, base, wedge, guard, ahead_m, points, too_near, candidates, entering, sight, bent };
        (in_view.points, in_view.too_near) = in_view.indices(&prepared.points);
        in_view.candidates = in_view.candidates_of(prepared, &in_view.points);
        if let Some(wider) = wider {
            let narrow = std::mem::replace(&mut in_view.wedge, wider);
            let (points, _) = in_view.indices(&prepared.points);
            in_view.entering = entering::others(in_view.candidates_of(prepared, &points), &in_view.candidates);
            in_view.wedge = narrow;
        }
        in_view
    }

    /// Dense points in the wedge and, after them, these reference points.
    fn candidates_of(&self, prepared: &Prepared, points: &[usize]) -> Vec<Candidate> {
        let offset = prepared.dense.len();
        let candidate = |id: usize, p: &ReferencePoint| Candidate::new(id as u32, p.grid, p.lift);
        let (dense, _) = self.indices(&prepared.dense);
        let dense = dense.iter().map(|&i| candidate(i, &prepared.dense[i]));
        dense.chain(points.iter().map(|&i| candidate(offset + i, &prepared.points[i]))).collect()
    }

    /// Indices of the points that are demanded, and of those that would be if they were not too near to the eye.
    pub(super) fn indices(&self, points: &[ReferencePoint]) -> (Vec<usize>, Vec<usize>) {
        let near = memory::ahead(self.field, points, self.wedge.eye, self.ahead_m);
        let in_frame = |p: &ReferencePoint| {
            !self.bent
                || in_picture::nearly_holds(self.base, self.field.scene_from_grid(p.grid).extend(p.ground + p.lift))
        };
        let (inside, outside) = in_view(self.field, points, &self.wedge, self.guard);
        let inside = inside.into_iter().filter(|&i| near[i] && in_frame(&points[i])).collect();
        // The wedge knows no height: most of what lies that near is below the picture.
        let shown = |p: &ReferencePoint| {
            in_picture::holds(self.base, self.field.scene_from_grid(p.grid).extend(p.ground + p.lift))
        };
        let too_near =
            |&(i, why): &(usize, LeftOut)| (why == LeftOut::TooNear && near[i] && shown(&points[i])).then_some(i);
        (inside, outside.iter().filter_map(too_near).collect())
    }
}
