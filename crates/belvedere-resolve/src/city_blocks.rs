//! Blocks of a level of abstraction on their ground: roofs above it, walls down to it.

use crate::city_ground::{OwnGround, middle};
use belvedere_construct::generalise::Level;
use belvedere_core::DVec2;
use belvedere_io::city::prism_on;
use belvedere_scene::city::{Building, City, Surface};

/// Depth of walls below the terrain, which is drawn with level of detail, metres.
pub const FOOT_M: f64 = 2.0;

/// Puts the blocks of `level` on the ground of a city without terrain.
pub fn stand(level: &mut Level, ground: &OwnGround) {
    for block in level.city.buildings.iter_mut().take(level.blocks.len()) {
        match ground {
            OwnGround::Level(z) => block.base_m = Some(*z),
            OwnGround::Sloping(_) => stand_on(block, 0.0, &|p| Some(ground.at(p))),
        }
    }
}

/// The same on `terrain`, walls at least `foot_m` in it; or over it where the buildings of a block, which are those of `city`, have
/// ground heights above it.
pub fn stand_on_terrain(level: &mut Level, city: &City, terrain: &dyn Fn(DVec2) -> Option<f64>, foot_m: f64) {
    for (block, shape) in level.blocks.iter().zip(&mut level.city.buildings) {
        let of = level.cells[block.cell].buildings.iter().map(|i| &city.buildings[*i]);
        let own: Vec<(f64, Option<f64>)> = of.filter_map(|b| Some((b.base_m?, terrain(middle(b))))).collect();
        let over = median(own.iter().filter_map(|(base, ground)| Some(base - (*ground)?)).collect()).unwrap_or(0.0);
        let base = median(own.iter().map(|(base, _)| *base).collect());
        stand_on(shape, foot_m, &|p| terrain(p).map(|z| z + over.max(0.0)).or(base));
    }
}

fn stand_on(block: &mut Building, foot_m: f64, ground: &dyn Fn(DVec2) -> Option<f64>) {
    let Some(faces) = prism_on(&block.footprint, block.height_m, foot_m, ground) else { return };
    // With a base the heights of faces are over the datum.
    let floor = faces.iter().filter(|f| f.surface == Surface::Ground).flat_map(|f| &f.rings).flatten();
    block.base_m = Some(floor.map(|p| p.z).fold(f64::INFINITY, f64::min) + foot_m);
    block.faces = faces;
}

fn median(mut values: Vec<f64>) -> Option<f64> {
    let middle = values.len() / 2;
    (!values.is_empty()).then(|| *values.select_nth_unstable_by(middle, f64::total_cmp).1)
}
