//! Smooth edges of volumes: more rays are followed in the pixels at [`edges`](super::edges), side by side across the edge.

use super::edges::{Across, Cover, Edges};
use super::gather::{Drawing, Found, Row};
use belvedere_composite::buffers::Buffers;
use belvedere_composite::color::{Packed, Rgb};
use belvedere_core::DVec2;
use belvedere_scene::{RenderError, RenderJob};
use rayon::prelude::*;
use std::sync::atomic::{AtomicU64, Ordering};

/// Least number of samples per pixel of pictures whose edges are smooth.
const SAMPLES: u32 = 4;
/// Places of the rays of a pixel at an edge, beside the one through its centre, in pixels across the edge.
const PLACES: [f64; 2] = [-1.0 / 3.0, 1.0 / 3.0];
/// Rows that a thread draws at a time.
const ROWS: usize = 8;

/// What the rays through the pixel centres tell, which edges are found by, and the surfaces behind all volumes.
pub(super) struct Behind {
    color: Vec<Packed>,
    /// Depths at which rays end.
    ends: Vec<f32>,
    far: f64,
    pub(super) cover: Vec<Cover>,
}

impl Behind {
    /// What is drawn before the volumes; `None` for pictures of one sample per pixel, whose edges stay as they are.
    pub(super) fn of(job: &RenderJob<'_>, buffers: &Buffers, far: f64) -> Option<Self> {
        (job.options.samples >= SAMPLES).then(|| Self {
            color: buffers.color.clone(),
            ends: buffers.depth.clone(),
            far,
            cover: vec![Cover::default(); buffers.depth.len()],
        })
    }
}

/// Draws the pixels at edges of the volumes again, each the mean of its centre and [`PLACES`]. Depths, ids and places stay those of the
/// centres. Returns the number of samples taken.
pub(super) fn draw(
    job: &RenderJob<'_>,
    drawing: &Drawing<'_>,
    behind: &Behind,
    buffers: &mut Buffers,
) -> Result<u64, RenderError> {
    let [width, height] = job.view.pinhole().image.map(|n| n as usize);
    let Behind { cover, ends, .. } = behind;
    let edges = Edges { pinhole: job.view.pinhole(), cover, ends, depth: &buffers.depth, voxel: drawing.voxel() };
    let color = &buffers.color;
    let samples = AtomicU64::new(0);
    let drawn: Vec<Vec<(usize, Packed)>> = (0..height.div_ceil(ROWS))
        .into_par_iter()
        .map(|part| {
            job.progress.tick("volumes", 1.0)?;
            let first = part * ROWS;
            let pixels = first * width..((part + 1) * ROWS).min(height) * width;
            let across: Vec<Option<Across>> = pixels.clone().map(|i| edges.at([i % width, i / width])).collect();
            let rows = rows(first, across.chunks(width));
            let wants = |row: usize, x: usize| {
                let (direction, Row { y, .. }) = rows[row];
                let end = || f64::from(behind.ends[y * width + x]).min(behind.far);
                (across[(y - first) * width + x] == Some(direction)).then(end)
            };
            let places: Vec<Row> = rows.iter().map(|(_, row)| *row).collect();
            let (found, taken) = drawing.gather(&places, wants);
            samples.fetch_add(taken, Ordering::Relaxed);
            let edge: Vec<usize> = (0..across.len()).filter(|i| across[*i].is_some()).collect();
            let mut sums: Vec<Rgb> = pixels.clone().map(|i| color[i].rgb()).collect();
            for i in &edge {
                sums[*i] += PLACES.len() as f32 * behind.color[first * width + i].rgb();
            }
            for ray in found.chunk_by(|a, b| (a.row, a.column) == (b.row, b.column)) {
                let i = (rows[ray[0].row].1.y - first) * width + ray[0].column;
                let back = behind.color[pixels.start + i].rgb();
                sums[i] += ray.iter().fold(back, |light, Found { gathered, .. }| gathered.over(light)) - back;
            }
            let mean = |i: usize| Packed::new(sums[i] / (1 + PLACES.len()) as f32);
            Ok(edge.into_iter().map(|i| (pixels.start + i, mean(i))).collect())
        })
        .collect::<Result<_, RenderError>>()?;
    drawn.into_iter().flatten().for_each(|(i, light)| buffers.color[i] = light);
    Ok(samples.into_inner())
}

/// Rows of rays for pixels with edges across one direction, and this direction.
fn rows<'a>(first: usize, across: impl Iterator<Item = &'a [Option<Across>]>) -> Vec<(Across, Row)> {
    let mut out = Vec::new();
    for (y, across) in (first..).zip(across) {
        for direction in [Across::Columns, Across::Rows] {
            if across.contains(&Some(direction)) {
                let within = |place: f64| DVec2::splat(0.5) + place * direction.unit();
                out.extend(PLACES.map(|place| (direction, Row { y, within: within(place) })));
            }
        }
    }
    out
}
