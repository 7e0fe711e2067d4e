//! Volumes of single buildings.

use super::shapes::{area, land_of};
use belvedere_scene::city::Building;

/// Volume of a building, m^3: that between its surfaces, which stand on its base where they are open below; without surfaces its
/// footprint times its height.
///
/// By the divergence theorem: the sum over all surfaces of their area in plan, > 0 for those that look up, times their height.
pub fn volume_m3(building: &Building) -> f64 {
    let base = building.base_m.unwrap_or(0.0);
    let rings = building.faces.iter().flat_map(|f| &f.rings);
    let under = |ring: &Vec<glam::DVec3>| {
        let corner = |k: usize| ring[k] - ring[0];
        let part = |k: usize| {
            let (a, b) = (corner(k - 1), corner(k));
            0.5 * a.truncate().perp_dot(b.truncate()) * (ring[0].z - base + (a.z + b.z) / 3.0)
        };
        (2..ring.len()).map(part).sum::<f64>()
    };
    // Solids whose surfaces all look inwards have a negative volume.
    let within = rings.map(under).sum::<f64>().abs();
    if within.is_finite() && within > 0.0 { within } else { area(&land_of(&building.footprint)) * height_m(building) }
}

/// Height of a building, 9 m where it has none that is usable, metres.
pub(super) fn height_m(building: &Building) -> f64 {
    let usable = building.height_m.is_finite() && building.height_m > 0.0;
    if usable { building.height_m } else { 9.0 }
}

#[cfg(test)]
mod tests {
    use super::*;
    use belvedere_scene::city::{CityFace, HeightSource, Polygon, Surface};
    use glam::DVec3;

    /// A wedge of 10 m by 20 m, 6 m high at the sides and 10 m at the ridge, on a floor at 500 m.
    fn house() -> Building {
        let at = |x: f64, y: f64, z: f64| DVec3::new(400_000.0 + x, 5_000_000.0 + y, 500.0 + z);
        let face = |surface, ring: Vec<DVec3>| CityFace { surface, rings: vec![ring], picture: None };
        let low = vec![at(0.0, 0.0, 0.0), at(0.0, 20.0, 0.0), at(10.0, 20.0, 0.0), at(10.0, 0.0, 0.0)];
        let west = vec![at(0.0, 0.0, 6.0), at(5.0, 0.0, 10.0), at(5.0, 20.0, 10.0), at(0.0, 20.0, 6.0)];
        let east = vec![at(5.0, 0.0, 10.0), at(10.0, 0.0, 6.0), at(10.0, 20.0, 6.0), at(5.0, 20.0, 10.0)];
        Building {
            id: String::new(),
            name: String::new(),
            landmark: false,
            footprint: vec![Polygon { outer: low.iter().rev().map(|p| p.truncate()).collect(), holes: Vec::new() }],
            base_m: Some(500.0),
            height_m: 8.0,
            height_source: HeightSource::Shape,
            faces: vec![face(Surface::Ground, low), face(Surface::Roof, west), face(Surface::Roof, east)],
        }
    }

    #[test]
    fn the_volume_of_a_building_is_that_between_its_surfaces() {
        let mut house = house();
        assert!((volume_m3(&house) - 200.0 * 8.0).abs() < 1e-6, "{}", volume_m3(&house));
        house.faces.remove(0);
        assert!((volume_m3(&house) - 200.0 * 8.0).abs() < 1e-6, "without a floor {}", volume_m3(&house));
        house.faces.iter_mut().flat_map(|f| &mut f.rings).for_each(|ring| ring.reverse());
        assert!((volume_m3(&house) - 200.0 * 8.0).abs() < 1e-6, "turned inwards {}", volume_m3(&house));
        house.faces.clear();
        house.height_m = 3.0;
        assert!((volume_m3(&house) - 600.0).abs() < 1e-6, "a prism {}", volume_m3(&house));
    }
}
