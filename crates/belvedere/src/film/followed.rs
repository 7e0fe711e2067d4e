//! A camera that moves with a layer that moves.

use crate::scene_file::suggestion;
use belvedere_core::DVec3;
use belvedere_resolve::motion::Motions;

/// Motions quicker than this are not followed, seconds.
const QUICK_S: f64 = 0.4;

/// How far the camera has moved in each frame, scene units: as far as the middle of the layer, without its quick motions.
///
/// * `motions`: what moves; `None` where nothing does, or where the camera follows something else.
///
/// # Errors
/// In words, if the layer does not move or holds nothing.
pub(crate) fn steps(motions: Option<&Motions>, layer: &str, frames: usize, fps: f64) -> Result<Vec<DVec3>, String> {
    let motions = motions.ok_or("no layer of the scene moves, or the camera goes along a route; leave follow out")?;
    let moving = motions.moving();
    if !moving.contains(&layer) {
        return Err(format!("\"{layer}\" is no layer that moves; {}", suggestion(layer, &moving)));
    }
    let middles: Option<Vec<DVec3>> = (0..frames).map(|k| motions.middle(layer, k as f64 / fps)).collect();
    let middles = middles.ok_or_else(|| format!("\"{layer}\" holds nothing that can be followed"))?;
    let steady = smoothed(&middles, QUICK_S * fps);
    Ok(steady.iter().map(|middle| *middle - steady[0]).collect())
}

/// Places over time without quick motions: the mean under a bell of a standard deviation of `sigma` frames; the ends are held.
fn smoothed(places: &[DVec3], sigma: f64) -> Vec<DVec3> {
    let reach = (3.0 * sigma).ceil().min(places.len() as f64) as isize;
    let weight = |d: isize| (-0.5 * (d as f64 / sigma.max(1e-9)).powi(2)).exp();
    let at = |k: isize| places[k.clamp(0, places.len() as isize - 1) as usize];
    let all: f64 = (-reach..=reach).map(weight).sum();
    let mean = |k: isize| (-reach..=reach).map(|d| weight(d) * at(k + d)).sum::<DVec3>() / all;
    (0..places.len() as isize).map(mean).collect()
}
