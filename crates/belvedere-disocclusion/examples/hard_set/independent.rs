//! An independent test of what is seen: marching over the heights at the nodes that were solved on, as a GeoTIFF on that grid holds them. Shares no code with the solver.

use belvedere_core::grid::Grid;
use belvedere_core::{DVec2, DVec3, View};
use belvedere_scene::{Heightfield, LayerKind, Scene};

/// Ground may rise so far over a line, metres.
const TOLERANCE_M: f64 = 0.5;
/// Points along features, cells; and the nearest to the eye that are judged.
const SPACING: f64 = 0.2;
const NEAREST: f64 = 4.5;
/// Steps per cell along a line.
const STEPS: f64 = 20.0;

/// Heights at nodes, single precision.
struct Written<'a> {
    ground: &'a Heightfield,
    heights: Vec<f64>,
}

impl<'a> Written<'a> {
    fn new(ground: &'a Heightfield, delta: &Grid) -> Self {
        let height = |i: usize| {
            let node = ground.node(i % ground.cols(), i / ground.cols())?;
            Some(f64::from((node.z + delta.sample(node.truncate()).unwrap_or(0.0)) as f32))
        };
        Self { ground, heights: (0..ground.cols() * ground.rows()).map(|i| height(i).unwrap_or(f64::NAN)).collect() }
    }

    /// On two triangles per cell, split from north-west to south-east.
    fn at(&self, g: DVec2) -> Option<f64> {
        let (cols, rows) = (self.ground.cols(), self.ground.rows());
        if !(g.x >= 0.0 && g.y >= 0.0 && g.x <= (cols - 1) as f64 && g.y <= (rows - 1) as f64) {
            return None;
        }
        let (c, r) = ((g.x as usize).min(cols - 2), (g.y as usize).min(rows - 2));
        let (u, v) = (g.x - c as f64, g.y - r as f64);
        let h = |x: usize, y: usize| self.heights[(r + y) * cols + c + x];
        let z = if u >= v {
            h(0, 0) + u * (h(1, 0) - h(0, 0)) + v * (h(1, 1) - h(1, 0))
        } else {
            h(0, 0) + v * (h(0, 1) - h(0, 0)) + u * (h(1, 1) - h(0, 1))
        };
        z.is_finite().then_some(z)
    }

    fn hidden(&self, g: DVec2, z: f64, eye: DVec2, eye_z: f64) -> bool {
        let steps = ((eye - g).abs().max_element() * STEPS).ceil().max(1.0) as usize;
        (1..steps).any(|k| {
            let t = k as f64 / steps as f64;
            self.at(g.lerp(eye, t)).is_some_and(|ground| ground > z + t * (eye_z - z) + TOLERANCE_M)
        })
    }
}

/// Share of the length in view of all features that must be seen.
pub(crate) fn seen(scene: &Scene, view: &View, delta: &Grid) -> f64 {
    let Some(ground) = scene.terrain() else { return f64::NAN };
    let (written, pinhole) = (Written::new(ground, delta), view.pinhole());
    let eye = ground.grid_from_scene(pinhole.eye.truncate());
    let (mut all, mut seen) = (0usize, 0usize);
    for (line, lift) in lines(scene) {
        for pair in line.windows(2) {
            let [a, b] = [pair[0], pair[1]].map(|p| ground.grid_from_scene(p));
            let count = ((b - a).length() / SPACING).ceil().max(1.0) as usize;
            for k in 0..count {
                let g = a.lerp(b, k as f64 / count as f64);
                let Some(z) = written.at(g).map(|z| z + lift) else { continue };
                let world = (ground.north_west() + DVec2::new(g.x, -g.y) * ground.spacing()).extend(z);
                let shown = pinhole.project(world).is_ok_and(|(pixel, _)| pinhole.contains(pixel));
                if shown && g.distance(eye) > NEAREST {
                    all += 1;
                    seen += usize::from(!written.hidden(g, z, eye, pinhole.eye.z));
                }
            }
        }
    }
    seen as f64 / all.max(1) as f64
}

/// Lines and rims in plan, with their heights over the ground.
fn lines(scene: &Scene) -> Vec<(Vec<DVec2>, f64)> {
    let mut out = Vec::new();
    for layer in scene.layers.iter().filter(|l| l.must_see) {
        match &layer.kind {
            LayerKind::Line(l) => {
                let plan = |p: &DVec3| p.truncate();
                out.extend(l.features.iter().map(|f| (f.points.iter().map(plan).collect(), l.lift_m)));
            }
            LayerKind::Area(l) => {
                let closed = |r: &Vec<DVec2>| r.iter().chain(r.first()).copied().collect();
                out.extend(l.features.iter().flat_map(|f| &f.rings).map(|r| (closed(r), l.lift_m)));
            }
            _ => {}
        }
    }
    out
}
