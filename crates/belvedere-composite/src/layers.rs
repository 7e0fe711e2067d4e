//! Compositing of styling sections by whole layers: every representation is drawn alone, and the pictures are mixed by the weights. This is
//! the published method, and that for pictures with edges or without common surfaces; thresholds ([`belvedere_sight::sections`]) need no memory
//! per representation, but give depths of single samples.
//!
//! Source: Pasewaldt et al. 2011, section 4.4; dividing by the sum of the weights, where layers see different places, is ours.

use crate::buffers::Buffers;
use crate::color::{Packed, Rgb, encode, linear};
use crate::finish::draw_marks;
use crate::marks::Marks;
use crate::stylise;
use belvedere_core::DVec3;
use belvedere_core::sections::MOST_REPRESENTATIONS;
use belvedere_scene::{Compositing, Frame, FrameStats, Overlay, RenderError, RenderJob, RenderOptions};
use belvedere_sight::screen::Screen;
use belvedere_sight::sections::Sections;
use rayon::prelude::*;

/// Sums of weights below this count as 0.
const LEAST: f64 = 1e-9;

/// Whether the representations of a job are drawn one by one.
pub fn are_needed(job: &RenderJob<'_>) -> bool {
    Levels::of(job).is_some()
}

/// The representations of a job that are drawn one by one.
#[derive(Debug, Clone)]
pub struct Levels<'a> {
    sections: Sections<'a>,
    /// Whether marks are drawn with each representation, as published, not over the whole picture.
    pub published: bool,
}

impl<'a> Levels<'a> {
    /// `None` for a job that is drawn at once.
    pub fn of(job: &RenderJob<'a>) -> Option<Self> {
        let options = job.options;
        let published = options.compositing == Compositing::Layers;
        let by_layers = |s: &Sections<'_>| {
            let apart = options.compositing == Compositing::Single && !s.has_one_surface();
            s.representations() > 1 && (published || apart || stylise::is_on(job))
        };
        let sections = if options.representation.is_none() { Sections::new(job) } else { None };
        sections.filter(by_layers).map(|sections| Self { sections, published })
    }

    /// Number of representations.
    pub fn count(&self) -> usize {
        self.sections.representations()
    }

    /// Options that draw one representation alone.
    pub fn options(&self, options: &RenderOptions, number: usize) -> RenderOptions {
        let marks = options.marks && self.published;
        let mut options = RenderOptions { representation: Some(number), exposures: 1, marks, ..options.clone() };
        options.aux.world = true;
        if !marks {
            options.overlay = Overlay::default();
        }
        options
    }

    /// Mixes the pictures, or the same rows of the pictures, of all representations; without colours if they have none.
    pub fn composite(&self, levels: &[Frame], keep_world: bool) -> Frame {
        composite(levels, &self.sections, keep_world)
    }
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
    let Some(levels) = Levels::of(job) else {
        return draw(job);
    };
    let alone = |number: usize| {
        let options = levels.options(job.options, number);
        draw(&RenderJob { options: &options, ..*job })
    };
    let layers = (0..levels.count()).map(alone).collect::<Result<Vec<_>, _>>()?;
    let frame = levels.composite(&layers, job.options.aux.world);
    Ok(if levels.published { frame } else { with_marks(job, frame, marks) })
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
    frame.stats = marks.counted(frame.stats);
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
        if layers[most].color.is_empty() {
            return ([0; 3], most);
        }
        if sum < LEAST {
            return (layers[most].color[i], most);
        }
        let mixed = weights.iter().zip(layers).map(|(w, layer)| (*w / sum) as f32 * linear(layer.color[i]));
        (encode(mixed.fold(Rgb::ZERO, |a, b| a + b)), most)
    };
    let first = &layers[0];
    let pixels: Vec<([u8; 3], usize)> = (0..first.depth.len()).into_par_iter().map(pixel).collect();
    let of = |i: usize| &layers[pixels[i].1];
    let all = 0..pixels.len();
    let stats = sum_of_stats(layers.iter().map(|layer| (layer.color.len(), &layer.stats)));
    Frame {
        width: first.width,
        height: first.height,
        color: if first.color.is_empty() { Vec::new() } else { pixels.iter().map(|p| p.0).collect() },
        depth: all.clone().map(|i| of(i).depth[i]).collect(),
        id: all.clone().map(|i| of(i).id[i]).collect(),
        world: keep_world.then(|| all.map(|i| place(of(i), i).to_array()).collect()),
        stats,
    }
}

/// Counts of a picture that is mixed from others, given by their numbers of pixels and their counts.
pub fn sum_of_stats<'s>(layers: impl Iterator<Item = (usize, &'s FrameStats)>) -> FrameStats {
    layers.fold(FrameStats::default(), |sum, (pixels, stats)| FrameStats {
        layer_bytes: sum.layer_bytes + (pixels * (3 + 4 + 4 + 24)) as u64,
        ..sum.and(stats)
    })
}
