//! The cells as a drape: mountains in colours that differ from those of their neighbours.

use super::area::Area;
use belvedere::disocclusion::internals::NO_CELL;
use belvedere::scene::{Drape, PaletteName, Scene};

/// Opacity of the colours over the relief.
const ALPHA: u8 = 215;

/// The scene with every cell in a separate colour.
pub(crate) fn painted(area: &Area) -> Scene {
    let field = &area.field;
    let colors = colors(area);
    let pixel = |label: &u32| if *label == NO_CELL { [0; 4] } else { colors[*label as usize] };
    let (nw, d) = (field.north_west(), field.spacing());
    let drape = Drape {
        pixels: area.cells.labels().iter().map(pixel).collect(),
        width: field.cols(),
        height: field.rows(),
        // The pixel centres are at nodes.
        pixel_from_scene: [1.0 / d.x, 0.0, 0.5 - nw.x / d.x, 0.0, -1.0 / d.y, 0.5 + nw.y / d.y],
    };
    let mut scene = area.session.scene().clone();
    for layer in &mut scene.layers {
        if let Some(terrain) = layer.kind.terrain_mut() {
            terrain.drapes = vec![drape.clone()];
            terrain.palette = PaletteName::Plain.into();
        }
    }
    scene
}

/// The first of a few muted colours that no neighbour has. As for countries on a map, a few colours are sufficient.
fn colors(area: &Area) -> Vec<[u8; 4]> {
    const TABLE: [[u8; 3]; 8] = [
        [166, 206, 227],
        [178, 223, 138],
        [251, 180, 174],
        [253, 205, 120],
        [202, 178, 214],
        [255, 242, 150],
        [150, 205, 190],
        [217, 200, 180],
    ];
    let mut chosen: Vec<Option<usize>> = vec![None; area.cells.len()];
    for cell in 0..area.cells.len() {
        let taken: Vec<usize> = area.cells.neighbours(cell).0.iter().filter_map(|&r| chosen[r as usize]).collect();
        // The search starts at another colour for each cell, so that no colour covers most of the map.
        let mut free = (0..TABLE.len()).map(|k| (k + cell) % TABLE.len()).filter(|k| !taken.contains(k));
        chosen[cell] = Some(free.next().unwrap_or(cell % TABLE.len()));
    }
    chosen.into_iter().map(|k| k.map_or([0; 4], |k| [TABLE[k][0], TABLE[k][1], TABLE[k][2], ALPHA])).collect()
}
