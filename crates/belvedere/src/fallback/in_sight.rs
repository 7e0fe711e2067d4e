//! Visible share of a target in a picture, pixel by pixel.

use super::{SAME_DEPTH, occluders};
use crate::resolve::constructor;
use crate::targets;
use crate::{BelvedereError, Session};
use belvedere_construct::rays::Target;
use belvedere_core::View;
use belvedere_scene::{Frame, Scene};

/// Whether an id of a picture is that of the target's layer.
pub(super) fn is_target(target: &Target, id: u32) -> bool {
    let is = |layer: usize| id as usize == layer + 1;
    target.own_layers.iter().any(|&layer| is(layer)) || target.own_parts.as_ref().is_some_and(|p| is(p.0))
}

/// Number of pixels of a target in a picture of it alone, and the share of them that a picture shows, 0..=1: by ids, and by depths where
/// other parts of its layer may hide it.
pub(super) fn share(target: &Target, frame: &Frame, alone: &Frame) -> (usize, f64) {
    let own = (0..alone.id.len()).filter(|&i| is_target(target, alone.id[i]));
    let is_seen = |i: usize| {
        let (here, there) = (f64::from(frame.depth[i]), f64::from(alone.depth[i]));
        let same_depth = target.own_parts.is_none() || (here - there).abs() <= SAME_DEPTH * there;
        is_target(target, frame.id[i]) && same_depth
    };
    let (all, seen) = own.fold((0usize, 0usize), |(all, seen), i| (all + 1, seen + usize::from(is_seen(i))));
    (all, seen as f64 / all.max(1) as f64)
}

/// The scene with the target alone; `None` for points and lines, which have no surface of their own.
pub(crate) fn target_alone(scene: &Scene, target: &Target) -> Option<Scene> {
    occluders::target_alone(scene, target)
}

/// The scene with its target opaque; `None` where it is. Ids and depths are those of what hides, so a target that something shines
/// through is looked for in a picture of this scene.
pub(crate) fn with_opaque_target(scene: &Scene, target: &Target) -> Option<Scene> {
    let is_own = |i: usize| is_target(target, i as u32 + 1) && scene.layers[i].kind.is_see_through();
    let own: Vec<usize> = (0..scene.layers.len()).filter(|i| is_own(*i)).collect();
    if own.is_empty() {
        return None;
    }
    let mut scene = scene.clone();
    own.into_iter().for_each(|i| scene.layers[i].kind.set_opacity(1.0));
    Some(scene)
}

/// The pixels that a target fills where it is drawn alone, and those of them that a picture shows.
pub(crate) struct Mask {
    /// Whether a pixel is one of the target's, row by row.
    pub(crate) own: Vec<bool>,
    /// Whether the picture shows the target there.
    pub(crate) seen: Vec<bool>,
    width: usize,
}

impl Mask {
    /// * `alone`: the target alone; `on_ground`: with the ground on which it stands, below which it has no pixels.
    pub(crate) fn of(target: &Target, frame: &Frame, alone: &Frame, on_ground: Option<&Frame>) -> Self {
        let same = |a: f32, b: f32| (f64::from(a) - f64::from(b)).abs() <= SAME_DEPTH * f64::from(b);
        let above = |i: usize| on_ground.is_none_or(|ground| same(ground.depth[i], alone.depth[i]));
        let own: Vec<bool> = (0..alone.id.len()).map(|i| is_target(target, alone.id[i]) && above(i)).collect();
        let is_seen = |i: usize| own[i] && is_target(target, frame.id[i]) && same(frame.depth[i], alone.depth[i]);
        let seen = (0..own.len()).map(is_seen).collect();
        Self { own, seen, width: frame.width }
    }

    /// Whether the picture shows the target at a pixel or beside it: its rim shares pixels with what is behind.
    fn is_seen(&self, i: usize) -> bool {
        let beside = [Some(i), i.checked_sub(1), Some(i + 1), i.checked_sub(self.width), Some(i + self.width)];
        beside.into_iter().flatten().any(|k| self.seen.get(k) == Some(&true))
    }

    /// Share of the pixels that are seen, 0..=1; 0 without any.
    pub(crate) fn share(&self) -> f64 {
        let own = (0..self.own.len()).filter(|&i| self.own[i]);
        let (all, seen) = own.fold((0usize, 0usize), |(all, seen), i| (all + 1, seen + usize::from(self.is_seen(i))));
        seen as f64 / all.max(1) as f64
    }
}

/// Visible share, 0..=1, of the session's tracked target in a picture; `None` if it tracks none, or one without pixels of its own, such
/// as a point.
///
/// * `frame`: the picture drawn through `view`.
///
/// # Errors
/// Those of `draw`, [`BelvedereError::Target`].
pub(crate) fn of_session(
    session: &Session,
    (view, frame): (&View, &Frame),
    draw: &dyn Fn(&Scene, &View) -> Result<Frame, BelvedereError>,
) -> Result<Option<f64>, BelvedereError> {
    let Some(source) = session.resolved.description.as_ref().map(|d| &d.source) else { return Ok(None) };
    let doc = source.document.constructor.as_ref().filter(|_| constructor::tracks_target(source));
    let Some(name) = doc.and_then(|doc| doc.target.as_deref()) else { return Ok(None) };
    let target = targets::target(session.scene(), name)?;
    let Some(alone) = occluders::target_alone(session.scene(), &target) else { return Ok(None) };
    let whole = with_opaque_target(session.scene(), &target).map(|scene| draw(&scene, view)).transpose()?;
    Ok(Some(share(&target, whole.as_ref().unwrap_or(frame), &draw(&alone, view)?).1))
}
