//! Fast ray marching: groups of samples, with empty-space skipping.

use super::bricks::{EDGE, Leaps};
use super::light::{SURFACE, light};
use super::ray::Segment;
use super::sampler::{GROUP, Group, Sampler, Voxel};
use super::spans::Spans;
use super::table::{ENTRIES, Table};
use super::{ENOUGH, Gathered, HALF, half_within};
use crate::simd::{self, Kernel, nearest};
use belvedere_core::{DVec3, View};
use belvedere_scene::{Volume, VolumeLayer, VolumeModel, VoxelValues};
use glam::{Mat3A, Vec3A};

/// A volume prepared for many rays.
pub(super) struct Marcher<'v> {
    layer: &'v VolumeLayer,
    table: Table,
    leaps: Leaps,
    step: f64,
    /// Matrix from lattice gradients to scene normals, per voxel edge.
    normal_from_gradient: Mat3A,
    /// Squared gradient per voxel edge at which a sample counts as half a surface.
    surface_squared: f32,
}

impl<'v> Marcher<'v> {
    pub(super) fn new(layer: &'v VolumeLayer) -> Self {
        let volume = &*layer.volume;
        let table = Table::new(layer);
        let leaps = Leaps::new(volume, &table);
        let [lo, hi] = volume.range();
        let inverse_transposed = volume.lattice_axes().transpose() * volume.voxel_edge();
        let surface = (SURFACE * (hi - lo)).max(f32::MIN_POSITIVE);
        Self {
            layer,
            table,
            leaps,
            step: layer.step_length(),
            normal_from_gradient: Mat3A::from_cols_array(&inverse_transposed.to_cols_array().map(|v| v as f32)),
            surface_squared: surface * surface,
        }
    }

    /// Whether no part of the volume is visible.
    pub(super) fn is_clear(&self) -> bool {
        self.leaps.is_clear()
    }

    /// The pixels of a view that may show it.
    pub(super) fn spans(&self, view: &View) -> Spans {
        Spans::new(view, self.volume(), &self.leaps)
    }

    pub(super) fn volume(&self) -> &'v Volume {
        &self.layer.volume
    }

    /// Switches empty-space skipping off.
    #[cfg(test)]
    pub(super) fn forget_leaps(&mut self) {
        self.leaps.forget();
    }

    /// Light gathered by a ray along its segments.
    pub(super) fn gather(&self, segments: &[Segment]) -> Gathered {
        let volume = self.volume();
        match volume.values() {
            VoxelValues::U8(v) => self.gather_in(Sampler::new(volume, v), segments),
            VoxelValues::U16(v) => self.gather_in(Sampler::new(volume, v), segments),
            VoxelValues::I16(v) => self.gather_in(Sampler::new(volume, v), segments),
            VoxelValues::F32(v) => self.gather_in(Sampler::new(volume, v), segments),
        }
    }

    fn gather_in<T: Voxel>(&self, sampler: Sampler<'_, T>, segments: &[Segment]) -> Gathered {
        let Some(first) = segments.first() else { return Gathered::default() };
        let mut out = simd::run(Walk { marcher: self, sampler, segments });
        out.enters = first.depth[0];
        if out.alpha >= ENOUGH {
            out.color /= out.alpha;
            out.alpha = 1.0;
        }
        out
    }
}

/// One ray.
struct Walk<'m, 'v, T> {
    marcher: &'m Marcher<'v>,
    sampler: Sampler<'m, T>,
    segments: &'m [Segment],
}

impl<T: Voxel> Kernel for Walk<'_, '_, T> {
    type Output = Gathered;

    #[inline(always)]
    fn run(self) -> Gathered {
        let mut out = Gathered::default();
        let mut rest = self.segments;
        while !rest.is_empty() && out.alpha < ENOUGH {
            let end = 1 + rest[1..].iter().position(|s| s.is_new).unwrap_or(rest.len() - 1);
            let (run, after) = rest.split_at(end);
            self.run_of(run, &mut out);
            rest = after;
        }
        out
    }
}

/// A segment in single precision: position by the distance from its start, in steps.
struct Stretch {
    c: [Vec3A; 4],
    /// Bound on half the second derivative, per axis; `None` for a straight one.
    bend: Option<Vec3A>,
}

impl Stretch {
    #[inline(always)]
    fn new(segment: &Segment, step: f64) -> Self {
        let per_step = step / segment.length;
        let mut scale = 1.0;
        let c = segment.curve.0.map(|c| {
            let scaled = (c * scale).as_vec3a();
            scale *= per_step;
            scaled
        });
        let steps = (segment.length / step) as f32;
        let bent = c[2] != Vec3A::ZERO || c[3] != Vec3A::ZERO;
        Self { c, bend: bent.then(|| c[2].abs() + 3.0 * steps * c[3].abs()) }
    }

    #[inline(always)]
    fn at(&self, n: f32) -> Vec3A {
        self.c[0] + n * (self.c[1] + n * (self.c[2] + n * self.c[3]))
    }

    #[inline(always)]
    fn direction(&self, n: f32) -> Vec3A {
        self.c[1] + n * (2.0 * self.c[2] + n * 3.0 * self.c[3])
    }

    /// Number of whole steps that stay within the cube of empty bricks around a brick.
    #[inline(always)]
    fn leap(&self, n: f32, p: Vec3A, (brick, distance): ([usize; 3], u8)) -> f32 {
        let v = self.direction(n);
        let corner = Vec3A::from_array(brick.map(|b| b as f32 * EDGE));
        let reach = (f32::from(distance) - 1.0) * EDGE;
        let (low, high) = (corner - reach, corner + (EDGE + reach));
        let way = Vec3A::select(v.cmpgt(Vec3A::ZERO), high - p, p - low);
        let pace = v.abs().max(Vec3A::splat(1e-12)).recip();
        let leap = (way * pace).min_element();
        let Some(bend) = self.bend else { return leap.floor().max(1.0) };
        // The bend may bring the ray to a side earlier, by at most `off` within the leap. For sides that it moves away from, the distance
        // itself counts, and the speed that the bend may give it towards them.
        let off = bend * (leap * leap);
        let ahead = ((way - off) * pace).min_element();
        let behind = (high - low - way - off).min_element() + 1e-3;
        if behind >= 0.0 { leap.min(ahead).floor().max(1.0) } else { 1.0 }
    }
}

/// Adjoining segments, and the position along them.
struct Run<'s> {
    segments: &'s [Segment],
    step: f64,
    /// Number of the current segment, and its start and end in steps.
    at: usize,
    start: f64,
    end: f64,
    stretch: Stretch,
}

impl<'s> Run<'s> {
    #[inline(always)]
    fn new(segments: &'s [Segment], step: f64) -> Self {
        let stretch = Stretch::new(&segments[0], step);
        Self { segments, step, at: 0, start: 0.0, end: segments[0].length / step, stretch }
    }

    /// Advances to the segment at a distance, in steps.
    #[inline(always)]
    fn seek(&mut self, way: f64) {
        while way >= self.end && self.at + 1 < self.segments.len() {
            self.next();
        }
    }

    #[inline(always)]
    fn next(&mut self) {
        self.at += 1;
        let segment = &self.segments[self.at];
        (self.start, self.end) = (self.end, self.end + segment.length / self.step);
        self.stretch = Stretch::new(segment, self.step);
    }

    /// Positions of samples from the distance `way` on, a step apart, and the direction per step if `directions` are asked for. The first
    /// lies in the current segment; if others lie in later ones, these become current.
    #[inline(always)]
    fn group(&mut self, way: f64, taken: usize, directions: bool) -> ([Group; 3], [Group; 3]) {
        let (mut p, mut v) = ([[0.0; GROUP]; 3], [[0.0; GROUP]; 3]);
        let mut first = 0.0f32;
        loop {
            let n0 = (way - self.start) as f32;
            for a in 0..3 {
                let [c0, c1, c2, c3] = [0, 1, 2, 3].map(|k| self.stretch.c[k].to_array()[a]);
                for l in 0..GROUP {
                    let n = n0 + l as f32;
                    let here = c0 + n * (c1 + n * (c2 + n * c3));
                    p[a][l] = if l as f32 >= first { here } else { p[a][l] };
                    if directions {
                        let ahead = c1 + n * (2.0 * c2 + n * 3.0 * c3);
                        v[a][l] = if l as f32 >= first { ahead } else { v[a][l] };
                    }
                }
            }
            if way + (taken - 1) as f64 <= self.end || self.at + 1 >= self.segments.len() {
                return (p, v);
            }
            first = (self.end - way).ceil() as f32;
            self.next();
        }
    }

    /// Depth and lattice position of a sample.
    #[inline(never)]
    fn place(&self, way: f64) -> (f64, DVec3) {
        let mut start = 0.0;
        for (i, segment) in self.segments.iter().enumerate() {
            let end = start + segment.length / self.step;
            if way < end || i + 1 == self.segments.len() {
                let t = ((way - start) / (end - start)).clamp(0.0, 1.0);
                return (segment.depth_at(t), segment.curve.at(t));
            }
            start = end;
        }
        (0.0, DVec3::ZERO)
    }
}

impl<T: Voxel> Walk<'_, '_, T> {
    /// Takes samples along adjoining segments, at `(k + 1/2)` steps of their joint length; the last, shorter step ends with them.
    #[inline(always)]
    fn run_of(&self, segments: &[Segment], out: &mut Gathered) {
        let step = self.marcher.step;
        let total: f64 = segments.iter().map(|s| s.length).sum::<f64>() / step;
        // Rounding must not add a step.
        let whole = (total + 1e-6).floor();
        let mut run = Run::new(segments, step);
        let mut k = 0.0f64;
        while k < whole {
            let way = k + 0.5;
            run.seek(way);
            let n = (way - run.start) as f32;
            let p = run.stretch.at(n);
            let found = self.marcher.leaps.at(p);
            if found.1 > 0 {
                let to_end = (run.end - way).ceil().max(1.0);
                k += f64::from(run.stretch.leap(n, p, found).min(1e6)).min(to_end);
                continue;
            }
            let taken = (whole - k).min(GROUP as f64);
            if self.group(&mut run, way, taken as usize, 1.0, out) {
                return;
            }
            k += taken;
        }
        let part = total - whole;
        if part > 1e-6 {
            let way = total - 0.5 * part;
            run.seek(way);
            self.group(&mut run, way, 1, part as f32, out);
        }
    }

    /// Takes `taken` samples from the distance `way` on; each counts for `share` of a step. Returns whether the ray is opaque.
    #[inline(always)]
    fn group(&self, run: &mut Run<'_>, way: f64, taken: usize, share: f32, out: &mut Gathered) -> bool {
        let marcher = self.marcher;
        let table = &marcher.table;
        let shaded = marcher.layer.model == VolumeModel::Shaded;
        let (p, v) = run.group(way, taken, shaded);
        let values = self.sampler.at(&p);
        let (mut place, mut rest) = ([0i32; GROUP], [0.0f32; GROUP]);
        for l in 0..GROUP {
            let at = ((values[l] - table.least) * table.scale).max(0.0);
            // The entry below, or on an entry perhaps the one before, which gives the same opacity.
            place[l] = nearest(at - 0.5);
            rest[l] = at - place[l] as f32;
        }
        out.samples += taken as u32;
        let mut alphas: Group = [0.0; GROUP];
        let mut any = false;
        for l in 0..taken {
            let [alpha, change] = table.alphas[place[l] as usize & (ENTRIES - 1)];
            alphas[l] = alpha + rest[l] * change;
            any |= alphas[l] > 0.0;
        }
        if !any {
            return false;
        }
        if share != 1.0 {
            alphas[0] = 1.0 - (1.0 - alphas[0]).powf(share);
        }
        let [factor, white] = if shaded { self.shading(&p, &v) } else { [[1.0; GROUP], [0.0; GROUP]] };
        for l in 0..taken {
            if alphas[l] <= 0.0 {
                continue;
            }
            let lit = table.colors[place[l] as usize & (ENTRIES - 1)] * factor[l] + white[l];
            let before = 1.0 - out.alpha;
            let weight = alphas[l] * before;
            out.color += lit * weight;
            out.alpha += weight;
            if out.half.is_none() && out.alpha >= HALF {
                let within = f64::from(share) * (half_within(before, alphas[l]) - 0.5);
                let (depth, q) = run.place(way + l as f64 + within);
                out.half = Some((depth, marcher.volume().scene_from_lattice(q)));
            }
            if out.alpha >= ENOUGH {
                return true;
            }
        }
        false
    }

    /// Factors of the colours, and white that is added to them.
    ///
    /// * `v`: direction per step, lattice coordinates.
    #[inline(always)]
    fn shading(&self, p: &[Group; 3], v: &[Group; 3]) -> [Group; 2] {
        let g = self.sampler.gradients(p);
        let m = self.marcher.normal_from_gradient;
        let [x, y, z] = [m.x_axis, m.y_axis, m.z_axis].map(|c| c.to_array());
        // The length of a step in voxel edges.
        let edges = self.marcher.layer.step as f32;
        let surface_squared = self.marcher.surface_squared;
        let mut out = [[0.0; GROUP]; 2];
        for l in 0..GROUP {
            let normal: [f32; 3] = std::array::from_fn(|a| x[a] * g[0][l] + y[a] * g[1][l] + z[a] * g[2][l]);
            let size = normal[0] * normal[0] + normal[1] * normal[1] + normal[2] * normal[2];
            let along = g[0][l] * v[0][l] + g[1][l] * v[1][l] + g[2][l] * v[2][l];
            let inverse = 1.0 / size.max(f32::MIN_POSITIVE).sqrt();
            let cos = (along.abs() * inverse / edges).min(1.0);
            let solid = size / (size + surface_squared);
            let up = normal[2] * inverse * if along > 0.0 { -1.0 } else { 1.0 };
            let [factor, white] = light(cos, solid, up);
            (out[0][l], out[1][l]) = (factor, white);
        }
        out
    }
}
