//! What volumes absorb along the ray of a pixel, in 64 bits: the reference that fast methods are tested against, and the judge of what a
//! pixel shows. Light and colours belong to renderers.
//!
//! The ray is cut into short chords by halving depths, and each chord is clipped to the box. Steps of equal length are laid along their
//! joint length, one sample within each, weighted by the chord of its step. Nothing is tabulated or skipped.
//! Source: Cui et al. 2010, section on volumes; equal steps and opacity by length are ours or common.

mod chords;
mod tracer;

use belvedere_core::{DVec2, DVec3, View};
use belvedere_scene::volume::absorbed;
use belvedere_scene::{Volume, VolumeLayer};
use chords::{Chord, Chords};
pub use tracer::VolumeTracer;

/// Absorbed share of light at which a ray ends.
pub const ENOUGH: f32 = 0.99;
/// Absorbed share of light at which a pixel shows the volume rather than the surface behind.
pub const HALF: f32 = 0.5;

/// What a volume absorbs along a ray.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Absorbed {
    /// Absorbed share of light, 0..=1.
    pub alpha: f32,
    /// Depth at which the ray enters, scene units.
    pub enters: f64,
    /// Depth and world point where half of the light is absorbed.
    pub half: Option<(f64, DVec3)>,
    /// Samples taken.
    pub samples: u32,
}

/// A sample that absorbs light.
#[derive(Debug, Clone, Copy)]
pub struct Sample {
    /// Lattice coordinates.
    pub q: DVec3,
    /// Value of the volume there.
    pub value: f64,
    /// Chord of its step, scene units.
    pub chord: DVec3,
    /// Share of the light from the far end that its step absorbs, behind the steps before: its weight in the picture.
    pub weight: f32,
}

/// What a volume absorbs of the ray of `pixel` between two depths.
///
/// * `each`: called for every sample that absorbs light, front to back.
pub fn absorb(
    view: &View,
    layer: &VolumeLayer,
    pixel: DVec2,
    [near, far]: [f64; 2],
    mut each: impl FnMut(&Sample),
) -> Absorbed {
    let mut out = Absorbed::default();
    if !(near < far) {
        return out;
    }
    let chords = Chords::of(view, layer, pixel, [near, far]);
    let Some(first) = chords.first() else { return out };
    out.enters = first.depth[0];
    for run in chords.chunk_by(|a, b| a.depth[1] == b.depth[0]) {
        march(layer, (run, place_in_step(pixel)), &mut each, &mut out);
    }
    out
}

fn march(layer: &VolumeLayer, (run, within): (&[Chord], f64), each: &mut impl FnMut(&Sample), out: &mut Absorbed) {
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
        let alpha = sample(layer, at(begin + within * (end - begin)).0, chord, (each, out));
        if out.half.is_none() && out.alpha >= HALF {
            let (q, depth) = at(begin + half_within(before, alpha) * (end - begin));
            out.half = Some((depth, scene(q)));
        }
        begin = end;
    }
}

/// Takes the sample of a step behind what is absorbed so far; returns the share that the step absorbs.
fn sample(layer: &VolumeLayer, q: DVec3, chord: DVec3, (each, out): (&mut impl FnMut(&Sample), &mut Absorbed)) -> f32 {
    let Some(value) = value_near(&layer.volume, q) else { return 0.0 };
    let alpha = absorbed(layer.transfer.opacity(value), chord.length() / layer.reference_length()) as f32;
    if alpha <= 0.0 {
        return 0.0;
    }
    let weight = alpha * (1.0 - out.alpha);
    each(&Sample { q, value, chord, weight });
    out.alpha += weight;
    alpha
}

/// Value at lattice coordinates, or at the nearest inside the volume where rounding has left them just outside.
pub fn value_near(volume: &Volume, q: DVec3) -> Option<f64> {
    volume.at(q.clamp(DVec3::ZERO, DVec3::from_array(volume.dims().map(|n| (n - 1) as f64))))
}

/// Place of the samples of a pixel's ray within their steps, 0..=1: scattered from pixel to pixel, since samples in the middles of all steps
/// draw contours of their own on surfaces that are steeper than a step. Source: Jimenez 2014, interleaved gradient noise.
#[inline]
pub fn place_in_step(pixel: DVec2) -> f64 {
    let at = pixel.floor();
    let noise = (52.982_918_9 * (0.067_110_56 * at.x + 0.005_837_15 * at.y).fract()).fract();
    // The three rays of a pixel at an edge share the step among them.
    let thirds = (3.0 * (pixel - at)).floor();
    (noise + 0.5 + (thirds.x + thirds.y - 2.0) / 3.0).rem_euclid(1.0)
}

/// Share of a step, 0..=1, after which half of the light is left; light decays exponentially along the step.
///
/// * `before`: light left where the step begins, above a half. `alpha`: what the step absorbs, 0..=1.
#[inline]
pub fn half_within(before: f32, alpha: f32) -> f64 {
    (f64::from(HALF / before).ln() / (-f64::from(alpha)).ln_1p()).clamp(0.0, 1.0)
}
