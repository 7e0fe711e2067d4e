//! Compositing of styling sections by whole layers: every representation is drawn alone, and the pictures are mixed by the weights. This is
//! the published method, and that for pictures with edges or without common surfaces; thresholds ([`crate::sections`]) need no memory
//! per representation, but give depths of single samples.
//!
//! Source: Pasewaldt et al. 2011, section 4.4; dividing by the sum of the weights, where layers see different places, is ours.

use crate::buffers::Buffers;
use crate::color::{Packed, Rgb, encode, linear};
use crate::finish::draw_marks;
use crate::marks::Marks;
use crate::screen::Screen;
use crate::sections::Sections;
use crate::stylise;
use belvedere_core::DVec3;
use belvedere_core::sections::MOST_REPRESENTATIONS;
use belvedere_scene::{Compositing, Frame, FrameStats, Overlay, RenderError, RenderJob, RenderOptions};
use rayon::prelude::*;

/// Sums of weights below this count as 0.
const LEAST: f64 = 1e-9;

/// Whether the representations of a job are drawn one by one.
pub fn are_needed(job: &RenderJob<'_>) -> bool {
    sections_by_layers(job).is_some()
}

fn sections_by_layers<'a>(job: &RenderJob<'a>) -> Option<Sections<'a>> {
    let options = job.options;
    let published = options.compositing == Compositing::Layers;
    let by_layers = |s: &Sections<'_>| {
        let apart = options.compositing == Compositing::Single && !s.has_one_surface();
        s.representations() > 1 && (published || apart || stylise::is_on(job))
    };
    let sections = if options.representation.is_none() { Sections::new(job) } else { None };
    sections.filter(by_layers)
}

/// Draws a job by `draw`, representation by representation if that is asked for, if no two representations show the same surface, or if
/// edges are drawn: edges then end where a representation ends, not where samples of others begin.
///
/// Marks are drawn over the whole picture, except in the published method, which draws them with each representation.
/// * `marks`: places the marks of a job over the surfaces whose depths are given.
pub fn draw(
    job: &RenderJob<'_>,
    draw: impl Fn(&RenderJob<'_>) -> Result<Frame, RenderError>,
    marks: impl Fn(&RenderJob<'_>, &Screen, &[f32]) -> Marks,
) -> Result<Frame, RenderError> {
    let options = job.options;
    let published = options.compositing == Compositing::Layers;
    let Some(sections) = sections_by_layers(job) else {
        return draw(job);
    };
    let alone = |number: usize| {
        let marks = options.marks && published;
        let mut options = RenderOptions { representation: Some(number), exposures: 1, marks, ..options.clone() };
        options.aux.world = true;
        if !marks {
            options.overlay = Overlay::default();
        }
        draw(&RenderJob { options: &options, ..*job })
    };
    let layers = (0..sections.representations()).map(alone).collect::<Result<Vec<_>, _>>()?;
    let frame = composite(&layers, &sections, options.aux.world);
    Ok(if published { frame } else { with_marks(job, frame, marks) })
}

/// The picture with the lines, points and names of its job drawn over it.
fn with_marks(
    job: &RenderJob<'_>,
    mut frame: Frame,
    marks: impl Fn(&RenderJob<'_>, &Screen, &[f32]) -> Marks,
) -> Frame {
    if !Marks::are_in(job) {
        return frame;
    }
    let screen = Screen::new(job.view.pinhole());
    let marks = marks(job, &screen, &frame.depth);
    let color = frame.color.iter().map(|c| Packed::new(linear(*c))).collect();
    let (depth, id, out) = (frame.depth, frame.id, frame.color);
    let mut buffers = Buffers { open: true, color, depth, id, world: frame.world, out };
    draw_marks(&marks, None, &screen, &mut buffers);
    let Buffers { depth, id, world, out, .. } = buffers;
    (frame.depth, frame.id, frame.world, frame.color) = (depth, id, world, out);
    frame
}

fn composite(layers: &[Frame], sections: &Sections<'_>, keep_world: bool) -> Frame {
    let place = |layer: &Frame, i: usize| layer.world.as_ref().map_or(DVec3::NAN, |w| DVec3::from_array(w[i]));
    let weight = |number: usize, i: usize| {
        let p = place(&layers[number], i);
        if p.is_finite() { sections.weight(number, sections.parameter(p)) } else { 0.0 }
    };
    let pixel = |i: usize| {
        let mut weights = [0.0; MOST_REPRESENTATIONS];
        (0..layers.len()).for_each(|number| weights[number] = weight(number, i));
        let weights = &weights[..layers.len()];
        let sum: f64 = weights.iter().sum();
        // Depth and id are those of the greatest weight, of equal weights those of the nearest.
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
