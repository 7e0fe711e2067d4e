//! Lit ground: colours of nodes, computed in tiles on demand.
//!
//! Light is fixed to the map and does not depend on the view, so the tiles of one frame serve the next. Two pictures of the
//! ground are kept: its lit colour, which most pixels use directly, and colour and light separately, for pixels where something
//! lies over the ground. A node takes eight bytes in each; a pixel is a weighted sum of four nodes in 16-bit integers.

use crate::shade::ground::patch::{LightingInputs, Patch};
use crate::shade::ground::tiles::{self, FourNodes, Node, Tile, Tiles};
use crate::shade::ground::upsample::CoarseColors;
use crate::shade::relief::ReliefLight;
use crate::simd::{self, IntLanes, Kernel, LANES, Lanes, nearest};
use belvedere_composite::color::Rgb;
use belvedere_scene::{Light, Palette, Relief};
use glam::Vec3A;

/// Largest amounts of light that can be stored.
const MOST_DIRECT: f32 = 1.4;
const MOST_SKY: f32 = 0.8;
/// Square root of the largest lit colour that can be stored; 1 = white.
const BRIGHTEST: f32 = 1.25;
/// Value of a weighted sum for square root 1 of linear light.
const ONE: f32 = 256.0 * 255.0 / BRIGHTEST;

/// Colour and light at a point of the ground.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub(crate) struct Lit {
    /// Square roots of linear light.
    root: [f32; 3],
    /// Amounts of direct light and of light from the sky.
    pub(crate) direct: f32,
    pub(crate) sky: f32,
    /// Strength of the texture, 0..=1.
    pub(crate) rough: f32,
}

/// Inputs of the lit ground, besides the ground itself.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct LitKey {
    pub(crate) relief: Relief,
    pub(crate) light: Light,
    pub(crate) palette: Palette,
    pub(crate) exaggeration: f64,
}

/// The two pictures of a ground, see the module.
#[derive(Debug)]
pub(crate) struct LitGround {
    /// Square roots of the lit colour of the level and the strength of its texture, and of the next level with a spare byte.
    colors: Tiles,
    /// Square roots of the colour without light, direct light, light from the sky, strength of the texture.
    parts: Tiles,
}

impl LitGround {
    /// Pictures without tiles.
    pub(crate) fn new(cols: usize, rows: usize, top: usize) -> Self {
        Self { colors: Tiles::new([cols, rows], top), parts: Tiles::new([cols, rows], top) }
    }

    /// Whether the tiles exceed the limit of memory, so that the next frame starts without them.
    pub(crate) fn is_full(&self) -> bool {
        self.colors.is_full() || self.parts.is_full()
    }

    /// Bytes of the tiles made so far.
    #[cfg(test)]
    pub(crate) fn bytes(&self) -> usize {
        self.colors.bytes() + self.parts.bytes()
    }

    /// Drops the tiles that may not be kept, see [`Tiles::retain`].
    pub(crate) fn retain(&mut self, keep: impl Fn([[usize; 2]; 2]) -> bool) {
        self.colors.retain(&keep);
        self.parts.retain(&keep);
    }

    /// Square roots of the lit colour at `n` points, see [`LitGround::color`].
    /// * `at`: columns and rows, [`tiles::CELL`] steps to a cell.
    #[inline(always)]
    pub(crate) fn colors_of(
        &self,
        at: &[IntLanes; 2],
        lods: &[u32; LANES],
        n: usize,
        inputs: &LightingInputs<'_>,
    ) -> Colors {
        let top = self.colors.top() as u32;
        let (mut k, mut x, mut y, mut first) = ([0; LANES], [0; LANES], [0; LANES], [0; LANES]);
        for i in 0..LANES {
            k[i] = least(lods[i] >> 8, top);
            (x[i], y[i]) = (tiles::level_position(at[0][i], k[i]), tiles::level_position(at[1][i], k[i]));
            first[i] = tiles::first_of(x[i], y[i]);
        }
        let mut nodes = [[[0; LANES]; 2]; 4];
        let (mut last, mut tile) = ([u32::MAX; 3], None);
        for i in 0..n {
            // Neighbouring points mostly lie in the same tile.
            let here = [k[i], x[i] / tiles::SPAN, y[i] / tiles::SPAN];
            if here != last {
                (last, tile) = (here, self.colors.tile(here, |k, tile| self.make_colors(k, tile, inputs)));
            }
            if let Some(around) = tile.and_then(|tile| tiles::around(tile, first[i] as usize)) {
                for (nodes, [fine, coarse]) in nodes.iter_mut().zip(around) {
                    (nodes[0][i], nodes[1][i]) = (fine, coarse);
                }
            }
        }
        let mut out = Colors { fine: [[0; LANES]; 2], coarse: [[0; LANES]; 2] };
        let [nw, ne, sw, se] = &nodes;
        for i in 0..LANES {
            let weights = weights(x[i] & 255, y[i] & 255);
            (out.fine[0][i], out.fine[1][i]) = mean([nw[0][i], ne[0][i], sw[0][i], se[0][i]], weights);
            (out.coarse[0][i], out.coarse[1][i]) = mean([nw[1][i], ne[1][i], sw[1][i], se[1][i]], weights);
        }
        out
    }

    /// Square roots of the lit colour at a point, and the strength of the texture there.
    /// * `lod`: level of averages, 256 steps to a level.
    pub(crate) fn color(&self, at: [i32; 2], lod: u32, inputs: &LightingInputs<'_>) -> ([f32; 3], f32) {
        let places = [0, 1].map(|axis| [at[axis]; LANES]);
        let colors = self.colors_of(&places, &[lod; LANES], 1, inputs);
        (colors.between(0, (lod & 255) as f32 / 256.0), colors.rough(0))
    }

    /// Colour and light at a point, see [`LitGround::color`].
    pub(crate) fn sample(&self, at: [i32; 2], lod: u32, inputs: &LightingInputs<'_>) -> Lit {
        let lod = lod.min((self.parts.top() as u32) << 8);
        let (k, share) = ((lod >> 8) as usize, lod & 255);
        let mut sum = [0u16; 8];
        for (k, total) in [(k, 256 - share), (k + 1, share)] {
            if total > 0
                && let Some(around) = self.parts.around(k, at, |k, tile| self.make_parts(k, tile, inputs))
            {
                add(&around, total, &mut sum);
            }
        }
        Lit::of(sum)
    }

    fn make_parts(&self, k: usize, tile: [usize; 2], inputs: &LightingInputs<'_>) -> Box<Tile> {
        let [columns, rows] = self.parts.repeated(k, tile);
        simd::run(Parts(&Patch::new(inputs, k, columns.all(), rows.all())))
    }

    fn make_colors(&self, k: usize, tile: [usize; 2], inputs: &LightingInputs<'_>) -> Box<Tile> {
        let [columns, rows] = self.colors.repeated(k, tile);
        let patch = Patch::new(inputs, k, columns.all(), rows.all());
        // The coarsest level stands for all coarser ones.
        let next = (k < self.colors.top()).then(|| CoarseColors::new(inputs, k + 1, [columns, rows]));
        simd::run(Writing { patch: &patch, next: next.as_ref(), light: inputs.light })
    }
}

/// Weights of four nodes: whole numbers that sum up to 256.
#[inline(always)]
fn weights(u: u32, v: u32) -> [u32; 4] {
    let both = (u * v) >> 8;
    [256 + both - u - v, u - both, v - both, both]
}

/// Weighted sum of a colour of four nodes, two channels in one product: no channel carries into the next. First and third
/// channel, then the second one.
#[inline(always)]
fn mean(nodes: [u32; 4], weights: [u32; 4]) -> (u32, u32) {
    const EVEN: u32 = 0x00ff_00ff;
    let (mut even, mut odd) = (0, 0);
    for i in 0..4 {
        even += (nodes[i] & EVEN) * weights[i];
        odd += (nodes[i] >> 8 & EVEN) * weights[i];
    }
    (even, odd)
}

#[inline(always)]
fn least(a: u32, b: u32) -> u32 {
    if a < b { a } else { b }
}

/// Square roots of the colours of two levels, point by point: red and blue in 16 bits each, and green.
pub(crate) struct Colors {
    fine: [[u32; LANES]; 2],
    coarse: [[u32; LANES]; 2],
}

impl Colors {
    /// Square roots of linear red, green, blue at point `i`, a share of the way to the coarser level.
    #[inline(always)]
    pub(crate) fn between(&self, i: usize, share: f32) -> [f32; 3] {
        let (even, odd) = ([self.fine[0][i], self.coarse[0][i]], [self.fine[1][i], self.coarse[1][i]]);
        [
            between(even[0] & 0xffff, even[1] & 0xffff, share),
            between(odd[0] & 0xffff, odd[1] & 0xffff, share),
            between(even[0] >> 16, even[1] >> 16, share),
        ]
    }

    /// Strength of the texture at point `i`, 0..=1.
    #[inline(always)]
    pub(crate) fn rough(&self, i: usize) -> f32 {
        (self.fine[1][i] >> 16) as i32 as f32 * (1.0 / (256.0 * 255.0))
    }
}

#[inline(always)]
fn between(fine: u32, coarse: u32, share: f32) -> f32 {
    let (fine, coarse) = (fine as i32 as f32, coarse as i32 as f32);
    (fine + share * (coarse - fine)) * (1.0 / ONE)
}

/// Adds the values of four nodes, weighted with whole numbers that sum up to `total`.
fn add(around: &FourNodes<'_>, total: u32, sum: &mut [u16; 8]) {
    let (u, v) = (around.east_share, around.south_share);
    let (east, south, both) = ((u * total) >> 8, (v * total) >> 8, (u * v * total) >> 16);
    let weights = [total + both - east - south, east - both, south - both, both];
    for (node, weight) in around.north.iter().chain(around.south).zip(weights) {
        for (s, v) in sum.iter_mut().zip(node) {
            *s += u16::from(*v) * weight as u16;
        }
    }
}

/// A value of 0..=1 in 255 steps.
#[inline(always)]
fn byte(v: f32) -> u32 {
    // In this order NaN becomes 0.
    let v = if v > 0.0 { v } else { 0.0 };
    nearest((if v < 1.0 { v } else { 1.0 }) * 255.0) as u32
}

/// Packs four values into a word.
#[inline(always)]
fn word(v: [f32; 4]) -> u32 {
    byte(v[0]) | byte(v[1]) << 8 | byte(v[2]) << 16 | byte(v[3]) << 24
}

/// Appends nodes of two words each, [`LANES`] at a time.
#[inline(always)]
fn push(out: &mut Vec<Node>, low: &[u32; LANES], high: &[u32; LANES]) {
    for i in 0..LANES.min(tiles::NODES - out.len()) {
        out.push((u64::from(low[i]) | u64::from(high[i]) << 32).to_le_bytes());
    }
}

/// Writes a tile of colour and light separately.
struct Parts<'a>(&'a Patch);

impl Kernel for Parts<'_> {
    type Output = Box<Tile>;

    #[inline(always)]
    fn run(self) -> Box<Tile> {
        let mut out = Vec::with_capacity(tiles::NODES);
        for nodes in self.0.nodes() {
            let ([r, g, b], direct, sky, rough) = (&nodes.root, &nodes.direct, &nodes.sky, &nodes.rough);
            let (mut low, mut high) = ([0; LANES], [0; LANES]);
            for i in 0..LANES {
                low[i] = word([r[i], g[i], b[i], direct[i] * (1.0 / MOST_DIRECT)]);
                high[i] = word([sky[i] * (1.0 / MOST_SKY), rough[i], 0.0, 0.0]);
            }
            push(&mut out, &low, &high);
        }
        tiles::boxed(out)
    }
}

/// Writes a tile of lit colours.
struct Writing<'a> {
    patch: &'a Patch,
    /// `None` on the coarsest level.
    next: Option<&'a CoarseColors>,
    light: &'a ReliefLight,
}

impl Kernel for Writing<'_> {
    type Output = Box<Tile>;

    #[inline(always)]
    fn run(self) -> Box<Tile> {
        let mut out = Vec::with_capacity(tiles::NODES);
        let next = self.next.map(CoarseColors::finer);
        for (n, nodes) in self.patch.nodes().iter().enumerate() {
            let here = nodes.lit_roots(self.light);
            let low = Self::words(&here, &nodes.rough);
            let high = match &next {
                Some(next) => next.get(n).map_or([0; LANES], |roots| Self::words(&roots, &[0.0; LANES])),
                None => low,
            };
            push(&mut out, &low, &high);
        }
        tiles::boxed(out)
    }
}

impl Writing<'_> {
    #[inline(always)]
    fn words([r, g, b]: &[Lanes; 3], rough: &Lanes) -> [u32; LANES] {
        let mut out = [0; LANES];
        for i in 0..LANES {
            let [r, g, b] = [r[i] * (1.0 / BRIGHTEST), g[i] * (1.0 / BRIGHTEST), b[i] * (1.0 / BRIGHTEST)];
            out[i] = word([r, g, b, rough[i]]);
        }
        out
    }
}

impl Lit {
    /// Converts a weighted sum of nodes, 256 times the stored values.
    fn of(sum: [u16; 8]) -> Self {
        const ONE: f32 = 256.0 * 255.0;
        let [r, g, b, direct, sky, rough, ..] = sum.map(f32::from);
        let root = [r / ONE, g / ONE, b / ONE];
        Self { root, direct: direct * (MOST_DIRECT / ONE), sky: sky * (MOST_SKY / ONE), rough: rough / ONE }
    }

    /// Linear colour of the ground without light.
    pub(crate) fn albedo(&self) -> Rgb {
        let root = Vec3A::from_array(self.root);
        root * root
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::shade::ground::patch::GroundShape;
    use crate::shade::ground::planes::Planes;
    use crate::shade::ground::surface::{MipPyramid, Surface};
    use crate::shade::ground::tiles::CELL;
    use belvedere_composite::tint::GroundTint;
    use belvedere_core::DVec2;
    use belvedere_scene::{Heightfield, Light, NodeState, Palette, PaletteName, Relief};
    use std::sync::Arc;

    fn hills(cols: usize, rows: usize) -> Heightfield {
        let h = |i: usize| {
            let (x, y) = ((i % cols) as f32 * 0.07, (i / cols) as f32 * 0.05);
            900.0 + 400.0 * (x.sin() * y.cos() + 0.3 * (3.0 * x + y).sin())
        };
        let heights = (0..cols * rows).map(h).collect();
        Heightfield::new(DVec2::ZERO, DVec2::splat(30.0), cols, rows, heights, vec![NodeState::Measured; cols * rows])
            .unwrap()
    }

    fn with_inputs(
        hf: &Heightfield,
        palette: &Palette,
        relief: Relief,
        test: impl Fn(&LitGround, &LightingInputs<'_>),
    ) {
        let surface = Surface::of_map(hf);
        let means = MipPyramid::new(&surface);
        let tint = GroundTint::new(palette, hf.z_range());
        let light = ReliefLight::new(relief, &Light::default());
        let inputs = LightingInputs {
            surface: &surface,
            means: &means,
            map: None,
            shadows: None,
            tint: &tint,
            light: &light,
            exaggeration: 1.0,
        };
        test(&LitGround::new(hf.cols(), hf.rows(), means.top()), &inputs);
    }

    /// Linear colour from its square roots.
    fn linear(roots: [f32; 3]) -> Rgb {
        Rgb::from_array(roots.map(|v| v * v))
    }

    #[test]
    fn interpolated_light_is_that_of_the_interpolated_ground() {
        let hf = hills(150, 131);
        with_inputs(&hf, &PaletteName::Alpine.into(), Relief::Swiss, |ground, m| {
            let mut row = Planes::new(150);
            let (mut worst, mut sum, mut n) = (0.0f32, 0.0, 0.0);
            for r in 1..129 {
                m.surface.row(r, 0, &mut row);
                for c in 1..148 {
                    for share in [0i32, 64, 200] {
                        let at = [c * CELL + share, r as i32 * CELL];
                        let parts = ground.sample(at, 0, m);
                        let shape = row.get(c as usize).lerp(row.get(c as usize + 1), share as f32 / 256.0);
                        let near = m.means.at(1, c as f32 + share as f32 / 256.0, r as f32);
                        let steep = shape.truncate().truncate().length();
                        let normal = Vec3A::new(-shape.x, -shape.y, 1.0).normalize();
                        let light = m.light.at(normal, m.means.openness().at(shape.z, near.z, near.w), 1.0);
                        let want = Rgb::from_array(m.tint.color(f64::from(shape.z), DVec2::new(f64::from(steep), 0.0)))
                            * light;
                        let apart = parts.albedo() * (m.light.warm * parts.direct + m.light.cool * parts.sky);
                        let steps = |c: Rgb| c.max(Rgb::ZERO).to_array().map(|v| 255.0 * v.sqrt());
                        for has in [apart, linear(ground.color(at, 0, m).0)] {
                            for (a, b) in steps(want).into_iter().zip(steps(has)) {
                                (worst, sum, n) = (worst.max((a - b).abs()), sum + (a - b).abs(), n + 1.0);
                            }
                        }
                    }
                }
            }
            assert!(worst < 8.0 && sum / n < 0.5, "{worst} steps at most, {} on average", sum / n);
        });
    }

    #[test]
    fn tints_are_those_of_the_map_wherever_the_ground_went() {
        let hf = hills(150, 131);
        // A bowl of 900 m, which would carry summits into the green of the valleys.
        let bowl = |i: usize| 900.0 * (-0.001 * ((i % 150) as f32 - 70.0).powi(2)).exp();
        let sunken = hf.heights().iter().enumerate().map(|(i, h)| h - bowl(i)).collect();
        let (map, moved) = (Surface::of_map(&hf), Surface::lifted(&hf, Arc::new(sunken)));
        let (map_means, moved_means) = (MipPyramid::new(&map), MipPyramid::new(&moved));
        let tint = GroundTint::new(&PaletteName::Alpine.into(), hf.z_range());
        let light = ReliefLight::new(Relief::Swiss, &Light::default());
        let inputs = |surface, means, map| LightingInputs {
            surface,
            means,
            map,
            shadows: None,
            tint: &tint,
            light: &light,
            exaggeration: 1.0,
        };
        let undisplaced = GroundShape { surface: &map, means: &map_means };
        let (there, here) = (inputs(&moved, &moved_means, Some(undisplaced)), inputs(&map, &map_means, None));
        let ground = |means: &MipPyramid| LitGround::new(150, 131, means.top());
        let (moved_ground, map_ground) = (ground(&moved_means), ground(&map_means));
        let mut other_light = 0;
        for i in 0..8000i32 {
            let at = [i * 7919 % (149 * CELL), i * 104_729 % (130 * CELL)];
            let lod = (i * 37 % 1800) as u32;
            let (a, b) = (moved_ground.sample(at, lod, &there), map_ground.sample(at, lod, &here));
            assert_eq!(a.root, b.root, "{at:?}, level {lod} / 256");
            other_light += u32::from((a.direct - b.direct).abs() > 0.05);
        }
        assert!(other_light > 1000, "{other_light} places in another light");
    }

    #[test]
    fn weights_are_whole_and_sum_up_everywhere() {
        let hf = hills(70, 70);
        with_inputs(&hf, &PaletteName::Plain.into(), Relief::None, |ground, m| {
            let (want, color) = (ground.sample([0, 0], 0, m), ground.color([0, 0], 0, m));
            for i in 0..20_000i32 {
                let at = [i * 7919 % (69 * CELL + 1), i * 104_729 % (69 * CELL + 1)];
                let lod = (i * 37 % 2300) as u32;
                assert_eq!(ground.sample(at, lod, m), want, "{at:?}");
                assert_eq!(ground.color(at, lod, m), color, "{at:?}");
            }
            for at in [[i32::MAX; 2], [-5 * CELL, 0], [0, 900 * CELL], [i32::MIN; 2]] {
                assert_eq!(ground.color(at, 0, m).0, [0.0; 3], "off the ground: {at:?}");
            }
        });
    }

    #[test]
    fn averages_match_the_mean_of_what_they_stand_for() {
        let hf = hills(257, 257);
        with_inputs(&hf, &PaletteName::Alpine.into(), Relief::Swiss, |ground, m| {
            // A point at the middle of a node of level 5, against the mean over its 32 x 32 nodes.
            let (c, r, side) = (96, 64, 32i32);
            let mut mean = [0.0f32; 8];
            let values = |lit: Lit, color: Rgb| {
                let [[r, g, b], color] = [lit.root, color.to_array().map(f32::sqrt)];
                [r, g, b, lit.direct, lit.sky, color[0], color[1], color[2]]
            };
            for i in 0..side * side {
                let at = [(c + i % side) * CELL, (r + i / side) * CELL];
                let now = values(ground.sample(at, 0, m), linear(ground.color(at, 0, m).0));
                mean.iter_mut().zip(now).for_each(|(s, v)| *s += v / (side * side) as f32);
            }
            let at = [c * CELL + (side - 1) * CELL / 2, r * CELL + (side - 1) * CELL / 2];
            let got = values(ground.sample(at, 5 << 8, m), linear(ground.color(at, 5 << 8, m).0));
            assert!(mean.iter().zip(got).all(|(a, b)| (a - b).abs() < 0.1), "{mean:?} {got:?}");
        });
    }

    #[test]
    fn levels_pass_into_each_other() {
        let hf = hills(150, 131);
        with_inputs(&hf, &PaletteName::Alpine.into(), Relief::Swiss, |ground, m| {
            let (mut worst, mut sum, mut n) = (0.0f32, 0.0, 0.0);
            for i in 0..20_000i32 {
                let at = [i * 7919 % (149 * CELL), i * 104_729 % (130 * CELL)];
                for k in 1..4 {
                    let steps = |lod: u32| linear(ground.color(at, lod, m).0).to_array().map(|v| 255.0 * v.sqrt());
                    for (a, b) in steps((k << 8) - 1).into_iter().zip(steps(k << 8)) {
                        (worst, sum, n) = (worst.max((a - b).abs()), sum + (a - b).abs(), n + 1.0);
                    }
                }
            }
            // What bends sharply at a node of the coarser level lies between nodes of the finer one.
            assert!(worst < 20.0 && sum / n < 1.6, "{worst} steps at most, {} on average", sum / n);
        });
    }
}
