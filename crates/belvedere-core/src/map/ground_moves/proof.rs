//! Proof that a net of displacements folds nowhere.

use super::net::{MoveNet, ORDER};
use glam::{DVec2, DVec3};

/// How often a cell is halved before its fold counts as found.
const HALVINGS: u32 = 6;
/// How often it is halved at least where the bound is low, so that the bound says how much the plan shrinks.
const SHARPER: u32 = 3;
/// A bound that is no lower is not sharpened.
const PLAIN: f64 = 0.7;

/// Ends of an interval.
type Span = [f64; 2];

fn times(a: Span, b: Span) -> Span {
    let all = [a[0] * b[0], a[0] * b[1], a[1] * b[0], a[1] * b[1]];
    [all.into_iter().fold(f64::INFINITY, f64::min), all.into_iter().fold(f64::NEG_INFINITY, f64::max)]
}

/// A lower bound on the determinant of the plan, `det(I + s D)`, over the whole net and for every share s of the displacement between 0
/// and 1; an error where no bound above `floor` is found: the place, and the bound there.
pub(super) fn least_determinant(net: &MoveNet, floor: f64) -> Result<f64, (DVec2, f64)> {
    let [across, up] = net.place().cells();
    let mut least = 1.0f64;
    for row in 0..up {
        for column in 0..across {
            let patch = net.patch([column, row]);
            if patch.iter().all(|c| *c == DVec3::ZERO) {
                continue;
            }
            let found = of_patch(&patch, net.place().step, floor, HALVINGS);
            if !(found > floor) {
                let middle = DVec2::new(column as f64 + 1.5, row as f64 + 1.5);
                return Err((net.place().first + net.place().step * middle, found));
            }
            least = least.min(found);
        }
    }
    Ok(least)
}

/// Derivatives of a B-spline lie among the differences of its coefficients; a half of the cell has coefficients of its own.
fn of_patch(c: &[DVec3; ORDER * ORDER], step: f64, floor: f64, halvings: u32) -> f64 {
    let bound = of_differences(c, step);
    let is_sharp = bound > PLAIN || halvings + SHARPER <= HALVINGS;
    if (bound > floor && is_sharp) || halvings == 0 {
        return bound;
    }
    // One quarter that folds ends the search.
    let mut least = f64::INFINITY;
    for quarter in quarters(c) {
        least = least.min(of_patch(&quarter, 0.5 * step, floor, halvings - 1));
        if !(least > floor) {
            break;
        }
    }
    least
}

fn of_differences(c: &[DVec3; ORDER * ORDER], step: f64) -> f64 {
    let mut spans = [[f64::INFINITY, f64::NEG_INFINITY]; 4];
    let mut grow = |k: usize, v: f64| spans[k] = [spans[k][0].min(v), spans[k][1].max(v)];
    for a in 0..ORDER {
        for b in 0..ORDER - 1 {
            let x = (c[a * ORDER + b + 1] - c[a * ORDER + b]) / step;
            let y = (c[(b + 1) * ORDER + a] - c[b * ORDER + a]) / step;
            grow(0, x.x);
            grow(1, x.y);
            grow(2, y.x);
            grow(3, y.y);
        }
    }
    let [xx, yx, xy, yy] = spans;
    let trace = xx[0] + yy[0];
    let determinant = times(xx, yy)[0] - times(yx, xy)[1];
    // The least of 1 + s trace + s^2 determinant.
    let turn = if determinant > 0.0 { (-trace / (2.0 * determinant)).clamp(0.0, 1.0) } else { 1.0 };
    [turn, 1.0].map(|s| 1.0 + s * (trace + s * determinant)).into_iter().fold(1.0, f64::min)
}

/// The coefficients of the four quarters of a cell, by inserting a knot in the middle of each direction.
fn quarters(c: &[DVec3; ORDER * ORDER]) -> [[DVec3; ORDER * ORDER]; 4] {
    let halves = |l: [DVec3; ORDER]| {
        let (on, between) = (|k: usize| (l[k - 1] + 6.0 * l[k] + l[k + 1]) / 8.0, |k: usize| (l[k] + l[k + 1]) / 2.0);
        [between(0), on(1), between(1), on(2), between(2)]
    };
    let wide: [[DVec3; 5]; ORDER] = std::array::from_fn(|j| halves(std::array::from_fn(|i| c[j * ORDER + i])));
    let both: [[DVec3; 5]; 5] = std::array::from_fn(|i| halves(std::array::from_fn(|j| wide[j][i])));
    std::array::from_fn(|q| std::array::from_fn(|k| both[k % ORDER + q % 2][k / ORDER + q / 2]))
}

#[cfg(test)]
mod tests {
    use super::super::net::NetPlace;
    use super::*;

    fn net(by: impl Fn(usize, usize) -> DVec3) -> MoveNet {
        let place = NetPlace { first: DVec2::ZERO, step: 10.0, size: [15, 15] };
        let coefficients = (0..225).map(|i| (i % 15, i / 15)).map(|(x, y)| {
            let is_inside = (3..12).contains(&x) && (3..12).contains(&y);
            if is_inside { by(x, y) } else { DVec3::ZERO }
        });
        MoveNet::new(place, coefficients.collect()).expect("a net")
    }

    #[test]
    fn the_bound_is_one_and_folds_are_found() {
        let mut random = crate::random::Random::new(5);
        for most in [2.0, 5.0, 9.0, 14.0, 30.0] {
            let values: Vec<DVec3> =
                (0..225).map(|_| most * DVec3::new(random.unit() - 0.5, random.unit() - 0.5, 0.0)).collect();
            let net = net(|x, y| values[y * 15 + x]);
            let determinant = |p: DVec2, s: f64| {
                let m = net.moved(p);
                let [a, b] = [DVec2::X + s * m.along_x.truncate(), DVec2::Y + s * m.along_y.truncate()];
                a.perp_dot(b)
            };
            let places =
                (0..40_000).map(|i| DVec2::new(10.0 + 0.6 * f64::from(i % 200), 10.0 + 0.6 * f64::from(i / 200)));
            let dense: Vec<DVec2> = places.collect();
            let seen = |s: f64| dense.iter().map(|p| determinant(*p, s)).fold(1.0, f64::min);
            let least = [0.25, 0.5, 0.75, 1.0].map(seen).into_iter().fold(1.0, f64::min);
            match least_determinant(&net, 0.05) {
                Ok(bound) => assert!(bound <= least && least < bound + 0.35, "{most}: {bound}, truly {least}"),
                Err((at, bound)) => assert!(bound <= 0.05 && least < 0.15, "{most}: {bound} at {at}, truly {least}"),
            }
        }
    }
}
