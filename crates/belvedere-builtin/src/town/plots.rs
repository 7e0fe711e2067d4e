//! Houses along the sides of a block: rows in the middle of the town, houses in gardens around it.

use super::solids::{Rect, Roof, solid};
use crate::noise::Random;
use belvedere_core::DVec2;
use belvedere_scene::{Building, City, HeightSource, Polygon};

/// Height of a storey, metres.
const STOREY_M: f64 = 3.1;

/// Fills a block, a convex counter-clockwise ring.
pub(super) fn build(lot: &[DVec2], core: bool, random: &mut Random, city: &mut City) {
    let mut taken: Vec<Rect> = Vec::new();
    for k in 0..lot.len() {
        let (from, to) = (lot[k], lot[(k + 1) % lot.len()]);
        let (along, length) = ((to - from).normalize_or_zero(), from.distance(to));
        let mut at = if core { 0.0 } else { random.range(4.0, 8.0) };
        while at < length {
            let rect = if core { row_house(random, from, along, at) } else { garden_house(random, from, along, at) };
            at += rect.length + if core { 0.0 } else { random.range(5.0, 10.0) };
            if inside(lot, &rect) && !taken.iter().any(|t| t.overlaps(&rect)) {
                city.buildings.push(house(&rect, core, random, city.buildings.len()));
                taken.push(rect);
            }
        }
    }
}

fn row_house(random: &mut Random, from: DVec2, along: DVec2, at: f64) -> Rect {
    Rect { corner: from + along * at, along, length: random.range(9.0, 15.0), depth: random.range(10.5, 13.0) }
}

fn garden_house(random: &mut Random, from: DVec2, along: DVec2, at: f64) -> Rect {
    let corner = from + along * at + along.perp() * random.range(3.0, 5.5);
    Rect { corner, along, length: random.range(8.5, 12.5), depth: random.range(8.0, 10.5) }
}

/// Whether a rectangle lies within a convex counter-clockwise ring.
fn inside(ring: &[DVec2], rect: &Rect) -> bool {
    (0..ring.len()).all(|k| {
        let (a, b) = (ring[k], ring[(k + 1) % ring.len()]);
        rect.corners().iter().all(|p| (b - a).perp_dot(*p - a) > -1e-6)
    })
}

fn house(rect: &Rect, core: bool, random: &mut Random, count: usize) -> Building {
    let storeys = if core { 2.0 + (random.unit() * 3.0).floor() } else { 1.0 + (random.unit() * 2.0).floor() };
    let eaves = storeys * STOREY_M + random.range(0.0, 0.6);
    let kind = random.unit();
    let roof = match kind {
        k if k < 0.3 => None,
        k if k < 0.72 => Some(Roof::Gabled),
        k if k < 0.86 => Some(Roof::GableFront),
        _ => Some(Roof::Hipped),
    };
    let span = match roof {
        Some(Roof::GableFront) => rect.length,
        Some(Roof::Hipped) => rect.length.min(rect.depth),
        _ => rect.depth,
    };
    let ridge = eaves + 0.5 * span * random.range(0.75, 1.0);
    Building {
        id: format!("house-{}", count + 1),
        name: String::new(),
        landmark: false,
        footprint: vec![Polygon { outer: rect.corners().to_vec(), holes: Vec::new() }],
        base_m: Some(0.0),
        height_m: if roof.is_some() { 0.5 * (eaves + ridge) } else { eaves + 0.8 },
        height_source: if roof.is_some() { HeightSource::Shape } else { HeightSource::Stated },
        faces: roof.map_or_else(Vec::new, |roof| solid(rect, roof, eaves, ridge)),
    }
}
