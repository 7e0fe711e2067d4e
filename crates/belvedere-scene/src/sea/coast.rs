//! Coast lines: where the drawn ground rises out of the sea.

use crate::{Heightfield, NodeState};
use belvedere_core::DVec2;
use std::collections::HashMap;

/// Height of the ground over the sea at a coast line, metres.
const COAST_M: f64 = 0.5;
/// Least and largest distance of a coast line from a node of the sea towards one of the land, as a share of their distance.
const BETWEEN: [f64; 2] = [0.12, 0.5];
/// Rounds of cutting corners; fewer where a coast has very many.
const ROUNDS: usize = 2;
const MANY_CORNERS: usize = 400_000;
/// Nodes by which the sea is extended outside the ground, so that no coast runs along its edge.
const BEYOND: usize = 2;

/// A side between two nodes next to each other, by the node that comes first and whether the other lies to the east.
type Side = (usize, bool);

/// Rings around the nodes of the sea, scene positions.
pub(super) fn rings(ground: &Heightfield, sea: &[bool], level: f64) -> Vec<Vec<DVec2>> {
    let padded = Padded::new(ground, sea);
    let next = padded.steps();
    let mut starts: Vec<Side> = next.keys().copied().collect();
    // The iteration order of a hash map is not deterministic.
    starts.sort_unstable();
    let (mut next, mut rings) = (next, Vec::new());
    for start in starts {
        let (mut ring, mut at) = (Vec::new(), start);
        while let Some(to) = next.remove(&at) {
            ring.push(padded.place(ground, at, level));
            at = to;
        }
        if ring.len() >= 3 {
            rings.push(ring);
        }
    }
    let rounds = if rings.iter().map(Vec::len).sum::<usize>() > MANY_CORNERS { 0 } else { ROUNDS };
    rings.into_iter().map(|ring| (0..rounds).fold(ring, |ring, _| cut(&ring))).collect()
}

/// A closed line with its corners cut off: two points on every edge (Chaikin 1974).
fn cut(ring: &[DVec2]) -> Vec<DVec2> {
    let edges = ring.iter().zip(ring.iter().cycle().skip(1));
    edges.flat_map(|(a, b)| [a.lerp(*b, 0.25), a.lerp(*b, 0.75)]).collect()
}

/// The nodes of the sea with a margin around the ground.
struct Padded {
    cols: usize,
    rows: usize,
    sea: Vec<bool>,
}

impl Padded {
    fn new(ground: &Heightfield, sea: &[bool]) -> Self {
        let margin = BEYOND + 1;
        let (cols, rows) = (ground.cols() + 2 * margin, ground.rows() + 2 * margin);
        let mut out = Self { cols, rows, sea: vec![false; cols * rows] };
        for (i, _) in sea.iter().enumerate().filter(|(_, sea)| **sea) {
            out.sea[(i / ground.cols() + margin) * cols + i % ground.cols() + margin] = true;
        }
        // Extends the sea into voids and over the edge of the ground.
        for _ in 0..BEYOND {
            let before = out.sea.clone();
            for r in 1..rows - 1 {
                for c in 1..cols - 1 {
                    let i = r * cols + c;
                    let near =
                        || [i - cols - 1, i - cols, i - cols + 1, i - 1, i + 1, i + cols - 1, i + cols, i + cols + 1];
                    if !before[i] && out.is_nowhere(ground, i) && near().iter().any(|k| before[*k]) {
                        out.sea[i] = true;
                    }
                }
            }
        }
        out
    }

    /// Index in the ground of a padded node; `None` outside the ground.
    fn node(&self, ground: &Heightfield, i: usize) -> Option<usize> {
        let (c, r) = ((i % self.cols).checked_sub(BEYOND + 1)?, (i / self.cols).checked_sub(BEYOND + 1)?);
        (c < ground.cols() && r < ground.rows()).then(|| r * ground.cols() + c)
    }

    /// Whether a padded node is a void, or lies outside the ground.
    fn is_nowhere(&self, ground: &Heightfield, i: usize) -> bool {
        self.node(ground, i).is_none_or(|i| ground.states()[i] == NodeState::Void)
    }

    /// Steps of the coast line from side to side (marching squares), the sea to the left, through every square of unlike nodes.
    fn steps(&self) -> HashMap<Side, Side> {
        let mut steps = HashMap::new();
        for r in 0..self.rows - 1 {
            for c in 0..self.cols - 1 {
                let nw = r * self.cols + c;
                let corners = [nw, nw + 1, nw + self.cols + 1, nw + self.cols].map(|i| self.sea[i]);
                // Sides between the corners, clockwise from the northern one.
                let sides = [(nw, true), (nw + 1, false), (nw + self.cols, true), (nw, false)];
                // Clockwise, a line comes in where sea begins, and goes out where it ends: land and sea at opposite corners stay apart.
                for k in (0..4).filter(|k| !corners[*k] && corners[(k + 1) % 4]) {
                    let end = (1..4).map(|n| (k + n) % 4).find(|j| corners[*j] && !corners[(j + 1) % 4]);
                    steps.extend(end.map(|end| (sides[k], sides[end])));
                }
            }
        }
        steps
    }

    /// Scene position at which the coast line crosses a side.
    fn place(&self, ground: &Heightfield, (first, east): Side, level: f64) -> DVec2 {
        let second = if east { first + 1 } else { first + self.cols };
        let (water, land) = if self.sea[first] { (first, second) } else { (second, first) };
        let over = self.node(ground, land).map_or(1.0, |i| f64::from(ground.heights()[i]) - level);
        let share = if over > 0.0 { (COAST_M / over).clamp(BETWEEN[0], BETWEEN[1]) } else { BETWEEN[1] };
        let at = |i: usize| {
            let place = DVec2::new((i % self.cols) as f64, (i / self.cols) as f64) - (BEYOND + 1) as f64;
            ground.north_west() + DVec2::new(place.x, -place.y) * ground.spacing()
        };
        at(water).lerp(at(land), share)
    }
}
