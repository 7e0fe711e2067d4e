//! The veil of a traced picture: rays meet every see-through layer on its own.

use crate::screen::SUB;
use crate::see_through::SeeThrough;
use crate::shade::Shader;
use belvedere_composite::color::Rgb;
use belvedere_composite::veil::Veil;
use belvedere_core::DVec2;
use belvedere_scene::{RenderError, RenderJob};
use belvedere_sight::Solids;
use belvedere_sight::sections::{Exposure, Sections};
use belvedere_sight::trace::{RayHit, RowRays, Tracer, same_surface};
use rayon::prelude::*;
use std::cell::OnceCell;

/// See-through layers, ready for rays.
pub(crate) struct TracedVeil<'a> {
    job: &'a RenderJob<'a>,
    shader: &'a Shader<'a>,
    /// Samples of a pixel, the centre first.
    offsets: &'a [[i32; 2]],
    /// What hides.
    behind: &'a Tracer<'a>,
    layers: Vec<(SeeThrough, Tracer<'a>)>,
}

/// Light, share of what is behind that is seen, and depth of a pixel.
type Pixel = (Rgb, f32, f32);

/// Nothing in front.
const CLEAR: Pixel = (Rgb::ZERO, 1.0, f32::INFINITY);

impl<'a> TracedVeil<'a> {
    /// `None` where a scene has no see-through layer.
    pub(crate) fn new(
        job: &'a RenderJob<'a>,
        (shader, behind): (&'a Shader<'a>, &'a Tracer<'a>),
        offsets: &'a [[i32; 2]],
        exposure: &Exposure,
    ) -> Option<Self> {
        let tracer = |layer: SeeThrough| {
            let solids = Solids::Alone(layer.layer);
            (layer, Tracer::exposed((job.scene, solids), job.view, Sections::new(job), exposure.clone()))
        };
        let layers: Vec<_> = SeeThrough::of(job.scene).into_iter().map(tracer).collect();
        (!layers.is_empty()).then_some(Self { job, shader, offsets, behind, layers })
    }

    /// The veil over a picture.
    /// * `seen`: first hits on what hides at the pixel centres.
    pub(crate) fn trace(&self, seen: &[Option<RayHit>]) -> Result<Veil, RenderError> {
        let width = self.job.view.pinhole().image[0] as usize;
        let mut hits: Vec<Vec<Option<RayHit>>> = Vec::new();
        for (_, tracer) in &self.layers {
            let mut own = vec![None; seen.len()];
            own.par_chunks_mut(width).enumerate().try_for_each(|(y, row)| {
                RowRays::new(tracer, y as f64 + 0.5, 0).first_hits(row);
                self.job.progress.tick("trace", 1.0)
            })?;
            hits.push(own);
        }
        let rows = (0..seen.len() / width.max(1)).into_par_iter().map(|y| {
            self.job.progress.tick("draw", 1.0)?;
            Ok(self.row(seen, &hits, y))
        });
        let pixels = rows.collect::<Result<Vec<Vec<Pixel>>, RenderError>>()?.concat();
        let mut veil = Veil::clear(seen.len());
        for (i, (light, through, depth)) in pixels.into_iter().enumerate() {
            (veil.light[i], veil.through[i], veil.depth[i]) = (light, through, depth);
        }
        Ok(veil)
    }

    fn row(&self, seen: &[Option<RayHit>], hits: &[Vec<Option<RayHit>>], y: usize) -> Vec<Pixel> {
        let [width, height] = self.job.view.pinhole().image.map(|n| n as usize);
        let tracers: Vec<&Tracer<'_>> =
            std::iter::once(self.behind).chain(self.layers.iter().map(|(_, tracer)| tracer)).collect();
        // Rows of single samples, prepared where a pixel needs them: those of what hides first, then those of each layer.
        let rows: Vec<Vec<OnceCell<RowRays<'_, '_>>>> =
            tracers.iter().map(|_| self.offsets.iter().map(|_| OnceCell::new()).collect()).collect();
        let place = |s: usize, x: usize| {
            DVec2::new(x as f64, y as f64) + DVec2::from_array(self.offsets[s].map(f64::from)) / f64::from(SUB)
        };
        let hit = |k: usize, s: usize, x: usize| {
            let at = place(s, x);
            rows[k][s].get_or_init(|| RowRays::new(tracers[k], at.y, s)).first_hit(at.x)
        };
        let around = |x: usize| {
            (y.saturating_sub(1)..(y + 2).min(height))
                .flat_map(move |v| (x.saturating_sub(1)..(x + 2).min(width)).map(move |u| v * width + u))
        };
        let pixel = |x: usize| {
            let i = y * width + x;
            if !hits.iter().any(|own| around(x).any(|j| own[j].is_some())) {
                return CLEAR;
            }
            let is_even = |own: &[Option<RayHit>]| around(x).all(|j| same_surface(own[i], own[j]));
            let even = self.offsets.len() == 1 || (is_even(seen) && hits.iter().all(|own| is_even(own)));
            let centre: Vec<Option<RayHit>> = hits.iter().map(|own| own[i]).collect();
            let centre = self.sample(seen[i], &centre, place(0, x));
            if even {
                return (centre.light, centre.through, centre.depth);
            }
            let samples = 1..self.offsets.len();
            let found: Vec<Sample> = samples
                .map(|s| {
                    let own: Vec<Option<RayHit>> = (1..tracers.len()).map(|k| hit(k, s, x)).collect();
                    Sample { number: s, ..self.sample(hit(0, s, x), &own, place(s, x)) }
                })
                .collect();
            let n = found.len() as f32;
            let mean = found.iter().map(|s| s.through).sum::<f32>() / n;
            let light = found.iter().fold(Rgb::ZERO, |sum, s| {
                let own = if s.through == mean {
                    Rgb::ZERO
                } else {
                    let at = place(s.number, x);
                    (s.through - mean) * self.shader.shade_hit(self.job.view, s.behind.as_ref(), at).color
                };
                sum + (s.light + own) / n
            });
            (light, mean, centre.depth)
        };
        (0..width).map(pixel).collect()
    }

    /// The layers before a sample.
    fn sample(&self, behind: Option<RayHit>, hits: &[Option<RayHit>], at: DVec2) -> Sample {
        let end = behind.map_or(f64::INFINITY, |hit| hit.depth);
        let mut front: Vec<(SeeThrough, RayHit)> =
            self.layers.iter().zip(hits).filter_map(|((layer, _), hit)| Some((*layer, (*hit)?))).collect();
        front.retain(|(_, hit)| hit.depth < end);
        front.sort_by(|a, b| a.1.depth.total_cmp(&b.1.depth));
        let (mut light, mut through) = (Rgb::ZERO, 1.0);
        for (layer, hit) in &front {
            let shaded = self.shader.shade_hit(self.job.view, Some(hit), at);
            light += through * layer.opacity * shaded.color;
            through *= 1.0 - layer.opacity;
        }
        let nearest = front.first();
        Sample { number: 0, behind, light, through, depth: nearest.map_or(f32::INFINITY, |(_, hit)| hit.depth as f32) }
    }
}

/// A sample of a pixel.
struct Sample {
    number: usize,
    behind: Option<RayHit>,
    light: Rgb,
    through: f32,
    depth: f32,
}
