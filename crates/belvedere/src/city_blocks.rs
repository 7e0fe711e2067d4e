//! Blocks of a level of abstraction on their ground: roofs above it, walls down to it.

use belvedere_construct::generalise::Level;
use belvedere_core::DVec2;
use belvedere_io::city::prism_on;
use belvedere_scene::city::City;

/// Depth of walls below the terrain, which is drawn with level of detail, metres.
const FOOT_M: f64 = 2.0;
/// Distance from a point below which all buildings have the same weight for its ground, metres.
const NEAR_M: f64 = 10.0;

/// Gives blocks of `city` at a level the shape of prisms over sloping ground: that of `terrain`, and where buildings have ground heights
/// of their own, interpolated between these, above the terrain everywhere. Blocks without any ground height are unchanged.
pub(crate) fn stand(level: &mut Level, city: &City, terrain: Option<&dyn Fn(DVec2) -> Option<f64>>) {
    for (block, shape) in level.blocks.iter().zip(&mut level.city.buildings) {
        let own = level.cells[block.cell].buildings.iter().filter_map(|i| {
            let building = &city.buildings[*i];
            let corners = building.footprint.iter().flat_map(|p| &p.outer);
            let [low, high] = corners.fold([DVec2::MAX, DVec2::MIN], |[a, b], p| [a.min(*p), b.max(*p)]);
            Some((0.5 * (low + high), building.base_m?)).filter(|(at, _)| at.is_finite())
        });
        let own: Vec<(DVec2, f64)> = own.collect();
        let ground = |p: DVec2| match (between(&own, p), terrain.and_then(|t| t(p))) {
            (Some(a), Some(b)) => Some(a.max(b)),
            (a, b) => a.or(b),
        };
        let foot_m = if terrain.is_some() { FOOT_M } else { 0.0 };
        if (terrain.is_some() || !own.is_empty())
            && let Some(faces) = prism_on(&shape.footprint, shape.height_m, foot_m, &ground)
        {
            shape.faces = faces;
        }
    }
}

/// Height at a point interpolated between others (inverse squared distance).
fn between(heights: &[(DVec2, f64)], p: DVec2) -> Option<f64> {
    let (sum, weights) = heights.iter().fold((0.0, 0.0), |(sum, weights), (at, z)| {
        let weight = 1.0 / (at.distance_squared(p) + NEAR_M * NEAR_M);
        (sum + weight * z, weights + weight)
    });
    (weights > 0.0).then(|| sum / weights)
}
