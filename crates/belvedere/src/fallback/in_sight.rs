//! Visible share of a target in a picture, pixel by pixel.

use super::{Draw, SAME_DEPTH, occluders};
use crate::{BelvedereError, Session};
use belvedere_construct::rays::Target;
use belvedere_core::{DVec2, DVec3, View};
use belvedere_resolve::constructor;
use belvedere_resolve::targets;
use belvedere_scene::{Frame, Scene};

/// Number of the part of a city's mesh that is its level ground.
const PLATE: u32 = 0;

/// Whether an id of a picture is that of the target's layer.
pub(super) fn is_target(target: &Target, id: u32) -> bool {
    let is = |layer: usize| id as usize == layer + 1;
    target.own_layers.iter().any(|&layer| is(layer)) || target.own_parts.as_ref().is_some_and(|p| is(p.0))
}

/// The scene with its target opaque; `None` where it is. Ids and depths are those of what hides, so a target that something shines
/// through is looked for in a picture of this scene.
pub(super) fn with_opaque_target(scene: &Scene, target: &Target) -> Option<Scene> {
    let is_own = |i: usize| is_target(target, i as u32 + 1) && scene.layers[i].kind.is_see_through();
    let own: Vec<usize> = (0..scene.layers.len()).filter(|i| is_own(*i)).collect();
    if own.is_empty() {
        return None;
    }
    let mut scene = scene.clone();
    own.into_iter().for_each(|i| scene.layers[i].kind.set_opacity(1.0));
    Some(scene)
}

/// How much of a target pictures show: of the pixels that it fills where it is drawn alone, those that show it. The one judge of targets that
/// have a surface: it decides whether a bend or a fallback is needed, and it is what reports say.
pub(crate) struct Judge {
    target: Target,
    alone: Scene,
    /// The target with the ground on which it stands, if that is drawn with it.
    ground: Option<Scene>,
    opaque: Option<Scene>,
}

impl Judge {
    /// `None` for points and lines, which have no surface of their own.
    ///
    /// * `on_ground`: the target with the ground on which it stands, or the target again.
    pub(crate) fn of(scene: &Scene, target: &Target, on_ground: &Target) -> Option<Self> {
        let alone = occluders::target_alone(scene, target)?;
        let ground = if on_ground == target { None } else { occluders::target_alone(scene, on_ground) };
        Some(Self { target: target.clone(), alone, ground, opaque: with_opaque_target(scene, target) })
    }

    /// The same of a target by itself: parts of a mesh with a plate stand on it.
    pub(crate) fn of_target(scene: &Scene, target: &Target) -> Option<Self> {
        let mut on_ground = target.clone();
        if let Some((layer, parts)) = &mut on_ground.own_parts
            && scene.layers[*layer].kind.mesh().is_some_and(|mesh| mesh.has_plate)
            && parts.first() != Some(&PLATE)
        {
            parts.insert(0, PLATE);
        }
        Self::of(scene, target, &on_ground)
    }

    /// Judges a picture in which the target is opaque.
    ///
    /// # Errors
    /// Those of `draw`.
    pub(super) fn opaque_in(&self, frame: &Frame, view: &View, draw: &Draw<'_>) -> Result<Mask, BelvedereError> {
        let above = self.ground.as_ref().map(|scene| draw(scene, view)).transpose()?;
        Ok(Mask::of(&self.target, frame, &draw(&self.alone, view)?, above.as_ref()))
    }

    /// Judges the picture of a scene through a view.
    ///
    /// * `frame`: that picture, where it is drawn already; `draw`: draws a scene in a view as that picture was drawn.
    ///
    /// # Errors
    /// Those of `draw`.
    pub(crate) fn mask(
        &self,
        (scene, frame): (&Scene, Option<&Frame>),
        view: &View,
        draw: &Draw<'_>,
    ) -> Result<Mask, BelvedereError> {
        match (&self.opaque, frame) {
            (None, Some(frame)) => self.opaque_in(frame, view, draw),
            (opaque, _) => self.opaque_in(&draw(opaque.as_ref().unwrap_or(scene), view)?, view, draw),
        }
    }
}

/// The pixels that a target fills where it is drawn alone, and those of them that a picture shows.
pub(crate) struct Mask {
    /// Whether a pixel is one of the target's, row by row.
    pub(crate) own: Vec<bool>,
    /// Whether the picture shows the target there.
    pub(crate) seen: Vec<bool>,
    /// Depths of the target alone.
    depth: Vec<f32>,
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
        Self { own, seen, depth: alone.depth.clone(), width: frame.width }
    }

    /// Whether the picture shows the target at a pixel or beside it: its rim shares pixels with what is behind.
    fn is_seen(&self, i: usize) -> bool {
        let beside = [Some(i), i.checked_sub(1), Some(i + 1), i.checked_sub(self.width), Some(i + self.width)];
        beside.into_iter().flatten().any(|k| self.seen.get(k) == Some(&true))
    }

    /// Number of the target's pixels.
    pub(crate) fn pixels(&self) -> usize {
        self.own.iter().filter(|own| **own).count()
    }

    /// Share of the pixels that are seen, 0..=1; 0 without any.
    pub(crate) fn share(&self) -> f64 {
        let seen = (0..self.own.len()).filter(|&i| self.own[i] && self.is_seen(i)).count();
        seen as f64 / self.pixels().max(1) as f64
    }

    /// Places on the target that the picture hides, evenly chosen.
    ///
    /// * `view`: that of the picture; `most`: their number, at most.
    pub(crate) fn hidden(&self, view: &View, most: usize) -> Vec<DVec3> {
        let hidden: Vec<usize> = (0..self.own.len()).filter(|&i| self.own[i] && !self.is_seen(i)).collect();
        let every = hidden.len().div_ceil(most.max(1)).max(1);
        let place = |&i: &usize| {
            let pixel = DVec2::new((i % self.width) as f64 + 0.5, (i / self.width) as f64 + 0.5);
            view.ray(pixel).at(f64::from(self.depth[i])).ok().map(|at| at.point)
        };
        hidden.iter().skip(every / 2).step_by(every).filter_map(place).collect()
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
    let Some(judge) = Judge::of(session.scene(), &target, &target) else { return Ok(None) };
    Ok(Some(judge.mask((session.scene(), Some(frame)), view, draw)?.share()))
}
