//! What the values of a volume are, for transfer functions that it suggests.

use super::{Volume, VoxelValues};

/// Bins of a histogram.
pub(super) const BINS: usize = 256;
/// About the largest number of voxels that are counted.
const COUNTED: usize = 1 << 21;
/// The same where neighbours are looked at.
const COUNTED_APART: usize = 1 << 19;
/// Distance from denser matter, voxels, up to which lower values may be its blurred border.
const BORDER: usize = 2;

/// Counts of values by equal shares of their range.
pub(super) type Counts = [u64; BINS];

/// Counts of every n-th voxel.
pub(super) fn counts(volume: &Volume) -> Counts {
    let bin = binned(volume);
    let mut counts = [0; BINS];
    let stride = stride(volume, COUNTED);
    let mut count = |v: f32| counts[bin(v)] += 1;
    match volume.values() {
        VoxelValues::U8(v) => v.iter().step_by(stride).for_each(|v| count(f32::from(*v))),
        VoxelValues::U16(v) => v.iter().step_by(stride).for_each(|v| count(f32::from(*v))),
        VoxelValues::I16(v) => v.iter().step_by(stride).for_each(|v| count(f32::from(*v))),
        VoxelValues::F32(v) => v.iter().step_by(stride).for_each(|v| count(*v)),
    }
    counts
}

/// An odd stride does not stay on one column of voxels.
fn stride(volume: &Volume, most: usize) -> usize {
    (volume.values().len() / most).max(1) | 1
}

fn binned(volume: &Volume) -> impl Fn(f32) -> usize {
    let [lo, hi] = volume.range();
    let scale = if hi > lo { BINS as f32 / (hi - lo) } else { 0.0 };
    move |v| (((v - lo) * scale) as usize).min(BINS - 1)
}

/// First bin of the upper class. Source: Otsu 1979, "A threshold selection method from gray-level histograms".
pub(super) fn otsu(weights: &[f64]) -> usize {
    let total: f64 = weights.iter().sum();
    let all: f64 = weights.iter().enumerate().map(|(i, w)| i as f64 * w).sum();
    let (mut below, mut sum) = (0.0, 0.0);
    // Empty bins have equal variance: the middle of the best bins is taken.
    let (mut best, mut first, mut last) = (0.0, weights.len() / 2, weights.len() / 2);
    for (i, weight) in weights.iter().enumerate().take(weights.len().saturating_sub(1)) {
        below += weight;
        sum += i as f64 * weight;
        let above = total - below;
        if below <= 0.0 || above <= 1e-12 * total {
            continue;
        }
        let apart = sum / below - (all - sum) / above;
        let between = below * above * apart * apart;
        if between > best * (1.0 + 1e-12) {
            (best, first, last) = (between, i + 1, i + 1);
        } else if between >= best * (1.0 - 1e-12) {
            last = i + 1;
        }
    }
    (first + last) / 2
}

/// Matter of low values that is no border of denser matter, such as leaves beside stems.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Thin {
    /// First bin of it.
    pub(super) from: usize,
    /// Its share of all voxels, 0..=1.
    pub(super) share: f64,
}

/// Least share of all voxels, and of those of such values, that counts as matter: fewer are borders and specks.
const LEAST_SHARE: f64 = 2e-4;
const LEAST_APART: f64 = 0.35;
/// Deviations of the background's values, above which they are no noise.
const DEVIATIONS: f64 = 4.5;

/// Matter of values between the background and `dense`, the first bin of dense matter; `None` if there is none to speak of.
pub(super) fn thin(volume: &Volume, counts: &Counts, dense: usize) -> Option<Thin> {
    let counts = smooth(volume, &counts[..dense]);
    // Rare values would not count beside the background: their logarithms do.
    let weights: Vec<f64> = counts.iter().map(|n| n.ln_1p()).collect();
    let from = otsu(&weights).max(end_of_noise(&counts));
    if from >= dense {
        return None;
    }
    let bin = binned(volume);
    let [nx, ny, nz] = volume.dims();
    let values = volume.values();
    let at = |p: [usize; 3]| bin(values.at((p[2] * ny + p[1]) * nx + p[0]));
    let stride = stride(volume, COUNTED_APART);
    let (mut found, mut low, mut all) = (0u64, 0u64, 0u64);
    for i in (0..values.len()).step_by(stride) {
        all += 1;
        if !(from..dense).contains(&bin(values.at(i))) {
            continue;
        }
        low += 1;
        let p = [i % nx, i / nx % ny, i / nx / ny];
        let beside = |axis: usize, by: usize| {
            let most = [nx, ny, nz][axis] - 1;
            let moved = |to: usize| {
                let mut q = p;
                q[axis] = to;
                at(q)
            };
            [moved(p[axis].saturating_sub(by)), moved((p[axis] + by).min(most))]
        };
        let near: Vec<usize> = (0..3).flat_map(|axis| beside(axis, 1)).collect();
        // Noise stands alone.
        let coherent = near.iter().filter(|b| **b >= from).count() >= 3;
        let border = near.iter().any(|b| *b >= dense) || (0..3).any(|a| beside(a, BORDER).iter().any(|b| *b >= dense));
        found += u64::from(coherent && !border);
    }
    let share = found as f64 / all.max(1) as f64;
    let apart = found as f64 >= LEAST_APART * low as f64;
    (share >= LEAST_SHARE && apart).then_some(Thin { from, share })
}

/// Counts without the gaps between whole numbers that are fewer than bins.
fn smooth(volume: &Volume, counts: &[u64]) -> Vec<f64> {
    let [lo, hi] = volume.range();
    let whole = !matches!(volume.values(), VoxelValues::F32(_));
    let apart = BINS as f32 / (hi - lo).max(f32::MIN_POSITIVE);
    let reach = if whole && apart > 1.001 { (apart.ceil() as usize).min(BINS) } else { 0 };
    let mean = |i: usize| {
        let near = counts.iter().take(i + reach + 1).skip(i.saturating_sub(reach));
        near.map(|n| *n as f64).sum::<f64>() / (2 * reach + 1) as f64
    };
    (0..counts.len()).map(mean).collect()
}

/// First bin above the noise of the most frequent value.
fn end_of_noise(counts: &[f64]) -> usize {
    let Some(mode) = (0..counts.len()).max_by(|a, b| counts[*a].total_cmp(&counts[*b])) else { return 0 };
    // The middle of the top; below it there is no matter.
    let half = 0.5 * counts[mode];
    let first = (0..mode).rev().find(|i| counts[*i] <= half).map_or(0, |i| i + 1);
    let last = (mode..counts.len()).find(|i| counts[*i] <= half).map_or(counts.len(), |i| i) - 1;
    let middle = 0.5 * (first + last) as f64;
    let below = &counts[..=middle as usize];
    let squares: f64 = below.iter().enumerate().map(|(i, n)| n * (i as f64 - middle).powi(2)).sum();
    let deviation = (squares / below.iter().sum::<f64>().max(f64::MIN_POSITIVE)).sqrt().max(0.5);
    (middle + DEVIATIONS * deviation).ceil() as usize
}
