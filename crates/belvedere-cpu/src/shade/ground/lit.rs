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
    /// Square roots of the lit colour of the level, and of the next level, each with a spare byte.
    colors: Tiles,
    /// Square roots of the colour without light, direct light, light from the sky.
    parts: Tiles,
}

impl LitGround {
    /// Pictures without tiles.
    /// * `top`, `finer`: see [`Tiles::new`].
    pub(crate) fn new(cols: usize, rows: usize, top: usize, finer: u32) -> Self {
        Self { colors: Tiles::new([cols, rows], top, finer), parts: Tiles::new([cols, rows], top, finer) }
    }

    /// Levels below that of the nodes of the ground.
    #[inline(always)]
    pub(crate) fn finer(&self) -> u32 {
        self.colors.finer()
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
        let (top, finer) = (self.colors.top() as u32, self.colors.finer());
        let (mut k, mut x, mut y, mut first) = ([0; LANES], [0; LANES], [0; LANES], [0; LANES]);
        for i in 0..LANES {
            k[i] = least(lods[i] >> 8, top);
            (x[i], y[i]) = (tiles::level_position(at[0][i], k[i], finer), tiles::level_position(at[1][i], k[i], finer));
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

    /// Square roots of the lit colour at a point.
    /// * `lod`: level, 256 steps to a level, 0 = the finest.
    pub(crate) fn color(&self, at: [i32; 2], lod: u32, inputs: &LightingInputs<'_>) -> [f32; 3] {
        let places = [0, 1].map(|axis| [at[axis]; LANES]);
        let colors = self.colors_of(&places, &[lod; LANES], 1, inputs);
        colors.between(0, (lod & 255) as f32 / 256.0)
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
        simd::run(Parts(&Patch::new(inputs, (k, self.finer()), columns.all(), rows.all())))
    }

    fn make_colors(&self, k: usize, tile: [usize; 2], inputs: &LightingInputs<'_>) -> Box<Tile> {
        let [columns, rows] = self.colors.repeated(k, tile);
        let patch = Patch::new(inputs, (k, self.finer()), columns.all(), rows.all());
        // The coarsest level stands for all coarser ones.
        let next = (k < self.colors.top()).then(|| CoarseColors::new(inputs, (k + 1, self.finer()), [columns, rows]));
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
            let ([r, g, b], direct, sky) = (&nodes.root, &nodes.direct, &nodes.sky);
            let (mut low, mut high) = ([0; LANES], [0; LANES]);
            for i in 0..LANES {
                low[i] = word([r[i], g[i], b[i], direct[i] * (1.0 / MOST_DIRECT)]);
                high[i] = word([sky[i] * (1.0 / MOST_SKY), 0.0, 0.0, 0.0]);
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
            let low = Self::words(&here);
            let high = match &next {
                Some(next) => next.get(n).map_or([0; LANES], |roots| Self::words(&roots)),
                None => low,
            };
            push(&mut out, &low, &high);
        }
        tiles::boxed(out)
    }
}

impl Writing<'_> {
    #[inline(always)]
    fn words([r, g, b]: &[Lanes; 3]) -> [u32; LANES] {
        let mut out = [0; LANES];
        for i in 0..LANES {
            let [r, g, b] = [r[i] * (1.0 / BRIGHTEST), g[i] * (1.0 / BRIGHTEST), b[i] * (1.0 / BRIGHTEST)];
            out[i] = word([r, g, b, 0.0]);
        }
        out
    }
}

impl Lit {
    /// Converts a weighted sum of nodes, 256 times the stored values.
    fn of(sum: [u16; 8]) -> Self {
        const ONE: f32 = 256.0 * 255.0;
        let [r, g, b, direct, sky, ..] = sum.map(f32::from);
        let root = [r / ONE, g / ONE, b / ONE];
        Self { root, direct: direct * (MOST_DIRECT / ONE), sky: sky * (MOST_SKY / ONE) }
    }

    /// Linear colour of the ground without light.
    pub(crate) fn albedo(&self) -> Rgb {
        let root = Vec3A::from_array(self.root);
        root * root
    }
}

#[cfg(test)]
mod tests;
