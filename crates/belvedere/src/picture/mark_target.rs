//! Marks of targets in pictures: a ring around points, an outline around everything that has a surface, with a ring where that is small.

use super::{Picture, PictureOptions, TargetPlace};
use crate::fallback::in_sight::Judge;
use crate::{BelvedereError, Session};
use belvedere_construct::rays::{BendReport, Target};
use belvedere_core::{DVec3, View};
use belvedere_overlay::{contour, ring};
use belvedere_scene::{Frame, Light, Progress, RenderJob, RenderOptions, Scene};

/// Draws scenes in the quality of a session's pictures without marks and shadows, to tell what is seen where.
pub(crate) fn plain<'a>(
    session: &'a Session,
    options: &'a PictureOptions,
    progress: &'a Progress,
) -> impl Fn(&Scene, &View) -> Result<Frame, BelvedereError> + 'a {
    let drawing = RenderOptions { marks: false, ..options.quality.clone() };
    let light = Light { shadows: false, ..*session.light() };
    move |scene, view| {
        let job = RenderJob { scene, view, light: &light, options: &drawing, progress };
        Ok(session.renderer(&options.renderer)?.render(&job)?)
    }
}

impl Picture {
    /// Marks a target point in both pictures, and records its position.
    /// * `density`: pixels per unit of symbols.
    pub(crate) fn mark_target(&mut self, place: &TargetPlace, report: &BendReport, density: f64) {
        let p = DVec3::from_array(place.point);
        let straight = self.view.straightened();
        let frames = [
            (Some(&mut self.frame), &self.view, report.visible),
            (self.straight.as_mut(), &straight, report.visible_straight),
        ];
        for (frame, view, visible) in frames {
            if let (Some(frame), Ok(image)) = (frame, view.project(p))
                && image.pixel.length() < 1e6
            {
                ring::draw(frame, image.pixel, visible < 0.5, density);
            }
        }
        self.sidecar.target = Some(place.clone());
    }

    /// Draws the outline of a target in both pictures, of dashes where it is hidden; returns the shares of its pixels that the straight and
    /// the bent picture show, of those that it fills where it is drawn alone. `None` for points and lines, which have no surface.
    ///
    /// * `on_ground`: the target with the ground on which it stands, if that is drawn with it.
    pub(crate) fn mark_shape(
        &mut self,
        session: &Session,
        (target, on_ground): (&Target, &Target),
        options: &PictureOptions,
    ) -> Result<Option<[f64; 2]>, BelvedereError> {
        let Some(judge) = Judge::of(session.scene(), target, on_ground) else { return Ok(None) };
        let draw = plain(session, options, &options.progress);
        // Around everything in the picture an outline tells nothing.
        let is_own = |i: usize| target.own_layers.contains(&i);
        let has_others =
            (0..session.scene().layers.len()).any(|i| !is_own(i) && !session.scene().layers[i].bounds().is_empty());
        let straight_view = self.view.straightened();
        let mut shares = [0.0; 2];
        let frames = [(self.straight.as_mut(), &straight_view), (Some(&mut self.frame), &self.view)];
        for (share, (frame, view)) in shares.iter_mut().zip(frames) {
            let Some(frame) = frame else { continue };
            let mask = judge.mask((session.scene(), Some(frame)), view, &draw)?;
            *share = mask.share();
            if has_others {
                contour::draw(frame, &mask.own, &mask.seen);
                for (at, is_seen) in contour::small_parts(&mask.own, &mask.seen, frame.width) {
                    ring::draw(frame, at, !is_seen, options.density);
                }
            }
        }
        Ok(Some(shares))
    }
}
