//! Outlines of point markers as signed distances, y down.

use crate::marks::drawn;
use belvedere_core::DVec2;
use belvedere_scene::Symbol;
use glam::Vec2;
use std::f64::consts::{FRAC_PI_2, FRAC_PI_4, TAU};
use std::sync::LazyLock;

/// Centre of a pin's head over its tip, and radius of the head, in half sizes.
const PIN: [f32; 2] = [1.9, 0.95];
/// Half width of the arms of a cross, in half sizes.
const ARM: f32 = 0.3;

/// Farthest point of the outline, in half sizes.
pub(crate) fn reach(symbol: Symbol) -> f32 {
    match symbol {
        Symbol::Dot => 1.0,
        Symbol::Triangle | Symbol::Square | Symbol::Cross => 1.5,
        Symbol::Pin => PIN[0] + PIN[1],
        // Whatever is drawn, picks find it as a disc.
        Symbol::Own(_) => 1.0,
        drawn => rings(drawn).iter().flatten().map(|p| p.length() as f32).fold(0.0, f32::max),
    }
}

/// Height of the symbol above its point, in half sizes.
pub(crate) fn top(symbol: Symbol) -> f64 {
    match symbol {
        Symbol::Triangle => 1.15,
        Symbol::Pin => f64::from(PIN[0] + PIN[1]),
        Symbol::Dot | Symbol::Square | Symbol::Cross | Symbol::Own(_) => 1.0,
        drawn => rings(drawn).iter().flatten().map(|p| -p.y).fold(0.0, f64::max),
    }
}

/// Outline of half size 1: rings, holes oriented against their outer ring.
pub(crate) fn rings(symbol: Symbol) -> &'static [Vec<DVec2>] {
    match drawn::number(symbol) {
        Some(number) => &DRAWN[number],
        None => {
            let number = BASIC.iter().position(|basic| *basic == symbol).unwrap_or(0);
            &BASIC_RINGS[number]
        }
    }
}

static DRAWN: LazyLock<Vec<Vec<Vec<DVec2>>>> = LazyLock::new(drawn::all);
const BASIC: [Symbol; 5] = [Symbol::Dot, Symbol::Triangle, Symbol::Square, Symbol::Pin, Symbol::Cross];
static BASIC_RINGS: LazyLock<Vec<Vec<Vec<DVec2>>>> =
    LazyLock::new(|| BASIC.iter().map(|symbol| vec![corners(*symbol)]).collect());

/// Corners of the outline of half size 1; curves in steps of less than 4 degrees.
fn corners(symbol: Symbol) -> Vec<DVec2> {
    let arc = |centre: DVec2, radius: f64, from: f64, to: f64| -> Vec<DVec2> {
        let steps = ((to - from).abs().to_degrees() / 4.0).ceil().max(1.0) as usize;
        (0..=steps).map(|i| centre + radius * DVec2::from_angle(from + (to - from) * i as f64 / steps as f64)).collect()
    };
    match symbol {
        Symbol::Triangle => {
            let side = 0.577;
            [[0.0, -2.0], [3f64.sqrt(), 1.0], [-3f64.sqrt(), 1.0]].map(|p| side * DVec2::from_array(p)).to_vec()
        }
        Symbol::Square => {
            [[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]].map(|p| 0.85 * DVec2::from_array(p)).to_vec()
        }
        Symbol::Cross => {
            let (long, arm) = (1.2, f64::from(ARM));
            let quarter = [DVec2::new(long, -arm), DVec2::new(long, arm), DVec2::new(arm, arm)];
            // The arms lie along the diagonals.
            let turned = |k: usize| DVec2::from_angle(FRAC_PI_2 * k as f64 - FRAC_PI_4);
            (0..4).flat_map(|k| quarter.map(|p| turned(k).rotate(p))).collect()
        }
        Symbol::Pin => {
            let [centre, radius] = PIN.map(f64::from);
            // The tangents from the tip touch the head this far from the direction to the tip.
            let touch = (radius / centre).acos();
            let mut ring = arc(DVec2::new(0.0, -centre), radius, FRAC_PI_2 + touch, FRAC_PI_2 + TAU - touch);
            ring.push(DVec2::ZERO);
            ring
        }
        _ => {
            let mut ring = arc(DVec2::ZERO, 1.0, 0.0, TAU);
            ring.pop();
            ring
        }
    }
}

/// Signed distance from `p`, relative to the point, to the outline of half size `half`; negative inside.
pub(crate) fn distance(symbol: Symbol, p: Vec2, half: f32) -> f32 {
    match symbol {
        Symbol::Dot | Symbol::Own(_) => p.length() - half,
        Symbol::Triangle => {
            // Centroid on the point; sides by their normals.
            let (sin, cos) = (0.5, 0.866_025_4);
            let side = 0.577 * half;
            (p.x.abs() * cos - p.y * sin).max(p.y) - side
        }
        Symbol::Square => {
            let q = p.abs() - 0.85 * half;
            q.max(Vec2::ZERO).length() + q.max_element().min(0.0)
        }
        Symbol::Cross => {
            let q = Vec2::new(p.x + p.y, p.y - p.x) * std::f32::consts::FRAC_1_SQRT_2;
            let arm = |v: Vec2| {
                let d = v.abs() - Vec2::new(1.2 * half, ARM * half);
                d.max(Vec2::ZERO).length() + d.max_element().min(0.0)
            };
            arm(q).min(arm(q.perp()))
        }
        Symbol::Pin => {
            // The convex hull of the tip and the head.
            let [centre, radius] = PIN.map(|v| v * half);
            let q = Vec2::new(p.x.abs(), -p.y);
            let slant = -radius / centre;
            let cos = (1.0 - slant * slant).sqrt();
            let along = q.dot(Vec2::new(-slant, cos));
            if along < 0.0 {
                q.length()
            } else if along > cos * centre {
                q.distance(Vec2::new(0.0, centre)) - radius
            } else {
                q.dot(Vec2::new(cos, slant))
            }
        }
        drawn => half * drawn::distance(rings(drawn), (p / half).as_dvec2()) as f32,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn outlines_have_the_size_they_say_and_no_jumps() {
        for (_, symbol) in Symbol::NAMED {
            let half = 10.0;
            let (mut ink, mut farthest) = (0, 0.0f32);
            for y in -400..400 {
                for x in -400..400 {
                    let p = Vec2::new(x as f32, y as f32) * 0.1;
                    let d = distance(symbol, p, half);
                    let right = distance(symbol, p + Vec2::new(0.1, 0.0), half);
                    assert!(
                        d.is_finite() && (right - d).abs() < 0.11 + 0.05,
                        "{symbol:?} jumps at {p}: {d} and {right}"
                    );
                    if d < 0.0 {
                        ink += 1;
                        farthest = farthest.max(p.length());
                    }
                }
            }
            let area = ink as f32 * 0.01;
            assert!((60.0..700.0).contains(&area), "{symbol:?}: {area} square pixels");
            assert!(
                farthest <= reach(symbol) * half && farthest > 0.6 * reach(symbol) * half,
                "{symbol:?}: {farthest}"
            );
            assert!(
                symbol != Symbol::Pin || distance(symbol, Vec2::new(0.0, 0.5), half) > 0.0,
                "the pin stands on its tip"
            );
        }
    }
}
