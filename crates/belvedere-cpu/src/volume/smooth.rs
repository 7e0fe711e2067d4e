//! Smooth edges of volumes: where the picture changes from pixel to pixel, more rays of the pixel are followed.

use super::gather::{Drawing, Found};
use crate::raster::band::sample_offsets;
use crate::screen::SUB;
use belvedere_composite::buffers::Buffers;
use belvedere_composite::color::{Packed, Rgb};
use belvedere_core::DVec2;
use belvedere_scene::{RenderError, RenderJob};
use rayon::prelude::*;
use std::sync::atomic::{AtomicU64, Ordering};

/// Rays of a pixel at an edge.
const RAYS: u32 = 4;
/// Least difference of square roots of linear light between neighbours at an edge, of 65535.
const EDGE: u16 = 4600;

/// The surfaces behind all volumes.
pub(super) struct Behind {
    color: Vec<Packed>,
    /// Depths at which rays end.
    ends: Vec<f32>,
    far: f64,
}

impl Behind {
    /// What is drawn before the volumes; `None` for pictures of one sample per pixel, whose edges stay as they are.
    pub(super) fn of(job: &RenderJob<'_>, buffers: &Buffers, far: f64) -> Option<Self> {
        (job.options.samples >= RAYS).then(|| Self { color: buffers.color.clone(), ends: buffers.depth.clone(), far })
    }
}

/// Draws the pixels at edges of the volumes again, each the mean of [`RAYS`] places. Depths, ids and places stay those of the centres.
/// Returns the number of samples taken.
pub(super) fn edges(
    job: &RenderJob<'_>,
    drawing: &Drawing<'_>,
    behind: &Behind,
    color: &mut [Packed],
) -> Result<u64, RenderError> {
    let [width, height] = job.view.pinhole().image.map(|n| n as usize);
    let offsets: Vec<DVec2> =
        sample_offsets(RAYS)[1..].iter().map(|offset| DVec2::from(offset.map(f64::from)) / f64::from(SUB)).collect();
    let samples = AtomicU64::new(0);
    let drawn: Vec<Vec<(usize, Packed)>> = (0..height)
        .into_par_iter()
        .map(|y| {
            let row = y * width..(y + 1) * width;
            let is_edge: Vec<bool> = (0..width).map(|x| is_edge(color, &behind.color, [x, y], width)).collect();
            if !is_edge.contains(&true) {
                return Ok(Vec::new());
            }
            job.progress.tick("volumes", 1.0)?;
            let (back, ends) = (&behind.color[row.clone()], &behind.ends[row.clone()]);
            let mut sums = vec![Rgb::ZERO; width];
            for within in &offsets {
                let mut light: Vec<Rgb> = back.iter().map(|light| light.rgb()).collect();
                let (found, taken) =
                    drawing.row((y, *within), |x| is_edge[x].then(|| f64::from(ends[x]).min(behind.far)));
                samples.fetch_add(taken, Ordering::Relaxed);
                for Found { column, gathered, .. } in found {
                    light[column] = gathered.over(light[column]);
                }
                sums.iter_mut().zip(light).for_each(|(sum, light)| *sum += light / offsets.len() as f32);
            }
            let again = sums.into_iter().enumerate().filter(|(x, _)| is_edge[*x]);
            Ok(again.map(|(x, sum)| (row.start + x, Packed::new(sum))).collect())
        })
        .collect::<Result<_, RenderError>>()?;
    drawn.into_iter().flatten().for_each(|(i, light)| color[i] = light);
    Ok(samples.into_inner())
}

/// Whether a pixel differs from one of its four neighbours, and a volume covers one of the two.
fn is_edge(color: &[Packed], behind: &[Packed], [x, y]: [usize; 2], width: usize) -> bool {
    let at = y * width + x;
    let row = y * width..(y + 1) * width;
    let beside = [at.wrapping_sub(1), at + 1].into_iter().filter(|i| row.contains(i));
    let above_below = [at.wrapping_sub(width), at + width].into_iter().filter(|i| *i < color.len());
    let covered = |i: usize| color[i] != behind[i];
    beside.chain(above_below).any(|i| differ(color[at], color[i]) && (covered(at) || covered(i)))
}

fn differ(a: Packed, b: Packed) -> bool {
    a.roots().iter().zip(b.roots()).any(|(a, b)| a.abs_diff(b) > EDGE)
}
