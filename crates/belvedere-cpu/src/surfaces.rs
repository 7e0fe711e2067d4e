//! The surfaces of a picture, ready to be rasterised: any rows of it, in bands.

use crate::cache::lock;
use crate::geometry::blocks::Blocks;
use crate::geometry::drawn_solids::DrawnSolids;
use crate::raster::band::{BAND, Band, sample_offsets};
use crate::resolve::relief::resolve_relief;
use crate::resolve::{Colors, Rows, resolve};
use crate::screen::Screen;
use crate::see_through::{self, Composer, SeeThrough};
use crate::shade::Shader;
use crate::shade::pixel_center::PixelCenters;
use belvedere_composite::buffers::Buffers;
use belvedere_composite::color::Packed;
use belvedere_composite::stylise::Relief;
use belvedere_composite::veil::Veil;
use belvedere_scene::{FrameStats, Instant, RenderError, RenderJob};
use belvedere_sight::Solids;
use belvedere_sight::sections::{Exposure, Sections};
use rayon::prelude::*;
use std::ops::Range;
use std::sync::Mutex;
use std::sync::atomic::{AtomicUsize, Ordering};

/// Buffers of a frame, kept for the next one.
#[derive(Debug, Default)]
pub(crate) struct Scratch {
    pub(crate) blocks: Blocks,
    pub(crate) color: Vec<Packed>,
    pub(crate) bands: Mutex<Vec<Band>>,
}

/// Counts of a picture.
pub(crate) fn stats(blocks: &Blocks, samples: u64, start: Instant) -> FrameStats {
    let counts = blocks.counts();
    FrameStats {
        triangles_in: blocks.triangles_in,
        triangles_drawn: counts.drawn,
        edges_split: counts.split,
        vertices_missed: counts.missed,
        samples,
        layer_bytes: 0,
        symbols_left_out: 0,
        names_left_out: 0,
        milliseconds: start.elapsed().as_secs_f64() * 1e3,
    }
}

/// Inputs for rasterising the bands of a frame.
#[derive(Clone, Copy)]
pub(crate) struct Surfaces<'a> {
    pub(crate) job: &'a RenderJob<'a>,
    pub(crate) screen: &'a Screen,
    pub(crate) blocks: &'a Blocks,
    pub(crate) shader: &'a Shader<'a>,
    pub(crate) centers: Option<&'a PixelCenters<'a>>,
    pub(crate) sections: Option<&'a Sections<'a>>,
    /// Layers that need bands of their own.
    pub(crate) layers: &'a [SeeThrough],
    /// Bands for reuse.
    pub(crate) spare: &'a Mutex<Vec<Band>>,
}

/// A relief and its pixels that are drawn.
pub(crate) type ReliefPart<'r> = (&'r mut Relief, Range<usize>);

impl Surfaces<'_> {
    /// Draws the bands of some rows of the picture, or of all.
    /// * `first`: number of the first row, a multiple of [`BAND`]; `buffers`: of these rows.
    pub(crate) fn draw(
        &self,
        first: usize,
        buffers: &mut Buffers,
        (relief, veil): (Option<ReliefPart<'_>>, Option<&mut Veil>),
    ) -> Result<(), RenderError> {
        let Self { job, screen, shader, centers, layers, spare, .. } = *self;
        let chunk = BAND * screen.width as usize;
        let rows = buffers.depth.len() / screen.width.max(1) as usize;
        let bands = rows.div_ceil(BAND);
        let all = (screen.height as usize).div_ceil(BAND);
        let done = AtomicUsize::new(first / BAND);
        let offsets = sample_offsets(job.options.samples);
        let mut worlds: Vec<Option<&mut [[f64; 3]]>> = match &mut buffers.world {
            Some(w) => w.chunks_mut(chunk).map(Some).collect(),
            None => (0..bands).map(|_| None).collect(),
        };
        let mut relief = match relief {
            Some((relief, pixels)) => relief.bands_of(pixels, chunk),
            None => (0..bands).map(|_| None).collect(),
        };
        let mut veil = match veil {
            Some(veil) => veil.bands(chunk),
            None => (0..bands).map(|_| None).collect(),
        };
        let mut colors: Vec<Colors<'_>> = if buffers.open {
            buffers.color.chunks_mut(chunk).map(Colors::Open).collect()
        } else {
            buffers.out.chunks_mut(chunk).map(Colors::Stored).collect()
        };
        let depth = buffers.depth.par_chunks_mut(chunk);
        let id = buffers.id.par_chunks_mut(chunk);
        colors
            .par_iter_mut()
            .zip(depth)
            .zip(id)
            .zip(worlds.par_iter_mut())
            .zip(relief.par_iter_mut().zip(veil.par_iter_mut()))
            .enumerate()
            .try_for_each(|(i, ((((color, depth), id), world), (relief, veil)))| {
                let y0 = (first + i * BAND) as i32;
                let y = [y0, (y0 + BAND as i32).min(screen.height)];
                let (band, exposed) = self.filled(y, &offsets, None);
                if let Some(relief) = relief {
                    resolve_relief(&band, shader, relief);
                }
                resolve(&band, shader, screen, &mut Rows { color, depth, id, world: world.as_deref_mut(), centers });
                if let Some(veil) = veil {
                    let bands = self.see_through(&band, y, (&offsets, exposed));
                    let composer = Composer { layers, behind: &band, bands: &bands, shader, screen };
                    composer.compose(veil);
                    lock(spare).extend(bands);
                }
                lock(spare).push(band);
                let done = done.fetch_add(1, Ordering::Relaxed) + 1;
                Ok(job.progress.tick("draw", done as f64 / all as f64)?)
            })
    }

    fn cleared(&self, [y0, y1]: [i32; 2], offsets: &[[i32; 2]]) -> Band {
        let mut band = lock(self.spare).pop().unwrap_or_default();
        band.clear(y0, y1, self.screen.width, offsets);
        band
    }

    fn exposure(&self, offsets: &[[i32; 2]]) -> Exposure {
        Exposure::new(self.job.options.exposures as usize, offsets.len())
    }

    /// The samples of what hides in some rows, and whether they have several exposures.
    /// * `only`: columns that are wanted, if not all.
    pub(crate) fn filled(&self, y: [i32; 2], offsets: &[[i32; 2]], only: Option<[i32; 2]>) -> (Band, bool) {
        let opaque = DrawnSolids { scene: self.job.scene, solids: Solids::Opaque };
        let mut band = self.cleared(y, offsets);
        band.only = only;
        self.blocks.draw(&mut band, opaque);
        let Some(sections) = self.sections.filter(|_| self.blocks.are_thin_in(&band)) else { return (band, false) };
        let exposure = self.exposure(offsets);
        band.expose(exposure.offsets(offsets));
        self.blocks.draw_thin(&mut band, self.screen.ortho, (sections, &exposure), opaque);
        (band, true)
    }

    /// The samples of the layers that something shines through in the rows of a band.
    pub(crate) fn see_through(&self, behind: &Band, y: [i32; 2], (offsets, exposed): (&[[i32; 2]], bool)) -> Vec<Band> {
        let mut bands: Vec<Band> = self.layers.iter().map(|_| self.cleared(y, offsets)).collect();
        let exposure = self.exposure(offsets);
        let thin = self.sections.filter(|_| exposed).map(|sections| (sections, &exposure, &behind.offsets[..]));
        see_through::draw((self.job.scene, self.layers), self.blocks, &mut bands, (self.screen.ortho, thin));
        bands
    }
}
