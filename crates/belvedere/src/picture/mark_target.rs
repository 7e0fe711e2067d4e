//! Marks of target points in pictures.

use super::{Picture, TargetPlace};
use crate::overlays::ring;
use belvedere_construct::rays::BendReport;
use belvedere_core::DVec3;

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
}
