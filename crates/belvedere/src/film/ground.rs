//! The ground as a view draws it: the eye's clearance over it, and the side that a picture shows.

use belvedere_core::{DVec2, DVec3, View};
use belvedere_scene::{CellTriangle, Frame, Heightfield, NodeState, Scene};

/// Part of the clearance that follows from the size of a cell.
const CELLS: f64 = 0.25;
/// Places around the point below the eye that the ground is taken from.
const RINGS: usize = 4;
const DIRECTIONS: usize = 12;
/// Places on a ray where its side is judged, as shares of the way back from the ground to the near plane.
const BACK: [f64; 9] = [0.005, 0.01, 0.02, 0.04, 0.08, 0.16, 0.32, 0.64, 1.0];
/// Distance from the ground within which the side is not judged: cells, and pixels at that depth.
const BESIDE: f64 = 0.02;
const PIXELS: f64 = 2.0;
/// Most pixels along a side of a picture that are judged.
const JUDGED_PX: usize = 160;

/// Facets of the terrain as a view displaces them.
pub(crate) struct DrawnGround<'a> {
    terrain: &'a Heightfield,
    view: &'a View,
    /// Id of the terrain's pixels.
    id: u32,
}

/// A facet of the terrain, undisplaced.
struct Facet {
    corners: [DVec3; 3],
    weights: [f64; 3],
}

impl<'a> DrawnGround<'a> {
    /// `None` for a scene without terrain.
    pub(crate) fn of(scene: &'a Scene, view: &'a View) -> Option<Self> {
        scene.layers.iter().enumerate().find_map(|(i, layer)| {
            layer.kind.terrain().map(|t| Self { terrain: &t.heightfield, view, id: 1 + i as u32 })
        })
    }

    /// Clearance that the eye needs, scene units: the distance to a corner of the near plane, and a quarter of a cell.
    pub(crate) fn needed(&self) -> f64 {
        let pinhole = self.view.pinhole();
        let half = pinhole.image.map(|n| 0.5 * f64::from(n) / pinhole.scale_px());
        let corner =
            if pinhole.is_orthographic() { half[0].hypot(half[1]) } else { pinhole.near * half[0].hypot(half[1]) };
        pinhole.near.hypot(corner) + CELLS * self.terrain.spacing().max_element()
    }

    /// Height of the eye over the highest drawn ground within [`DrawnGround::needed`] of it in plan, scene units; negative under ground.
    /// `None` where no ground is drawn there.
    pub(crate) fn clearance(&self) -> Option<f64> {
        let eye = self.view.pinhole().eye;
        // The place whose image the eye is: stages may move the ground sideways.
        let below = self.view.undisplace(eye).map_or(eye, |(p, _)| p).truncate();
        let reach = self.needed();
        let ring = |k: usize| {
            (0..DIRECTIONS).map(move |d| {
                let angle = std::f64::consts::TAU * (d as f64 + 0.5 * (k % 2) as f64) / DIRECTIONS as f64;
                below + reach * k as f64 / RINGS as f64 * DVec2::from_angle(angle)
            })
        };
        let places = std::iter::once(below).chain((1..=RINGS).flat_map(ring));
        let highest = places.filter_map(|xy| self.at(xy)).map(|p| p.z).reduce(f64::max)?;
        Some(eye.z - highest)
    }

    /// Image before the pinhole of the drawn ground at a place of the undisplaced ground.
    pub(crate) fn at(&self, xy: DVec2) -> Option<DVec3> {
        let Facet { corners, weights } = self.facet(xy)?;
        let [a, b, c] = corners.map(|p| self.view.displace(p).ok().map(|d| d.point));
        Some(weights[0] * a? + weights[1] * b? + weights[2] * c?)
    }

    /// Height of the drawn ground over the undisplaced one at a place, scene units; 0 where none is drawn.
    pub(crate) fn rise(&self, xy: DVec2) -> f64 {
        self.at(xy).zip(self.terrain.surface_at(xy)).map_or(0.0, |(drawn, height)| drawn.z - height)
    }

    fn facet(&self, xy: DVec2) -> Option<Facet> {
        let t = self.terrain;
        let g = t.grid_from_scene(xy);
        let last = DVec2::new((t.cols() - 1) as f64, (t.rows() - 1) as f64);
        if !(g.cmpge(DVec2::ZERO).all() && g.cmple(last).all()) {
            return None;
        }
        let corner = g.floor().min(last - 1.0);
        let (col, row) = (corner.x as usize, corner.y as usize);
        let triangle = CellTriangle::at(g - corner);
        let node = |k: usize| {
            let (c, r) = (col + k % 2, row + k / 2);
            t.node(c, r).filter(|_| t.states().get(r * t.cols() + c) != Some(&NodeState::Void))
        };
        let [a, b, c] = triangle.corners().map(node);
        Some(Facet { corners: [a?, b?, c?], weights: triangle.weights(g - corner) })
    }

    /// Pixels of the ground that were judged, and those of them that show its lower side.
    pub(crate) fn seen_from_below(&self, frame: &Frame) -> [usize; 2] {
        let step = (frame.width.max(frame.height) / JUDGED_PX).max(1);
        let mut out = [0, 0];
        for row in (step / 2..frame.height).step_by(step) {
            for col in (step / 2..frame.width).step_by(step) {
                let i = row * frame.width + col;
                if frame.id[i] != self.id || !frame.depth[i].is_finite() {
                    continue;
                }
                out[0] += 1;
                out[1] += usize::from(self.shows_below(frame, [col, row]));
            }
        }
        out
    }

    /// Whether the ray of a pixel lies under the ground before it meets it. Rays start on one side and stay there until they meet the ground,
    /// so the last place decides where the ray is farther from the ground than the drawn ground may be from the true one.
    fn shows_below(&self, frame: &Frame, [col, row]: [usize; 2]) -> bool {
        let pinhole = self.view.pinhole();
        let depth = f64::from(frame.depth[row * frame.width + col]);
        let ray = self.view.ray(DVec2::new(col as f64 + 0.5, row as f64 + 0.5));
        let pixel = if pinhole.is_orthographic() { 0.0 } else { PIXELS / pinhole.scale_px() };
        let surely = BESIDE * self.terrain.spacing().min_element();
        let over = |back: f64| {
            let t = pinhole.near + (1.0 - back) * (depth - pinhole.near);
            let p = ray.at(t).ok()?.point;
            let height = p.z - self.terrain.surface_at(p.truncate())?;
            (height.abs() > surely + pixel * t).then_some(height)
        };
        BACK.into_iter().find_map(over).is_some_and(|height| height < 0.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use belvedere_core::{Pinhole, Projection};
    use belvedere_cpu::CpuRenderer;
    use belvedere_scene::{Layer, Light, Progress, RenderJob, RenderOptions, Renderer, TerrainLayer};

    /// A slope that falls to the south, with cells of 10.
    fn slope() -> Scene {
        let heights = (0..41 * 41).map(|i| 100.0 - 5.0 * (i / 41) as f32).collect();
        let states = vec![NodeState::Measured; 41 * 41];
        let terrain = Heightfield::new(DVec2::new(0.0, 400.0), DVec2::splat(10.0), 41, 41, heights, states)
            .expect("a heightfield");
        let kind = TerrainLayer::new(terrain).into();
        Scene { layers: vec![Layer { id: "ground".into(), must_see: false, kind }], ..Scene::default() }
    }

    fn seen(scene: &Scene, eye: DVec3, to: DVec3) -> (Option<f64>, [usize; 2]) {
        let lens = Projection::Perspective { fov_y: 0.8 };
        let pinhole = Pinhole::look_at(eye, to, DVec3::Z, lens, [48, 32], 1.0, None).expect("a camera");
        let view = View::straight(pinhole);
        let (light, options, progress) = (Light::default(), RenderOptions::default(), Progress::silent());
        let job = RenderJob { scene, view: &view, light: &light, options: &options, progress: &progress };
        let frame = CpuRenderer::default().render(&job).expect("a picture");
        let ground = DrawnGround::of(scene, &view).expect("terrain");
        assert!((ground.needed() - 3.7).abs() < 0.2, "{}", ground.needed());
        (ground.clearance(), ground.seen_from_below(&frame))
    }

    #[test]
    fn the_side_and_the_clearance_of_the_eye_are_told_apart() {
        let scene = slope();
        let [north, south] = [DVec3::new(200.0, 390.0, 40.0), DVec3::new(200.0, 10.0, -100.0)];
        let (clearance, [pixels, below]) = seen(&scene, DVec3::new(200.0, 50.0, 80.0), north);
        assert!((152.0..154.0).contains(&clearance.expect("ground")), "{clearance:?}");
        assert!(pixels > 300 && below == 0, "{below} of {pixels}");
        let (clearance, [pixels, below]) = seen(&scene, DVec3::new(200.0, 390.0, 40.0), south);
        assert!(clearance.expect("ground") < -50.0, "{clearance:?}");
        assert!(pixels > 300 && below == pixels, "{below} of {pixels}");
        assert_eq!(seen(&scene, DVec3::new(-500.0, 200.0, 80.0), north).0, None, "beside the ground");
    }
}
