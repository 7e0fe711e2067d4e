//! Rays side by side: one lane follows one ray through the volume and takes the next one at its end.
//!
//! What a ray gathers does not depend on the rays beside it, so pictures do not depend on how rays are put together.

use super::Gathered;
use super::bricks::EDGE;
use super::clip::Segment;
use super::cursor::{Cursor, Stretch};
use super::light::light;
use super::prepared::Prepared;
use super::sampler::{Sampler, Voxel};
use super::table::ENTRIES;
use crate::simd::{Kernel, nearest};
use belvedere_scene::VolumeModel;
use belvedere_sight::volume::{ENOUGH, HALF, half_within};

/// Rays side by side.
const RAYS: usize = 32;
/// Samples of a ray between two looks at the bricks.
const SAMPLES_PER_LOOK: usize = 4;
/// Samples that are taken together.
const BLOCK: usize = RAYS * SAMPLES_PER_LOOK;
/// Samples that are shaded together.
const SHADED: usize = 32;

type Lane = [f32; RAYS];
type Block = [f32; BLOCK];

/// Rays to follow.
pub(super) struct Packet<'m, 'v, T> {
    pub(super) prepared: &'m Prepared<'v>,
    pub(super) sampler: Sampler<'m, T>,
    /// Segments of all rays, and for each ray the number of those before its end.
    pub(super) segments: &'m [Segment],
    pub(super) ends: &'m [usize],
    /// For each ray the place of its samples within their steps, 0..=1.
    pub(super) within: &'m [f64],
    /// What each ray gathers.
    pub(super) out: &'m mut [Gathered],
}

/// A ray in a lane.
struct Follower<'s> {
    number: usize,
    cursor: Cursor<'s>,
}

/// State of the lanes; those of [`Stretch`] by lane.
struct Lanes {
    c: [[Lane; 3]; 4],
    bend: [Lane; 3],
    first: Lane,
    last: Lane,
    count: Lane,
    share: Lane,
    /// Samples of the stretch passed.
    passed: Lane,
    /// Absorbed share of light, and light.
    alpha: Lane,
    color: [[f32; 4]; RAYS],
    samples: [u32; RAYS],
}

impl Lanes {
    fn new() -> Self {
        let zero = [0.0; RAYS];
        Self {
            c: [[zero; 3]; 4],
            bend: [zero; 3],
            first: zero,
            last: zero,
            count: zero,
            share: [1.0; RAYS],
            passed: zero,
            alpha: zero,
            color: [[0.0; 4]; RAYS],
            samples: [0; RAYS],
        }
    }

    fn set(&mut self, l: usize, stretch: &Stretch) {
        for a in 0..3 {
            for k in 0..4 {
                self.c[k][a][l] = stretch.c[k][a];
            }
            self.bend[a][l] = stretch.bend[a];
        }
        (self.first[l], self.last[l]) = (stretch.first, stretch.last);
        (self.count[l], self.share[l], self.passed[l]) = (stretch.count, stretch.share, 0.0);
    }
}

impl<T: Voxel> Kernel for Packet<'_, '_, T> {
    type Output = ();

    #[inline(always)]
    fn run(mut self) {
        let mut lanes = Lanes::new();
        let mut followers: [Option<Follower<'_>>; RAYS] = [const { None }; RAYS];
        let mut next = 0;
        let mut live = RAYS;
        loop {
            let mut ready = [0.0; RAYS];
            // Empty space, until most lanes have come to where something may be seen.
            loop {
                for l in 0..RAYS {
                    if lanes.passed[l] >= lanes.count[l] && !self.advance(&mut lanes, &mut followers[l], l, &mut next) {
                        live = followers.iter().flatten().count();
                    }
                }
                if live == 0 {
                    return;
                }
                self.leap(&mut lanes, &mut ready);
                if 4.0 * ready.iter().sum::<f32>() >= 3.0 * live as f32 {
                    break;
                }
            }
            self.block(&mut lanes, &followers, &ready);
        }
    }
}

impl<'m, T: Voxel> Packet<'m, '_, T> {
    /// Goes on to the next stretch of the ray in a lane, or to the next ray; returns whether there is any.
    #[inline(never)]
    fn advance(&mut self, lanes: &mut Lanes, follower: &mut Option<Follower<'m>>, l: usize, next: &mut usize) -> bool {
        loop {
            if let Some(Follower { number, cursor }) = follower {
                if lanes.alpha[l] < ENOUGH
                    && let Some(stretch) = cursor.next()
                {
                    lanes.set(l, &stretch);
                    return true;
                }
                let out = &mut self.out[*number];
                let [r, g, b, _] = lanes.color[l];
                out.color = glam::Vec3A::new(r, g, b);
                (out.alpha, out.samples) = (lanes.alpha[l], lanes.samples[l]);
                (lanes.alpha[l], lanes.color[l], lanes.samples[l]) = (0.0, [0.0; 4], 0);
                *follower = None;
            }
            if *next == self.ends.len() {
                (lanes.passed[l], lanes.count[l]) = (0.0, 0.0);
                return false;
            }
            let begin = if *next == 0 { 0 } else { self.ends[*next - 1] };
            let segments = &self.segments[begin..self.ends[*next]];
            if let Some(first) = segments.first() {
                self.out[*next].enters = first.depth.0[0];
                let cursor = Cursor::new(segments, self.prepared.step, self.within[*next]);
                *follower = Some(Follower { number: *next, cursor });
            }
            *next += 1;
        }
    }

    /// Moves rays in empty bricks ahead by the whole steps that stay within the cube of empty bricks around them. Sets `ready` to 1 for
    /// rays in other bricks, else to 0.
    #[inline(always)]
    fn leap(&self, lanes: &mut Lanes, ready: &mut Lane) {
        let leaps = &self.prepared.leaps;
        let dims = leaps.dims().map(|n| n as i32);
        let (mut p, mut v) = ([[0.0; RAYS]; 3], [[0.0; RAYS]; 3]);
        let mut bricks = [[0i32; RAYS]; 3];
        let mut n = [0.0; RAYS];
        for (l, n) in n.iter_mut().enumerate() {
            let way = lanes.first[l] + lanes.passed[l];
            *n = if way < lanes.last[l] { way } else { lanes.last[l] };
        }
        for a in 0..3 {
            let [c0, c1, c2, c3] = [0, 1, 2, 3].map(|k| &lanes.c[k][a]);
            for l in 0..RAYS {
                p[a][l] = c0[l] + n[l] * (c1[l] + n[l] * (c2[l] + n[l] * c3[l]));
                v[a][l] = c1[l] + n[l] * (2.0 * c2[l] + n[l] * 3.0 * c3[l]);
                let place = p[a][l] * (1.0 / EDGE);
                bricks[a][l] = nearest(place - 0.5).min(dims[a] - 1).max(0);
            }
        }
        let mut numbers = [0i32; RAYS];
        for l in 0..RAYS {
            numbers[l] = (bricks[2][l] * dims[1] + bricks[1][l]) * dims[0] + bricks[0][l];
        }
        let mut distance = [0.0f32; RAYS];
        for l in 0..RAYS {
            distance[l] = f32::from(leaps.distance(numbers[l] as usize));
        }
        let (mut leap, mut ahead, mut behind) = ([1e6f32; RAYS], [1e6f32; RAYS], [1e6f32; RAYS]);
        let (mut ways, mut paces) = ([[0.0; RAYS]; 3], [[0.0; RAYS]; 3]);
        for a in 0..3 {
            for l in 0..RAYS {
                let reach = (distance[l] - 1.0) * EDGE;
                let corner = bricks[a][l] as f32 * EDGE;
                let (low, high) = (corner - reach, corner + (EDGE + reach));
                let (before, after) = (p[a][l] - low, high - p[a][l]);
                let speed = v[a][l].abs();
                let pace = 1.0 / if speed > 1e-12 { speed } else { 1e-12 };
                let way = if v[a][l] > 0.0 { after } else { before };
                (ways[a][l], paces[a][l]) = (way, pace);
                leap[l] = if way * pace < leap[l] { way * pace } else { leap[l] };
            }
        }
        // The bend may bring the ray to a side earlier, by at most `off` within the leap. For sides that it moves away from, the distance
        // itself counts, and the speed that the bend may give it towards them.
        for a in 0..3 {
            for l in 0..RAYS {
                let off = lanes.bend[a][l] * (leap[l] * leap[l]);
                let this = (ways[a][l] - off) * paces[a][l];
                ahead[l] = if this < ahead[l] { this } else { ahead[l] };
                let cube = (2.0 * distance[l] - 1.0) * EDGE;
                let other = cube - ways[a][l] - off;
                behind[l] = if other < behind[l] { other } else { behind[l] };
            }
        }
        for l in 0..RAYS {
            let way = if behind[l] + 1e-3 >= 0.0 { ahead[l] } else { 1.0 };
            let whole = nearest(way - 0.5) as f32;
            let whole = if whole > 1.0 { whole } else { 1.0 };
            let is_live = lanes.passed[l] < lanes.count[l];
            let sees = distance[l] == 0.0;
            ready[l] = if is_live && sees { 1.0 } else { 0.0 };
            lanes.passed[l] += if is_live && !sees { whole } else { 0.0 };
        }
    }

    /// Takes the next [`SAMPLES_PER_LOOK`] samples of the rays that are ready.
    #[inline(always)]
    fn block(&mut self, lanes: &mut Lanes, followers: &[Option<Follower<'m>>; RAYS], ready: &Lane) {
        let prepared = self.prepared;
        let table = &prepared.table;
        let mut p = [[0.0; BLOCK]; 3];
        let mut n = [0.0; BLOCK];
        for s in 0..SAMPLES_PER_LOOK {
            for l in 0..RAYS {
                let way = lanes.first[l] + (lanes.passed[l] + s as f32);
                n[s * RAYS + l] = if way < lanes.last[l] { way } else { lanes.last[l] };
            }
        }
        for (a, p) in p.iter_mut().enumerate() {
            let [c0, c1, c2, c3] = [0, 1, 2, 3].map(|k| &lanes.c[k][a]);
            for s in 0..SAMPLES_PER_LOOK {
                for l in 0..RAYS {
                    let n = n[s * RAYS + l];
                    p[s * RAYS + l] = c0[l] + n * (c1[l] + n * (c2[l] + n * c3[l]));
                }
            }
        }
        let values = self.sampler.at(&p);
        let (mut place, mut rest) = ([0i32; BLOCK], [0.0f32; BLOCK]);
        for i in 0..BLOCK {
            let at = ((values[i] - table.least) * table.scale).max(0.0);
            // The entry below, or on an entry perhaps the one before, which gives the same opacity.
            place[i] = nearest(at - 0.5);
            rest[i] = at - place[i] as f32;
        }
        let (mut alphas, mut changes) = ([0.0; BLOCK], [0.0; BLOCK]);
        for i in 0..BLOCK {
            [alphas[i], changes[i]] = table.alphas[place[i] as usize & (ENTRIES - 1)];
        }
        let mut most = [0.0f32; RAYS];
        for s in 0..SAMPLES_PER_LOOK {
            for l in 0..RAYS {
                let i = s * RAYS + l;
                let counts = ready[l] > 0.0 && lanes.passed[l] + (s as f32) < lanes.count[l];
                let alpha = alphas[i] + rest[i] * changes[i];
                alphas[i] = if counts && alpha > 0.0 { alpha } else { 0.0 };
                lanes.samples[l] += u32::from(counts);
                most[l] = if alphas[i] > most[l] { alphas[i] } else { most[l] };
            }
        }
        if most.iter().any(|m| *m > 0.0) {
            self.shares(lanes, &mut alphas);
            let (mut factor, mut white) = ([1.0; BLOCK], [0.0; BLOCK]);
            if prepared.layer.model == VolumeModel::Shaded {
                self.shade(lanes, &p, &n, &alphas, [&mut factor, &mut white]);
            }
            self.lay(lanes, followers, &alphas, &place, [&factor, &white]);
        }
        for (l, ready) in ready.iter().enumerate() {
            let passed = lanes.passed[l] + ready * SAMPLES_PER_LOOK as f32;
            lanes.passed[l] = if lanes.alpha[l] < ENOUGH { passed } else { lanes.count[l] };
        }
    }

    /// Opacities of steps that are shorter than the others.
    #[inline(always)]
    fn shares(&self, lanes: &Lanes, alphas: &mut Block) {
        for l in 0..RAYS {
            let s = lanes.count[l] - 1.0 - lanes.passed[l];
            if lanes.share[l] != 1.0 && (0.0..SAMPLES_PER_LOOK as f32).contains(&s) {
                let alpha = &mut alphas[s as usize * RAYS + l];
                if *alpha > 0.0 {
                    *alpha = 1.0 - (1.0 - *alpha).powf(lanes.share[l]);
                }
            }
        }
    }

    /// Composites samples behind the light gathered so far.
    #[inline(always)]
    fn lay(
        &mut self,
        lanes: &mut Lanes,
        followers: &[Option<Follower<'m>>; RAYS],
        alphas: &Block,
        place: &[i32; BLOCK],
        [factor, white]: [&Block; 2],
    ) {
        let mut weights = [0.0; BLOCK];
        let mut before_half = [0.0; RAYS];
        let mut half = [-1.0f32; RAYS];
        for s in 0..SAMPLES_PER_LOOK {
            for l in 0..RAYS {
                let i = s * RAYS + l;
                let old = lanes.alpha[l];
                let before = 1.0 - old;
                let weight = if old < ENOUGH { alphas[i] * before } else { 0.0 };
                weights[i] = weight;
                lanes.alpha[l] = old + weight;
                let crosses = old < HALF && lanes.alpha[l] >= HALF;
                before_half[l] = if crosses { before } else { before_half[l] };
                half[l] = if crosses { s as f32 } else { half[l] };
            }
        }
        for i in 0..BLOCK {
            let lit = table_color(&self.prepared.table.colors, place[i]);
            let (f, w, weight) = (factor[i], white[i], weights[i]);
            let out = &mut lanes.color[i % RAYS];
            for c in 0..4 {
                out[c] += (lit[c] * f + w) * weight;
            }
        }
        if half.iter().any(|h| *h >= 0.0) {
            self.halves(lanes, followers, alphas, (&half, &before_half));
        }
    }

    /// Notes where half of the light is absorbed.
    #[inline(never)]
    fn halves(
        &mut self,
        lanes: &Lanes,
        followers: &[Option<Follower<'m>>; RAYS],
        alphas: &Block,
        (half, before): (&Lane, &Lane),
    ) {
        for (l, follower) in followers.iter().enumerate() {
            let Some(follower) = follower.as_ref().filter(|_| half[l] >= 0.0) else { continue };
            let within = half_within(before[l], alphas[half[l] as usize * RAYS + l]);
            let (depth, q) = follower.cursor.place(lanes.passed[l] + half[l], within);
            self.out[follower.number].half = Some((depth, self.prepared.volume().scene_from_lattice(q)));
        }
    }

    /// Factors of the colours of visible samples, and white that is added to them.
    #[inline(always)]
    fn shade(&self, lanes: &Lanes, p: &[Block; 3], n: &Block, alphas: &Block, out: [&mut Block; 2]) {
        let mut visible = [0u8; BLOCK + 1];
        let mut count = 0;
        for (i, alpha) in alphas.iter().enumerate() {
            visible[count] = i as u8;
            count += usize::from(*alpha > 0.0);
        }
        let [factor, white] = out;
        for part in visible[..count].chunks(SHADED) {
            let (mut q, mut v) = ([[0.0; SHADED]; 3], [[0.0; SHADED]; 3]);
            for k in 0..SHADED {
                let i = usize::from(part[k.min(part.len() - 1)]) % BLOCK;
                let (l, n) = (i % RAYS, n[i]);
                for a in 0..3 {
                    q[a][k] = p[a][i];
                    let [c1, c2, c3] = [1, 2, 3].map(|k| lanes.c[k][a][l]);
                    v[a][k] = c1 + n * (2.0 * c2 + n * 3.0 * c3);
                }
            }
            let [factors, whites] = self.shading(&q, &v);
            for (k, i) in part.iter().enumerate() {
                factor[usize::from(*i) % BLOCK] = factors[k];
                white[usize::from(*i) % BLOCK] = whites[k];
            }
        }
    }

    /// * `v`: direction per step, lattice coordinates.
    #[inline(always)]
    fn shading(&self, p: &[[f32; SHADED]; 3], v: &[[f32; SHADED]; 3]) -> [[f32; SHADED]; 2] {
        let g = self.sampler.gradients(p);
        let m = self.prepared.normal_from_gradient;
        let [x, y, z] = [m.x_axis, m.y_axis, m.z_axis].map(|c| c.to_array());
        // The length of a step in voxel edges.
        let edges = self.prepared.layer.step as f32;
        let surface_squared = self.prepared.surface_squared;
        let mut out = [[0.0; SHADED]; 2];
        for l in 0..SHADED {
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

#[inline(always)]
fn table_color(colors: &[[f32; 4]; ENTRIES], place: i32) -> [f32; 4] {
    colors[place as usize & (ENTRIES - 1)]
}
