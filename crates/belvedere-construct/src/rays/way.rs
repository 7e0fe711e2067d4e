//! The cheapest way of a second viewpoint through the frames of a film: a shortest path (Bellman 1957) over frames and places on a disc.
//!
//! Ours. A place is a cell of a square grid on the disc of radius 1 across the view. The last sense of motion along either axis is
//! part of the state, so that turning round has a price.

use rayon::prelude::*;

/// Cells from the middle of the disc to its rim, at most: all states fit 16 bits.
const MOST: usize = 40;
/// Width of a cell that is fine enough.
const CELL: f64 = 0.05;
/// Cost of turning round; moving by 1 costs 1.
const TURN: f64 = 1.0;
/// Senses of the last motion: bit 0 to the right, bit 1 upwards.
const SENSES: usize = 4;

/// Places of the second viewpoint, and how far it may go from one to another.
#[derive(Debug, Clone)]
pub(super) struct Disc {
    /// Width of a cell.
    pub(super) cell: f64,
    /// Column and row, from the middle.
    pub(super) places: Vec<[i32; 2]>,
    /// Frames from one move to the next.
    pub(super) stride: usize,
    rim: i32,
    moves: Vec<[i32; 2]>,
}

impl Disc {
    /// * `per_frame`: the most that a place may move in a frame, > 0; `sideways`: whether only the middle row is used.
    pub(super) fn new(per_frame: f64, sideways: bool) -> Self {
        // Slow viewpoints move every few frames by a cell that is not too fine.
        let stride = (CELL / per_frame * (1.0 - 1e-9)).ceil().clamp(1.0, 1e6) as usize;
        let most = per_frame * stride as f64;
        let cell = match most {
            _ if most < 2.0 * CELL => 0.5 * most,
            _ if most < 8.0 * CELL => most / (most / CELL).ceil(),
            _ => 2.0 * CELL,
        };
        let rim = ((1.0 / cell * (1.0 + 1e-9)) as usize).min(MOST) as i32;
        let reach = (most / cell * (1.0 + 1e-9)).min(2.0 * f64::from(rim)) as i32;
        let within = |r: i32| {
            let rows = if sideways { 0..=0 } else { -r..=r };
            rows.flat_map(move |y| (-r..=r).map(move |x| [x, y])).filter(move |[x, y]| x * x + y * y <= r * r)
        };
        Self { cell, places: within(rim).collect(), stride, rim, moves: within(reach).collect() }
    }

    /// Number of a place on the square around the disc.
    fn slot(&self, [x, y]: [i32; 2]) -> Option<usize> {
        let width = 2 * self.rim + 1;
        (x.abs() <= self.rim && y.abs() <= self.rim).then(|| ((y + self.rim) * width + x + self.rim) as usize)
    }

    /// The cheapest way: its cost, and the place of every knot by its number.
    ///
    /// * `cost`: what each place costs at a knot.
    pub(super) fn cheapest(&self, knots: usize, cost: impl Fn(usize) -> Vec<f64>) -> (f64, Vec<usize>) {
        let mut numbers = vec![None; ((2 * self.rim + 1) * (2 * self.rim + 1)) as usize];
        for (number, place) in self.places.iter().enumerate() {
            if let Some(slot) = self.slot(*place) {
                numbers[slot] = Some(number);
            }
        }
        let mut total: Vec<[f64; SENSES]> = vec![[0.0; SENSES]; self.places.len()];
        let mut parents: Vec<Vec<[u16; SENSES]>> = Vec::new();
        for knot in 0..knots {
            let own = cost(knot);
            let step = |number: usize| {
                let mut best = ([f64::INFINITY; SENSES], [0u16; SENSES]);
                for by in if knot == 0 { &[[0, 0]][..] } else { &self.moves } {
                    let [x, y] = self.places[number];
                    let from = self.slot([x - by[0], y - by[1]]).and_then(|slot| numbers[slot]);
                    let Some(from) = from else { continue };
                    let length = f64::from(by[0] * by[0] + by[1] * by[1]).sqrt();
                    // Of two ways of the same length the slower one.
                    let way = self.cell * length * (1.0 + 0.02 * length);
                    for (sense, before) in total[from].iter().enumerate() {
                        let (now, turns) = sense_after(sense, *by);
                        let sum = before + way + TURN * f64::from(turns);
                        if sum < best.0[now] {
                            best.0[now] = sum;
                            best.1[now] = (from * SENSES + sense) as u16;
                        }
                    }
                }
                (best.0.map(|sum| sum + own[number]), best.1)
            };
            let next: Vec<_> = (0..self.places.len()).into_par_iter().map(step).collect();
            total = next.iter().map(|(sums, _)| *sums).collect();
            parents.push(next.into_iter().map(|(_, from)| from).collect());
        }
        let states = (0..self.places.len() * SENSES).map(|s| (total[s / SENSES][s % SENSES], s));
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

/// The sense after a move, and how many axes turn round by it.
fn sense_after(before: usize, by: [i32; 2]) -> (usize, u32) {
    let mut now = before;
    for (axis, d) in by.into_iter().enumerate() {
        match d.signum() {
            1 => now |= 1 << axis,
            -1 => now &= !(1 << axis),
            _ => {}
        }
    }
    (now, (before ^ now).count_ones())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn moves_keep_the_speed_and_states_fit_16_bits() {
        for per_frame in [0.001, 0.013, 0.0249, 0.05, 0.0625, 0.099, 0.1, 0.24, 0.39, 0.41, 1.5, 9.0] {
            let disc = Disc::new(per_frame, false);
            assert!(disc.places.len() * SENSES <= usize::from(u16::MAX), "{per_frame}: {}", disc.places.len());
            let longest = disc.moves.iter().map(|[x, y]| f64::from(x * x + y * y).sqrt()).fold(0.0, f64::max);
            assert!(longest * disc.cell <= per_frame * disc.stride as f64 * (1.0 + 1e-6), "{per_frame}: {longest}");
            let reach = f64::from(disc.rim) * disc.cell;
            assert!(reach > 0.9 && reach <= 1.0 + 1e-9, "{per_frame}: {reach}");
        }
    }

    #[test]
    fn waits_aside_where_returning_would_mean_turning_round_again() {
        let disc = Disc::new(0.1, true);
        let middle = disc.places.iter().position(|p| *p == [0, 0]).unwrap();
        // The middle is closed at two times; between them being there would be free.
        let cost = |knot: usize| {
            let closed = [10, 30].contains(&knot);
            (0..disc.places.len()).map(|n| if closed && n == middle { 1e6 } else { 0.0 }).collect()
        };
        let (least, way) = disc.cheapest(40, cost);
        assert!(least < 1e-9 && way.len() == 40 && way.iter().all(|n| n == &way[0] && *n != middle), "{least} {way:?}");
    }
}
