//! A ray as short chords inside the box of a volume.

use belvedere_core::{DVec2, DVec3, RayPath, View};
use belvedere_scene::VolumeLayer;

/// Longest chord, steps.
const CHORD: f64 = 0.25;
/// Largest number of halvings of depths.
const MAX_HALVINGS: u32 = 24;

/// A chord of the ray inside the volume: lattice coordinates, depths.
pub(super) struct Chord {
    pub(super) ends: [DVec3; 2],
    pub(super) depth: [f64; 2],
}

/// Chords of a ray inside a volume.
pub(super) struct Chords<'a> {
    ray: RayPath<'a>,
    layer: &'a VolumeLayer,
    most: DVec3,
    /// Centre and radius of a ball around the volume, scene units.
    ball: (DVec3, f64),
    found: Vec<Chord>,
}

impl<'a> Chords<'a> {
    /// The chords between two depths, in order.
    pub(super) fn of(view: &'a View, layer: &'a VolumeLayer, pixel: DVec2, range: [f64; 2]) -> Vec<Chord> {
        let bounds = layer.volume.bounds();
        let ball = (bounds.center(), 0.5 * bounds.min.distance(bounds.max));
        let most = DVec3::from_array(layer.volume.dims().map(|n| (n - 1) as f64));
        let mut chords = Self { ray: view.ray(pixel), layer, most, ball, found: Vec::new() };
        // Equal parts, short compared with the bends.
        let parts = 64;
        let depth = |i: i32| range[0] + (range[1] - range[0]) * f64::from(i) / f64::from(parts);
        let point = |w: f64| chords.ray.at(w).ok().map(|p| p.point);
        let points: Vec<_> = (0..=parts).map(|i| (depth(i), point(depth(i)))).collect();
        for pair in points.windows(2) {
            chords.halved(pair[0], pair[1], 0);
        }
        chords.found
    }

    fn halved(&mut self, a: (f64, Option<DVec3>), b: (f64, Option<DVec3>), halvings: u32) {
        if let (Some(p), Some(q)) = (a.1, b.1) {
            let way = p.distance(q);
            if p.lerp(q, 0.5).distance(self.ball.0) > self.ball.1 + 2.0 * way {
                return;
            }
            if way <= CHORD * self.layer.step_length() || halvings >= MAX_HALVINGS {
                return self.clipped([a.0, b.0], [p, q]);
            }
        } else if halvings >= 12 || (a.1.is_none() && b.1.is_none() && halvings >= 6) {
            return;
        }
        let depth = 0.5 * (a.0 + b.0);
        let middle = (depth, self.ray.at(depth).ok().map(|p| p.point));
        self.halved(a, middle, halvings + 1);
        self.halved(middle, b, halvings + 1);
    }

    fn clipped(&mut self, depth: [f64; 2], points: [DVec3; 2]) {
        let [a, b] = points.map(|p| self.layer.volume.lattice_from_scene(p));
        let (mut t0, mut t1) = (0.0f64, 1.0f64);
        for axis in 0..3 {
            let way = b[axis] - a[axis];
            if way == 0.0 {
                if a[axis] < 0.0 || a[axis] > self.most[axis] {
                    return;
                }
                continue;
            }
            let (low, high) = ((0.0 - a[axis]) / way, (self.most[axis] - a[axis]) / way);
            t0 = t0.max(low.min(high));
            t1 = t1.min(low.max(high));
        }
        if t0 < t1 {
            let depth = [t0, t1].map(|t| if t == 1.0 { depth[1] } else { depth[0] + t * (depth[1] - depth[0]) });
            self.found.push(Chord { ends: [a.lerp(b, t0), a.lerp(b, t1)], depth });
        }
    }
}
