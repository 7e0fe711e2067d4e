//! Solids of a footprint, its heights and a shape of roof, as in OpenStreetMap's Simple 3D Buildings.
//!
//! A roof is the least of some inclined planes over the footprint, so that one construction makes them all: gabled, hipped, skillion,
//! pyramidal, domed. Source: OpenStreetMap Wiki, "Simple 3D Buildings" (tags and their meaning).

use super::attributes::Attributes;
use belvedere_scene::{CityFace, Polygon, Surface};
use glam::{DVec2, DVec3};

/// Metres per degree of latitude.
const DEGREE_M: f64 = 111_195.0;
/// Pitch of roofs of unknown rise, as rise over half the span.
const PITCH: f64 = 0.55;
/// Largest rise of such a roof, as a share of the building's height.
const MOST_SHARE: f64 = 0.45;
/// Facets around a dome, and rings up.
const AROUND: usize = 12;
const RINGS: usize = 4;
/// Pieces smaller than this are dropped, square metres.
const LEAST_M2: f64 = 1e-4;

/// Heights of a solid over its ground, metres: underside, eaves, top.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Heights {
    pub(super) under: f64,
    pub(super) eaves: f64,
    pub(super) top: f64,
}

/// The roof that tags describe.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Roof {
    shape: Shape,
    /// Rise from eaves to top, metres, if it is stated.
    pub(super) rise: Option<f64>,
    /// Direction that a skillion falls to, degrees clockwise from north.
    direction: Option<f64>,
    /// Whether the ridge runs across the long side.
    across: bool,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Shape {
    Flat,
    Skillion,
    Gabled,
    Gambrel,
    HalfHipped,
    Hipped,
    Mansard,
    Round,
    Pyramidal,
    Dome,
}

impl Roof {
    /// The roof that tags describe; unknown shapes are flat.
    pub(super) fn of(about: &impl Attributes, length: impl Fn(&str) -> Option<f64>) -> Self {
        let shape = about.text("roof:shape").or_else(|| about.text("building:roof:shape")).unwrap_or_default();
        let shape = match shape.to_lowercase().as_str() {
            "skillion" | "lean_to" | "shed" | "sloped" | "pent" => Shape::Skillion,
            "gabled" | "pitched" | "saltbox" | "double_saltbox" | "quadruple_saltbox" | "side_hipped" => Shape::Gabled,
            "gambrel" => Shape::Gambrel,
            "half-hipped" | "half_hipped" => Shape::HalfHipped,
            "hipped" | "side_half-hipped" => Shape::Hipped,
            "mansard" => Shape::Mansard,
            "round" | "barrel" => Shape::Round,
            "pyramidal" | "pyramid" | "cone" | "conical" | "hipped-and-gabled" => Shape::Pyramidal,
            "dome" | "onion" => Shape::Dome,
            _ => Shape::Flat,
        };
        let rise = about.text("roof:height").as_deref().and_then(&length).filter(|h| *h > 0.0 && *h < 500.0);
        let rise = rise.or_else(|| {
            let levels = about.text("roof:levels")?.parse::<f64>().ok().filter(|n| *n > 0.0 && *n < 20.0)?;
            Some(2.5 * levels)
        });
        let direction = about.text("roof:direction").as_deref().and_then(bearing);
        let across = about.text("roof:orientation").is_some_and(|o| o == "across");
        Self { shape, rise: rise.filter(|_| shape != Shape::Flat), direction, across }
    }

    /// Whether the roof is not flat.
    pub(super) fn is_pitched(&self) -> bool {
        self.shape != Shape::Flat
    }

    /// Rise of a roof without a stated one, metres: by the usual pitch over the span of the footprint.
    pub(super) fn usual_rise(&self, footprint: &[Polygon], height: f64) -> f64 {
        let span = footprint.iter().map(|p| Plan::new(&p.outer, self.across).half[1]).fold(0.0, f64::max);
        let pitch = if self.shape == Shape::Skillion { 2.0 * 0.3 } else { PITCH };
        (pitch * span).min(MOST_SHARE * height)
    }
}

/// Degrees clockwise from north, from a number or a point of the compass.
fn bearing(text: &str) -> Option<f64> {
    const POINTS: [&str; 16] =
        ["N", "NNE", "NE", "ENE", "E", "ESE", "SE", "SSE", "S", "SSW", "SW", "WSW", "W", "WNW", "NW", "NNW"];
    let named = POINTS.iter().position(|p| p.eq_ignore_ascii_case(text.trim()));
    named.map(|k| 22.5 * k as f64).or_else(|| text.trim().parse().ok()).filter(|d: &f64| d.is_finite())
}

/// A footprint in metres around its middle, with the box along its longest edge.
struct Plan {
    middle: DVec2,
    scale: DVec2,
    ring: Vec<DVec2>,
    /// Unit directions along the ridge and across it.
    axes: [DVec2; 2],
    /// Half the sizes of the box along them, metres.
    half: [f64; 2],
    /// Middle of the box, metres.
    centre: DVec2,
}

impl Plan {
    /// * `outer`: longitudes and latitudes.
    fn new(outer: &[DVec2], across: bool) -> Self {
        let middle = outer.iter().sum::<DVec2>() / outer.len().max(1) as f64;
        let scale = DVec2::new(DEGREE_M * middle.y.to_radians().cos().max(1e-3), DEGREE_M);
        let ring: Vec<DVec2> = outer.iter().map(|p| (*p - middle) * scale).collect();
        let edges = (0..ring.len()).map(|k| ring[(k + 1) % ring.len()] - ring[k]);
        let longest = edges.max_by(|a, b| a.length().total_cmp(&b.length())).unwrap_or(DVec2::X);
        let mut u = longest.normalize_or(DVec2::X);
        let size = |axis: DVec2| {
            let [lo, hi] = ring
                .iter()
                .fold([f64::INFINITY, f64::NEG_INFINITY], |[lo, hi], p| [lo.min(p.dot(axis)), hi.max(p.dot(axis))]);
            [0.5 * (lo + hi), 0.5 * (hi - lo)]
        };
        if (size(u)[1] < size(u.perp())[1]) != across {
            u = u.perp();
        }
        let v = u.perp();
        let ([mu, hu], [mv, hv]) = (size(u), size(v));
        Self { middle, scale, ring, axes: [u, v], half: [hu.max(1e-6), hv.max(1e-6)], centre: mu * u + mv * v }
    }

    fn degrees(&self, p: DVec2) -> DVec2 {
        self.middle + p / self.scale
    }
}

/// Height over the eaves as a share of the rise: `slope · (p − centre) + at`.
#[derive(Debug, Clone, Copy)]
struct Plane {
    slope: DVec2,
    at: f64,
}

impl Plane {
    fn height(&self, p: DVec2) -> f64 {
        self.slope.dot(p) + self.at
    }
}

/// Planes that rise from 0 at both sides of the box along an axis; `profile` = pairs of distance from the middle (1 = side) and height.
fn sides(axis: DVec2, half: f64, profile: &[(f64, f64)]) -> Vec<Plane> {
    let pieces = profile.windows(2).map(|w| {
        let fall = (w[1].1 - w[0].1) / (w[1].0 - w[0].0);
        (fall / half, w[0].1 - fall * w[0].0)
    });
    pieces.flat_map(|(fall, at)| [1.0, -1.0].map(|s| Plane { slope: s * fall * axis, at })).collect()
}

fn planes(roof: &Roof, plan: &Plan) -> Vec<Plane> {
    const STRAIGHT: [(f64, f64); 2] = [(0.0, 1.0), (1.0, 0.0)];
    const BROKEN: [(f64, f64); 3] = [(0.0, 1.0), (0.6, 0.65), (1.0, 0.0)];
    let [u, v] = plan.axes;
    let [hu, hv] = plan.half;
    let across = |profile: &[(f64, f64)]| sides(v, hv, profile);
    // The ends are as steep as the sides.
    let ends = |profile: &[(f64, f64)], lift: f64| -> Vec<Plane> {
        let reach: Vec<(f64, f64)> = profile.iter().map(|(d, h)| (1.0 - (1.0 - d) * hv / hu, *h)).collect();
        sides(u, hu, &reach).into_iter().map(|p| Plane { at: p.at + lift, ..p }).collect()
    };
    let round: Vec<(f64, f64)> = (0..=RINGS)
        .map(|k| (k as f64 / RINGS as f64 * std::f64::consts::FRAC_PI_2).sin_cos())
        .map(|(s, c)| (s, c.max(0.0)))
        .collect();
    match roof.shape {
        Shape::Flat => Vec::new(),
        Shape::Gabled => across(&STRAIGHT),
        Shape::Gambrel => across(&BROKEN),
        Shape::Round => across(&round),
        Shape::Hipped => [across(&STRAIGHT), ends(&STRAIGHT, 0.0)].concat(),
        Shape::HalfHipped => [across(&STRAIGHT), ends(&STRAIGHT, 0.5)].concat(),
        Shape::Mansard => [across(&BROKEN), ends(&BROKEN, 0.0)].concat(),
        Shape::Pyramidal => [sides(u, hu, &STRAIGHT), sides(v, hv, &STRAIGHT)].concat(),
        Shape::Skillion => {
            let down = match roof.direction {
                Some(degrees) => DVec2::new(degrees.to_radians().sin(), degrees.to_radians().cos()),
                None => v,
            };
            let along = |p: &DVec2| (*p - plan.centre).dot(down);
            let [lo, hi] =
                plan.ring.iter().map(along).fold([f64::INFINITY, f64::NEG_INFINITY], |[l, h], d| [l.min(d), h.max(d)]);
            let length = (hi - lo).max(1e-6);
            vec![Plane { slope: -down / length, at: hi / length }]
        }
        Shape::Dome => (0..AROUND)
            .flat_map(|k| {
                let angle = (k as f64 + 0.5) / AROUND as f64 * std::f64::consts::TAU;
                let out = DVec2::new(angle.cos() / hu, angle.sin() / hv);
                let axis = out.x * u + out.y * v;
                round
                    .windows(2)
                    .map(move |w| {
                        let fall = (w[1].1 - w[0].1) / (w[1].0 - w[0].0);
                        Plane { slope: fall * axis, at: w[0].1 - fall * w[0].0 }
                    })
                    .collect::<Vec<_>>()
            })
            .collect(),
    }
}

/// The surfaces of a solid over one polygon (longitudes and latitudes), heights over its ground. Roofs over courtyards are flat.
pub(super) fn solid(polygon: &Polygon, heights: Heights, roof: &Roof) -> Vec<CityFace> {
    let mut out = Vec::new();
    let face = |surface: Surface, rings: Vec<Vec<DVec3>>| CityFace { surface, rings, picture: None };
    let rings: Vec<&Vec<DVec2>> = std::iter::once(&polygon.outer).chain(&polygon.holes).collect();
    let level = |z: f64, turned: bool| -> Vec<Vec<DVec3>> {
        let at = |ring: &&Vec<DVec2>| {
            let mut ring: Vec<DVec3> = ring.iter().map(|p| p.extend(z)).collect();
            if turned {
                ring.reverse();
            }
            ring
        };
        rings.iter().map(at).collect()
    };
    out.push(face(Surface::Ground, level(heights.under, true)));
    let plan = Plan::new(&polygon.outer, roof.across);
    let planes = if polygon.holes.is_empty() && heights.top > heights.eaves { planes(roof, &plan) } else { Vec::new() };
    if planes.is_empty() {
        out.push(face(Surface::Roof, level(heights.top, false)));
        for ring in rings {
            for (k, a) in ring.iter().enumerate() {
                let b = ring[(k + 1) % ring.len()];
                let (low, high) = (heights.under, heights.top);
                out.push(face(Surface::Wall, vec![vec![a.extend(low), b.extend(low), b.extend(high), a.extend(high)]]));
            }
        }
        return out;
    }
    let rise = heights.top - heights.eaves;
    let share =
        |p: DVec2| planes.iter().map(|q| q.height(p - plan.centre)).fold(f64::INFINITY, f64::min).clamp(0.0, 1.0);
    let lifted = |p: DVec2| plan.degrees(p).extend(heights.eaves + rise * share(p));
    for (k, plane) in planes.iter().enumerate() {
        let mut piece = plan.ring.clone();
        for (j, other) in planes.iter().enumerate().filter(|(j, _)| *j != k) {
            // Where both are the same plane the first one has it.
            let same = (other.slope - plane.slope).length() < 1e-12 && (other.at - plane.at).abs() < 1e-12;
            if same && j < k {
                piece.clear();
            }
            piece = clipped(&piece, |p| other.height(p - plan.centre) - plane.height(p - plan.centre));
        }
        if area(&piece).abs() > LEAST_M2 {
            out.push(face(Surface::Roof, vec![piece.iter().map(|p| lifted(*p)).collect()]));
        }
    }
    for (k, a) in plan.ring.iter().enumerate() {
        let b = plan.ring[(k + 1) % plan.ring.len()];
        let (low, high) = (plan.degrees(*a).extend(heights.under), plan.degrees(b).extend(heights.under));
        let mut ring = vec![low, high];
        ring.extend(breaks(*a, b, &planes, plan.centre).into_iter().rev().map(|t| lifted(a.lerp(b, t))));
        ring.dedup_by(|p, q| p.distance(*q) < 1e-9);
        if ring.len() >= 3 {
            out.push(face(Surface::Wall, vec![ring]));
        }
    }
    out
}

/// Parameters along an edge, 0..=1 with both ends, at which the roof has a break.
fn breaks(a: DVec2, b: DVec2, planes: &[Plane], centre: DVec2) -> Vec<f64> {
    let mut out = vec![0.0, 1.0];
    for (k, p) in planes.iter().enumerate() {
        for q in &planes[k + 1..] {
            let at = |x: DVec2| p.height(x - centre) - q.height(x - centre);
            let (d0, d1) = (at(a), at(b));
            let t = d0 / (d0 - d1);
            if (1e-6..=1.0 - 1e-6).contains(&t) {
                let x = a.lerp(b, t) - centre;
                let lowest = planes.iter().map(|r| r.height(x)).fold(f64::INFINITY, f64::min);
                if p.height(x) <= lowest + 1e-9 {
                    out.push(t);
                }
            }
        }
    }
    out.sort_by(f64::total_cmp);
    out.dedup_by(|a, b| (*a - *b).abs() < 1e-9);
    out
}

fn area(ring: &[DVec2]) -> f64 {
    0.5 * (0..ring.len()).map(|k| ring[k].perp_dot(ring[(k + 1) % ring.len()])).sum::<f64>()
}

/// The part of a ring where `side` is not negative.
fn clipped(ring: &[DVec2], side: impl Fn(DVec2) -> f64) -> Vec<DVec2> {
    let mut out = Vec::with_capacity(ring.len() + 2);
    for (k, a) in ring.iter().enumerate() {
        let b = ring[(k + 1) % ring.len()];
        let (da, db) = (side(*a), side(b));
        if da >= 0.0 {
            out.push(*a);
        }
        if (da > 0.0 && db < 0.0) || (da < 0.0 && db > 0.0) {
            out.push(a.lerp(b, da / (da - db)));
        }
    }
    out.dedup_by(|p, q| p.distance(*q) < 1e-9);
    out
}

#[cfg(test)]
mod tests;
