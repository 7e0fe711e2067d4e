//! Translucent ground over features that it still covers.

use belvedere_core::{DVec2, View};
use belvedere_disocclusion::report::Covered;
use belvedere_disocclusion::{DisocclusionError, ghost};
use belvedere_scene::{Frame, Scene};
use std::ops::Range;

/// Depth of cover at which the ground is half transparent, scene units.
const HALF_M: f64 = 20.0;
/// Radius of the translucent ground around a covered point, as a share of the picture's width.
const RADIUS: f64 = 0.02;

/// The scene with the ground lowered to the lines of sight of the covered points. `None` without terrain.
///
/// # Errors
/// [`DisocclusionError::Field`].
pub fn cut(scene: &Scene, view: &View, covered: &[Covered]) -> Result<Option<Scene>, DisocclusionError> {
    let mut out = scene.clone();
    let ground = out.layers.iter_mut().find_map(|l| l.kind.terrain_mut().map(|t| &mut t.heightfield));
    let Some(ground) = ground else { return Ok(None) };
    *ground = ghost::cut_open(ground, view, covered)?.into();
    Ok(Some(out))
}

/// Translucent ground of a picture.
pub struct Thin {
    /// Size of the picture, pixels.
    size: [usize; 2],
    radius: f64,
    /// Images of the covered points, and the opacity of the ground over each.
    points: Vec<(DVec2, f64)>,
}

impl Thin {
    /// * `size`: of the picture, pixels.
    pub fn new(scene: &Scene, view: &View, covered: &[Covered], size: [usize; 2]) -> Self {
        let image = |point: &Covered| {
            let xy = DVec2::from_array(point.at);
            let ground = scene.terrain().and_then(|t| t.surface_at(xy)).unwrap_or(0.0);
            let image = view.project(xy.extend(ground + point.lift_m)).ok()?;
            Some((image.pixel, ghost::opacity(point.over_m, HALF_M)))
        };
        let points = covered.iter().filter_map(image).collect();
        Self { size, radius: (RADIUS * size[0] as f64).max(2.0), points }
    }

    /// Blends `behind`, the picture of the lowered ground, into `frame` around covered points, more strongly where the cover is deeper.
    /// * `first`: number of the first row of both.
    pub fn draw(&self, frame: &mut Frame, behind: &Frame, first: usize) {
        if (behind.width, behind.height) != (frame.width, frame.height) {
            return;
        }
        let opacity = self.opacity(first..first + frame.height);
        for (i, solid) in opacity.into_iter().enumerate() {
            // Only ground that was lowered covers anything.
            if solid < 1.0 && behind.depth[i] > frame.depth[i] * 1.0001 {
                for (over, under) in frame.color[i].iter_mut().zip(behind.color[i]) {
                    *over = (solid * f32::from(*over) + (1.0 - solid) * f32::from(under)).round() as u8;
                }
            }
        }
    }

    /// Opacity of covering ground per pixel of some rows, 0..=1.
    fn opacity(&self, rows: Range<usize>) -> Vec<f32> {
        let (radius, [width, height]) = (self.radius, self.size);
        let mut out = vec![1.0f32; width * rows.len()];
        for (image, alpha) in &self.points {
            let (low, high) = (*image - radius, *image + radius);
            let range = |low: f64, high: f64, n: usize| low.max(0.0) as usize..(high.max(0.0) as usize).min(n);
            let within = range(low.y, high.y, height);
            for y in within.start.max(rows.start)..within.end.min(rows.end) {
                for x in range(low.x, high.x, width) {
                    let away = (DVec2::new(x as f64, y as f64) + 0.5).distance(*image) / radius;
                    let share = (2.0 - 2.0 * away).clamp(0.0, 1.0);
                    let slot = &mut out[(y - rows.start) * width + x];
                    *slot = slot.min((1.0 - share * (1.0 - alpha)) as f32);
                }
            }
        }
        out
    }
}
