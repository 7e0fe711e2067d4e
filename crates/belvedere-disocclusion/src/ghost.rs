//! Ground that still covers required features: its opacity, and the terrain with that ground cut away.

use crate::solve::Covered;
use crate::visibility_qp::{LinesOfSight, ViewSight};
use belvedere_core::{DVec2, SpaceMap, View};
use belvedere_scene::{Heightfield, NodeState};
use belvedere_sight::{Field, FieldError};

/// Ground this near to a covered point stays whole, cells.
const WHOLE: f64 = 1.0;
/// Ground within this of a line of sight is cut away, cells.
const WIDTH: f64 = 1.0;
/// The cut ground lies this far below the lines of sight, scene units.
const BELOW: f64 = 0.5;

/// Opacity of ground that still covers a line of sight by `slack_m` metres, `1 / (1 + s / s0)`: 1 without slack, 1/2 at
/// `half_m` (> 0). Ours.
pub fn opacity(slack_m: f64, half_m: f64) -> f64 {
    1.0 / (1.0 + slack_m.max(0.0) / half_m)
}

/// The ground cut away down to the lines of sight of the points that it covers in a view with its displacement. Ours.
///
/// # Errors
/// [`FieldError`] if the terrain holds no data.
pub fn cut_open(terrain: &Heightfield, view: &View, covered: &[Covered]) -> Result<Heightfield, FieldError> {
    let fallen = |xy: DVec2| view.earth().and_then(|e| e.apply(xy.extend(0.0)).ok()).map_or(0.0, |p| -p.z);
    let delta = |xy: DVec2| view.ground().map_or(0.0, |ground| ground.delta_at(xy.extend(0.0)));
    let field = Field::new(terrain, fallen)?;
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
    let states: Vec<NodeState> = terrain.states().to_vec();
    let (cols, rows) = (terrain.cols(), terrain.rows());
    // Heights were only lowered, so they are as well formed as before.
    Ok(Heightfield::new(terrain.north_west(), terrain.spacing(), cols, rows, heights, states)
        .unwrap_or_else(|_| terrain.clone()))
}
