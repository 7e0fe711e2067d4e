//! Rings in plan, and the plan of solids.

use belvedere_core::polygon::{doubled_area, is_inside};
use belvedere_core::{Warning, WarningKind};
use belvedere_scene::{CityFace, HeightSource, Polygon, Surface};
use glam::{DVec2, DVec3};

/// Largest valid coordinate, in the unit of the file: no coordinate system of the earth has larger ones.
const FARTHEST: f64 = 1e8;
/// Height of a storey, metres.
const STOREY_M: f64 = 2.5;
/// Share of the box around a solid that it fills at least, for its volume to have a sign: rounding leaves less.
const LEAST_FILLED: f64 = 1e-6;
/// Buildings higher than this give a warning, metres: the file may have other units.
const HIGHEST_M: f64 = 2000.0;

/// Numbers of repairs, for one warning each.
#[derive(Debug, Default, Clone, Copy)]
pub(super) struct Repairs {
    /// Rings of fewer than three different vertices.
    pub(super) short_rings: usize,
    /// Rings without area.
    pub(super) flat_rings: usize,
    /// Footprints that cross themselves.
    pub(super) crossing: usize,
    /// Heights that are out of range, or not numbers.
    pub(super) heights: usize,
    /// Heights that are stated as approximate.
    pub(super) about: usize,
    /// Heights that are lists or ranges.
    pub(super) several: usize,
    /// Polygons with a coordinate beyond the limit, or not finite.
    pub(super) far: usize,
    /// Holes that are not within their outline.
    pub(super) holes: usize,
    /// Solids higher than the limit.
    pub(super) tall: usize,
    /// Solids whose faces look inwards.
    pub(super) inside_out: usize,
    /// References to surfaces that lead nowhere.
    pub(super) lost: usize,
}

impl Repairs {
    pub(super) fn warnings(&self) -> impl Iterator<Item = Warning> {
        use WarningKind::{Assumed, Ignored, Inexact, Repaired, Suspect};
        let of = Warning::counted;
        [
            of(Ignored, self.short_rings, "rings of fewer than 3 different vertices were dropped"),
            of(Ignored, self.flat_rings, "rings without area were dropped"),
            of(Suspect, self.crossing, "footprints cross themselves; their outlines are drawn as they are"),
            of(Ignored, self.holes, "holes that are not within their outline were dropped"),
            of(Ignored, self.far, "polygons with coordinates beyond 1e8 were dropped; correct their system"),
            of(Repaired, self.heights, "heights that are no numbers of metres in 0..2000 were not believed"),
            of(Inexact, self.about, "heights are stated as approximate, such as ~18, and are taken as they stand"),
            of(Assumed, self.several, "heights are lists or ranges, such as 5;7; the largest of each is taken"),
            of(Repaired, self.inside_out, "solids were inside out and are turned"),
            of(Ignored, self.lost, "references to surfaces lead nowhere and were left out"),
            of(Suspect, self.tall, "buildings are higher than 2000 m by their shape; check the unit of their heights"),
        ]
        .into_iter()
        .flatten()
    }
}

/// Area vector of a ring in space, twice as long as the area.
pub(super) fn normal(ring: &[DVec3]) -> DVec3 {
    let origin = ring.first().copied().unwrap_or_default();
    (0..ring.len()).map(|k| (ring[k] - origin).cross(ring[(k + 1) % ring.len()] - origin)).sum()
}

/// The polygon of rings, outer first: repeated vertices dropped, outer ring counter-clockwise, holes clockwise. `None` if the outer
/// ring is not valid.
pub(super) fn polygon(rings: impl IntoIterator<Item = Vec<DVec2>>, repairs: &mut Repairs) -> Option<Polygon> {
    let mut cleaned = rings.into_iter().map(|ring| clean(ring, repairs)).collect::<Vec<_>>().into_iter();
    let mut outer = cleaned.next()??;
    if outer.iter().any(|p| !(p.abs().max_element() <= FARTHEST)) {
        repairs.far += 1;
        return None;
    }
    if doubled_area(&outer) < 0.0 {
        outer.reverse();
    }
    repairs.crossing += usize::from(crosses_itself(&outer));
    let mut holes = Vec::new();
    for mut hole in cleaned.flatten() {
        if !is_hole(&outer, &hole) {
            repairs.holes += 1;
            continue;
        }
        if doubled_area(&hole) > 0.0 {
            hole.reverse();
        }
        holes.push(hole);
    }
    Some(Polygon { holes, outer })
}

/// Whether a ring can be a hole of another: smaller, and with a vertex in it.
fn is_hole(outer: &[DVec2], hole: &[DVec2]) -> bool {
    doubled_area(hole).abs() < doubled_area(outer).abs() && hole.iter().any(|p| is_inside([outer], *p))
}

/// A position of a solid, or why it is invalid.
pub(super) fn position(p: DVec3) -> Result<DVec3, String> {
    if p.abs().max_element() <= FARTHEST {
        return Ok(p);
    }
    Err(format!("lies at ({:e}, {:e}, {:e}), the limit is 1e8", p.x, p.y, p.z))
}

fn clean(mut ring: Vec<DVec2>, repairs: &mut Repairs) -> Option<Vec<DVec2>> {
    ring.dedup();
    while ring.len() > 1 && ring.first() == ring.last() {
        ring.pop();
    }
    let (short, flat) = (ring.len() < 3, doubled_area(&ring).abs() < 1e-12);
    repairs.short_rings += usize::from(short);
    repairs.flat_rings += usize::from(!short && flat);
    (!short && !flat).then_some(ring)
}

/// Whether two edges of a ring cross; tested for rings of up to 2000 vertices, else `false`.
fn crosses_itself(ring: &[DVec2]) -> bool {
    let n = ring.len();
    let edge = |i: usize| (ring[i], ring[(i + 1) % n]);
    let side = |a: DVec2, b: DVec2, p: DVec2| (b - a).perp_dot(p - a);
    let cross = |i: usize, j: usize| {
        let ((a, b), (c, d)) = (edge(i), edge(j));
        side(a, b, c) * side(a, b, d) < 0.0 && side(c, d, a) * side(c, d, b) < 0.0
    };
    n <= 2000 && (0..n).any(|i| (i + 2..n).any(|j| (i, j) != (0, n - 1) && cross(i, j)))
}

/// Kind of a face without semantics, by its direction.
pub(super) fn surface_of(rings: &[Vec<DVec3>]) -> Surface {
    let up = rings.first().map_or(0.0, |ring| normal(ring).normalize_or_zero().z);
    match up {
        up if up > 0.35 => Surface::Roof,
        up if up < -0.35 => Surface::Ground,
        _ => Surface::Wall,
    }
}

/// Turns the faces of a solid that is inside out, by the sign of its volume; whether it was. Kinds that faces have by their direction
/// alone are told anew; those that a file states stay.
pub(super) fn turn_outwards(faces: &mut [CityFace]) -> bool {
    let all = || faces.iter().flat_map(|f| f.rings.iter().flatten()).copied();
    let (low, high) = all().fold((DVec3::INFINITY, DVec3::NEG_INFINITY), |(low, high), p| (low.min(p), high.max(p)));
    // Over its lowest level a solid without a floor has a volume, too.
    let foot = (0.5 * (low + high)).with_z(low.z);
    let above = |ring: &Vec<DVec3>| ring.first().map_or(0.0, |p| normal(ring).dot(*p - foot));
    let volume: f64 = faces.iter().flat_map(|f| &f.rings).map(above).sum::<f64>() / 6.0;
    if volume > -LEAST_FILLED * (high - low).element_product() || faces.is_empty() {
        return false;
    }
    let is_stated = faces.iter().any(|f| f.surface != surface_of(&f.rings));
    for face in faces {
        face.rings.iter_mut().for_each(|ring| ring.reverse());
        face.picture.iter_mut().flat_map(|picture| &mut picture.rings).for_each(|ring| ring.reverse());
        if !is_stated {
            face.surface = surface_of(&face.rings);
        }
    }
    true
}

/// Footprint, height of the ground and height over it of a solid's faces.
pub(super) fn of_solid(faces: &[CityFace], repairs: &mut Repairs) -> (Vec<Polygon>, f64, f64) {
    let z = |f: &CityFace| f.rings.iter().flatten().map(|p| p.z).collect::<Vec<_>>();
    let all: Vec<f64> = faces.iter().flat_map(z).collect();
    let lowest = all.iter().copied().fold(f64::INFINITY, f64::min);
    let grounds: Vec<&CityFace> = faces.iter().filter(|f| f.surface == Surface::Ground).collect();
    let base = median(floor(&grounds).into_iter().flat_map(z).collect()).unwrap_or(lowest);
    let roofs: Vec<f64> = faces.iter().filter(|f| f.surface == Surface::Roof).flat_map(z).collect();
    let top = median(roofs).unwrap_or_else(|| all.iter().copied().fold(f64::NEG_INFINITY, f64::max));
    // Without a floor the roofs give the footprint.
    let plan = if grounds.is_empty() { faces.iter().filter(|f| f.surface == Surface::Roof).collect() } else { grounds };
    let flat = |f: &&CityFace| {
        let rings = f.rings.iter().map(|ring| ring.iter().map(|p| p.truncate()).collect());
        polygon(rings, repairs)
    };
    let footprint = plan.iter().filter_map(flat).collect();
    repairs.tall += usize::from(top - base > HIGHEST_M);
    (footprint, base, top - base)
}

/// The faces that a solid stands on: the lowest of those that look down, and all within a storey of it. Eaves, passages and
/// balconies lie higher.
fn floor<'f>(grounds: &[&'f CityFace]) -> Vec<&'f CityFace> {
    let height = |f: &CityFace| median(f.rings.iter().flatten().map(|p| p.z).collect()).unwrap_or(f64::INFINITY);
    let lowest = grounds.iter().map(|f| height(f)).fold(f64::INFINITY, f64::min);
    grounds.iter().copied().filter(|f| height(f) <= lowest + STOREY_M).collect()
}

fn median(mut values: Vec<f64>) -> Option<f64> {
    let middle = values.len() / 2;
    (!values.is_empty()).then(|| *values.select_nth_unstable_by(middle, f64::total_cmp).1)
}

/// Number of heights per source, in words for messages.
pub(super) fn sources(heights: impl Iterator<Item = HeightSource>) -> String {
    let mut counts = std::collections::BTreeMap::new();
    heights.for_each(|source| *counts.entry(source).or_insert(0usize) += 1);
    let words = counts.into_iter().map(|(source, count)| {
        let from = match source {
            HeightSource::Shape => "by their shape",
            HeightSource::Stated => "stated",
            HeightSource::Levels => "from storeys",
            HeightSource::Assumed => "assumed to be 9 m",
        };
        format!("{count} {from}")
    });
    words.collect::<Vec<_>>().join(", ")
}
