//! Pictures of rays that part: each branch is drawn on its own, and the pictures are joined along the seams.

use crate::color::{Rgb, encode, linear};
use belvedere_core::DVec2;
use belvedere_core::map::split_rays::Branch;
use belvedere_scene::{Frame, FrameStats, RenderError, RenderJob};
use rayon::prelude::*;

/// Pixels over which colours blend across a seam.
const SEAM_PX: f64 = 2.0;

/// Draws a job by `draw`, once per branch where rays part.
pub fn draw(
    job: &RenderJob<'_>,
    draw: impl Fn(&RenderJob<'_>) -> Result<Frame, RenderError>,
) -> Result<Frame, RenderError> {
    let Some(split) = job.view.split_rays() else { return draw(job) };
    let mut drawn = Vec::with_capacity(split.branches().len());
    for branch in split.branches() {
        let view = job.view.along(branch);
        drawn.push((branch, draw(&RenderJob { view: &view, ..*job })?));
    }
    Ok(joined(drawn, job.options.samples > 1))
}

/// * `smooth`: whether colours blend across seams.
fn joined(drawn: Vec<(&Branch, Frame)>, smooth: bool) -> Frame {
    let (width, height) = drawn.first().map_or((0, 0), |(_, frame)| (frame.width, frame.height));
    let position = |i: usize| DVec2::new((i % width) as f64 + 0.5, (i / width) as f64 + 0.5);
    let owner = |i: usize| drawn.iter().position(|(branch, _)| branch.region.contains(position(i))).unwrap_or(0);
    let owners: Vec<usize> = (0..width * height).into_par_iter().map(owner).collect();
    let color = |i: usize| {
        let own = drawn[owners[i]].1.color[i];
        let shares: Vec<(f32, [u8; 3])> = drawn
            .iter()
            .map(|(branch, frame)| (branch.region.coverage(position(i), SEAM_PX) as f32, frame.color[i]))
            .filter(|(share, _)| *share > 0.0)
            .collect();
        if !smooth || shares.len() < 2 {
            return own;
        }
        encode(shares.into_iter().map(|(share, color)| share * linear(color)).fold(Rgb::ZERO, |a, b| a + b))
    };
    let world = |i: usize| drawn[owners[i]].1.world.as_ref().map_or([f64::NAN; 3], |world| world[i]);
    let has_world = drawn.iter().all(|(_, frame)| frame.world.is_some());
    let pixels = 0..width * height;
    Frame {
        width,
        height,
        color: pixels.clone().into_par_iter().map(color).collect(),
        depth: pixels.clone().map(|i| drawn[owners[i]].1.depth[i]).collect(),
        id: pixels.clone().map(|i| drawn[owners[i]].1.id[i]).collect(),
        world: has_world.then(|| pixels.map(world).collect()),
        stats: drawn.iter().fold(FrameStats::default(), |sum, (_, frame)| sum.and(&frame.stats)),
    }
}
