//! Marks of targets in pictures: a ring around points, an outline around everything that has a surface.

use super::{Picture, PictureOptions, TargetPlace};
use crate::fallback::in_sight::{Mask, target_alone};
use crate::overlays::{contour, ring};
use crate::{BelvedereError, Session};
use belvedere_construct::rays::{BendReport, Target};
use belvedere_core::{DVec3, View};
use belvedere_scene::{RenderJob, RenderOptions};

impl Picture {
    /// Marks a target point in both pictures, and records its position.
    pub(crate) fn mark_target(&mut self, place: &TargetPlace, report: &BendReport) {
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
                ring::draw(frame, image.pixel, visible < 0.5);
            }
        }
        self.sidecar.target = Some(place.clone());
    }

    /// Draws the outline of a target in both pictures, of dashes where it is hidden; returns the shares of its pixels that the straight and
    /// the bent picture show, of those that it fills where it is drawn alone. `None` for points and lines, which have no surface.
    pub(crate) fn mark_shape(
        &mut self,
        session: &Session,
        target: &Target,
        options: &PictureOptions,
    ) -> Result<Option<[f64; 2]>, BelvedereError> {
        let Some(alone) = target_alone(session.scene(), target) else { return Ok(None) };
        let drawing = RenderOptions { marks: false, ..options.quality.clone() };
        let draw = |view: &View| {
            let (light, progress) = (session.light(), &options.progress);
            let job = RenderJob { scene: &alone, view, light, options: &drawing, progress };
            options.renderer.of(session).render(&job)
        };
        let straight_view = self.view.straightened();
        let mut shares = [0.0; 2];
        let frames = [(self.straight.as_mut(), &straight_view), (Some(&mut self.frame), &self.view)];
        for (share, (frame, view)) in shares.iter_mut().zip(frames) {
            let Some(frame) = frame else { continue };
            let mask = Mask::of(target, frame, &draw(view)?);
            *share = mask.share();
            contour::draw(frame, &mask);
        }
        Ok(Some(shares))
    }
}
