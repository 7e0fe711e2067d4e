//! Reference ray marching in 64 bits: the fast method is tested against it, and the exact renderer uses it.
//!
//! The ray is cut into short chords by halving depths, and each chord is clipped to the box. Steps of equal length are laid along their
//! joint length, one sample within each, weighted by the chord of its step. Nothing is tabulated or skipped.

use super::light::{SURFACE, light};
use super::table::light_and_opacity;
use super::{ENOUGH, Gathered, HALF, half_within, place_in_step};
use belvedere_core::{DVec2, DVec3, RayPath, View};
use belvedere_scene::volume::absorbed;
use belvedere_scene::{VolumeLayer, VolumeModel};
use glam::Vec3A;

/// Longest chord, steps.
const CHORD: f64 = 0.25;
/// Largest number of halvings of depths.
const MAX_HALVINGS: u32 = 24;

/// A chord of the ray inside the volume: lattice coordinates, depths.
struct Chord {
    ends: [DVec3; 2],
    depth: [f64; 2],
}

/// Light that the ray of `pixel` gathers between two depths.
pub(super) fn gather(view: &View, layer: &VolumeLayer, pixel: DVec2, [near, far]: [f64; 2]) -> Gathered {
    let mut out = Gathered::default();
    if !(near < far) {
        return out;
    }
    let chords = Chords::of(view, layer, pixel, [near, far]);
    let Some(first) = chords.first() else { return out };
    out.enters = first.depth[0];
    for run in chords.chunk_by(|a, b| a.depth[1] == b.depth[0]) {
        march(layer, (run, place_in_step(pixel)), &mut out);
    }
    if out.alpha >= ENOUGH {
        out.color /= out.alpha;
        out.alpha = 1.0;
    }
    out
}

fn march(layer: &VolumeLayer, (run, within): (&[Chord], f64), out: &mut Gathered) {
    let volume = &*layer.volume;
    let scene = |q: DVec3| volume.scene_from_lattice(q);
    // Distance at the beginning of every chord, and at the end of the last.
    let mut ways = vec![0.0];
    for chord in run {
        ways.push(ways[ways.len() - 1] + scene(chord.ends[0]).distance(scene(chord.ends[1])));
    }
    let total = ways[run.len()];
    let at = |way: f64| {
        let i = ways.partition_point(|w| *w <= way).clamp(1, run.len()) - 1;
        let t = ((way - ways[i]) / (ways[i + 1] - ways[i])).clamp(0.0, 1.0);
        let Chord { ends, depth } = &run[i];
        (ends[0].lerp(ends[1], t), depth[0] + t * (depth[1] - depth[0]))
    };
    let step = layer.step_length();
    let mut begin = 0.0;
    while begin < total && out.alpha < ENOUGH {
        let end = (begin + step).min(total);
        let chord = scene(at(end).0) - scene(at(begin).0);
        out.samples += 1;
        let before = 1.0 - out.alpha;
        let alpha = sample(layer, at(begin + within * (end - begin)).0, chord, out);
        if out.half.is_none() && out.alpha >= HALF {
            let (q, depth) = at(begin + half_within(before, alpha) * (end - begin));
            out.half = Some((depth, scene(q)));
        }
        begin = end;
    }
}

/// Composites the sample of a step behind the light gathered so far; returns the share that the step absorbs.
fn sample(layer: &VolumeLayer, q: DVec3, chord: DVec3, out: &mut Gathered) -> f32 {
    let Some(value) = layer.volume.at(inside(layer, q)) else { return 0.0 };
    let (rgb, opacity) = light_and_opacity(&layer.transfer, value);
    let alpha = absorbed(opacity, chord.length() / layer.reference_length()) as f32;
    if alpha <= 0.0 {
        return 0.0;
    }
    let lit = match layer.model {
        VolumeModel::Plain => Vec3A::from_array(rgb),
        VolumeModel::Shaded => {
            let [factor, white] = shading(layer, q, chord.normalize());
            Vec3A::from_array(rgb) * factor + white
        }
    };
    let weight = alpha * (1.0 - out.alpha);
    out.color += lit * weight;
    out.alpha += weight;
    alpha
}

/// Clamps a position that rounding has left just outside.
fn inside(layer: &VolumeLayer, q: DVec3) -> DVec3 {
    q.clamp(DVec3::ZERO, DVec3::from_array(layer.volume.dims().map(|n| (n - 1) as f64)))
}

fn shading(layer: &VolumeLayer, q: DVec3, along: DVec3) -> [f32; 2] {
    let volume = &*layer.volume;
    let value = |q: DVec3| volume.at(inside(layer, q)).unwrap_or(0.0);
    let gradient = [DVec3::X, DVec3::Y, DVec3::Z].map(|e| 0.5 * (value(q + e) - value(q - e)));
    // Normals transform by the inverse transpose of the axes.
    let normal = volume.lattice_axes().transpose() * DVec3::from_array(gradient);
    let per_edge = normal.length() * volume.voxel_edge();
    let [lo, hi] = volume.range().map(f64::from);
    let surface = f64::from(SURFACE) * (hi - lo);
    let solid = per_edge * per_edge / (per_edge * per_edge + surface * surface).max(f64::MIN_POSITIVE);
    let n = normal.normalize_or_zero();
    let towards = if n.dot(along) > 0.0 { -n } else { n };
    light(n.dot(along).abs() as f32, solid as f32, towards.z as f32)
}

/// Chords of a ray inside a volume.
struct Chords<'a> {
    ray: RayPath<'a>,
    layer: &'a VolumeLayer,
    most: DVec3,
    /// Centre and radius of a ball around the volume, scene units.
    ball: (DVec3, f64),
    found: Vec<Chord>,
}

impl<'a> Chords<'a> {
    fn of(view: &'a View, layer: &'a VolumeLayer, pixel: DVec2, range: [f64; 2]) -> Vec<Chord> {
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
