//! Crowns of trees: clumps of them from afar, single ones from near by, lit and coloured by the same form.

use super::GroundNodes;
use super::fractal::{ramp, turned};
use crate::noise;

/// Clumps of trees: sizes, metres, lightness and rise.
const CLUMPS: [(f32, f32, f32); 3] = [(150.0, 0.62, 0.12), (75.0, 0.44, 0.22), (37.0, 0.31, 0.30)];
/// Groups of crowns and crowns: sizes, metres, and rise.
const CROWNS: [(f32, f32); 2] = [(21.0, 0.30), (9.5, 0.44)];
/// Heights of domes, see [`noise::Domes`], between which the gaps of a wood become crowns.
const GAP: [f32; 2] = [0.48, 0.92];
/// Lightness of gaps and of crowns over that of the wood from afar.
const TONES: [f32; 2] = [0.74, 1.10];
/// The same heights where a tree stands alone.
const ALONE: [f32; 2] = [0.62, 0.74];

/// Nodes over a crown from which on single trees begin to be drawn.
const SINGLE: f32 = 2.4;

/// Crowns at nodes.
pub(super) struct Canopy<const N: usize> {
    /// Lightness as a factor.
    pub(super) tone: [f32; N],
    /// Lightness of clumps alone, about -0.5..=0.5.
    pub(super) clump: [f32; N],
    /// Rise to the east and to the north.
    pub(super) rise: [[f32; N]; 2],
    /// Height of the crown, 0..=1, and a value of its own, -1..=1.
    height: [f32; N],
    pub(super) own: [f32; N],
    /// Share in which single trees are drawn.
    single: f32,
}

impl<const N: usize> Canopy<N> {
    #[inline(always)]
    pub(super) fn new(nodes: &GroundNodes<'_, N>) -> Self {
        let none = [0.0; N];
        let mut out = Self { tone: [1.0; N], clump: none, rise: [none; 2], height: none, own: none, single: 0.0 };
        for (k, (size, light, rise)) in CLUMPS.into_iter().enumerate() {
            let shown = shown(size, nodes.spacing_m);
            if shown == 0.0 {
                return out;
            }
            let [x, y] = turned(nodes, size, 0);
            let (value, slope) = noise::value([&x, &y], 401 + k as u32);
            out.rise(&slope, shown * rise);
            for ((clump, tone), value) in out.clump.iter_mut().zip(&mut out.tone).zip(&value) {
                *clump += shown * light * value;
                *tone = 1.0 + *clump;
            }
        }
        for (k, (size, rise)) in CROWNS.into_iter().enumerate() {
            let shown = shown(size, nodes.spacing_m);
            if shown == 0.0 {
                break;
            }
            let [x, y] = turned(nodes, size, 0);
            let domes = noise::domes([&x, &y], 431 + k as u32);
            out.rise(&domes.slope, shown * rise);
            for i in 0..N {
                let tone = TONES[0] + (TONES[1] - TONES[0]) * ramp(domes.height[i], GAP[0], GAP[1]);
                out.tone[i] *= 1.0 + shown * (tone - 1.0);
            }
            (out.height, out.own) = (domes.height, domes.own);
        }
        // Trees of few nodes would be specks.
        out.single = (CROWNS[1].0 / (SINGLE * nodes.spacing_m) - 1.0).clamp(0.0, 1.0);
        out
    }

    #[inline(always)]
    fn rise(&mut self, [east, south]: &[[f32; N]; 2], by: f32) {
        for i in 0..N {
            self.rise[0][i] += by * east[i];
            self.rise[1][i] -= by * south[i];
        }
    }

    /// The share of a node that trees cover, where a wood has this share: from near by, each tree stands or it does not.
    #[inline(always)]
    pub(super) fn covered(&self, i: usize, share: f32) -> f32 {
        let stands = ramp(share - 0.04 - 0.46 * (1.0 + self.own[i]), -0.03, 0.03);
        let alone = ramp(self.height[i], ALONE[0], ALONE[1]);
        let closed = ramp(share, 0.7, 0.95);
        share + self.single * (stands * (alone + closed * (1.0 - alone)) - share)
    }
}

/// Share in which a size is drawn: all from three nodes on, none below one and a half.
#[inline(always)]
fn shown(size_m: f32, spacing_m: f32) -> f32 {
    (size_m / (1.5 * spacing_m) - 1.0).clamp(0.0, 1.0)
}
