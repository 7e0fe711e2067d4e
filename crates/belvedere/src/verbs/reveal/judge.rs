//! `reveal --see`: the bend of one view, sought by lines of sight and judged by pictures.
//!
//! Lines of sight to some points choose among thousands of bends. What they miss between these points is seen in the picture: places that it
//! hides become points themselves, and the search is repeated.

use super::subject::Targets;
use crate::fallback::in_sight::{Judge, Mask};
use crate::fallback::{Draw, has_volumes};
use crate::picture::{PictureOptions, plain};
use crate::{BelvedereError, Session};
use belvedere_construct::rays::{AroundOptions, BendReport, Sidestep, TargetSight, bend_around_by};
use belvedere_construct::reveal::thresholds::LEAST_GAIN;
use belvedere_core::{CurvedRays, Pinhole, Stage, View};
use belvedere_scene::{Progress, Scene};

/// Searches for one view, at most.
const ROUNDS: usize = 2;
/// Hidden places of a picture that become points, at most.
const PLACES: usize = 16;
/// Pixels of a picture that judges, at most; larger ones show the same.
const MOST_PIXELS: f64 = 1e6;

/// Judges views of a target by pictures.
pub(super) struct PictureJudge<'a> {
    scene: &'a Scene,
    /// `None` where pictures cannot tell: for points and lines, and where volumes let light through.
    judge: Option<Judge>,
    draw: Box<Draw<'a>>,
}

impl<'a> PictureJudge<'a> {
    pub(super) fn new(
        session: &'a Session,
        targets: &Targets,
        (options, progress): (&'a PictureOptions, &'a Progress),
    ) -> Self {
        let scene = session.scene();
        let judge = if has_volumes(scene) { None } else { Judge::of(scene, &targets.shape, &targets.judge) };
        Self { scene, judge, draw: Box::new(plain(session, options, progress)) }
    }

    /// Whether pictures judge, or lines of sight to points.
    pub(super) fn is_by_pictures(&self) -> bool {
        self.judge.is_some()
    }

    /// What the picture of a view shows, with the view of that picture; a smaller one for posters.
    fn mask(&self, view: &View) -> Result<Option<(Mask, View)>, BelvedereError> {
        let Some(judge) = &self.judge else { return Ok(None) };
        let view = smaller(view).unwrap_or_else(|| view.clone());
        let mask = judge.mask((self.scene, None), &view, &*self.draw)?;
        Ok(Some((mask, view)))
    }

    /// Share of the whole target that a view shows, 0..=1: of its pixels, or of its points where pictures cannot tell.
    pub(super) fn share(&self, sight: &TargetSight<'_>, view: &View) -> Result<f64, BelvedereError> {
        let mask = self.mask(view)?;
        Ok(mask.map_or_else(|| sight.share(view, 0.0), |(mask, _)| mask.share() * sight.in_frame(view)))
    }

    /// Whether pictures show more of the target bent than straight; `true` where they cannot tell.
    pub(super) fn gains(&self, sight: &TargetSight<'_>, straight: &View, bent: &View) -> Result<bool, BelvedereError> {
        Ok(!self.is_by_pictures() || self.share(sight, bent)? >= self.share(sight, straight)? + LEAST_GAIN)
    }

    /// The bend of a view that shows most of the target, if one shows more than straight rays. Where the straight picture shows all of it
    /// none is tried.
    pub(super) fn bend(
        &self,
        sight: &TargetSight<'_>,
        view: &View,
        progress: &Progress,
    ) -> Result<(Option<Sidestep>, BendReport), BelvedereError> {
        let around = AroundOptions::default();
        let Some((straight, drawn)) = self.mask(view)? else {
            let found = bend_around_by(sight, view, &around, progress)?;
            return Ok((found.bent.map(|(_, sidestep)| sidestep), found.report));
        };
        let in_frame = sight.in_frame(view);
        let (visible, light) = (straight.share() * in_frame, straight.share());
        let mut report = BendReport {
            visible_straight: visible,
            visible,
            in_frame_straight: in_frame,
            in_frame,
            light_straight: light,
            light_best: light,
            motion: 0.0,
            tried: 0,
        };
        let mut hidden = straight.hidden(&drawn, PLACES);
        let mut best = None;
        if hidden.is_empty() && in_frame >= 1.0 {
            return Ok((None, report));
        }
        for _ in 0..ROUNDS {
            let target = sight.target().with_points(&hidden);
            let found = bend_around_by(&sight.to_points(&target), view, &around, progress)?;
            report.tried += found.report.tried;
            let Some((bent, sidestep)) = found.bent else { break };
            let Some((mask, drawn)) = self.mask(&bent)? else { break };
            let in_frame = sight.in_frame(&bent);
            let visible = mask.share() * in_frame;
            report.light_best = report.light_best.max(mask.share());
            if visible >= report.visible + LEAST_GAIN {
                (report.visible, report.in_frame, report.motion) = (visible, in_frame, found.report.motion);
                best = Some(sidestep);
            }
            let more = mask.hidden(&drawn, PLACES);
            if more.is_empty() {
                break;
            }
            hidden.extend(more);
        }
        Ok((best, report))
    }
}

/// The view in a picture of [`MOST_PIXELS`]; `None` where it is not larger.
fn smaller(view: &View) -> Option<View> {
    let pinhole = view.pinhole();
    let scale = (MOST_PIXELS / pinhole.image.iter().map(|n| f64::from(*n)).product::<f64>()).sqrt();
    if scale >= 1.0 {
        return None;
    }
    let image = pinhole.image.map(|n| ((scale * f64::from(n)).round() as u32).max(1));
    let pinhole = Pinhole { image, ..pinhole.clone() };
    // Curved rays belong to the pixels of their picture.
    let stage = |stage: &Stage| match stage {
        Stage::CurvedRays(rays) => CurvedRays::new(&pinhole, rays.model(), rays.spec()).ok().map(Stage::CurvedRays),
        other => Some(other.clone()),
    };
    let stages: Option<Vec<Stage>> = view.stages().iter().map(stage).collect();
    View::new(pinhole.clone(), stages?).ok()
}
