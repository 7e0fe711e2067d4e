//! Rigid bodies in a view: buildings that the stages carry as a whole.

use super::View;
use crate::{Miss, RigidMotion, Stage};
use glam::{DMat3, DVec3};

impl View {
    /// Whether rigid bodies are carried as a whole: whether a stage comes before the curved rays.
    pub fn carries_bodies(&self) -> bool {
        !self.stages().iter().all(|stage| stage.bends_rays())
    }

    /// The motion of a rigid body whose foot is `foot`, scene coordinates, by all stages before the curved rays: the foot goes where they carry
    /// it, and the body turns with the strip and with the deformation curve there ([`crate::map::StageMap::rotation_of_body`]). Earth, terrain and relief move bodies without turning or
    /// stretching them.
    ///
    /// Laws: an isometry; the identity where the stages are; on the reference plane the derivative of a spline bend at the foot.
    ///
    /// # Errors
    /// [`Miss`] where a stage has no image of the foot.
    pub fn body_motion(&self, foot: DVec3) -> Result<RigidMotion, Miss> {
        let (mut to, mut rotation) = (foot, DMat3::IDENTITY);
        for stage in self.stages().iter().filter(|stage| !stage.bends_rays()) {
            rotation = stage.rotation_of_body(to)? * rotation;
            to = stage.apply(to)?;
        }
        if to.is_finite() { Ok(RigidMotion::new(foot, to, rotation)) } else { Err(Miss::OutsideDomain) }
    }

    /// View of bodies that [`View::body_motion`] has carried: the same pinhole behind the curved rays alone.
    pub fn after_bodies(&self) -> Self {
        let stages = self.stages().iter().filter(|stage| stage.bends_rays()).cloned().collect();
        Self { pinhole: self.pinhole().clone(), stages }
    }

    /// View of a body that moves by `motion`: it projects the body's undisplaced points to their pixels in the picture.
    pub fn of_body(&self, motion: RigidMotion) -> Self {
        let after = self.stages().iter().filter(|stage| stage.bends_rays()).cloned();
        let stages = std::iter::once(Stage::Body(motion)).chain(after).collect();
        Self { pinhole: self.pinhole().clone(), stages }
    }
}
