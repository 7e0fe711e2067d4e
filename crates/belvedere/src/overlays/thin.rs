//! Ground that still covers what must be seen, drawn see-through.

use belvedere_core::{DVec2, SpaceMap, Stage, View};
use belvedere_disocclusion::DisocclusionError;
use belvedere_disocclusion::visibility_qp::{LinesOfSight, ViewSight};
use belvedere_disocclusion::{Covered, Field, ghost_alpha};
use belvedere_scene::{Frame, Heightfield, LayerKind, Scene};

/// Occlusion at which the ground is half see-through, scene units.
const HALF_M: f64 = 20.0;
/// Radius around a covered point in which the ground is see-through, share of the picture's width.
const RADIUS: f64 = 0.02;
/// Ground this near to a covered point stays whole, cells.
const WHOLE: f64 = 1.0;
/// Ground within this of a line of sight is cut away, cells.
const WIDTH: f64 = 1.0;
/// The cut ground lies this far below the lines of sight, scene units.
const BELOW: f64 = 0.5;

/// The scene with the ground cut away down to the lines of sight of what it covers. `None` without terrain.
///
/// # Errors
/// [`DisocclusionError::Terrain`].
pub(crate) fn cut(scene: &Scene, view: &View, covered: &[Covered]) -> Result<Option<Scene>, DisocclusionError> {
    let Some(terrain) = scene.terrain() else { return Ok(None) };
    let fallen = |xy: DVec2| {
        let earth = view.stages().iter().find_map(|s| match s {
            Stage::EarthCurvature(earth) => Some(earth),
            _ => None,
        });
        earth.and_then(|e| e.apply(xy.extend(0.0)).ok()).map_or(0.0, |p| -p.z)
    };
    let field = Field::new(terrain, fallen)?;
    let delta = |xy: DVec2| {
        let moved = view.stages().iter().find_map(|s| match s {
            Stage::TerrainDisocclusion(ground) => Some(ground.delta_at(xy.extend(0.0))),
            _ => None,
        });
        moved.unwrap_or(0.0)
    };
    let sight = ViewSight::new(view, &field);
    let mut heights = terrain.heights().to_vec();
    let mut line = Vec::new();
    for point in covered {
        let xy = DVec2::from_array(point.at);
        let grid = field.grid_from_scene(xy);
        let Some(ground) = field.surface_at(grid) else { continue };
        line.clear();
        sight.trace(grid, ground + delta(xy) + point.lift_m, &mut line);
        for pair in line.windows(2) {
            let [(a, za), (b, zb)] = [pair[0], pair[1]];
            let steps = (2.0 * (b - a).length()).ceil().clamp(1.0, 1e5) as usize;
            for k in 0..=steps {
                let t = k as f64 / steps as f64;
                let (g, z) = (a.lerp(b, t), za + t * (zb - za));
                if g.distance(grid) < WHOLE || !field.contains(g) {
                    continue;
                }
                let low = (g - WIDTH).ceil().max(DVec2::ZERO);
                for row in low.y as usize..=((g.y + WIDTH) as usize).min(field.rows() - 1) {
                    for col in low.x as usize..=((g.x + WIDTH) as usize).min(field.cols() - 1) {
                        let node = terrain.node_xy(col, row);
                        let limit = (z - BELOW - delta(node) + fallen(node)) as f32;
                        let height = &mut heights[row * field.cols() + col];
                        *height = height.min(limit);
                    }
                }
            }
        }
    }
    let mut out = scene.clone();
    for layer in &mut out.layers {
        if let LayerKind::Terrain(t) = &mut layer.kind {
            let states = terrain.states().iter().copied().collect();
            let whole = &t.heightfield;
            let (cols, rows) = (whole.cols(), whole.rows());
            if let Ok(cut) = Heightfield::new(whole.north_west(), whole.spacing(), cols, rows, heights, states) {
                t.heightfield = cut.into();
            }
            return Ok(Some(out));
        }
    }
    Ok(None)
}

/// Lets `behind`, the picture of the cut ground, show through `frame` around what is covered: the more, the deeper it is.
pub(crate) fn draw(frame: &mut Frame, behind: &Frame, scene: &Scene, view: &View, covered: &[Covered]) {
    let (width, height) = (frame.width, frame.height);
    if (behind.width, behind.height) != (width, height) {
        return;
    }
    let opacity = opacity(scene, view, covered, [width, height]);
    for (i, solid) in opacity.into_iter().enumerate() {
        // Only what was cut away covers anything.
        if solid < 1.0 && behind.depth[i] > frame.depth[i] * 1.0001 {
            for (over, under) in frame.color[i].iter_mut().zip(behind.color[i]) {
                *over = (solid * f32::from(*over) + (1.0 - solid) * f32::from(under)).round() as u8;
            }
        }
    }
}

/// Opacity of covering ground per pixel, 0..=1.
fn opacity(scene: &Scene, view: &View, covered: &[Covered], [width, height]: [usize; 2]) -> Vec<f32> {
    let mut out = vec![1.0f32; width * height];
    let radius = (RADIUS * width as f64).max(2.0);
    for point in covered {
        let xy = DVec2::from_array(point.at);
        let ground = scene.terrain().and_then(|t| t.surface_at(xy)).unwrap_or(0.0);
        let Ok(image) = view.project(xy.extend(ground + point.lift_m)) else { continue };
        let alpha = ghost_alpha(point.over_m, HALF_M);
        let (low, high) = (image.pixel - radius, image.pixel + radius);
        let range = |low: f64, high: f64, n: usize| low.max(0.0) as usize..(high.max(0.0) as usize).min(n);
        for y in range(low.y, high.y, height) {
            for x in range(low.x, high.x, width) {
                let away = (DVec2::new(x as f64, y as f64) + 0.5).distance(image.pixel) / radius;
                let share = (2.0 - 2.0 * away).clamp(0.0, 1.0);
                let slot = &mut out[y * width + x];
                *slot = slot.min((1.0 - share * (1.0 - alpha)) as f32);
            }
        }
    }
    out
}
