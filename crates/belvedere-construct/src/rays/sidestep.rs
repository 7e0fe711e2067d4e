//! The camera of one turn behind parallel planes.

use crate::ConstructError;
use belvedere_core::map::curved_rays::{Model, Pencil, Sharpness, TurnSpec};
use belvedere_core::{CurvedRays, DVec3, Pinhole, Stage, View};

/// A second viewpoint beside the eye: rays leave the eye straight, bend between planes across the direction of view, and
/// go on as if they came from that viewpoint. Parallel planes, so that modified and original rays are the same.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Sidestep {
    /// Vector from the eye to the second viewpoint, scene units.
    pub offset: DVec3,
    /// Distances of t0, t1, t2 from the eye along the direction of view, scene units, rising.
    pub planes: [f64; 3],
}

impl Sidestep {
    /// The turn behind `root`.
    pub fn turn(&self, root: &Pinhole) -> TurnSpec {
        let [t0, t1, t2] = self.planes.map(|z| root.eye + z * root.forward);
        let pencil = Pencil::Parallel { normal: root.forward };
        TurnSpec { viewpoint: root.eye + self.offset, t0, t1, t2, pencil, m: Sharpness::Bend }
    }

    /// `base` with its own curved rays, if it has any, replaced by this turn.
    ///
    /// # Errors
    /// [`ConstructError::Rays`] if the turn is not possible, e.g. with an orthographic camera.
    pub fn view(&self, base: &View) -> Result<View, ConstructError> {
        self.seen_by(base.pinhole(), base)
    }

    /// The turn behind `root`, which stays where it is in space, in the picture of `base`: a camera at the same eye that may look elsewhere.
    ///
    /// # Errors
    /// As [`Sidestep::view`].
    pub fn seen_by(&self, root: &Pinhole, base: &View) -> Result<View, ConstructError> {
        let pinhole = base.pinhole();
        let rays = CurvedRays::new(pinhole, Model::Modified, &[self.turn(root)])?;
        let earlier = base.stages().iter().filter(|s| !s.bends_rays()).cloned();
        Ok(View::new(pinhole.clone(), earlier.chain([Stage::CurvedRays(rays)]).collect())?)
    }
}

/// The second viewpoint of a frame.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PlannedBend {
    /// Its signed distance from the eye, -1..=1, in units of `a`.
    pub f: f64,
    /// Direction of f > 0 across the view, degrees from the right of the picture upwards.
    pub direction_deg: f64,
    /// Distance of plane t0 from the eye, share of the target's; a distance that is stated comes before it.
    pub start: f64,
}

impl Default for PlannedBend {
    fn default() -> Self {
        Self { f: 0.0, direction_deg: 0.0, start: Self::START }
    }
}

impl PlannedBend {
    /// Usual share of the target's distance at which rays begin to bend, that of the paper.
    pub const START: f64 = 0.5;
}
