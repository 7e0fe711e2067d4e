//! Ground: nodes with the tints of the map, pictures and areas laid over them.

use super::sheet::Sheet;
use super::{Carrier, ExportOptions, MOST_TRIANGLES};
use crate::BelvedereError;
use belvedere_composite::tint::GroundTint;
use belvedere_core::{DVec2, Warning, WarningKind, polygon};
use belvedere_scene::{AreaLayer, Color, Drape, Heightfield, Scene, TerrainLayer};
use rayon::prelude::*;

/// Displaced ground with its colours.
pub(super) fn sheet(
    terrain: &TerrainLayer,
    scene: &Scene,
    carrier: &Carrier<'_>,
    options: &ExportOptions,
    warnings: &mut Vec<Warning>,
    id: &str,
) -> Result<Sheet, BelvedereError> {
    let hf = &*terrain.heightfield;
    let step = step(hf, options.ground_nodes.max(4));
    if step > 1 {
        let text = format!(
            "layer \"{id}\": one of {step} nodes of the ground is exported in each direction, so that there are at most {}; lines near \
             it may sink in; raise the number of nodes to take more",
            options.ground_nodes
        );
        warnings.push(
            Warning::new(WarningKind::Reduced, text).about(id).with("step", step as f64).settled_by("ground_nodes"),
        );
    }
    let (cols, rows) = (taken(hf.cols(), step), taken(hf.rows(), step));
    let mut colors = tints(terrain, &cols, &rows);
    for drape in &terrain.drapes {
        lay(drape, hf, (&cols, &rows), &mut colors);
    }
    for layer in &scene.layers {
        if let Some(areas) = layer.kind.areas() {
            fill(areas, hf, (&cols, &rows), &mut colors);
        }
    }
    let places: Vec<(usize, usize)> = rows.iter().flat_map(|row| cols.iter().map(|col| (*col, *row))).collect();
    let nodes: Vec<_> =
        places.par_iter().map(|(col, row)| hf.node(*col, *row).map(|p| (p, carrier.carry(p)))).collect();
    let mut sheet = Sheet { smooth: true, ..Sheet::default() };
    for (node, color) in nodes.iter().zip(&colors) {
        match node {
            Some((p, carried)) => sheet.push(*p, *carried, *color),
            None => sheet.push(belvedere_core::DVec3::ZERO, None, *color),
        };
    }
    let number = |col: usize, row: usize| (row * cols.len() + col) as u32;
    for row in 1..rows.len() {
        for col in 1..cols.len() {
            let [nw, ne] = [col - 1, col].map(|col| number(col, row - 1));
            let [sw, se] = [col - 1, col].map(|col| number(col, row));
            sheet.triangles.extend([[nw, sw, se], [nw, se, ne]]);
        }
    }
    sheet.refined(carrier, MOST_TRIANGLES, &options.progress)
}

/// The smallest step between nodes with which there are at most `most`.
fn step(hf: &Heightfield, most: usize) -> usize {
    (1..).find(|step| taken(hf.cols(), *step).len() * taken(hf.rows(), *step).len() <= most).unwrap_or(1)
}

/// Every `step`th node and the last one.
fn taken(nodes: usize, step: usize) -> Vec<usize> {
    let mut out: Vec<usize> = (0..nodes).step_by(step).collect();
    if out.last().is_some_and(|last| last + 1 < nodes) {
        out.push(nodes - 1);
    }
    out
}

fn tints(terrain: &TerrainLayer, cols: &[usize], rows: &[usize]) -> Vec<[f32; 3]> {
    let hf = &*terrain.heightfield;
    let tint = GroundTint::new(&terrain.palette, hf.z_range());
    let height = |col: usize, row: usize| hf.node(col.min(hf.cols() - 1), row.min(hf.rows() - 1)).map(|p| p.z);
    let spacing = hf.spacing();
    let color = |col: usize, row: usize| {
        let Some(z) = height(col, row) else { return [0.0; 3] };
        let slope = |a: Option<f64>, b: Option<f64>, length: f64| a.zip(b).map_or(0.0, |(a, b)| (b - a) / length);
        let across = slope(height(col.saturating_sub(1), row), height(col + 1, row), 2.0 * spacing.x);
        let along = slope(height(col, row.saturating_sub(1)), height(col, row + 1), 2.0 * spacing.y);
        // Rows go south.
        tint.color(z, DVec2::new(across, -along))
    };
    rows.par_iter().flat_map_iter(|row| cols.iter().map(move |col| color(*col, *row))).collect()
}

/// Lays a picture over the nodes.
fn lay(drape: &Drape, hf: &Heightfield, (cols, rows): (&[usize], &[usize]), colors: &mut [[f32; 3]]) {
    let a = drape.pixel_from_scene;
    for (i, color) in colors.iter_mut().enumerate() {
        let p = hf.node_xy(cols[i % cols.len()], rows[i / cols.len()]);
        let (x, y) = (a[0] * p.x + a[1] * p.y + a[2], a[3] * p.x + a[4] * p.y + a[5]);
        if (0.0..drape.width as f64).contains(&x) && (0.0..drape.height as f64).contains(&y) {
            let [r, g, b, alpha] = drape.pixels[y as usize * drape.width + x as usize];
            over(color, Color { r, g, b, a: alpha });
        }
    }
}

/// Fills areas, by the rows of nodes that they cross.
fn fill(areas: &AreaLayer, hf: &Heightfield, (cols, rows): (&[usize], &[usize]), colors: &mut [[f32; 3]]) {
    for feature in &areas.features {
        let color = feature.style.as_ref().and_then(|style| style.color).unwrap_or(areas.fill);
        let ys = feature.rings.iter().flatten().map(|p| p.y);
        let (low, high) = ys.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), y| (low.min(y), high.max(y)));
        for (k, row) in rows.iter().enumerate() {
            let y = hf.node_xy(0, *row).y;
            if y < low || y > high {
                continue;
            }
            let mut crossed: Vec<f64> = feature.rings.iter().flat_map(|ring| polygon::crossings(ring, y)).collect();
            crossed.sort_by(f64::total_cmp);
            for [from, to] in crossed.as_chunks().0 {
                for (i, col) in cols.iter().enumerate() {
                    if (*from..*to).contains(&hf.node_xy(*col, *row).x) {
                        over(&mut colors[k * cols.len() + i], color);
                    }
                }
            }
        }
    }
}

/// Blends a colour over another one, in the space of stored values, as pictures do.
fn over(color: &mut [f32; 3], over: Color) {
    let alpha = f32::from(over.a) / 255.0;
    for (below, above) in color.iter_mut().zip([over.r, over.g, over.b]) {
        let stored = stored(*below);
        *below = linear(stored + alpha * (f32::from(above) / 255.0 - stored));
    }
}

/// A linear colour as stored (sRGB), 0..=1.
fn stored(linear: f32) -> f32 {
    if linear <= 0.003_130_8 { 12.92 * linear } else { 1.055 * linear.powf(1.0 / 2.4) - 0.055 }
}

/// A stored (sRGB) colour as linear, 0..=1.
pub(super) fn linear(stored: f32) -> f32 {
    if stored <= 0.040_45 { stored / 12.92 } else { ((stored + 0.055) / 1.055).powf(2.4) }
}

/// A colour as linear red, green, blue.
pub(super) fn linear_of(color: Color) -> [f32; 3] {
    [color.r, color.g, color.b].map(|v| linear(f32::from(v) / 255.0))
}
