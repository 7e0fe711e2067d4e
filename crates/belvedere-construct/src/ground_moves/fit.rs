//! The smoothest net that carries out handles: least squares over its coefficients.
//!
//! The energy is that of a thin plate under tension, the sum of squared second and first differences; goals of handles are rows of a great weight. Plan and height have
//! nothing in common and are solved one after the other. Coefficients whose place is beyond reach are zero; those that touch a
//! lake are one unknown, so that it stays level exactly; those that touch the sea are zero in height.

use super::kept::{Kept, places_inside};
use super::{KeptLine, Move};
use belvedere_core::map::ground_moves::NetPlace;
use belvedere_core::{DVec2, DVec3};

/// Weight of a first difference of heights, beside 1 of a second one.
const HEIGHT_TENSION: f64 = 0.3;
/// The same in plan, at first.
const TENSION: f64 = 0.1;
/// Ground in plan that is stretched or compressed by more than this share becomes stiffer.
const STRAIN: f64 = 0.4;
/// Weight against stretching routes, at first.
const ROUTES: f64 = 3.0;
/// Weight of a goal, beside 1 of a second difference.
const GOAL: f64 = 100.0;
/// Steps of the net from the place of a coefficient to the corners of what it moves.
const SUPPORT: f64 = 2.0 * std::f64::consts::SQRT_2;
/// Weight that ties neighbouring points of a river.
const RIVER: f64 = 1e9;
/// Coefficients go no farther than what is asked for, times this.
const SWING: f64 = 1.1;
/// Rounds in which rivers that rise are tied.
const ROUNDS: u32 = 12;
/// A river rises by less than this, metres, before it is tied.
const RISE_M: f64 = 0.01;

/// Coefficients and what they were fitted to.
pub(super) struct Fitted {
    pub(super) coefficients: Vec<DVec3>,
    /// Lakes that moved up or down.
    pub(super) lakes: usize,
}

/// What grows where a displacement folds or stretches a route, from one round to the next.
pub(super) struct Stiffness {
    /// Weight against stretching routes, for each stretch of half a step of the net or more, beside 1 of a second difference.
    pub(super) routes: f64,
    /// Weight of the first differences in plan from each coefficient to the next one along x and along y.
    sides: Vec<[f64; 2]>,
}

impl Stiffness {
    pub(super) fn new(place: &NetPlace) -> Self {
        Self { routes: ROUTES, sides: vec![[TENSION; 2]; place.size[0] * place.size[1]] }
    }

    /// Makes the ground stiffer where it is stretched or compressed most, so that more of it gives way.
    pub(super) fn spread(&mut self, place: &NetPlace, coefficients: &[DVec3]) {
        for (i, sides) in self.sides.iter_mut().enumerate() {
            let at = |k: usize| coefficients.get(k).map_or(DVec2::ZERO, |c| c.truncate());
            for (weight, next) in sides.iter_mut().zip([i + 1, i + place.size[0]]) {
                let strain = (at(next) - at(i)).length() / place.step;
                *weight *= (strain / STRAIN).powi(2).clamp(1.0, 10.0);
            }
        }
    }
}

pub(super) fn fit(place: &NetPlace, moves: &[Move], kept: &Kept, stiffness: &Stiffness) -> Fitted {
    let mut out = Fitted { coefficients: vec![DVec3::ZERO; place.size[0] * place.size[1]], lakes: 0 };
    let (heights, plan): (Vec<&Move>, Vec<&Move>) = moves.iter().partition(|m| m.handle.is_height());
    if !plan.is_empty() {
        let mut unknowns = Unknowns::within(place, &plan);
        unknowns.number(place);
        let mut rows = unknowns.plate(place, &stiffness.sides);
        rows.extend(unknowns.goals(place, &plan));
        rows.extend(unknowns.stretches(place, &kept.routes, stiffness.routes));
        let found = unknowns.solve(&rows);
        for (c, k) in out.coefficients.iter_mut().zip(&unknowns.of) {
            if let Some(k) = k {
                [c.x, c.y] = found[*k];
            }
        }
    }
    if !heights.is_empty() {
        let (found, lakes) = fit_heights(place, &heights, kept, stiffness);
        for (c, z) in out.coefficients.iter_mut().zip(found) {
            c.z = z;
        }
        out.lakes = lakes.iter().filter(|lake| out.coefficients[**lake].z != 0.0).count();
    }
    out
}

/// Heights of the coefficients, and the first coefficient of each lake.
fn fit_heights(place: &NetPlace, moves: &[&Move], kept: &Kept, stiffness: &Stiffness) -> (Vec<f64>, Vec<usize>) {
    let mut unknowns = Unknowns::within(place, moves);
    unknowns.hold(place, &kept.sea);
    let lakes = unknowns.tie_lakes(place, &kept.lakes);
    unknowns.number(place);
    let mut rivers: Vec<River> = kept.rivers.iter().map(|river| River::new(river, 0.5 * place.step)).collect();
    let goals = unknowns.goals(place, moves);
    let asked = goals.iter().fold([0.0f64; 2], |[low, high], row| [low.min(row.goal[0]), high.max(row.goal[0])]);
    let mut rows = unknowns.plate(place, &vec![[HEIGHT_TENSION; 2]; unknowns.of.len()]);
    rows.extend(goals);
    rows.extend(unknowns.stretches(place, &kept.routes, stiffness.routes));
    let own = rows.len();
    let mut far = vec![None; unknowns.count];
    let mut found = unknowns.solve(&rows);
    for _ in 0..ROUNDS {
        let (rises, swings) = (unknowns.tie_rising(place, &mut rivers, &found), swing(&mut far, &found, asked));
        if !(rises || swings) {
            break;
        }
        rows.truncate(own);
        rows.extend(unknowns.tied(place, &rivers));
        let held = far.iter().enumerate().filter_map(|(k, most)| Some((k, (*most)?)));
        rows.extend(held.map(|(k, most)| Row { terms: vec![(k, 1.0)], goal: [most, 0.0], weight: GOAL }));
        found = unknowns.solve(&rows);
    }
    (unknowns.of.iter().map(|k| k.map_or(0.0, |k| found[k][0])).collect(), lakes)
}

/// Marks the unknowns that go farther than anything that is asked for, with how far they may go; whether there are new ones.
fn swing(far: &mut [Option<f64>], found: &[[f64; 2]], asked: [f64; 2]) -> bool {
    let mut any = false;
    for (far, [z, _]) in far.iter_mut().zip(found) {
        let most = SWING * z.clamp(asked[0], asked[1]);
        if far.is_none() && z.abs() > most.abs() + RISE_M {
            *far = Some(most);
            any = true;
        }
    }
    any
}

/// A row of the least squares: a weighted sum of unknowns and its goals, one for each direction of the plan, or the height alone.
struct Row {
    terms: Vec<(usize, f64)>,
    goal: [f64; 2],
    weight: f64,
}

/// A river at points about half a step of the net apart, and between which of them it goes up and down as one.
struct River {
    points: Vec<DVec3>,
    tied: Vec<bool>,
}

impl River {
    fn new(line: &KeptLine, step: f64) -> Self {
        let mut points = vec![line.points[0]];
        for p in &line.points[1..] {
            if points[points.len() - 1].truncate().distance(p.truncate()) >= step {
                points.push(*p);
            }
        }
        Self { tied: vec![false; points.len() - 1], points }
    }
}

/// Which unknown each coefficient is; `None` = zero.
struct Unknowns {
    of: Vec<Option<usize>>,
    count: usize,
}

impl Unknowns {
    /// The coefficients whose B-spline lies wholly within reach of a handle.
    fn within(place: &NetPlace, moves: &[&Move]) -> Self {
        let [cols, rows] = place.size;
        let is_free = |i: usize| {
            let (column, row) = (i % cols, i / cols);
            let is_rim = column.min(row).min(cols - 1 - column).min(rows - 1 - row) < 3;
            let at = place.first + place.step * DVec2::new(column as f64, row as f64);
            !is_rim && moves.iter().any(|m| m.distance(at) <= m.reach - SUPPORT * place.step)
        };
        let of: Vec<Option<usize>> = (0..cols * rows).map(|i| is_free(i).then_some(i)).collect();
        Self { count: of.len(), of }
    }

    /// Coefficients that a place depends on.
    fn touched(place: &NetPlace, at: DVec2) -> impl Iterator<Item = (usize, f64)> {
        let place = *place;
        place.weights(at).into_iter().flat_map(move |w| {
            (0..16).map(move |k| {
                let (i, j) = (k % 4, k / 4);
                (place.index(w.first[0] + i, w.first[1] + j), w.x[i] * w.y[j])
            })
        })
    }

    /// Sets the coefficients that touch places to zero.
    fn hold(&mut self, place: &NetPlace, at: &[DVec2]) {
        for p in at {
            for (i, _) in Self::touched(place, *p) {
                self.of[i] = None;
            }
        }
    }

    /// Makes the coefficients that touch a lake one unknown: its first one. Lakes that touch fixed coefficients stay. The first coefficient
    /// of each lake within the net.
    fn tie_lakes(&mut self, place: &NetPlace, lakes: &[Vec<Vec<DVec2>>]) -> Vec<usize> {
        let mut leaders = Vec::new();
        for rings in lakes {
            let mut all: Vec<usize> = places_inside(rings, 0.5 * place.step)
                .into_iter()
                .flat_map(|p| Self::touched(place, p).map(|(i, _)| i))
                .collect();
            all.sort_unstable();
            all.dedup();
            let Some(first) = all.first().copied() else { continue };
            leaders.push(first);
            let stays = all.iter().any(|i| self.of[*i].is_none());
            let mut groups: Vec<usize> = all.iter().filter_map(|i| self.of[*i]).collect();
            groups.sort_unstable();
            // What is one unknown with any of them already moves with them.
            let joined = groups.first().copied();
            for of in &mut self.of {
                if of.is_some_and(|k| groups.binary_search(&k).is_ok()) {
                    *of = if stays { None } else { joined };
                }
            }
        }
        leaders
    }

    /// Numbers the unknowns along the shorter side of the net, so that those of a row lie close together; lakes come last.
    fn number(&mut self, place: &NetPlace) {
        let [cols, rows] = place.size;
        let mut uses = vec![0u32; self.of.len()];
        for k in self.of.iter().flatten() {
            uses[*k] += 1;
        }
        let mut numbers = vec![None; self.of.len()];
        let mut count = 0;
        for is_lake in [false, true] {
            for i in 0..cols * rows {
                let i = if cols <= rows { i } else { i % rows * cols + i / rows };
                let Some(k) = self.of[i] else { continue };
                if (uses[k] > 1) == is_lake && numbers[k].is_none() {
                    numbers[k] = Some(count);
                    count += 1;
                }
            }
        }
        for of in &mut self.of {
            *of = of.and_then(|k| numbers[k]);
        }
        self.count = count;
    }

    /// A weighted sum of coefficients as a row.
    fn row(&self, terms: impl IntoIterator<Item = (usize, f64)>, goal: [f64; 2], weight: f64) -> Row {
        let mut known: Vec<(usize, f64)> = terms.into_iter().filter_map(|(i, w)| Some((self.of[i]?, w))).collect();
        known.sort_unstable_by_key(|(k, _)| *k);
        known.dedup_by(|next, kept| {
            let is_same = next.0 == kept.0;
            if is_same {
                kept.1 += next.1;
            }
            is_same
        });
        Row { terms: known, goal, weight }
    }

    fn goals(&self, place: &NetPlace, moves: &[&Move]) -> Vec<Row> {
        let of_move = |m: &&Move| {
            let is_height = m.handle.is_height();
            let one = move |goal: super::handles::Goal| {
                let by = if is_height { [goal.by.z, 0.0] } else { [goal.by.x, goal.by.y] };
                self.row(Self::touched(place, goal.at), by, GOAL)
            };
            m.goals(place.step).into_iter().map(one).collect::<Vec<_>>()
        };
        moves.iter().flat_map(of_move).collect()
    }

    /// Neighbouring points of routes move alike.
    fn stretches(&self, place: &NetPlace, routes: &[KeptLine], weight: f64) -> Vec<Row> {
        let mut rows = Vec::new();
        for route in routes {
            let mut from = route.points[0].truncate();
            for to in route.points[1..].iter().map(|p| p.truncate()) {
                if from.distance(to) < 0.5 * place.step {
                    continue;
                }
                let less = Self::touched(place, from).map(|(i, w)| (i, -w));
                rows.push(self.row(Self::touched(place, to).chain(less), [0.0; 2], weight));
                from = to;
            }
        }
        rows.retain(|row| !row.terms.is_empty());
        rows
    }

    /// Ties together what lies along every stretch of a river that rises more than it did; whether there are any.
    fn tie_rising(&self, place: &NetPlace, rivers: &mut [River], found: &[[f64; 2]]) -> bool {
        let height =
            |at: DVec2| -> f64 { Self::touched(place, at).filter_map(|(i, w)| Some(w * found[self.of[i]?][0])).sum() };
        let mut any = false;
        for river in rivers {
            // The lowest point so far: none downstream of it may lie higher, but for what it did before.
            let (mut low, mut lowest, mut before) = (0, f64::INFINITY, f64::INFINITY);
            for (k, p) in river.points.iter().enumerate() {
                let z = p.z + height(p.truncate());
                before = before.min(p.z);
                if z > lowest + (p.z - before) + RISE_M {
                    river.tied[low..k].fill(true);
                    any = true;
                }
                if z < lowest {
                    (low, lowest) = (k, z);
                }
            }
        }
        any
    }

    /// Rows of the tied stretches of rivers.
    fn tied(&self, place: &NetPlace, rivers: &[River]) -> Vec<Row> {
        let of_river = |river: &River| {
            let tied = river.points.windows(2).zip(&river.tied).filter(|(_, tied)| **tied);
            let row = |(pair, _): (&[DVec3], _)| {
                let less = Self::touched(place, pair[0].truncate()).map(|(i, w)| (i, -w));
                self.row(Self::touched(place, pair[1].truncate()).chain(less), [0.0; 2], RIVER)
            };
            tied.map(row).filter(|row| !row.terms.is_empty()).collect::<Vec<_>>()
        };
        rivers.iter().flat_map(of_river).collect()
    }

    /// Second differences along both directions and across, and first ones, of every place whose coefficients are not all zero.
    /// * `sides`: weights of the first differences.
    fn plate(&self, place: &NetPlace, sides: &[[f64; 2]]) -> Vec<Row> {
        let [cols, rows] = place.size;
        let mut out = Vec::new();
        for row in 0..rows {
            for column in 0..cols {
                let at = |i: usize, j: usize| place.index(column + i, row + j);
                let mut push = |terms: &[(usize, f64)], weight: f64| {
                    let row = self.row(terms.iter().copied(), [0.0; 2], weight);
                    if !row.terms.is_empty() {
                        out.push(row);
                    }
                };
                let [along_x, along_y] = sides[at(0, 0)];
                if column + 1 < cols {
                    push(&[(at(0, 0), -1.0), (at(1, 0), 1.0)], along_x);
                }
                if row + 1 < rows {
                    push(&[(at(0, 0), -1.0), (at(0, 1), 1.0)], along_y);
                }
                if column + 2 < cols {
                    push(&[(at(0, 0), 1.0), (at(1, 0), -2.0), (at(2, 0), 1.0)], 1.0);
                }
                if row + 2 < rows {
                    push(&[(at(0, 0), 1.0), (at(0, 1), -2.0), (at(0, 2), 1.0)], 1.0);
                }
                if column + 1 < cols && row + 1 < rows {
                    push(&[(at(0, 0), 1.0), (at(1, 0), -1.0), (at(0, 1), -1.0), (at(1, 1), 1.0)], 2.0);
                }
            }
        }
        out
    }

    /// The unknowns of least squared weighted errors over rows, those of the plate among them, by Cholesky's factors within the
    /// envelope of the matrix.
    fn solve(&self, rows: &[Row]) -> Vec<[f64; 2]> {
        let mut first: Vec<usize> = (0..self.count).collect();
        for row in rows {
            let lowest = row.terms.first().map_or(0, |(k, _)| *k);
            for (k, _) in &row.terms {
                first[*k] = first[*k].min(lowest);
            }
        }
        let mut matrix: Vec<Vec<f64>> = first.iter().enumerate().map(|(k, low)| vec![0.0; k + 1 - low]).collect();
        let mut right = vec![[0.0; 2]; self.count];
        for row in rows {
            for (n, (k, w)) in row.terms.iter().enumerate() {
                for (j, v) in &row.terms[..=n] {
                    matrix[*k][j - first[*k]] += row.weight * w * v;
                }
                for (r, goal) in right[*k].iter_mut().zip(row.goal) {
                    *r += row.weight * w * goal;
                }
            }
        }
        factor(&mut matrix, &first);
        substitute(&matrix, &first, &mut right);
        right
    }
}

/// Cholesky's factor in place; rows hold the entries from `first` to the diagonal.
fn factor(matrix: &mut [Vec<f64>], first: &[usize]) {
    for k in 0..matrix.len() {
        let (above, rest) = matrix.split_at_mut(k);
        let row = &mut rest[0];
        for j in first[k]..k {
            let from = first[k].max(first[j]);
            let known = dot(&row[from - first[k]..j - first[k]], &above[j][from - first[j]..j - first[j]]);
            row[j - first[k]] = (row[j - first[k]] - known) / above[j][j - first[j]];
        }
        let last = k - first[k];
        let squares = dot(&row[..last], &row[..last]);
        // The plate is positive definite: what is left is greater than zero but for rounding.
        row[last] = (row[last] - squares).max(1e-12 * row[last]).sqrt();
    }
}

fn substitute(matrix: &[Vec<f64>], first: &[usize], right: &mut [[f64; 2]]) {
    for k in 0..matrix.len() {
        let (row, last) = (&matrix[k], k - first[k]);
        for d in 0..2 {
            let known: f64 = row[..last].iter().zip(&right[first[k]..k]).map(|(a, b)| a * b[d]).sum();
            right[k][d] = (right[k][d] - known) / row[last];
        }
    }
    for k in (0..matrix.len()).rev() {
        let (row, last) = (&matrix[k], k - first[k]);
        for d in 0..2 {
            right[k][d] /= row[last];
            let found = right[k][d];
            for (a, b) in row[..last].iter().zip(&mut right[first[k]..k]) {
                b[d] -= a * found;
            }
        }
    }
}

/// Eight sums side by side, which the compiler keeps in vector registers.
fn dot(a: &[f64], b: &[f64]) -> f64 {
    let (wide_a, wide_b) = (a.chunks_exact(8), b.chunks_exact(8));
    let rest: f64 = wide_a.remainder().iter().zip(wide_b.remainder()).map(|(a, b)| a * b).sum();
    let mut sums = [0.0; 8];
    for (a, b) in wide_a.zip(wide_b) {
        for (sum, (a, b)) in sums.iter_mut().zip(a.iter().zip(b)) {
            *sum += a * b;
        }
    }
    rest + sums.iter().sum::<f64>()
}
