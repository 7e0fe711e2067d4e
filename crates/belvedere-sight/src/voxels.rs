//! Transmission of light through volumes along straight and curved rays.
//!
//! Volumes absorb by their transfer functions, as they are drawn; their colours and shading do not matter here.

use belvedere_core::{DVec2, DVec3, View};
use belvedere_scene::volume::BRICK;
use belvedere_scene::{Scene, VolumeLayer};

/// Largest distance of a chord from the ray, voxel edges.
const NEAR: f64 = 0.1;
/// Parts into which a ray is first divided.
const PARTS: usize = 16;
/// Most halvings of a chord, and most where part of the ray has no world point.
const MAX_HALVINGS: u32 = 14;
const MAX_HALVINGS_OF_NOTHING: u32 = 6;
/// Less light than this counts as 0.
const DARK: f64 = 1e-3;
/// Voxels within this distance of a point, voxel edges, do not hide it.
const OWN: f64 = 1.0;

/// The volumes of a scene that can hide points.
pub struct Voxels<'a> {
    volumes: Vec<Absorber<'a>>,
}

impl<'a> Voxels<'a> {
    /// The volumes of `scene` but for some layers, by their index; one pass over their bricks.
    pub fn without(scene: &'a Scene, layers: &[usize]) -> Self {
        let others = scene.layers.iter().enumerate().filter(|(i, _)| !layers.contains(i));
        let volumes = others
            .filter_map(|(_, layer)| layer.kind.volume().map(Absorber::new).filter(|a| a.visible.contains(&true)));
        Self { volumes: volumes.collect() }
    }

    /// Share of the light from a point that reaches the eye, 0..=1: the product over all volumes of their transmission along the ray of
    /// `view`, from the near plane to within a voxel's edge of the point.
    ///
    /// * `pixel`, `depth`: image of the point, pixels and scene units.
    pub fn light(&self, view: &View, pixel: DVec2, depth: f64) -> f64 {
        let mut light = 1.0;
        for volume in &self.volumes {
            if light >= DARK {
                light *= Walk::new(volume, view, pixel, depth).light();
            }
        }
        if light >= DARK { light } else { 0.0 }
    }
}

/// A volume and its bricks that absorb light.
struct Absorber<'a> {
    layer: &'a VolumeLayer,
    /// Largest lattice coordinates.
    most: DVec3,
    /// Centre and radius of a ball around it, scene units.
    ball: (DVec3, f64),
    /// Whether anything in a brick absorbs light.
    visible: Vec<bool>,
}

impl<'a> Absorber<'a> {
    fn new(layer: &'a VolumeLayer) -> Self {
        let (volume, bounds) = (&*layer.volume, layer.volume.bounds());
        let seen = |[lo, hi]: &[f32; 2]| layer.transfer.most_opaque(f64::from(*lo), f64::from(*hi)) > 0.0;
        Self {
            layer,
            most: DVec3::from_array(volume.dims().map(|n| (n - 1) as f64)),
            ball: (bounds.center(), 0.5 * bounds.min.distance(bounds.max)),
            visible: volume.bricks().ranges().iter().map(seen).collect(),
        }
    }

    /// Optical depth of the straight path between two lattice positions: the negative logarithm of its transmission.
    fn thickness(&self, a: DVec3, b: DVec3) -> f64 {
        let volume = &*self.layer.volume;
        let (mut t0, mut t1) = (0.0f64, 1.0f64);
        let way = b - a;
        for axis in 0..3 {
            if way[axis] == 0.0 {
                if a[axis] < 0.0 || a[axis] > self.most[axis] {
                    return 0.0;
                }
                continue;
            }
            let (low, high) = ((0.0 - a[axis]) / way[axis], (self.most[axis] - a[axis]) / way[axis]);
            t0 = t0.max(low.min(high));
            t1 = t1.min(low.max(high));
        }
        if !(t0 < t1) {
            return 0.0;
        }
        let (a, way) = (a + t0 * way, (t1 - t0) * way);
        let length = (*volume.axes() * way).length();
        let steps = (length / self.layer.step_length()).ceil().max(1.0);
        let per_step = way / steps;
        let dims = volume.bricks().dims();
        let (mut sum, mut k) = (0.0, 0.0);
        while k < steps {
            let q = (a + (k + 0.5) * per_step).clamp(DVec3::ZERO, self.most);
            let brick: [usize; 3] = std::array::from_fn(|i| (q[i] as usize / BRICK).min(dims[i] - 1));
            if !self.visible[(brick[2] * dims[1] + brick[1]) * dims[0] + brick[0]] {
                k += out_of(brick, q, per_step).floor().max(1.0);
                continue;
            }
            let opacity = volume.at(q).map_or(0.0, |value| self.layer.transfer.opacity(value));
            if opacity > 0.0 {
                sum -= (1.0 - opacity).ln();
            }
            k += 1.0;
        }
        sum * length / steps / self.layer.reference_length()
    }
}

/// Number of steps after which a path leaves a brick.
fn out_of(brick: [usize; 3], q: DVec3, per_step: DVec3) -> f64 {
    let mut steps = f64::INFINITY;
    for axis in 0..3 {
        let low = (brick[axis] * BRICK) as f64;
        let side = if per_step[axis] > 0.0 { low + BRICK as f64 } else { low };
        if per_step[axis] != 0.0 {
            steps = steps.min((side - q[axis]) / per_step[axis]);
        }
    }
    if steps.is_finite() { steps } else { 1.0 }
}

/// A ray through one volume, as chords near enough to it.
struct Walk<'w, 'a> {
    volume: &'w Absorber<'a>,
    at: Box<dyn Fn(f64) -> Option<DVec3> + 'w>,
    range: [f64; 2],
    thickness: f64,
    /// Optical depth beyond which the light counts as 0.
    dark: f64,
}

impl<'w, 'a> Walk<'w, 'a> {
    fn new(volume: &'w Absorber<'a>, view: &'w View, pixel: DVec2, depth: f64) -> Self {
        let ray = view.ray(pixel);
        // Pieces in closed form save undoing the stages at every depth.
        let bends_only = view.stages().len() == 1 && view.curved_rays().is_some();
        let pieces = if bends_only { ray.pieces().ok() } else { None };
        let at = move |w: f64| match &pieces {
            Some(pieces) => pieces.iter().find(|p| w <= p.depth[1]).map(|p| p.at(w)),
            None => ray.at(w).ok().map(|r| r.point),
        };
        let near = view.pinhole().near.min(depth);
        let own = OWN * volume.layer.volume.voxel_edge();
        let step = 1e-5 * depth;
        let speed = match (at(depth - step), at(depth)) {
            (Some(p), Some(q)) => p.distance(q) / step,
            _ => 1.0,
        };
        let end = if speed > 0.0 { depth - own / speed } else { depth };
        Self { volume, at: Box::new(at), range: [near, end], thickness: 0.0, dark: -DARK.ln() }
    }

    fn light(mut self) -> f64 {
        let [near, far] = self.range;
        if !(near < far) {
            return 1.0;
        }
        let depth = |i: usize| near + (far - near) * i as f64 / PARTS as f64;
        let ends: Vec<_> = (0..=PARTS).map(|i| (depth(i), (self.at)(depth(i)))).collect();
        // From the point towards the eye: occluders are usually near the point.
        for pair in ends.windows(2).rev() {
            self.part(pair[0], pair[1], 0);
        }
        (-self.thickness).exp()
    }

    fn part(&mut self, a: (f64, Option<DVec3>), b: (f64, Option<DVec3>), halvings: u32) {
        if self.thickness > self.dark {
            return;
        }
        let depth = 0.5 * (a.0 + b.0);
        let middle = (depth, (self.at)(depth));
        let most = match (a.1, middle.1, b.1) {
            (Some(p), Some(m), Some(q)) => {
                let way = p.distance(m) + m.distance(q);
                if m.distance(self.volume.ball.0) > self.volume.ball.1 + way {
                    return;
                }
                let volume = &self.volume.layer.volume;
                if m.distance(0.5 * (p + q)) <= NEAR * volume.voxel_edge() || halvings >= MAX_HALVINGS {
                    let [p, q] = [p, q].map(|p| volume.lattice_from_scene(p));
                    self.thickness += self.volume.thickness(p, q);
                    return;
                }
                MAX_HALVINGS
            }
            (None, None, None) => 2,
            _ => MAX_HALVINGS_OF_NOTHING,
        };
        if halvings < most {
            self.part(middle, b, halvings + 1);
            self.part(a, middle, halvings + 1);
        }
    }
}

#[cfg(test)]
mod tests;
