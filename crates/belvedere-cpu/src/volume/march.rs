//! The fast way along a ray: groups of samples, leaps over what is empty.

use super::bricks::{EDGE, Leaps};
use super::light::{SURFACE, light};
use super::ray::Segment;
use super::sampler::{GROUP, Group, Sampler, Voxel};
use super::table::{ENTRIES, Table};
use super::{ENOUGH, Gathered, HALF};
use crate::simd::{self, Kernel, nearest};
use belvedere_scene::{Volume, VolumeLayer, VolumeModel, VoxelValues};
use glam::{Mat3A, Vec3A};

/// A volume ready for many rays.
pub(super) struct Marcher<'v> {
    layer: &'v VolumeLayer,
    table: Table,
    leaps: Leaps,
    step: f64,
    /// Scene normals from lattice gradients, per voxel edge.
    normal_from_gradient: Mat3A,
    /// Change per voxel edge that makes half a surface, squared.
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

    /// Whether nothing of the volume is visible.
    pub(super) fn is_clear(&self) -> bool {
        self.leaps.is_clear()
    }

    pub(super) fn volume(&self) -> &'v Volume {
        &self.layer.volume
    }

    /// Takes every sample from now on.
    #[cfg(test)]
    pub(super) fn forget_leaps(&mut self) {
        self.leaps.forget();
    }

    /// What a ray gathers along its segments.
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

/// A segment in 32 bits: position by the way from its start, in steps.
struct Stretch {
    c: [[f32; 3]; 4],
    /// Bound on half the second derivative, per axis.
    bend: [f32; 3],
}

impl Stretch {
    #[inline(always)]
    fn new(segment: &Segment, step: f64) -> Self {
        let per_step = step / segment.length;
        let mut scale = 1.0;
        let c = segment.curve.0.map(|c| {
            let scaled = (c * scale).to_array().map(|v| v as f32);
            scale *= per_step;
            scaled
        });
        let steps = (segment.length / step) as f32;
        let bend = std::array::from_fn(|a| c[2][a].abs() + 3.0 * c[3][a].abs() * steps);
        Self { c, bend }
    }

    #[inline(always)]
    fn at(&self, n: f32) -> [f32; 3] {
        std::array::from_fn(|a| self.c[0][a] + n * (self.c[1][a] + n * (self.c[2][a] + n * self.c[3][a])))
    }

    #[inline(always)]
    fn direction(&self, n: f32) -> [f32; 3] {
        std::array::from_fn(|a| self.c[1][a] + n * (2.0 * self.c[2][a] + n * 3.0 * self.c[3][a]))
    }

    /// Whole steps that stay within the cube of bricks around a brick.
    #[inline(always)]
    fn leap(&self, n: f32, (brick, distance): ([usize; 3], u8)) -> f32 {
        let (p, v) = (self.at(n), self.direction(n));
        let reach = f32::from(distance) - 1.0;
        let mut leap = f32::INFINITY;
        for a in 0..3 {
            let low = (brick[a] as f32 - reach) * EDGE;
            let high = (brick[a] as f32 + 1.0 + reach) * EDGE;
            let way = if v[a] > 0.0 { high - p[a] } else { p[a] - low };
            let straight = way / v[a].abs().max(1e-12);
            leap = leap.min(straight);
        }
        // The bend may bring it to a side earlier: as far as it goes within the leap.
        let mut bent = leap;
        for a in 0..3 {
            if self.bend[a] > 0.0 {
                let low = (brick[a] as f32 - reach) * EDGE;
                let high = (brick[a] as f32 + 1.0 + reach) * EDGE;
                let off = self.bend[a] * leap * leap;
                let up = (high - p[a] - off) / v[a].max(1e-12);
                let down = (p[a] - low - off) / (-v[a]).max(1e-12);
                bent = bent.min(up).min(down);
            }
        }
        bent.floor().max(1.0)
    }
}

impl<T: Voxel> Walk<'_, '_, T> {
    /// Samples of segments that go on from each other, at `(k + 1/2)` steps of their common length; the last step ends with them.
    #[inline(always)]
    fn run_of(&self, run: &[Segment], out: &mut Gathered) {
        let step = self.marcher.step;
        let total: f64 = run.iter().map(|s| s.length).sum::<f64>() / step;
        // Rounding makes no step of its own.
        let whole = (total + 1e-6).floor();
        let mut start = 0.0;
        let mut k = 0.0f64;
        for segment in run {
            let end = start + segment.length / step;
            let stretch = Stretch::new(segment, step);
            // Samples k with start <= k + 1/2 < end, whole ones.
            let last = (end - 0.5).ceil().min(whole);
            if k < last {
                let offset = (k + 0.5 - start) as f32;
                let count = (last - k) as u32;
                if self.samples(&stretch, segment, offset, count, 1.0, out) {
                    return;
                }
                k = last;
            }
            start = end;
        }
        let part = total - whole;
        if part > 1e-6
            && let Some(segment) = run.last()
        {
            let stretch = Stretch::new(segment, step);
            let at = segment.length / step - 0.5 * part;
            self.samples(&stretch, segment, at as f32, 1, part as f32, out);
        }
    }

    /// `count` samples from `offset` steps into a segment on; each counts for `share` of a step. Answers whether that was enough.
    #[inline(always)]
    fn samples(
        &self,
        stretch: &Stretch,
        segment: &Segment,
        offset: f32,
        count: u32,
        share: f32,
        out: &mut Gathered,
    ) -> bool {
        let mut k = 0;
        while k < count {
            let n = offset + k as f32;
            let found = self.marcher.leaps.at(stretch.at(n));
            if found.1 > 0 {
                k = k.saturating_add(stretch.leap(n, found).min(1e6) as u32);
                continue;
            }
            let taken = (count - k).min(GROUP as u32);
            if self.group(stretch, segment, n, taken as usize, share, out) {
                return true;
            }
            k += taken;
        }
        false
    }

    #[inline(always)]
    fn group(
        &self,
        stretch: &Stretch,
        segment: &Segment,
        n: f32,
        taken: usize,
        share: f32,
        out: &mut Gathered,
    ) -> bool {
        let table = &self.marcher.table;
        let mut p: [Group; 3] = [[0.0; GROUP]; 3];
        for (a, p) in p.iter_mut().enumerate() {
            let [c0, c1, c2, c3] = [0, 1, 2, 3].map(|k| stretch.c[k][a]);
            for (l, p) in p.iter_mut().enumerate() {
                let n = n + l as f32;
                *p = c0 + n * (c1 + n * (c2 + n * c3));
            }
        }
        let values = self.sampler.at(&p);
        let mut place = [0i32; GROUP];
        for l in 0..GROUP {
            let v = (values[l] - table.least) * table.scale;
            place[l] = nearest(v);
        }
        out.samples += taken as u32;
        for l in 0..taken {
            let entry = table.entries[place[l] as usize & (ENTRIES - 1)];
            let mut alpha = entry[3];
            if alpha <= 0.0 {
                continue;
            }
            if share != 1.0 {
                alpha = 1.0 - (1.0 - alpha).powf(share);
            }
            let at = [p[0][l], p[1][l], p[2][l]];
            let lit = self.lit(entry, at, stretch, n + l as f32);
            let weight = alpha * (1.0 - out.alpha);
            out.color += lit * weight;
            out.alpha += weight;
            if out.half.is_none() && out.alpha >= HALF {
                out.half = Some(self.place(segment, n + l as f32));
            }
            if out.alpha >= ENOUGH {
                return true;
            }
        }
        false
    }

    /// Depth and place of a sample.
    #[inline(always)]
    fn place(&self, segment: &Segment, n: f32) -> (f64, belvedere_core::DVec3) {
        let t = (f64::from(n) * self.marcher.step / segment.length).clamp(0.0, 1.0);
        let depth = segment.depth[0] + t * (segment.depth[1] - segment.depth[0]);
        (depth, self.marcher.volume().scene_from_lattice(segment.curve.at(t)))
    }

    #[inline(always)]
    fn lit(&self, [r, g, b, _]: [f32; 4], p: [f32; 3], stretch: &Stretch, n: f32) -> Vec3A {
        let rgb = Vec3A::new(r, g, b);
        if self.marcher.layer.model == VolumeModel::Plain {
            return rgb;
        }
        let gradient = Vec3A::from_array(self.sampler.gradient(p));
        let normal = self.marcher.normal_from_gradient * gradient;
        let size = normal.length_squared();
        // The length of a step, in lattice coordinates, is that of the direction.
        let along = gradient.dot(Vec3A::from_array(stretch.direction(n)));
        let edges = (self.marcher.layer.step) as f32;
        let inverse = 1.0 / size.max(f32::MIN_POSITIVE).sqrt();
        let cos = (along.abs() * inverse / edges).min(1.0);
        let solid = size / (size + self.marcher.surface_squared);
        let up = normal.z * inverse * if along > 0.0 { -1.0 } else { 1.0 };
        let [factor, white] = light(cos, solid, up);
        rgb * factor + white
    }
}
