//! Parts of the required features that a view hides.

use super::image::{self, SampleImage, Sight};
use super::{MeasureOptions, samples, sight_options};
use crate::sample::{Amount, SampledFeature};
use belvedere_core::View;
use belvedere_scene::{Progress, Scene};
use serde::Serialize;

/// Why a part of a feature is not seen.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(tag = "reason", rename_all = "snake_case")]
pub enum HiddenReason {
    /// Something stands before it.
    Covered {
        /// Largest rise of it over the line of sight, scene units.
        over_m: f64,
    },
    /// The picture folds over there.
    Folded,
}

/// A part of a feature inside the image that is not seen: of a line a stretch, of areas and points all of it.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct HiddenRun {
    /// Index of the layer in the scene.
    pub layer: usize,
    /// Id of the layer.
    pub layer_id: String,
    /// Index of the feature in its layer.
    pub feature: usize,
    /// Name of the feature, possibly empty.
    pub name: String,
    /// Length along a line at the beginning, scene units; `None` for areas and points.
    pub from_m: Option<f64>,
    /// Length along a line at the end.
    pub to_m: Option<f64>,
    /// Scene x, y of the sample that is covered most; of the first where the picture folds.
    pub at: [f64; 2],
    /// Samples.
    pub points: usize,
    /// Length, area or count of what is hidden.
    pub amount: f64,
    /// Reason, with the largest rise of all samples of that reason.
    #[serde(flatten)]
    pub reason: HiddenReason,
}

/// The parts of required features inside the image that `view` hides, by lines of sight along its rays; in the order of the features.
///
/// # Errors
/// [`belvedere_scene::Cancelled`].
pub fn hidden(
    scene: &Scene,
    view: &View,
    options: &MeasureOptions,
    progress: &Progress,
) -> Result<Vec<HiddenRun>, belvedere_scene::Cancelled> {
    progress.tick("what stays hidden", 0.0)?;
    let features = samples(scene, options);
    let images = image::all(&Sight::new(scene, view), view, &features, &sight_options(scene, options));
    Ok(all(&features, &images))
}

/// The hidden parts of all features.
pub(super) fn all(features: &[SampledFeature], images: &[Vec<SampleImage>]) -> Vec<HiddenRun> {
    features.iter().zip(images).flat_map(|(feature, images)| runs(feature, images)).collect()
}

fn runs(feature: &SampledFeature, images: &[SampleImage]) -> Vec<HiddenRun> {
    let is_line = feature.amount == Amount::Length;
    let (mut out, mut along, mut open): (Vec<HiddenRun>, f64, bool) = (Vec::new(), 0.0, false);
    for (sample, image) in feature.samples.iter().zip(images) {
        let (from, to) = (along, along + sample.amount);
        along = to;
        if !image.in_frame || image.visible() {
            open = false;
            continue;
        }
        let over_m = -image.clearance.unwrap_or(0.0);
        let here = match image {
            _ if image.folded => HiddenReason::Folded,
            _ => HiddenReason::Covered { over_m },
        };
        match out.last_mut().filter(|_| open || !is_line) {
            Some(run) => {
                run.to_m = is_line.then_some(to);
                run.points += 1;
                run.amount += sample.amount;
                if worse(run.reason, here) {
                    (run.reason, run.at) = (here, sample.p_world.truncate().to_array());
                }
            }
            None => out.push(HiddenRun {
                layer: feature.layer,
                layer_id: feature.layer_id.clone(),
                feature: feature.feature,
                name: feature.name.clone(),
                from_m: is_line.then_some(from),
                to_m: is_line.then_some(to),
                at: sample.p_world.truncate().to_array(),
                points: 1,
                amount: sample.amount,
                reason: here,
            }),
        }
        open = true;
    }
    out
}

/// Whether `next` is a worse reason than `first`: the larger rise is worse.
fn worse(first: HiddenReason, next: HiddenReason) -> bool {
    use HiddenReason::Covered;
    matches!((first, next), (Covered { over_m: most }, Covered { over_m }) if over_m > most)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sample::Sample;
    use belvedere_core::DVec3;

    fn feature(amount: Amount, n: usize) -> SampledFeature {
        let sample = |i: usize| Sample {
            p_world: DVec3::new(i as f64, 0.0, 0.0),
            lift: 1.0,
            amount: 10.0,
            surface: None,
            triangle: None,
        };
        let samples = (0..n).map(sample).collect();
        SampledFeature { layer: 2, feature: 5, layer_id: "way".into(), name: "GR".into(), amount, samples }
    }

    fn image(clearance: Option<f64>) -> SampleImage {
        SampleImage { in_frame: clearance.is_some(), clearance, ..SampleImage::UNSEEN }
    }

    #[test]
    fn stretches_end_where_a_line_is_seen_or_leaves_the_image() {
        let images: Vec<_> =
            [Some(-3.0), Some(-7.0), Some(2.0), Some(-1.0), None, Some(-4.0), Some(0.0)].map(image).into();
        let found = runs(&feature(Amount::Length, 7), &images);
        let told: Vec<_> = found.iter().map(|r| (r.from_m, r.to_m, r.points, r.amount, r.reason)).collect();
        let covered = |over_m| HiddenReason::Covered { over_m };
        let run = |from, to, n, over_m| (Some(from), Some(to), n, 10.0 * n as f64, covered(over_m));
        assert_eq!(told, [run(0.0, 20.0, 2, 7.0), run(30.0, 40.0, 1, 1.0), run(50.0, 60.0, 1, 4.0)]);
        assert_eq!((found[2].at, found[2].layer, found[2].feature), ([5.0, 0.0], 2, 5));
        let area = runs(&feature(Amount::Area, 7), &images);
        assert_eq!((area.len(), area[0].points, area[0].amount, area[0].from_m), (1, 4, 40.0, None));
        assert_eq!(area[0].reason, covered(7.0));
    }
}
