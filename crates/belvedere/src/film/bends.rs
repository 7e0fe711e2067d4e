//! Bends of a scene as they follow a camera behind a walker.
//!
//! A scene places its bends for its own camera. In a film they keep their shape and move with the camera: lengths scale with the distance
//! between eye and walker.

use crate::scene_file::{Document, PlaneDoc, PointDoc, PresetsDoc, RaysStageDoc, SplineStageDoc, StageDoc};
use belvedere_core::presets::{BendFrame, DepthUnits, PresetDocument};
use belvedere_core::{DVec3, Pinhole, View};

/// Distance of the walker at which rays begin to bend, turn and go on straight, in depths of the walker.
const PLANES: [f64; 3] = [1.05, 1.5, 2.2];
/// Depth of what rays bend for, in depths of the walker, and the farthest second viewpoint in its shares.
const TARGET: f64 = 2.5;
const MOST_OFFSET: f64 = 0.5;
/// Cosine of the angle to the optical axis below which planes are not placed for the scene's camera.
const ALONG_AXIS: f64 = 0.999;

/// The scene's own camera, which its bends were placed for.
#[derive(Debug, Clone)]
pub(crate) struct FollowingBends {
    root: Pinhole,
    /// Distance from the eye to the pivot of the spline.
    pivot_distance: Option<f64>,
    /// Depth of the point looked at.
    depth: f64,
}

/// Camera and walker of a frame.
#[derive(Debug, Clone, Copy)]
pub(crate) struct FollowingCamera {
    pub(crate) eye: DVec3,
    pub(crate) look_at: DVec3,
    /// The walker on the ground, smoothed.
    pub(crate) walker: DVec3,
}

impl FollowingCamera {
    fn forward(&self) -> DVec3 {
        (self.look_at - self.eye).normalize_or_zero()
    }

    /// Viewing angle over level ground, degrees.
    fn pitch_deg(&self) -> f64 {
        (-self.forward().z).clamp(-1.0, 1.0).asin().to_degrees()
    }
}

impl FollowingBends {
    pub(crate) fn of(view: &View, scene: &Document) -> Self {
        let root = view.pinhole().clone();
        let depth = match scene.camera.look_at {
            Some(PointDoc::Scene(p)) => (DVec3::from_array(p) - root.eye).dot(root.forward),
            _ => f64::NAN,
        };
        Self { pivot_distance: view.spline_bend().map(|bend| bend.resolved().distance), depth, root }
    }

    /// Moves the bends to a frame's camera.
    ///
    /// * `share`: share of their strength, 0..=1; terrain, strips and relief keep theirs.
    pub(crate) fn apply(&self, stages: &mut Vec<StageDoc>, camera: &FollowingCamera, share: f64) {
        let mut out = Vec::with_capacity(stages.len());
        for stage in stages.drain(..) {
            out.extend(match stage {
                StageDoc::SplineBend(spline) => Some(StageDoc::SplineBend(self.spline(spline, camera, share))),
                StageDoc::CurvedRays(rays) if self.is_own(&rays) => self.rays(rays, camera, share),
                // The anchor moves with the camera.
                StageDoc::Strip(mut strip) => {
                    strip.anchor = None;
                    Some(StageDoc::Strip(strip))
                }
                other => Some(other),
            });
        }
        *stages = out;
    }

    /// The spline over the level of the ground at the walker, who is its pivot.
    fn spline(&self, spline: SplineStageDoc, camera: &FollowingCamera, share: f64) -> SplineStageDoc {
        let level = spline.plane.as_ref().is_none_or(|p| p.normal == [0.0, 0.0, 1.0]);
        let PresetsDoc::Inline(presets) = &spline.presets else { return SplineStageDoc { pivot: None, ..spline } };
        if !level {
            return SplineStageDoc { pivot: None, ..spline };
        }
        let mut presets = (**presets).clone();
        if let Some(distance) = self.pivot_distance.filter(|d| presets.units == DepthUnits::Absolute && *d > 0.0) {
            presets.units = DepthUnits::Distance;
            presets.presets.iter_mut().for_each(|p| [p.s, p.e] = [p.s / distance, p.e / distance]);
        }
        presets.pin = true;
        ease(&mut presets, camera.pitch_deg(), share);
        SplineStageDoc {
            presets: PresetsDoc::Inline(Box::new(presets)),
            pivot: Some(camera.walker.to_array()),
            plane: Some(PlaneDoc { normal: [0.0, 0.0, 1.0], height_m: Some(camera.walker.z) }),
        }
    }

    /// Whether rays have a single turn behind planes across the scene's own optical axis.
    fn is_own(&self, rays: &RaysStageDoc) -> bool {
        let [turn] = &rays.turn[..] else { return false };
        let across = turn.normal.and_then(|n| DVec3::from_array(n).try_normalize());
        rays.split.is_none() && self.depth > 0.0 && across.is_some_and(|n| n.dot(self.root.forward).abs() > ALONG_AXIS)
    }

    /// Rays that bend behind the walker, towards a second viewpoint that is no lower than the eye. `None` without an offset.
    fn rays(&self, mut rays: RaysStageDoc, camera: &FollowingCamera, share: f64) -> Option<StageDoc> {
        let forward = camera.forward();
        let right = forward.cross(DVec3::Z).try_normalize()?;
        let up = right.cross(forward);
        let depth = (camera.walker - camera.eye).dot(forward);
        let turn = rays.turn.first_mut()?;
        let offset = (DVec3::from_array(turn.viewpoint) - self.root.eye) / self.depth;
        let (aside, over) = (offset.dot(self.root.right), offset.dot(self.root.down).abs());
        let reach = aside.hypot(over);
        let size = share * TARGET * depth * (MOST_OFFSET / reach.max(1e-12)).min(1.0);
        if !(depth > 0.0 && size * reach > 1e-6 * depth) {
            return None;
        }
        turn.viewpoint = (camera.eye + size * (aside * right + over * up)).to_array();
        [turn.t0, turn.t1, turn.t2] = PLANES.map(|k| (camera.eye + k * depth * forward).to_array());
        (turn.line, turn.normal) = (None, Some(forward.to_array()));
        Some(StageDoc::CurvedRays(rays))
    }
}

/// Brings the curves of presets nearer to the straight curve that is the ordinary perspective.
///
/// * `pitch_deg`: the camera's viewing angle.
fn ease(document: &mut PresetDocument, pitch_deg: f64, share: f64) {
    if share >= 1.0 {
        return;
    }
    let last = document.presets.iter().map(|p| p.phi + p.tau).fold(f64::NEG_INFINITY, f64::max);
    let followed = if document.follow { (pitch_deg - last).max(0.0) } else { 0.0 };
    let slope_deg = match document.frame {
        BendFrame::Camera => pitch_deg - followed,
        BendFrame::Plane => 0.0,
    };
    let (sin, cos) = slope_deg.to_radians().sin_cos();
    let mix = |straight: f64, bent: f64| straight + share * (bent - straight);
    for preset in &mut document.presets {
        for angle in preset.angles.iter_mut().flatten() {
            angle[1] = mix(slope_deg, angle[1]);
        }
        let Some(&first) = preset.control.first() else { continue };
        let (mut before, mut l) = (first, 0.0);
        for p in &mut preset.control {
            let bent = *p;
            l += (bent[0] - before[0]).hypot(bent[1] - before[1]);
            before = bent;
            *p = [mix(first[0] + l * cos, bent[0]), mix(first[1] + l * sin, bent[1])];
        }
    }
}
