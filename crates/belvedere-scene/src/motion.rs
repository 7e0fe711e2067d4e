//! Layers that move.

use crate::{BoxShape, LayerKind, Placement};
use belvedere_core::DVec3;
use std::f64::consts::{PI, TAU};

/// Placements at times, interpolated linearly (yaw by the shorter turn), constant before the first and after the last.
#[derive(Debug, Clone, PartialEq)]
pub struct Motion {
    keys: Vec<(f64, Placement)>,
}

/// Errors of a motion.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum MotionError {
    /// There is no placement.
    #[error("a motion needs at least one row of t, x, y, z, yaw_deg")]
    Empty,
    /// A time or placement is not finite.
    #[error("row {row} of a motion holds a number that is not finite; repair it")]
    NotFinite {
        /// From 1.
        row: usize,
    },
    /// The times do not rise.
    #[error("row {row} of a motion is at {t} s, after {before} s; times must rise")]
    Order {
        /// From 1.
        row: usize,
        /// Its time, seconds.
        t: f64,
        /// The time of the row before, seconds.
        before: f64,
    },
}

impl Motion {
    /// Placements at rising times, seconds.
    ///
    /// # Errors
    /// [`MotionError`].
    pub fn new(keys: Vec<(f64, Placement)>) -> Result<Self, MotionError> {
        if keys.is_empty() {
            return Err(MotionError::Empty);
        }
        for (i, (t, at)) in keys.iter().enumerate() {
            if !(t.is_finite() && at.translate.is_finite() && at.yaw.is_finite()) {
                return Err(MotionError::NotFinite { row: i + 1 });
            }
            if let Some(before) = i.checked_sub(1).map(|k| keys[k].0).filter(|before| t <= before) {
                return Err(MotionError::Order { row: i + 1, t: *t, before });
            }
        }
        Ok(Self { keys })
    }

    /// Placement at time `t`, seconds.
    pub fn at(&self, t: f64) -> Placement {
        let after = self.keys.partition_point(|(at, _)| *at <= t);
        let last = self.keys.len() - 1;
        let (Some(i), true) = (after.checked_sub(1), after <= last) else {
            return self.keys[after.min(last)].1;
        };
        let ((t0, a), (t1, b)) = (self.keys[i], self.keys[after]);
        let share = (t - t0) / (t1 - t0);
        let turn = (b.yaw - a.yaw + PI).rem_euclid(TAU) - PI;
        Placement { translate: a.translate.lerp(b.translate, share), yaw: a.yaw + share * turn }
    }

    /// Time of the last placement, seconds.
    pub fn end(&self) -> f64 {
        self.keys[self.keys.len() - 1].0
    }

    /// Positions of the layer's origin at all times, scene coordinates.
    pub fn path(&self) -> Vec<DVec3> {
        self.keys.iter().map(|(_, at)| at.translate).collect()
    }
}

impl LayerKind {
    /// The layer at a placement; `None` for kinds that cannot move.
    pub fn placed(&self, at: &Placement) -> Option<Self> {
        match self {
            Self::Boxes(layer) => {
                let place = |b: &BoxShape| BoxShape { base: at.apply(b.base), yaw: b.yaw + at.yaw, ..*b };
                let mut layer = layer.clone();
                layer.boxes.iter_mut().for_each(|b| *b = place(b));
                Some(Self::Boxes(layer))
            }
            Self::Mesh(_) | Self::Own(_) => {
                let mut placed = self.clone();
                placed.mesh_mut().into_iter().for_each(|layer| layer.mesh = layer.mesh.placed(at));
                Some(placed)
            }
            Self::Molecule(layer) => {
                let mut placed = layer.clone();
                placed.surface.mesh = layer.surface.mesh.placed(at);
                placed.placement = layer.placement.placed(at);
                Some(Self::Molecule(placed))
            }
            _ => None,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{BoxLayer, Color, Mesh, MeshColors, MeshLayer};

    fn key(t: f64, x: f64, yaw_deg: f64) -> (f64, Placement) {
        (t, Placement { translate: DVec3::new(x, 0.0, 1.0), yaw: yaw_deg.to_radians() })
    }

    #[test]
    fn a_motion_is_even_between_its_rows_and_rests_outside() {
        let motion = Motion::new(vec![key(1.0, 0.0, 170.0), key(3.0, 10.0, -170.0), key(4.0, 10.0, 0.0)]).unwrap();
        assert_eq!(motion.at(-5.0), motion.at(1.0));
        assert_eq!(motion.at(99.0).translate.x, 10.0);
        let middle = motion.at(2.0);
        assert_eq!(middle.translate, DVec3::new(5.0, 0.0, 1.0));
        assert!((middle.yaw.to_degrees() - 180.0).abs() < 1e-9, "turns the shorter way: {}", middle.yaw.to_degrees());
        assert_eq!(motion.end(), 4.0);
        let two = Motion::new(vec![key(1.0, 0.0, 0.0), key(1.0, 1.0, 0.0)]).unwrap_err().to_string();
        assert!(two.contains("row 2") && two.contains("rise"), "{two}");
        assert!(Motion::new(vec![key(f64::NAN, 0.0, 0.0)]).is_err() && Motion::new(Vec::new()).is_err());
    }

    #[test]
    fn boxes_and_meshes_move_alike() {
        let shape =
            BoxShape { base: DVec3::ZERO, size: DVec3::new(4.0, 2.0, 1.0), yaw: 0.0, color: Color::rgb(1, 2, 3) };
        let corners = shape.corners();
        let mesh = Mesh::new(&corners, vec![[0, 1, 2], [4, 5, 6]], MeshColors::Layer).unwrap();
        let at = Placement { translate: DVec3::new(5e5, 4.7e6, 100.0), yaw: 0.7 };
        let boxes = LayerKind::Boxes(BoxLayer::new(vec![shape])).placed(&at).unwrap();
        let mesh = LayerKind::Mesh(MeshLayer::new(mesh, Color::rgb(1, 2, 3))).placed(&at).unwrap();
        let (LayerKind::Boxes(boxes), LayerKind::Mesh(mesh)) = (boxes, mesh) else { panic!("the kind stays") };
        for (i, corner) in boxes.boxes[0].corners().into_iter().enumerate().take(7) {
            assert!(mesh.mesh.vertex(i as u32).distance(corner) < 1e-5, "corner {i}");
        }
    }
}
