//! Translucent ground over features that it still covers.

use belvedere_core::{DVec2, View};
use belvedere_disocclusion::report::Covered;
use belvedere_disocclusion::{DisocclusionError, ghost};
use belvedere_scene::{Frame, LayerKind, Scene};

/// Depth of cover at which the ground is half transparent, scene units.
const HALF_M: f64 = 20.0;
/// Radius of the translucent ground around a covered point, as a share of the picture's width.
const RADIUS: f64 = 0.02;

/// The scene with the ground lowered to the lines of sight of the covered points. `None` without terrain.
///
/// # Errors
/// [`DisocclusionError::Field`].
pub(crate) fn cut(scene: &Scene, view: &View, covered: &[Covered]) -> Result<Option<Scene>, DisocclusionError> {
    let mut out = scene.clone();
    let ground = out.layers.iter_mut().find_map(|l| match &mut l.kind {
        LayerKind::Terrain(t) => Some(&mut t.heightfield),
        _ => None,
    });
    let Some(ground) = ground else { return Ok(None) };
    *ground = ghost::cut_open(ground, view, covered)?.into();
    Ok(Some(out))
}

/// Blends `behind`, the picture of the lowered ground, into `frame` around covered points, more strongly where the cover is deeper.
pub(crate) fn draw(frame: &mut Frame, behind: &Frame, scene: &Scene, view: &View, covered: &[Covered]) {
    let (width, height) = (frame.width, frame.height);
    if (behind.width, behind.height) != (width, height) {
        return;
    }
    let opacity = opacity(scene, view, covered, [width, height]);
    for (i, solid) in opacity.into_iter().enumerate() {
        // Only ground that was lowered covers anything.
        if solid < 1.0 && behind.depth[i] > frame.depth[i] * 1.0001 {
            for (over, under) in frame.color[i].iter_mut().zip(behind.color[i]) {
                *over = (solid * f32::from(*over) + (1.0 - solid) * f32::from(under)).round() as u8;
            }
        }
    }
}

/// Opacity of covering ground per pixel, 0..=1.
fn opacity(scene: &Scene, view: &View, covered: &[Covered], [width, height]: [usize; 2]) -> Vec<f32> {
    let mut out = vec![1.0f32; width * height];
    let radius = (RADIUS * width as f64).max(2.0);
    for point in covered {
        let xy = DVec2::from_array(point.at);
        let ground = scene.terrain().and_then(|t| t.surface_at(xy)).unwrap_or(0.0);
        let Ok(image) = view.project(xy.extend(ground + point.lift_m)) else { continue };
        let alpha = ghost::opacity(point.over_m, HALF_M);
        let (low, high) = (image.pixel - radius, image.pixel + radius);
        let range = |low: f64, high: f64, n: usize| low.max(0.0) as usize..(high.max(0.0) as usize).min(n);
        for y in range(low.y, high.y, height) {
            for x in range(low.x, high.x, width) {
                let away = (DVec2::new(x as f64, y as f64) + 0.5).distance(image.pixel) / radius;
                let share = (2.0 - 2.0 * away).clamp(0.0, 1.0);
                let slot = &mut out[y * width + x];
                *slot = slot.min((1.0 - share * (1.0 - alpha)) as f32);
            }
        }
    }
    out
}
