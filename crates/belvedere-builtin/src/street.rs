//! A town of towers on a street grid.

use super::noise::{Random, seeded};
use super::viewpoint::{Viewpoint, best_viewpoint};
use super::{BuiltinError, SuggestedCamera, ground_layer, line_layer};
use belvedere_core::{DVec2, DVec3};
use belvedere_scene::{
    AreaFeature, AreaLayer, AreaSurface, BoxLayer, BoxShape, Color, Crs, Heightfield, Hidden, Layer, LineFeature,
    NodeState, PaletteName, Scene, Unit, drape_polyline,
};

/// Blocks per side.
const BLOCKS: usize = 9;
/// Height of the ground, metres.
const GROUND_M: f64 = 12.0;

/// Edges of the blocks along one axis: `[from, to]` in metres, centred on 0.
fn block_edges(random: &mut Random) -> Vec<[f64; 2]> {
    let (mut edges, mut at) = (Vec::new(), 0.0);
    for k in 0..BLOCKS {
        let depth = random.range(74.0, 104.0);
        edges.push([at, at + depth]);
        at += depth + if k % 3 == 2 { 30.0 } else { 17.0 }; // every third street is an avenue
    }
    let shift = 0.5 * edges.last().map_or(0.0, |e| e[1]);
    edges.iter().map(|e| [e[0] - shift, e[1] - shift]).collect()
}

/// Middles of the streets along one axis, outermost ones included.
fn street_middles(edges: &[[f64; 2]]) -> Vec<f64> {
    let mut middles: Vec<f64> = edges.windows(2).map(|w| 0.5 * (w[0][1] + w[1][0])).collect();
    if let (Some(first), Some(last)) = (edges.first(), edges.last()) {
        middles.insert(0, first[0] - 9.0);
        middles.push(last[1] + 9.0);
    }
    middles
}

/// A town of some 300 boxes on flat ground: 9 x 9 blocks with towers that rise towards the centre.
///
/// Layers: `ground`, `blocks`, `parks`, `towers`, and `route` (must be seen), which follows the streets between the towers from
/// one corner to the other. The suggested camera sees less than half of it. The same seed gives the same bytes on every platform.
///
/// # Errors
/// [`BuiltinError::Heightfield`], which does not occur in practice.
///
/// Source: ours.
pub fn street(seed: u64) -> Result<(Scene, SuggestedCamera), BuiltinError> {
    let mut random = seeded(seed ^ 0x7374_7265_6574);
    let (xs, ys) = (block_edges(&mut random), block_edges(&mut random));
    let (nodes, spacing) = (145, 25.0);
    let corner = DVec2::new(-0.5, 0.5) * spacing * (nodes - 1) as f64;
    let heights = vec![GROUND_M as f32; nodes * nodes];
    let terrain = Heightfield::new(
        corner,
        DVec2::splat(spacing),
        nodes,
        nodes,
        heights,
        vec![NodeState::Measured; nodes * nodes],
    )?;
    let (mut towers, mut blocks, mut parks) = (Vec::new(), Vec::new(), Vec::new());
    for (row, y) in ys.iter().enumerate() {
        for (col, x) in xs.iter().enumerate() {
            let ring =
                vec![DVec2::new(x[0], y[0]), DVec2::new(x[1], y[0]), DVec2::new(x[1], y[1]), DVec2::new(x[0], y[1])];
            if random.unit() < 0.05 {
                parks.push(AreaFeature { style: None, name: format!("Park {}", parks.len() + 1), rings: vec![ring] });
                continue;
            }
            blocks.push(AreaFeature { style: None, name: format!("Block {col}-{row}"), rings: vec![ring] });
            build_block(&mut random, *x, *y, &mut towers);
        }
    }
    let line = route_line(&mut random, &street_middles(&xs), &street_middles(&ys));
    let points = drape_polyline(&terrain, &line).parts.into_iter().next().unwrap_or_default();
    let Viewpoint { eye, look_at } = best_viewpoint(&terrain, &towers, &points, &[0.12, 0.16, 0.2, 0.25], 0.42);
    let title = format!("Town {seed}: a route between the towers");
    let layers = vec![
        ground_layer(terrain, PaletteName::Plain.into()),
        area_layer("blocks", blocks, Color::rgb(222, 217, 207)),
        area_layer("parks", parks, Color::rgb(146, 178, 120)),
        Layer { id: "towers".into(), must_see: false, kind: BoxLayer::new(towers).into() },
        line_layer("route", LineFeature { style: None, name: "Route through town".into(), points }),
    ];
    let camera = SuggestedCamera { title: title.clone(), eye, look_at, fov_y: 45f64.to_radians() };
    Ok((Scene { title, crs: Crs::Local, unit: Unit::Metre, layers, ..Scene::default() }, camera))
}

fn area_layer(id: &str, features: Vec<AreaFeature>, fill: Color) -> Layer {
    Layer {
        id: id.into(),
        must_see: false,
        kind: AreaLayer {
            features,
            fill,
            outline: None,
            width_px: 1.0,
            surface: AreaSurface::Plain,
            hidden: Hidden::Cut,
            lift_m: 0.1,
            label_px: None,
            beyond: 0.0,
        }
        .into(),
    }
}

/// Adds towers on the lots of one block; tall ones stand on a podium.
fn build_block(random: &mut Random, x: [f64; 2], y: [f64; 2], towers: &mut Vec<BoxShape>) {
    let lots = [(1, 1), (2, 1), (1, 2), (2, 2), (2, 2), (3, 2)][(random.unit() * 6.0) as usize % 6];
    let (lot_x, lot_y) = ((x[1] - x[0]) / f64::from(lots.0), (y[1] - y[0]) / f64::from(lots.1));
    for i in 0..lots.0 {
        for j in 0..lots.1 {
            let centre = DVec2::new(x[0] + (f64::from(i) + 0.5) * lot_x, y[0] + (f64::from(j) + 0.5) * lot_y);
            let from_core = centre.length_squared() / (300.0 * 300.0);
            let core = 1.0 / (1.0 + from_core * from_core);
            let u = random.unit();
            let height = (16.0 + 26.0 * random.unit() + core * (30.0 + 165.0 * u * u * u)).round();
            let (sx, sy) = (lot_x - random.range(5.0, 10.0), lot_y - random.range(5.0, 10.0));
            let color = facade(random);
            let mut stack = |size: DVec3, z: f64, color: Color| {
                towers.push(BoxShape { base: centre.extend(GROUND_M + z), size, yaw: 0.0, color });
            };
            if height > 75.0 {
                let podium = random.range(12.0, 24.0).round();
                let slim = random.range(0.55, 0.78);
                stack(DVec3::new(sx, sy, podium), 0.0, shade(color, 12));
                stack(DVec3::new(sx * slim, sy * slim, height - podium), podium, color);
            } else {
                stack(DVec3::new(sx, sy, height), 0.0, color);
            }
        }
    }
}

fn facade(random: &mut Random) -> Color {
    const FACADES: [[u8; 3]; 7] = [
        [214, 205, 190],
        [196, 186, 172],
        [184, 192, 200],
        [160, 174, 188],
        [205, 180, 155],
        [226, 222, 214],
        [172, 150, 134],
    ];
    let [r, g, b] = FACADES[(random.unit() * 7.0) as usize % 7];
    let lighter = (random.unit() * 16.0) as u8;
    Color::rgb(r + lighter, g + lighter, b + lighter)
}

fn shade(c: Color, by: u8) -> Color {
    Color::rgb(c.r.saturating_sub(by), c.g.saturating_sub(by), c.b.saturating_sub(by))
}

/// A route along the streets from the south-west to the north-east, one to three blocks between turns, corners cut by 6 m.
fn route_line(random: &mut Random, xs: &[f64], ys: &[f64]) -> Vec<DVec2> {
    let (mut i, mut j, mut east) = (1, 1, random.unit() < 0.5);
    let (last_i, last_j) = (xs.len() - 2, ys.len() - 2);
    let mut corners = vec![DVec2::new(xs[i], ys[j])];
    while (i, j) != (last_i, last_j) {
        let run = 1 + (random.unit() * 3.0) as usize;
        if east {
            i = (i + run).min(last_i);
        } else {
            j = (j + run).min(last_j);
        }
        let corner = DVec2::new(xs[i], ys[j]);
        if corners.last() != Some(&corner) {
            corners.push(corner);
        }
        east = !east;
    }
    let mut line = vec![corners[0]];
    for w in corners.windows(3) {
        let toward = |p: DVec2| w[1] + (p - w[1]).normalize_or_zero() * 6.0;
        line.extend([toward(w[0]), toward(w[2])]);
    }
    line.extend(corners.last());
    line
}
