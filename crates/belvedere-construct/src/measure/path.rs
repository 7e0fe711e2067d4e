//! Length of a path that a picture shows.

use super::image::{self, Sight};
use super::{MeasureOptions, sight_options};
use crate::sample::{Amount, Sample, SampledFeature};
use crate::samples::default_spacing;
use belvedere_core::{DVec3, View};
use belvedere_scene::Scene;

/// Samples of a path at most.
const MOST_SAMPLES: f64 = 20_000.0;
/// Samples per usual spacing, as where shares are judged.
const DENSER: f64 = 4.0;

/// Length of the path that the picture of `view` shows, by lines of sight over the drawn ground as [`super::measure()`] follows them:
/// from `ahead[0]` to `ahead[1]`, and of all of it; scene units.
///
/// * `at`: position at a length along the path; on terrain its plan position counts, set on the ground; `length`: of the path;
/// * `lift`: height over the ground at which it must be seen, scene units.
pub fn length_seen(
    scene: &Scene,
    view: &View,
    (at, length): (&dyn Fn(f64) -> DVec3, f64),
    ahead: [f64; 2],
    lift: f64,
) -> [f64; 2] {
    let count = (DENSER * length / default_spacing(scene).max(1e-9)).ceil().clamp(1.0, MOST_SAMPLES);
    let part = length / count;
    let middle = |k: usize| part * (k as f64 + 0.5);
    let sample = |k: usize| {
        let p = at(middle(k));
        let on_ground =
            scene.terrain().and_then(|hf| hf.surface_at(p.truncate())).map_or(p, |z| p.truncate().extend(z));
        Sample { p_world: on_ground + lift * DVec3::Z, lift, amount: part, surface: None, triangle: None }
    };
    let path = SampledFeature {
        layer: 0,
        feature: 0,
        layer_id: String::new(),
        name: String::new(),
        amount: Amount::Length,
        samples: (0..count as usize).map(sample).collect(),
    };
    let options = sight_options(scene, &MeasureOptions::default());
    let images = image::all(&Sight::new(scene, view), view, &[path], &options);
    // What is hidden is subtracted, so that a path of which all is seen has its very length.
    let mut seen = [ahead[1].min(length) - ahead[0].max(0.0), length];
    for k in images.iter().flatten().enumerate().filter(|(_, image)| !image.visible()).map(|(k, _)| k) {
        // A part across an end counts as far as it reaches.
        let [from, to] = [middle(k) - 0.5 * part, middle(k) + 0.5 * part];
        seen[0] -= (to.min(ahead[1]) - from.max(ahead[0])).max(0.0);
        seen[1] -= part;
    }
    seen.map(|length| length.max(0.0))
}
