//! A small town by a river, as a mapped city: streets with classes, blocks, houses under gabled and flat roofs, a church.

mod grid;
mod landmarks;
mod plots;
mod river;
mod solids;

use super::BuiltinError;
use super::noise::seeded;
use belvedere_core::DVec2;
use belvedere_scene::{City, CityArea, LandCover, Polygon};
use grid::{Cell, Grid};

/// Least and greatest width of a town, metres.
pub const TOWN_SIZES_M: [f64; 2] = [500.0, 5000.0];

/// A town `size_m` metres wide around the origin, on ground of height 0, of some 1500 buildings at 1200 m.
///
/// Streets follow a bent grid: the middle ones are primary roads, every third one is secondary or tertiary. A river with bridges
/// crosses the town, a church and a town hall stand on the market square, a park lies by the water. Every third house or so has
/// a flat roof and no faces of its own. The same arguments give the same city on every platform.
///
/// # Errors
/// [`BuiltinError::TownSize`] if `size_m` is out of [`TOWN_SIZES_M`].
///
/// Source: ours.
pub fn town(seed: u64, size_m: f64) -> Result<City, BuiltinError> {
    if !(TOWN_SIZES_M[0]..=TOWN_SIZES_M[1]).contains(&size_m) {
        return Err(BuiltinError::TownSize { size_m });
    }
    let mut random = seeded(seed ^ 0x746f_776e);
    let grid = Grid::new(seed, size_m, &mut random);
    let mut city = City { ways: grid.ways(), ..City::default() };
    river::build(&grid, &mut random, &mut city);
    for row in 0..grid.rows() {
        for col in 0..grid.cols() {
            let lot = grid.lot(col, row);
            match grid.cell(col, row) {
                Cell::Country | Cell::River => {}
                Cell::Square => {
                    landmarks::build(&lot, &mut city);
                    city.areas.push(area("Market Square", LandCover::Road, lot));
                }
                Cell::Park => {
                    river::plant(&lot, &mut random, &mut city);
                    city.areas.push(area("River Park", LandCover::Green, lot));
                }
                Cell::Core => plots::build(&lot, true, &mut random, &mut city),
                Cell::Outskirts => {
                    plots::build(&lot, false, &mut random, &mut city);
                    city.areas.push(area("", LandCover::Green, lot));
                }
            }
        }
    }
    let streets = grid.street_polygons();
    city.areas.push(CityArea { name: "Streets".into(), cover: LandCover::Road, polygons: streets });
    Ok(city)
}

fn area(name: &str, cover: LandCover, outer: Vec<DVec2>) -> CityArea {
    CityArea { name: name.into(), cover, polygons: vec![Polygon { outer, holes: Vec::new() }] }
}
