//! The church and the town hall on the market square.

use super::solids::{Rect, Roof, solid};
use belvedere_core::DVec2;
use belvedere_scene::{Building, City, CityFace, HeightSource, Polygon};

/// Adds both to the square, a convex counter-clockwise ring whose first side runs east.
pub(super) fn build(square: &[DVec2], city: &mut City) {
    let centre = square.iter().sum::<DVec2>() / square.len() as f64;
    let along = (square[1] - square[0]).normalize_or_zero();
    let rect = |east: f64, north: f64, length: f64, depth: f64| Rect {
        corner: centre + along * east + along.perp() * north,
        along,
        length,
        depth,
    };
    let church = [
        (rect(-26.0, 7.5, 9.0, 9.0), Roof::Pyramid, 36.0, 60.0),
        (rect(-17.0, 5.0, 31.0, 14.0), Roof::Gabled, 12.0, 21.0),
        (rect(14.0, 7.5, 10.0, 9.0), Roof::Gabled, 9.0, 15.0),
    ];
    city.buildings.push(landmark("church", "Town Church", &church));
    let hall = [
        (rect(-12.0, -26.0, 27.0, 14.0), Roof::Hipped, 12.0, 18.0),
        (rect(-1.5, -12.0, 6.0, 6.0), Roof::Pyramid, 22.0, 30.0),
    ];
    city.buildings.push(landmark("town-hall", "Town Hall", &hall));
}

/// A landmark of several solids; its height is that of the widest one.
fn landmark(id: &str, name: &str, solids: &[(Rect, Roof, f64, f64)]) -> Building {
    let widest = solids.iter().max_by(|a, b| a.0.area().total_cmp(&b.0.area()));
    let faces: Vec<CityFace> =
        solids.iter().flat_map(|(rect, roof, eaves, ridge)| solid(rect, *roof, *eaves, *ridge)).collect();
    Building {
        id: id.into(),
        name: name.into(),
        landmark: true,
        footprint: solids.iter().map(|s| Polygon { outer: s.0.corners().to_vec(), holes: Vec::new() }).collect(),
        base_m: Some(0.0),
        height_m: widest.map_or(1.0, |(_, _, eaves, ridge)| 0.5 * (eaves + ridge)),
        height_source: HeightSource::Shape,
        faces,
    }
}
