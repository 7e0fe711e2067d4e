//! Pixel buffers of a frame that is being drawn.

use crate::color::Packed;
use belvedere_scene::{Frame, RenderJob};

/// Pixel buffers of a frame that is being drawn.
#[derive(Debug)]
pub struct Buffers {
    /// Whether lines, points or stylisation may be drawn over the surfaces.
    pub open: bool,
    /// Colours of the surfaces while they are open, else empty.
    pub color: Vec<Packed>,
    /// Depths of the pixel centres, scene units; infinite in the sky.
    pub depth: Vec<f32>,
    /// Layers, as in [`Frame::id`].
    pub id: Vec<u32>,
    /// World points, as in [`Frame::world`].
    pub world: Option<Vec<[f64; 3]>>,
    /// The stored colours.
    pub out: Vec<[u8; 3]>,
}

impl Buffers {
    /// Buffers of the size of the picture in the memory of older ones; all pixels must be written.
    pub fn reuse(job: &RenderJob<'_>, open: bool, color: Vec<Packed>, old: Frame) -> Self {
        let n = job.view.pinhole().image.map(|s| s as usize).iter().product();
        Self::of_pixels(job, (n, open), color, old)
    }

    /// [`Buffers::reuse`] of so many pixels.
    pub fn of_pixels(job: &RenderJob<'_>, (n, open): (usize, bool), mut color: Vec<Packed>, old: Frame) -> Self {
        let Frame { color: mut out, mut depth, mut id, .. } = old;
        if open {
            color.resize(n, Packed::default());
        }
        out.resize(n, [0; 3]);
        depth.resize(n, f32::INFINITY);
        id.resize(n, 0);
        let world = job.options.aux.world.then(|| vec![[f64::NAN; 3]; n]);
        Self { open, color, depth, id, world, out }
    }
}
