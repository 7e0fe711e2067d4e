//! Symbols of maps as polygons.

use belvedere_core::{DVec2, polygon::to_segment};
use belvedere_scene::Symbol;
use std::f64::consts::TAU;

/// Symbols that are polygons, in the order of [`all`].
const SYMBOLS: [Symbol; 7] =
    [Symbol::Hut, Symbol::Pass, Symbol::Lift, Symbol::Viewpoint, Symbol::Parking, Symbol::Ring, Symbol::Target];

/// Number of a symbol in [`all`]; `None` for others.
pub(super) fn number(symbol: Symbol) -> Option<usize> {
    SYMBOLS.iter().position(|drawn| *drawn == symbol)
}

/// Outlines of half size 1, y down; outer rings run clockwise on the picture, holes against them.
pub(super) fn all() -> Vec<Vec<Vec<DVec2>>> {
    SYMBOLS.iter().map(|symbol| of(*symbol)).collect()
}

fn ring(points: &[[f64; 2]]) -> Vec<DVec2> {
    points.iter().map(|p| DVec2::from_array(*p)).collect()
}

/// Part of a circle, from one angle to another, y down: growing angles run clockwise.
fn arc(middle: [f64; 2], radius: f64, from: f64, to: f64) -> Vec<DVec2> {
    let steps = ((to - from).abs() / TAU * 72.0).ceil().max(2.0) as usize;
    let at = |i: usize| from + (to - from) * i as f64 / steps as f64;
    (0..=steps).map(|i| DVec2::from_array(middle) + radius * DVec2::from_angle(at(i))).collect()
}

fn circle(radius: f64) -> Vec<DVec2> {
    let mut ring = arc([0.0; 2], radius, 0.0, TAU);
    ring.pop();
    ring
}

fn hole(mut ring: Vec<DVec2>) -> Vec<DVec2> {
    ring.reverse();
    ring
}

fn of(symbol: Symbol) -> Vec<Vec<DVec2>> {
    match symbol {
        Symbol::Hut => vec![
            ring(&[[0.0, -1.15], [1.2, -0.1], [0.85, -0.1], [0.85, 0.95], [-0.85, 0.95], [-0.85, -0.1], [-1.2, -0.1]]),
            hole(ring(&[[-0.26, 0.2], [0.26, 0.2], [0.26, 0.95], [-0.26, 0.95]])),
        ],
        Symbol::Pass => {
            let side = |sign: f64| {
                let bow = |radius: f64, from: f64, to: f64| arc([sign * 1.55, 0.0], radius, from, to);
                let middle = if sign > 0.0 { TAU / 2.0 } else { 0.0 };
                [bow(1.35, middle - 0.9, middle + 0.9), bow(0.9, middle + 1.1, middle - 1.1)].concat()
            };
            vec![side(-1.0), side(1.0)]
        }
        Symbol::Lift => vec![
            ring(&[
                [-1.2, -0.72],
                [1.2, -1.2],
                [1.2, -0.92],
                [0.14, -0.71],
                [0.14, -0.3],
                [0.85, -0.3],
                [0.85, 0.95],
                [-0.85, 0.95],
                [-0.85, -0.3],
                [-0.14, -0.3],
                [-0.14, -0.65],
                [-1.2, -0.44],
            ]),
            hole(ring(&[[-0.55, 0.0], [-0.12, 0.0], [-0.12, 0.42], [-0.55, 0.42]])),
            hole(ring(&[[0.12, 0.0], [0.55, 0.0], [0.55, 0.42], [0.12, 0.42]])),
        ],
        Symbol::Viewpoint => {
            // Five rays over a half disc.
            let foot = DVec2::new(0.0, 0.7);
            let ray = |k: i32| {
                let angle = -TAU / 4.0 + f64::from(k) * TAU / 11.0;
                let at = |radius: f64, off: f64| foot + radius * DVec2::from_angle(angle + off);
                vec![at(0.75, -0.1), at(1.75, -0.12), at(1.75, 0.12), at(0.75, 0.1)]
            };
            let mut out: Vec<Vec<DVec2>> = (-2..=2).map(ray).collect();
            out.push(arc(foot.to_array(), 0.5, TAU / 2.0, TAU));
            out
        }
        Symbol::Parking => {
            let bow = |radius: f64, from: f64, to: f64| arc([0.08, -0.22], radius, from, to);
            let quarter = TAU / 4.0;
            let (stem, foot) = (ring(&[[-0.42, 0.62], [-0.42, -0.66]]), ring(&[[-0.14, 0.22], [-0.14, 0.62]]));
            let letter = [stem, bow(0.44, -quarter, quarter), foot].concat();
            let eye = [ring(&[[-0.14, -0.4]]), bow(0.18, -quarter, quarter), ring(&[[-0.14, -0.04]])].concat();
            vec![ring(&[[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]]), hole(letter), eye]
        }
        Symbol::Ring => vec![circle(1.0), hole(circle(0.52))],
        Symbol::Target => vec![circle(1.0), hole(circle(0.68)), circle(0.36)],
        _ => Vec::new(),
    }
}

/// Signed distance to rings, negative inside; a point is inside where it lies in an odd number of them.
pub(super) fn distance(rings: &[Vec<DVec2>], p: DVec2) -> f64 {
    let (mut inside, mut least) = (false, f64::INFINITY);
    for ring in rings {
        for (a, b) in ring.iter().zip(ring.iter().cycle().skip(1)) {
            if (a.y > p.y) != (b.y > p.y) && p.x < a.x + (b.x - a.x) * (p.y - a.y) / (b.y - a.y) {
                inside = !inside;
            }
            least = least.min(to_segment(p, *a, *b).length());
        }
    }
    if inside { -least } else { least }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rings_are_oriented_so_that_both_rules_of_filling_agree() {
        for (symbol, rings) in SYMBOLS.iter().zip(all()) {
            for i in 0..60 * 60 {
                let p = DVec2::new(f64::from(i % 60), f64::from(i / 60)) * 0.05 - 1.487;
                let turns: i32 = rings
                    .iter()
                    .flat_map(|ring| ring.iter().zip(ring.iter().cycle().skip(1)))
                    .filter(|(a, b)| (a.y > p.y) != (b.y > p.y) && p.x < a.x + (b.x - a.x) * (p.y - a.y) / (b.y - a.y))
                    .map(|(a, b)| if b.y > a.y { 1 } else { -1 })
                    .sum();
                assert_eq!(turns != 0, distance(&rings, p) < 0.0, "{symbol:?} at {p}");
                assert!((0..=1).contains(&turns.abs()), "{symbol:?}: rings lie over each other at {p}");
            }
        }
    }
}
