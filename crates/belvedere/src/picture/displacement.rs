//! Displacement of the points in a picture.

use belvedere_core::{DVec2, DVec3, View};
use belvedere_overlay::badge;
use belvedere_scene::{Frame, PictureRows, PixelGrid, RenderError, Unit};
use belvedere_sight::RigidLayers;
use rayon::prelude::*;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Displacement of the points in a picture against the same camera without bends, at some thousand of the pixels that show a surface, or
/// at all of them where they are fewer. Ground outside the picture may have moved farther.
#[derive(Debug, Clone, Copy, Default, PartialEq, JsonSchema, Serialize, Deserialize)]
pub struct DisplacementReport {
    /// Largest displacement, scene units; refined pixel by pixel around the largest samples.
    pub max_m: f64,
    /// Root mean square displacement, scene units.
    pub rms_m: f64,
    /// Largest distance between the bent and the straight image of a point, pixels, of points that lie in both pictures: beside the eye
    /// images lie arbitrarily far, and behind it there are none.
    pub max_px: f64,
    /// Root mean square of that distance, pixels.
    pub rms_px: f64,
    /// Share of samples where the picture folds over, 0..=1.
    pub folded_share: f64,
    /// Pixels sampled.
    pub samples: usize,
}

impl DisplacementReport {
    /// The largest displacement in words, rounded up.
    ///
    /// * `unit`: unit of the scene.
    pub fn most(&self, unit: Unit) -> String {
        badge::moved(self.max_m, unit)
    }
}

/// Number of samples around which every pixel is measured.
const LARGEST: usize = 24;
/// Samples, at least, where as many pixels show a surface.
const SAMPLES: usize = 8000;

/// Displacement of the point at a pixel.
struct Moved {
    pixel: [usize; 2],
    by_m: f64,
    by_px: Option<f64>,
    folded: bool,
}

/// Distance from a pixel to the straight image of its point, pixels; `None` if that lies outside the picture.
fn distance_px(straight: &View, point: DVec3, pixel: DVec2) -> Option<f64> {
    let image = straight.project(point).ok()?;
    let pinhole = straight.pinhole();
    let in_range = image.depth >= pinhole.near && pinhole.far.is_none_or(|far| image.depth <= far);
    (in_range && pinhole.contains(image.pixel)).then(|| image.pixel.distance(pixel))
}

/// Pixels of a picture, drawn or still to be drawn.
pub(super) trait Pixels {
    /// Width and height, pixels.
    fn size(&self) -> [usize; 2];
    /// Depths of a grid of pixels; with `points` their layers and world points as well.
    fn look(&self, grid: &PixelGrid, points: bool) -> Result<Frame, RenderError>;
}

impl Pixels for Frame {
    fn size(&self) -> [usize; 2] {
        [self.width, self.height]
    }

    fn look(&self, grid: &PixelGrid, points: bool) -> Result<Frame, RenderError> {
        let [width, height] = grid.count;
        let all = || {
            (0..width * height).map(|i| {
                let [col, row] = grid.pixel(i);
                row * self.width + col
            })
        };
        let world = self.world.as_ref().filter(|_| points);
        Ok(Self {
            width,
            height,
            depth: all().map(|i| self.depth[i]).collect(),
            id: all().filter(|_| points).map(|i| self.id[i]).collect(),
            world: world.map(|world| all().map(|i| world[i]).collect()),
            ..Self::default()
        })
    }
}

impl Pixels for &dyn PictureRows {
    fn size(&self) -> [usize; 2] {
        PictureRows::size(*self)
    }

    fn look(&self, grid: &PixelGrid, points: bool) -> Result<Frame, RenderError> {
        PictureRows::look(*self, grid, points)
    }
}

/// Pixels among which those that show a surface are counted, about, in pictures that have more.
const COUNTED: usize = 1 << 20;

/// Distance between neighbouring samples, pixels: 1 where few pixels show a surface, as thin or distant things do.
fn step(pixels: &impl Pixels) -> Result<usize, RenderError> {
    let size = pixels.size();
    let every = ((size[0] * size[1]) as f64 / COUNTED as f64).sqrt().floor().max(1.0) as usize;
    let counted = pixels.look(&PixelGrid::over(size, every / 2, every), false)?;
    let shown = counted.depth.iter().filter(|depth| depth.is_finite()).count() * every * every;
    Ok(((shown as f64 / SAMPLES as f64).sqrt().floor() as usize).max(1))
}

/// Displacement at the pixel with number `i` of those that were looked at.
fn at_pixel(
    (view, straight): (&View, &View),
    rigid: &RigidLayers,
    (seen, grid): (&Frame, &PixelGrid),
    i: usize,
) -> Option<Moved> {
    let [col, row] = grid.pixel(i);
    let depth = f64::from(seen.depth[i]);
    let pixel = DVec2::new(col as f64 + 0.5, row as f64 + 0.5);
    if let Some(id) = seen.id.get(i).filter(|id| rigid.shown(**id)) {
        // Rays of other points do not apply to a carried body; the picture's own world point does.
        let point = DVec3::from_array(*seen.world.as_ref()?.get(i)?);
        let bent = rigid.displaced_at(view, (*id, pixel, seen.depth[i]), point)?;
        let plain = straight.displace(point).ok()?.point;
        let by_px = distance_px(straight, point, pixel);
        return Some(Moved { pixel: [col, row], by_m: bent.distance(plain), by_px, folded: false });
    }
    let seen = view.ray(pixel).at(if depth.is_finite() { depth } else { -1.0 }).ok()?;
    let (bent, plain) = (view.displace(seen.point).ok()?, straight.displace(seen.point).ok()?);
    let by_px = distance_px(straight, seen.point, pixel);
    Some(Moved { pixel: [col, row], by_m: bent.point.distance(plain.point), by_px, folded: bent.folded })
}

/// Samples the displacement of points in the picture, in space and on the image.
/// * `pixels`: need world points if they show rigid layers.
///
/// # Errors
/// [`RenderError::Cancelled`], of pixels that are still to be drawn.
pub(super) fn measure(
    view: &View,
    rigid: &RigidLayers,
    pixels: &impl Pixels,
) -> Result<DisplacementReport, RenderError> {
    let straight = view.straightened();
    let (step, size, points) = (step(pixels)?, pixels.size(), rigid.any());
    let moved = |grid: &PixelGrid| {
        let seen = pixels.look(grid, points)?;
        let all = (0..seen.depth.len()).into_par_iter();
        let all = all.filter_map(|i| at_pixel((view, &straight), rigid, (&seen, grid), i));
        Ok::<_, RenderError>(all.collect::<Vec<Moved>>())
    };
    let mut all = moved(&PixelGrid::over(size, step / 2, step))?;
    let mean = |sum: f64, count: usize| if count == 0 { 0.0 } else { sum / count as f64 };
    let on_image: Vec<f64> = all.iter().filter_map(|m| m.by_px).collect();
    let largest = |values: &mut dyn Iterator<Item = f64>| values.fold(0.0, f64::max);
    let mut report = DisplacementReport {
        max_m: largest(&mut all.iter().map(|m| m.by_m)),
        rms_m: mean(all.iter().map(|m| m.by_m * m.by_m).sum(), all.len()).sqrt(),
        max_px: largest(&mut on_image.iter().copied()),
        rms_px: mean(on_image.iter().map(|px| px * px).sum(), on_image.len()).sqrt(),
        folded_share: mean(all.iter().filter(|m| m.folded).count() as f64, all.len()),
        samples: all.len(),
    };
    all.sort_by(|a, b| b.by_m.total_cmp(&a.by_m));
    for at in all.iter().take(LARGEST).map(|m| m.pixel) {
        let first = at.map(|at| at.saturating_sub(step));
        let count = [0, 1].map(|k| (at[k] + step + 1).min(size[k]) - first[k]);
        let near = moved(&PixelGrid { first, step: 1, count })?;
        report.max_m = largest(&mut near.iter().map(|m| m.by_m).chain([report.max_m]));
    }
    Ok(report)
}

#[cfg(test)]
mod tests;
