//! Fast ray marching: groups of samples, with empty-space skipping.
//!
//! Samples are taken at the ends of steps. Between two of them the value is taken to change evenly, and the step is cut into parts over
//! which it changes little; colour and opacity are looked up for each part, without another sample, and the light of the ends is
//! interpolated. Without the parts, thin layers of matter are met or missed by whole samples, which draws rings on surfaces.

use super::bricks::{EDGE, Leaps};
use super::light::{SURFACE, light};
use super::ray::Segment;
use super::sampler::{GROUP, Group, Sampler, Voxel};
use super::spans::Spans;
use super::table::{ENTRIES, Entry, PARTS, Table};
use super::{ENOUGH, Gathered, HALF, half_within};
use crate::simd::{self, Kernel};
use belvedere_core::{DVec3, View};
use belvedere_scene::{Volume, VolumeLayer, VolumeModel, VoxelValues};
use glam::{Mat3A, Vec3A};

/// A volume prepared for many rays.
pub(super) struct Marcher<'v> {
    layer: &'v VolumeLayer,
    table: Table,
    leaps: Leaps,
    step: f64,
    /// Longest way of a step in the lattice.
    pace: f32,
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
        // The Frobenius norm is a bound.
        let norm = volume.lattice_axes().to_cols_array().iter().map(|v| v * v).sum::<f64>().sqrt();
        Self {
            layer,
            table,
            leaps,
            step: layer.step_length(),
            pace: (layer.step_length() * norm) as f32,
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

    /// Number of whole steps, at most `to_end`, that stay within the cube of empty bricks around a brick; 0 if the next one may leave it.
    ///
    /// * `pace`: the longest way of a step; steps beyond the end of the stretch are bounded by it.
    #[inline(always)]
    fn leap(&self, n: f32, p: Vec3A, (brick, distance): ([usize; 3], u8), to_end: f32, pace: f32) -> f32 {
        let corner = Vec3A::from_array(brick.map(|b| b as f32 * EDGE));
        let reach = (f32::from(distance) - 1.0) * EDGE;
        let (low, high) = (corner - reach, corner + (EDGE + reach));
        let along = self.leap_along(n, p, low, high).min(to_end);
        if along >= 1.0 {
            return along.floor();
        }
        let gap = (high - p).min(p - low).min_element();
        (gap / pace).floor().max(0.0)
    }

    /// Steps along the stretch that stay between two corners.
    #[inline(always)]
    fn leap_along(&self, n: f32, p: Vec3A, low: Vec3A, high: Vec3A) -> f32 {
        let v = self.direction(n);
        let way = Vec3A::select(v.cmpgt(Vec3A::ZERO), high - p, p - low);
        let pace = v.abs().max(Vec3A::splat(1e-12)).recip();
        let leap = (way * pace).min_element();
        let Some(bend) = self.bend else { return leap };
        // The bend may bring the ray to a side earlier, by at most `off` within the leap. For sides that it moves away from, the distance
        // itself counts, and the speed that the bend may give it towards them.
        let off = bend * (leap * leap);
        let ahead = ((way - off) * pace).min_element();
        let behind = (high - low - way - off).min_element() + 1e-3;
        if behind >= 0.0 { leap.min(ahead) } else { 0.0 }
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

/// The end of a step that the next one begins with: the index of its value in the table, and its light if it was asked for.
#[derive(Clone, Copy)]
struct Front {
    at: f32,
    light: Option<[f32; 2]>,
}

/// Adjoining samples: the distance of the first, their number, and the share of a step between them.
#[derive(Clone, Copy)]
struct Samples {
    way: f64,
    taken: usize,
    share: f32,
}

impl<T: Voxel> Walk<'_, '_, T> {
    /// Follows adjoining segments in steps of equal length; the last, shorter one ends with them.
    #[inline(always)]
    fn run_of(&self, segments: &[Segment], out: &mut Gathered) {
        let step = self.marcher.step;
        let total: f64 = segments.iter().map(|s| s.length).sum::<f64>() / step;
        // Rounding must not add a step.
        let whole = (total + 1e-6).floor();
        let part = (total - whole) as f32;
        let mut run = Run::new(segments, step);
        let mut front: Option<Front> = None;
        let mut k = 0.0f64;
        loop {
            let last = k >= whole;
            if k > whole || (last && part <= 1e-6) {
                return;
            }
            run.seek(k);
            let n = (k - run.start) as f32;
            let p = run.stretch.at(n);
            let found = self.marcher.leaps.at(p);
            if found.1 > 0 {
                let to_end = (run.end - k).max(0.0) as f32;
                let leap = run.stretch.leap(n, p, found, to_end, self.marcher.pace).min(1e6);
                if leap >= 1.0 {
                    k += f64::from(leap);
                    front = None;
                    continue;
                }
            }
            if last {
                if front.is_none() {
                    self.group(&mut run, Samples { way: k, taken: 1, share: 1.0 }, &mut front, out);
                }
                run.seek(total);
                self.group(&mut run, Samples { way: total, taken: 1, share: part }, &mut front, out);
                return;
            }
            let begun = f64::from(u8::from(front.is_some()));
            let taken = (whole - k + 1.0 - begun).min(GROUP as f64);
            run.seek(k + begun);
            if self.group(&mut run, Samples { way: k + begun, taken: taken as usize, share: 1.0 }, &mut front, out) {
                return;
            }
            k += taken - 1.0 + begun;
        }
    }

    /// Takes samples and gathers the light of the steps between them, and of the one from `front` to the first; `front` becomes the last
    /// sample. Returns whether the ray is opaque.
    #[inline(always)]
    fn group(&self, run: &mut Run<'_>, samples: Samples, front: &mut Option<Front>, out: &mut Gathered) -> bool {
        let Samples { way, taken, share } = samples;
        let marcher = self.marcher;
        let table = &marcher.table;
        let shaded = marcher.layer.model == VolumeModel::Shaded;
        let (p, v) = run.group(way, taken, shaded);
        let values = self.sampler.at(&p);
        let mut at = [0.0f32; GROUP];
        for l in 0..GROUP {
            at[l] = ((values[l] - table.least) * table.scale).max(0.0).min((ENTRIES - 1) as f32);
        }
        out.samples += taken as u32;
        let first = front.unwrap_or(Front { at: at[0], light: None });
        let mut seen = [false; GROUP];
        let mut any = false;
        let mut before: &Entry = table.entry(Table::number(first.at));
        for l in 0..taken {
            let here = table.entry(Table::number(at[l]));
            seen[l] = before.sees(here);
            any |= seen[l];
            before = here;
        }
        if !any {
            *front = Some(Front { at: at[taken - 1], light: None });
            return false;
        }
        let [factor, white] = if shaded { self.shading(&p, &v) } else { [[1.0; GROUP], [0.0; GROUP]] };
        let light = |l: usize| [factor[l], white[l]];
        // The first sample alone begins no step.
        let steps = usize::from(front.is_none())..taken;
        let mut from = (first.at, first.light.unwrap_or(light(0)));
        for l in 0..taken {
            let to = (at[l], light(l));
            if seen[l] && steps.contains(&l) {
                let start = if share == 1.0 { way + l as f64 - 1.0 } else { way - f64::from(share) };
                if self.step([from, to], share, out, |within| {
                    let (depth, q) = run.place(start + within);
                    (depth, marcher.volume().scene_from_lattice(q))
                }) {
                    return true;
                }
            }
            from = to;
        }
        *front = Some(Front { at: from.0, light: Some(from.1) });
        false
    }

    /// Gathers the light of a step between two samples, given by the index of their value and their light. Returns whether the ray is
    /// opaque.
    ///
    /// * `share`: its length in steps; `place`: depth and place within it, by the distance from its start in steps.
    #[inline(always)]
    fn step(
        &self,
        [(a, light_a), (b, light_b)]: [(f32, [f32; 2]); 2],
        share: f32,
        out: &mut Gathered,
        place: impl Fn(f64) -> (f64, DVec3),
    ) -> bool {
        let change = b - a;
        let parts = parts_for(change.abs());
        let length = 1.0 / parts as f32;
        for j in 0..parts {
            let t = (j as f32 + 0.5) * length;
            let (mut alpha, color) = self.marcher.table.at(a + t * change);
            if alpha <= 0.0 {
                continue;
            }
            // From the shortest part to this one.
            for _ in 0..(PARTS / parts).trailing_zeros() {
                alpha *= 2.0 - alpha;
            }
            if share != 1.0 {
                alpha = 1.0 - (1.0 - alpha).powf(share);
            }
            let factor = light_a[0] + t * (light_b[0] - light_a[0]);
            let white = light_a[1] + t * (light_b[1] - light_a[1]);
            let before = 1.0 - out.alpha;
            let weight = alpha * before;
            out.color += (color * factor + white) * weight;
            out.alpha += weight;
            if out.half.is_none() && out.alpha >= HALF {
                let within = (f64::from(j) + half_within(before, alpha)) * f64::from(length * share);
                out.half = Some(place(within));
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

/// Parts of a step for a change of value, table entries: a power of two.
#[inline(always)]
fn parts_for(change: f32) -> u32 {
    // Shares of the range of values over which usual functions change little.
    const SMALL: f32 = ENTRIES as f32 / 128.0;
    match change {
        c if c <= SMALL => 1,
        c if c <= 2.0 * SMALL => 2,
        c if c <= 4.0 * SMALL => 4,
        _ => PARTS,
    }
}
