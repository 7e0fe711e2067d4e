//! A line of sight that is followed by itself: one that bends, or one without neighbours.

use super::candidate_line::CandidateLine;
use super::rise::Rise;
use super::surface::Surface;
use super::walk::{Clearance, Touch};

/// If the room is more than this many times the greatest rise, that rise is subtracted without looking up the rise along the line.
const AMPLE: f64 = 8.0;

/// The line of one candidate.
#[derive(Debug, Clone)]
pub(super) struct SingleLine {
    member: usize,
    /// For each chord, height by which the ground may rise towards it before a position can be missed, scene units; negative if not known.
    rooms: Vec<f64>,
}

impl SingleLine {
    /// * `member`: index of the candidate.
    pub(super) fn new(member: usize, seen: &CandidateLine) -> Self {
        Self { member, rooms: vec![-1.0; seen.chords.len()] }
    }

    /// Updates the rooms after a change of the displacement: subtracts bounds of the rise of the ground and of the fall of the line.
    pub(super) fn moved(&mut self, seen: &[CandidateLine], rise: &Rise) {
        let seen = &seen[self.member];
        let sank = (-seen.displacement(rise.change)).max(0.0);
        for (room, chord) in self.rooms.iter_mut().zip(seen.chords.iter()).filter(|(room, _)| **room > 0.0) {
            let ample = *room > AMPLE * (sank + rise.greatest);
            *room -= sank + if ample { rise.greatest } else { rise.along([chord.ends[0]; 2], [chord.ends[1]; 2]) };
        }
    }

    /// All positions where the required clearance is missed; chords with room left are skipped.
    pub(super) fn walk(
        &mut self,
        seen: &[CandidateLine],
        surface: &Surface,
        clearance: &Clearance,
    ) -> Vec<(usize, Touch)> {
        let (seen, member, mut touches) = (&seen[self.member], self.member, Vec::new());
        for (room, chord) in self.rooms.iter_mut().zip(seen.line(seen.displacement(&surface.u))) {
            if *room > 0.0 {
                continue;
            }
            *room = f64::INFINITY;
            let Some(part) = chord.part(surface, seen.grid, clearance.guard) else { continue };
            let before = touches.len();
            for end in chord.ends_of(surface, part, clearance) {
                match end {
                    Ok(touch) => touches.push((member, touch)),
                    Err(left) => *room = room.min(left),
                }
            }
            chord.walk(surface, part, clearance, room, &mut |touch| touches.push((member, touch)));
            if touches.len() > before {
                *room = -1.0;
            }
        }
        touches
    }
}

#[cfg(test)]
mod tests;
