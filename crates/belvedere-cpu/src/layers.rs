//! Styling sections composed of whole layers: every representation drawn alone wherever it has a weight, and the pictures put together by
//! the weights. The published way, kept to compare with; thresholds ([`crate::sections`]) need no memory per representation.
//!
//! Source: Pasewaldt et al. 2011, section 4.4; dividing by the sum of the weights, where layers see different places, is ours.

use crate::sections::Sections;
use crate::shade::color::{Rgb, encode, linear};
use belvedere_core::DVec3;
use belvedere_scene::{Compositing, Frame, FrameStats, RenderError, RenderJob, RenderOptions};
use rayon::prelude::*;

/// Weights below this count for nothing.
const LEAST: f64 = 1e-9;

/// Draws a job by `draw`, representation by representation where that is asked for and there are several.
pub(crate) fn draw(
    job: &RenderJob<'_>,
    draw: impl Fn(&RenderJob<'_>) -> Result<Frame, RenderError>,
) -> Result<Frame, RenderError> {
    let options = job.options;
    let sections = Sections::new(job).filter(|_| options.compositing == Compositing::Layers);
    let Some(sections) = sections.filter(|s| s.representations() > 1 && options.representation.is_none()) else {
        return draw(job);
    };
    let alone = |number: usize| {
        let mut options = RenderOptions { representation: Some(number), exposures: 1, ..options.clone() };
        options.aux.world = true;
        draw(&RenderJob { options: &options, ..*job })
    };
    let layers = (0..sections.representations()).map(alone).collect::<Result<Vec<_>, _>>()?;
    Ok(composite(&layers, &sections, options.aux.world))
}

fn composite(layers: &[Frame], sections: &Sections<'_>, keep_world: bool) -> Frame {
    let place = |layer: &Frame, i: usize| layer.world.as_ref().map_or(DVec3::NAN, |w| DVec3::from_array(w[i]));
    let weight = |number: usize, i: usize| {
        let p = place(&layers[number], i);
        if p.is_finite() { sections.weight(number, sections.parameter(p)) } else { 0.0 }
    };
    let pixel = |i: usize| {
        let weights: Vec<f64> = (0..layers.len()).map(|number| weight(number, i)).collect();
        let sum: f64 = weights.iter().sum();
        // The greatest weight tells depth and identity, of equal ones the nearest.
        let first = |a: &usize, b: &usize| {
            weights[*a].total_cmp(&weights[*b]).then(layers[*b].depth[i].total_cmp(&layers[*a].depth[i]))
        };
        let most = (0..layers.len()).max_by(first).unwrap_or(0);
        if sum < LEAST {
            return (layers[most].color[i], most);
        }
        let mixed = weights.iter().zip(layers).map(|(w, layer)| (*w / sum) as f32 * linear(layer.color[i]));
        (encode(mixed.fold(Rgb::ZERO, |a, b| a + b)), most)
    };
    let first = &layers[0];
    let pixels: Vec<([u8; 3], usize)> = (0..first.color.len()).into_par_iter().map(pixel).collect();
    let of = |i: usize| &layers[pixels[i].1];
    let all = 0..pixels.len();
    let bytes = |layer: &Frame| (layer.color.len() * (3 + 4 + 4 + 24)) as u64;
    let stats = layers.iter().fold(FrameStats::default(), |sum, layer| FrameStats {
        layer_bytes: sum.layer_bytes + bytes(layer),
        ..sum.and(&layer.stats)
    });
    Frame {
        width: first.width,
        height: first.height,
        color: pixels.iter().map(|p| p.0).collect(),
        depth: all.clone().map(|i| of(i).depth[i]).collect(),
        id: all.clone().map(|i| of(i).id[i]).collect(),
        world: keep_world.then(|| all.map(|i| place(of(i), i).to_array()).collect()),
        stats,
    }
}
