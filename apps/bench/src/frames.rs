//! Frames and projections, drawn in turn.

use crate::BenchRequest;
use crate::clock::{Stopwatch, median};
use crate::scene::{NamedView, chain, ground, views};
use anyhow::Result;
use belvedere::core::View;
use belvedere::cpu::{CpuRenderer, GroundImage};
use belvedere::scene::{Frame, Light, Progress, RenderJob, RenderOptions, Renderer, Scene};
use schemars::JsonSchema;
use serde::Serialize;

/// A frame.
#[derive(Debug, Clone, JsonSchema, Serialize)]
pub struct FrameCost {
    /// Bend: `straight`, `curved rays`, `spline`.
    pub view: &'static str,
    /// Coverage samples per pixel.
    pub samples: u32,
    /// Worst error of less detail, pixels; 0 draws every triangle.
    pub lod_px: f64,
    /// Triangles drawn.
    pub triangles: u64,
    /// Median processor time, milliseconds.
    pub cpu_ms: f64,
    /// Median wall time, milliseconds.
    pub wall_ms: f64,
    /// Median ratio of processor time to the straight frame of one sample and every triangle that was drawn in the same round.
    pub ratio: f64,
}

/// Projection alone.
#[derive(Debug, Clone, JsonSchema, Serialize)]
pub struct ProjectionCost {
    /// Bend.
    pub view: &'static str,
    /// Points projected.
    pub points: usize,
    /// Median of millions of points per second of processor time: what one undisturbed core does.
    pub mpts_per_core_s: f64,
}

/// How processor time grows, `time ~ size^exponent`, least squares in logarithms.
#[derive(Debug, Clone, JsonSchema, Serialize)]
pub struct Growth {
    /// The quantity that grows.
    pub of: &'static str,
    /// Sizes.
    pub sizes: Vec<f64>,
    /// Median processor times, milliseconds.
    pub cpu_ms: Vec<f64>,
    /// The exponent.
    pub exponent: f64,
}

/// A view of a scene at some quality.
pub(crate) struct Case<'a> {
    pub(crate) name: &'static str,
    pub(crate) scene: &'a Scene,
    pub(crate) view: &'a View,
    pub(crate) samples: u32,
    pub(crate) lod_px: f64,
}

/// Draws every case once per round, after a round that warms up.
pub(crate) fn measure(cases: &[Case<'_>], rounds: usize, progress: &Progress) -> Result<Vec<FrameCost>> {
    let (renderer, light) = (CpuRenderer::default(), Light::default());
    let mut times: Vec<[Vec<f64>; 2]> = vec![Default::default(); cases.len()];
    let mut triangles = vec![0; cases.len()];
    let mut frame = Frame::default();
    for round in 0..=rounds {
        for k in 0..cases.len() {
            let k = if round % 2 == 0 { k } else { cases.len() - 1 - k };
            let Case { scene, view, samples, lod_px, .. } = cases[k];
            let options = RenderOptions { samples, lod_px, ..RenderOptions::default() };
            let watch = Stopwatch::start();
            let job = RenderJob { scene, view, light: &light, options: &options, progress };
            renderer.render_into(&job, &mut frame)?;
            let wall = watch.wall_ms();
            let cpu = watch.cpu_ms().unwrap_or(wall);
            triangles[k] = frame.stats.triangles_drawn;
            if round > 0 {
                times[k].iter_mut().zip([cpu, wall]).for_each(|(t, v)| t.push(v));
            }
        }
    }
    let cost = |(k, case): (usize, &Case<'_>)| FrameCost {
        view: case.name,
        samples: case.samples,
        lod_px: case.lod_px,
        triangles: triangles[k],
        cpu_ms: median(times[k][0].clone()),
        wall_ms: median(times[k][1].clone()),
        ratio: median(times[k][0].iter().zip(&times[0][0]).map(|(a, b)| a / b).collect()),
    };
    Ok(cases.iter().enumerate().map(cost).collect())
}

pub(crate) fn grow_triangles(request: &BenchRequest, view: &View, lod_px: f64, progress: &Progress) -> Result<Growth> {
    let cells = request.nodes - 1;
    let sizes: Vec<usize> = [cells / 4, cells / 2, cells, 2 * cells].map(|n| n + 1).into_iter().collect();
    let scenes = sizes.iter().map(|&n| ground(n)).collect::<Result<Vec<_>, _>>()?;
    let case = |scene| Case { name: "curved rays", scene, view, samples: 1, lod_px };
    let costs = measure(&scenes.iter().map(case).collect::<Vec<_>>(), request.rounds.min(5), progress)?;
    let of = if lod_px > 0.0 { "triangles of the ground, level of detail" } else { "triangles of the ground" };
    Ok(Growth::new(of, sizes.iter().map(|n| (2 * (n - 1) * (n - 1)) as f64).collect(), ms(&costs)))
}

pub(crate) fn grow_pixels(request: &BenchRequest, scene: &Scene, progress: &Progress) -> Result<Growth> {
    let [w, h] = request.image;
    let sizes = [[w / 2, h / 2], [w, h], [2 * w, 2 * h], [4 * w, 4 * h]];
    let views = sizes.into_iter().map(views).collect::<Result<Vec<_>, _>>()?;
    let curved = views.iter().map(|[_, (name, view), _]| Case { name, scene, view, samples: 1, lod_px: 0.5 });
    let cases: Vec<Case<'_>> = curved.collect();
    let costs = measure(&cases, request.rounds.min(5), progress)?;
    Ok(Growth::new("pixels", sizes.map(|[w, h]| f64::from(w) * f64::from(h)).to_vec(), ms(&costs)))
}

/// Numbers of turns of the measured chains.
const TURNS: [usize; 5] = [1, 7, 100, 127, 300];

pub(crate) fn grow_turns(request: &BenchRequest, scene: &Scene, lod_px: f64, progress: &Progress) -> Result<Growth> {
    let views = TURNS.iter().map(|&n| chain(request.image, n)).collect::<Result<Vec<_>>>()?;
    let case = |view| Case { name: "curved rays", scene, view, samples: 1, lod_px };
    let costs = measure(&views.iter().map(case).collect::<Vec<_>>(), request.rounds.min(5), progress)?;
    let of = if lod_px > 0.0 { "turns, level of detail" } else { "turns" };
    Ok(Growth::new(of, TURNS.map(|n| n as f64).to_vec(), ms(&costs)))
}

/// Processor times of frames, milliseconds.
fn ms(costs: &[FrameCost]) -> Vec<f64> {
    costs.iter().map(|cost| cost.cpu_ms).collect()
}

impl Growth {
    pub(crate) fn new(of: &'static str, sizes: Vec<f64>, cpu_ms: Vec<f64>) -> Self {
        let n = sizes.len() as f64;
        let (x, y): (Vec<f64>, Vec<f64>) = sizes.iter().zip(&cpu_ms).map(|(s, t)| (s.ln(), t.ln())).unzip();
        let (mx, my) = (x.iter().sum::<f64>() / n, y.iter().sum::<f64>() / n);
        let (mut both, mut square) = (0.0, 0.0);
        for (x, y) in x.iter().zip(&y) {
            both += (x - mx) * (y - my);
            square += (x - mx) * (x - mx);
        }
        Self { of, sizes, cpu_ms, exponent: both / square }
    }
}

/// About 4.3 million points through the views that have a fast form.
pub(crate) fn project(views: &[NamedView; 3], rounds: usize) -> Result<Vec<ProjectionCost>> {
    let scene = ground(2073)?;
    let Some(hf) = scene.terrain() else { return Ok(Vec::new()) };
    let (points, mut image) = (hf.heights().len(), GroundImage::default());
    let mut rates: [Vec<f64>; 2] = Default::default();
    for round in 0..=rounds {
        for (rates, (_, view)) in rates.iter_mut().zip(views) {
            let watch = Stopwatch::start();
            let whole = image.project(hf, view, 0);
            let cpu = watch.cpu_ms().unwrap_or_else(|| watch.wall_ms() * rayon::current_num_threads() as f64);
            if round > 0 && whole {
                rates.push(points as f64 / cpu * 1e-3);
            }
        }
    }
    let of =
        |(rates, (view, _)): (Vec<f64>, &NamedView)| ProjectionCost { view, points, mpts_per_core_s: median(rates) };
    Ok(rates.into_iter().zip(views).map(of).collect())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_exponent_of_a_power_law_is_found() {
        let sizes = vec![10.0, 40.0, 160.0];
        let growth = Growth::new("n", sizes.clone(), sizes.iter().map(|n: &f64| 3.0 * n.powf(0.7)).collect());
        assert!((growth.exponent - 0.7).abs() < 1e-12);
    }
}
