//! The cheapest path of a second viewpoint through the frames of a film: a shortest path (Bellman 1957) over frames and positions on
//! a disc.
//!
//! Ours. Positions lie on rings around the middle of the disc of radius 1 across the view, so that f can rest while its direction
//! turns. The last senses of motion, outwards or inwards and round, are part of the state, so that turning round has a price.

use rayon::prelude::*;

/// Rings around the middle, at most: all states fit 16 bits.
const RINGS: usize = 40;
/// Positions on the first ring; every further ring has this many more, so that the axes and diagonals are among them.
pub(super) const PER_RING: usize = 8;
/// Distance of rings that is aimed at, share of the radius of the disc.
const CELL: f64 = 0.05;
/// Cost of turning round; moving by 1 costs 1.
const TURN: f64 = 1.0;
/// Senses of the last motion: bit 0 outwards, bit 1 counterclockwise; in the middle the number of the axis that it was reached along.
const SENSES: usize = 4;
const AXES: [[f64; 2]; SENSES] = [[1.0, 0.0], [0.0, 1.0], [-1.0, 0.0], [0.0, -1.0]];

/// Positions of the second viewpoint, and the moves from one to another.
#[derive(Debug, Clone)]
pub(super) struct Disc {
    /// Offset of each to the right and upwards, shares of `a`.
    pub(super) places: Vec<[f64; 2]>,
    /// Frames from one move to the next.
    pub(super) stride: usize,
    /// For every position the moves that end there.
    moves: Vec<Vec<Move>>,
}

/// A move to a position.
#[derive(Debug, Clone, Copy)]
struct Move {
    from: usize,
    cost: f64,
    kind: Kind,
}

#[derive(Debug, Clone, Copy, PartialEq)]
enum Kind {
    Stay,
    /// Along or beside the rings: signs of the motion outwards and round.
    Aside([i8; 2]),
    /// Straight over the middle to the other side.
    Across,
    /// To the middle, along this axis.
    In(usize),
    /// From the middle; for every axis along which the middle was reached, whether the move goes back to that side.
    Out([bool; SENSES]),
}

impl Disc {
    /// * `per_frame`: greatest distance that a position may move in a frame, > 0; `sideways`: whether only the line to the left and
    ///   right is used.
    pub(super) fn new(per_frame: f64, sideways: bool) -> Self {
        // Slow viewpoints move every few frames by a cell that is not too fine.
        let stride = (CELL / per_frame * (1.0 - 1e-9)).ceil().clamp(1.0, 1e6) as usize;
        let most = per_frame * stride as f64;
        let cell = match most {
            _ if most < 2.0 * CELL => 0.5 * most,
            _ if most < 8.0 * CELL => most / (most / CELL).ceil(),
            _ => 2.0 * CELL,
        };
        let rings = ((1.0 / cell * (1.0 + 1e-9)) as usize).min(RINGS);
        let places: Vec<(usize, [f64; 2])> = std::iter::once((0, [0.0; 2]))
            .chain((1..=rings).flat_map(|ring| {
                let share = cell * rings as f64;
                on_ring(ring, rings).map(move |place| (ring, place.map(|v| v * share)))
            }))
            .filter(|(_, place)| !sideways || place[1] == 0.0)
            .collect();
        let moves = |to: &(usize, [f64; 2])| {
            let reach = most * (1.0 + 1e-9);
            let near = places.iter().enumerate().filter(|(_, from)| distance(from.1, to.1) <= reach);
            near.map(|(number, from)| Move::new((number, *from), *to, cell)).collect()
        };
        let moves = places.par_iter().map(moves).collect();
        Self { places: places.into_iter().map(|(_, place)| place).collect(), stride, moves }
    }

    /// The cheapest path: its cost, and the number of its position at every knot.
    ///
    /// * `cost`: cost of each position at a knot.
    pub(super) fn cheapest(&self, knots: usize, cost: impl Fn(usize) -> Vec<f64>) -> (f64, Vec<usize>) {
        let mut total: Vec<[f64; SENSES]> = Vec::new();
        let mut parents: Vec<Vec<[u16; SENSES]>> = Vec::new();
        for knot in 0..knots {
            let own = cost(knot);
            let step = |number: usize| {
                if knot == 0 {
                    return ([own[number]; SENSES], [0u16; SENSES]);
                }
                let mut best = ([f64::INFINITY; SENSES], [0u16; SENSES]);
                for by in &self.moves[number] {
                    for (sense, before) in total[by.from].iter().enumerate() {
                        let (now, turns) = by.kind.sense_after(sense);
                        let sum = before + by.cost + TURN * f64::from(turns);
                        for now in now {
                            if sum < best.0[now] {
                                best.0[now] = sum;
                                best.1[now] = (by.from * SENSES + sense) as u16;
                            }
                        }
                    }
                }
                (best.0.map(|sum| sum + own[number]), best.1)
            };
            let next: Vec<_> = (0..self.places.len()).into_par_iter().map(step).collect();
            total = next.iter().map(|(sums, _)| *sums).collect();
            parents.push(next.into_iter().map(|(_, from)| from).collect());
        }
        let states = (0..total.len() * SENSES).map(|s| (total[s / SENSES][s % SENSES], s));
        let Some((least, mut state)) = states.min_by(|a, b| a.0.total_cmp(&b.0)) else { return (0.0, Vec::new()) };
        let mut way = Vec::with_capacity(knots);
        for parents in parents.iter().rev() {
            way.push(state / SENSES);
            state = usize::from(parents[state / SENSES][state % SENSES]);
        }
        way.reverse();
        (least, way)
    }
}

impl Move {
    fn new((number, from): (usize, (usize, [f64; 2])), to: (usize, [f64; 2]), cell: f64) -> Self {
        let length = distance(from.1, to.1);
        // Of two paths of the same length the one with shorter steps is cheaper.
        let cost = length * (1.0 + 0.02 * length / cell);
        let round = from.1[0] * to.1[1] - from.1[1] * to.1[0];
        let along = dot(from.1, to.1);
        let is_straight = round.abs() <= 1e-9;
        let kind = match (from.0, to.0) {
            (0, 0) => Kind::Stay,
            (0, _) => Kind::Out(AXES.map(|axis| dot(axis, to.1) > -1e-9)),
            (_, 0) => Kind::In(
                (0..SENSES).max_by(|a, b| dot(AXES[*a], from.1).total_cmp(&dot(AXES[*b], from.1))).unwrap_or(0),
            ),
            _ if is_straight && along < 0.0 => Kind::Across,
            (a, b) => Kind::Aside([sign(b as f64 - a as f64), if is_straight { 0 } else { sign(round) }]),
        };
        Self { from: number, cost, kind }
    }
}

impl Kind {
    /// The senses after a move, two that are possible, and the number of senses that the move reverses.
    fn sense_after(self, before: usize) -> ([usize; 2], u32) {
        match self {
            Kind::Stay => ([before; 2], 0),
            Kind::Out(back) => ([1, 3], u32::from(back[before])),
            Kind::In(axis) => ([axis; 2], before as u32 & 1),
            Kind::Across => ([before | 1; 2], before as u32 & 1),
            Kind::Aside(signs) => {
                let mut now = before;
                for (bit, sign) in signs.into_iter().enumerate() {
                    match sign {
                        1 => now |= 1 << bit,
                        -1 => now &= !(1 << bit),
                        _ => {}
                    }
                }
                ([now; 2], (before ^ now).count_ones())
            }
        }
    }
}

/// Positions on one of `rings` rings, from the right counterclockwise, shares of the radius of the last.
pub(super) fn on_ring(ring: usize, rings: usize) -> impl Iterator<Item = [f64; 2]> {
    let count = PER_RING * ring;
    (0..count).map(move |k| direction(k, count).map(|v| v * (ring as f64 / rings as f64)))
}

/// Unit vector, exact along the axes; `count` is a multiple of 4.
fn direction(k: usize, count: usize) -> [f64; 2] {
    if (4 * k).is_multiple_of(count) {
        return AXES[4 * k / count];
    }
    let (sin, cos) = (std::f64::consts::TAU * k as f64 / count as f64).sin_cos();
    [cos, sin]
}

fn dot(a: [f64; 2], b: [f64; 2]) -> f64 {
    a[0] * b[0] + a[1] * b[1]
}

fn distance(a: [f64; 2], b: [f64; 2]) -> f64 {
    (a[0] - b[0]).hypot(a[1] - b[1])
}

fn sign(x: f64) -> i8 {
    i8::from(x > 0.0) - i8::from(x < 0.0)
}

#[cfg(test)]
mod tests;
