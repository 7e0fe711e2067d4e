//! The nearest valid camera to one that is not.

use super::CurvedRays;
use super::build::Chain;
use super::check::corner_pixels;
use super::nearest::{Way, heals_well, nearest_turn, valid_turn};
use super::spec::{CurvedRaysError, Model, Pencil, Remedy, Sharpness, TurnSpec};
use crate::Pinhole;
use glam::DVec3;

/// Changes of a camera per turn, at most.
const MOST_CHANGES: usize = 24;
/// Share of a viewpoint's distance from the eye at which it stands after turns were made gentler once.
const GENTLER: f64 = 0.8;

/// A camera that was made valid.
#[derive(Debug, Clone)]
pub struct Mended {
    /// The valid camera.
    pub rays: CurvedRays,
    /// What was wrong, and what was done, in order; empty for a camera that was valid.
    pub changes: Vec<CurvedRaysError>,
}

impl CurvedRays {
    /// The camera of [`CurvedRays::new`], or a valid one near it: as long as something is wrong, what its error names as the nearest valid
    /// value is set; where that does not help, the turn becomes the nearest valid one on the way to a turn with parallel planes across the
    /// axis of the rays. `None` for an orthographic root, and where no such camera is valid.
    pub fn mended(root: &Pinhole, model: Model, turns: &[TurnSpec]) -> Option<Mended> {
        let (mut root, mut model, mut turns) = (root.clone(), model, turns.to_vec());
        let corners = corner_pixels(&root);
        let (mut changes, mut last) = (Vec::new(), None);
        loop {
            let mut chain = Chain::new(&root, model, &corners, true).ok()?;
            let wrong = turns.iter().enumerate().find_map(|(k, turn)| chain.add(turn).err().map(|e| (k, e)));
            let Some((k, error)) = wrong else { return Some(Mended { rays: chain.finish(), changes }) };
            let context = chain.context();
            let again = last.replace(k) == Some(k) && changes.len() > 2;
            let (near, other) = match error.remedy() {
                // The same turn may need several values; if it needs many it is made anew.
                _ if changes.last() == Some(&error) => (None, valid_turn(&turns[k], &context, Way::End)),
                _ if again && changes.len() % 4 == 3 => (None, nearest_turn(&turns[k], &context)),
                Some(Remedy::Near { near }) => (Some(*near), None),
                Some(Remedy::Shrink { factor }) if k > 0 => {
                    turns[k - 1] = narrower(&turns[k - 1], *factor);
                    (None, Some(narrower(&turns[k], *factor)))
                }
                Some(Remedy::OtherModel) => {
                    model = Model::Modified;
                    (None, Some(turns[k]))
                }
                Some(remedy) => {
                    // A value that makes the turn only just valid leaves no room for the turns behind it.
                    let one = applied(remedy, &turns[k]);
                    let is_last = k + 1 == turns.len();
                    let good = one.filter(|turn| is_last || heals_well(turn, &context));
                    (None, good.or_else(|| nearest_turn(&turns[k], &context)).or(one))
                }
                None => (None, nearest_turn(&turns[k], &context)),
            };
            match (near, other) {
                (Some(near), _) => root.near = near,
                (None, Some(turn)) => turns[k] = turn,
                // The rays that come to the turn go too far apart: the turns before it become gentler.
                (None, None) if k > 0 => gentler(&mut turns[..k], root.eye),
                (None, None) => return None,
            }
            changes.push(error);
            if changes.len() > MOST_CHANGES * turns.len() {
                return None;
            }
        }
    }
}

/// A turn with the value that a remedy names.
fn applied(remedy: &Remedy, spec: &TurnSpec) -> Option<TurnSpec> {
    let mut turn = *spec;
    match (remedy, &mut turn.pencil) {
        (Remedy::MovePoint { name: "line.point", to }, Pencil::Line { point, .. }) => *point = *to,
        (Remedy::MovePoint { name, to }, _) => match *name {
            "t0" => turn.t0 = *to,
            "t2" => turn.t2 = *to,
            "viewpoint" => turn.viewpoint = *to,
            _ => return None,
        },
        (Remedy::MovePlanes { by }, _) => {
            [&mut turn.t0, &mut turn.t1, &mut turn.t2].into_iter().for_each(|t| *t += *by)
        }
        (Remedy::Normal { normal }, _) => turn.pencil = Pencil::Parallel { normal: *normal },
        (Remedy::SwapPlanes, _) => std::mem::swap(&mut turn.t0, &mut turn.t2),
        (Remedy::BendInPicture, _) => turn.m = Sharpness::Value(1.0),
        (Remedy::Turn { turn: other }, _) => turn = **other,
        _ => return None,
    }
    Some(turn)
}

/// A turn whose t0 and t2 are nearer to its t1.
fn narrower(spec: &TurnSpec, factor: f64) -> TurnSpec {
    TurnSpec { t0: spec.t1.lerp(spec.t0, factor), t2: spec.t1.lerp(spec.t2, factor), ..*spec }
}

/// Brings viewpoints nearer to the eye.
fn gentler(turns: &mut [TurnSpec], eye: DVec3) {
    turns.iter_mut().for_each(|turn| *turn = turn.eased(eye, GENTLER));
}
