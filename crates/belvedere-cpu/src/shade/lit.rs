//! Ground with its light on it: colour and light of every node, made tile by tile where they are looked at.
//!
//! Light is fixed to the map, so none of it depends on the view: what one frame makes serves the next. A node takes
//! eight bytes, a pixel eight nodes, and their weighted sum is one pass of 16-bit integers.

use super::color::{Rgb, encode_root};
use super::ground::{Means, Surface};
use super::palette::Tint;
use super::relief::ReliefLight;
use super::shadow::Shadows;
use glam::{Vec3A, Vec4};
use std::sync::OnceLock;
use std::sync::atomic::{AtomicUsize, Ordering};

/// Red, green, blue (square roots of linear light), direct light, light from the sky; the rest is spare.
type Node = [u8; 8];

/// Cells along a side of a tile, a power of two; one more node along each side, so that no cell lies in two tiles.
const TILE: usize = 64;
const STRIDE: usize = TILE + 1;

/// Amounts of light that the stored values end at.
const MOST_DIRECT: f32 = 1.4;
const MOST_SKY: f32 = 0.8;

/// Bytes of tiles after which a frame starts anew: long flights over a huge ground must not collect all of it.
const MOST_BYTES: usize = 192 << 20;

/// Fixed-point steps of a cell.
pub(crate) const CELL: i32 = 256;

/// Everything that the tiles of a ground are made from.
pub(crate) struct Making<'a> {
    pub(crate) surface: &'a Surface<'a>,
    pub(crate) means: &'a Means,
    pub(crate) shadows: Option<&'a Shadows>,
    pub(crate) tint: &'a Tint,
    pub(crate) light: &'a ReliefLight,
    pub(crate) exaggeration: f32,
}

/// Colour and light at a place of the ground.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct Lit {
    /// Square roots of linear light.
    pub(crate) root: [f32; 3],
    /// Amounts of direct light and of light from the sky.
    pub(crate) direct: f32,
    pub(crate) sky: f32,
}

struct Level {
    cols: usize,
    rows: usize,
    tiles_across: usize,
    tiles: Vec<OnceLock<Box<[Node]>>>,
}

/// The tiles of a ground, see the module.
pub(crate) struct LitGround {
    levels: Vec<Level>,
    bytes: AtomicUsize,
}

impl LitGround {
    /// No tile made yet.
    pub(crate) fn new(cols: usize, rows: usize, top: usize) -> Self {
        let level = |k: usize| {
            let [cols, rows] = [cols, rows].map(|n| n.div_ceil(1 << k));
            let [across, down] = [cols, rows].map(|n| n.div_ceil(TILE));
            let tiles = (0..across * down).map(|_| OnceLock::new()).collect();
            Level { cols, rows, tiles_across: across, tiles }
        };
        Self { levels: (0..=top).map(level).collect(), bytes: AtomicUsize::new(0) }
    }

    /// Whether so much is kept that the next frame had better start anew.
    pub(crate) fn is_full(&self) -> bool {
        self.bytes.load(Ordering::Relaxed) > MOST_BYTES
    }

    /// Weighted sum of nodes around a place, over 2^lod cells; 256 times the stored values.
    /// * `at`: column and row, [`CELL`] steps to a cell;
    /// * `lod`: level of averages, 256 steps to a level.
    #[inline]
    pub(crate) fn sample(&self, at: [i32; 2], lod: u32, making: &Making<'_>) -> [u16; 8] {
        let lod = lod.min((self.levels.len() as u32 - 1) << 8);
        let (k, share) = ((lod >> 8) as usize, lod & 255);
        let mut sum = [0u16; 8];
        self.add(k, at, 256 - share, making, &mut sum);
        if share > 0 {
            self.add(k + 1, at, share, making, &mut sum);
        }
        sum
    }

    #[inline]
    fn add(&self, k: usize, at: [i32; 2], total: u32, making: &Making<'_>, sum: &mut [u16; 8]) {
        let level = &self.levels[k];
        // Node i of level k lies at (i + 0.5) 2^k - 0.5 of level 0.
        let place = |x: i32, n: usize| {
            let x = (((x + CELL / 2) >> k) - CELL / 2).clamp(0, (n as i32 - 1) * CELL) as u32;
            ((x >> 8) as usize, x & 255)
        };
        let ((c, u), (r, v)) = (place(at[0], level.cols), place(at[1], level.rows));
        let index = r / TILE * level.tiles_across + c / TILE;
        let tile = match level.tiles[index].get() {
            Some(tile) => tile,
            None => self.make(k, index, making),
        };
        // Whole weights that sum up to `total`.
        let (wu, wuv) = ((u * total) >> 8, (u * v * total) >> 16);
        let wv = (v * total) >> 8;
        let first = r % TILE * STRIDE + c % TILE;
        let Some(nodes) = tile.get(first..first + STRIDE + 2) else { return };
        accumulate(sum, nodes[0], total + wuv - wu - wv);
        accumulate(sum, nodes[1], wu - wuv);
        accumulate(sum, nodes[STRIDE], wv - wuv);
        accumulate(sum, nodes[STRIDE + 1], wuv);
    }

    #[cold]
    #[inline(never)]
    fn make(&self, k: usize, index: usize, making: &Making<'_>) -> &[Node] {
        let level = &self.levels[k];
        level.tiles[index].get_or_init(|| {
            self.bytes.fetch_add(STRIDE * STRIDE * size_of::<Node>(), Ordering::Relaxed);
            let (c0, r0) = (index % level.tiles_across * TILE, index / level.tiles_across * TILE);
            let mut tile = Vec::with_capacity(STRIDE * STRIDE);
            let mut row = Row::new(STRIDE.min(level.cols - c0));
            for j in 0..STRIDE {
                row.fill(making, k, (r0 + j).min(level.rows - 1), c0);
                tile.extend((0..STRIDE).map(|i| row.lit[i.min(row.lit.len() - 1)]));
            }
            tile.into_boxed_slice()
        })
    }
}

#[inline]
fn accumulate(sum: &mut [u16; 8], node: Node, weight: u32) {
    for (s, v) in sum.iter_mut().zip(node) {
        *s = s.wrapping_add(u16::from(v).wrapping_mul(weight as u16));
    }
}

impl Lit {
    /// From a weighted sum of nodes.
    #[inline]
    pub(crate) fn of(sum: [u16; 8]) -> Self {
        const ONE: f32 = 256.0 * 255.0;
        let [r, g, b, direct, sky, ..] = sum.map(f32::from);
        Self { root: [r / ONE, g / ONE, b / ONE], direct: direct * (MOST_DIRECT / ONE), sky: sky * (MOST_SKY / ONE) }
    }

    /// Linear colour of the ground without light.
    pub(crate) fn albedo(&self) -> Rgb {
        let root = Vec3A::from_array(self.root);
        root * root
    }
}

/// A row of nodes in the making.
struct Row {
    shape: Vec<Vec4>,
    shares: Vec<f32>,
    lit: Vec<Node>,
}

impl Row {
    fn new(n: usize) -> Self {
        Self { shape: vec![Vec4::ZERO; n], shares: vec![1.0; n], lit: vec![Node::default(); n] }
    }

    fn fill(&mut self, m: &Making<'_>, k: usize, row: usize, first: usize) {
        let stored = k >= m.means.first;
        if stored {
            for (i, n) in self.shape.iter_mut().enumerate() {
                *n = m.means.node(k, first + i, row);
            }
        } else {
            m.surface.mean_row(k, row, first, &mut self.shape);
        }
        if let Some(shadows) = m.shadows {
            shadows.share_row(k, row, first, &mut self.shares);
        }
        let side = (1u32 << k) as f32;
        let place = |i: usize| (i as f32 + 0.5) * side - 0.5;
        for (i, (out, shape)) in self.lit.iter_mut().zip(&self.shape).enumerate() {
            let near = if stored { *shape } else { m.means.at(m.means.first, place(first + i), place(row)) };
            // A hole looks like the ground around it.
            let shape = if stored || shape.w > 0.0 { *shape } else { near };
            *out = lit_node(m, shape, m.means.openness(shape.z, near), self.shares[i]);
        }
    }
}

fn lit_node(m: &Making<'_>, shape: Vec4, open: f32, lit: f32) -> Node {
    let steep = (shape.x * shape.x + shape.y * shape.y).sqrt();
    let [r, g, b] = encode_root(m.tint.color(shape.z, steep));
    let n = Vec3A::new(-shape.x * m.exaggeration, -shape.y * m.exaggeration, 1.0).normalize();
    let [direct, sky] = m.light.parts(n, open, lit);
    let byte = |v: f32| (v.clamp(0.0, 1.0) * 255.0 + 0.5) as u8;
    [r, g, b, byte(direct / MOST_DIRECT), byte(sky / MOST_SKY), 0, 0, 0]
}

#[cfg(test)]
mod tests {
    use super::*;
    use belvedere_core::DVec2;
    use belvedere_scene::{Heightfield, Light, NodeState, Palette, Relief};

    fn hills(cols: usize, rows: usize) -> Heightfield {
        let h = |i: usize| {
            let (x, y) = ((i % cols) as f32 * 0.07, (i / cols) as f32 * 0.05);
            900.0 + 400.0 * (x.sin() * y.cos() + 0.3 * (3.0 * x + y).sin())
        };
        let heights = (0..cols * rows).map(h).collect();
        Heightfield::new(DVec2::ZERO, DVec2::splat(30.0), cols, rows, heights, vec![NodeState::Measured; cols * rows])
            .unwrap()
    }

    fn with_making(hf: &Heightfield, test: impl Fn(&LitGround, &Making<'_>)) {
        let surface = Surface::of_map(hf);
        let means = Means::new(&surface);
        let tint = Tint::new(&Palette::Alpine, hf.z_range());
        let light = ReliefLight::new(Relief::Swiss, &Light::default());
        let making =
            Making { surface: &surface, means: &means, shadows: None, tint: &tint, light: &light, exaggeration: 1.0 };
        test(&LitGround::new(hf.cols(), hf.rows(), means.top()), &making);
    }

    #[test]
    fn interpolated_light_is_that_of_the_interpolated_ground() {
        let hf = hills(150, 131);
        with_making(&hf, |ground, m| {
            let mut row = vec![Vec4::ZERO; 150];
            let (mut worst, mut sum, mut n) = (0.0f32, 0.0, 0.0);
            for r in 1..129 {
                m.surface.row(r, 0, &mut row);
                for c in 1..148 {
                    for share in [0i32, 64, 200] {
                        let got = Lit::of(ground.sample([c * CELL + share, r as i32 * CELL], 0, m));
                        let shape = row[c as usize].lerp(row[c as usize + 1], share as f32 / 256.0);
                        let near = m.means.at(1, c as f32 + share as f32 / 256.0, r as f32);
                        let steep = shape.truncate().truncate().length();
                        let normal = Vec3A::new(-shape.x, -shape.y, 1.0).normalize();
                        let light = m.light.at(normal, m.means.openness(shape.z, near));
                        let want = m.tint.color(shape.z, steep) * light;
                        let has = got.albedo() * (m.light.warm * got.direct + m.light.cool * got.sky);
                        let steps = |c: Rgb| c.max(Rgb::ZERO).to_array().map(|v| 255.0 * v.sqrt());
                        for (a, b) in steps(want).into_iter().zip(steps(has)) {
                            (worst, sum, n) = (worst.max((a - b).abs()), sum + (a - b).abs(), n + 1.0);
                        }
                    }
                }
            }
            assert!(worst < 4.0 && sum / n < 0.5, "{worst} steps at most, {} on average", sum / n);
        });
    }

    #[test]
    fn weights_are_whole_and_sum_up_everywhere() {
        let hf = hills(70, 70);
        let (surface, light) = (Surface::of_map(&hf), ReliefLight::new(Relief::None, &Light::default()));
        let means = Means::new(&surface);
        let tint = Tint::new(&Palette::Plain, hf.z_range());
        let making =
            Making { surface: &surface, means: &means, shadows: None, tint: &tint, light: &light, exaggeration: 1.0 };
        let ground = LitGround::new(70, 70, means.top());
        let want = ground.sample([0, 0], 0, &making);
        for i in 0..20_000i32 {
            let at = [i * 7919 % (80 * CELL) - 5 * CELL, i * 104_729 % (80 * CELL) - 5 * CELL];
            assert_eq!(ground.sample(at, (i * 37 % 2300) as u32, &making), want, "{at:?}");
        }
    }

    #[test]
    fn averages_match_the_mean_of_what_they_stand_for() {
        let hf = hills(257, 257);
        with_making(&hf, |ground, m| {
            // A place at the middle of a node of level 5, against the mean over its 32 x 32 nodes.
            let (c, r, side) = (96, 64, 32i32);
            let mut mean = [0.0f32; 5];
            for i in 0..side * side {
                let sum = ground.sample([(c + i % side) * CELL, (r + i / side) * CELL], 0, m);
                let lit = Lit::of(sum);
                for (s, v) in mean.iter_mut().zip([lit.root[0], lit.root[1], lit.root[2], lit.direct, lit.sky]) {
                    *s += v / (side * side) as f32;
                }
            }
            let at = [c * CELL + (side - 1) * CELL / 2, r * CELL + (side - 1) * CELL / 2];
            let lit = Lit::of(ground.sample(at, 5 << 8, m));
            for (a, b) in mean.into_iter().zip([lit.root[0], lit.root[1], lit.root[2], lit.direct, lit.sky]) {
                assert!((a - b).abs() < 0.1, "{mean:?} {lit:?}");
            }
        });
    }
}
