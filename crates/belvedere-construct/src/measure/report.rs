//! Figures of a measure, ready to be written as JSON.

use super::bend::{BendMeasure, displacement};
use super::image::SampleImage;
use crate::sample::{Amount, SampledFeature};
use belvedere_core::Warning;
use serde::Serialize;

/// Everything [`super::measure`] found.
#[derive(Debug, Clone, Default, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Measures {
    /// One entry per feature of the layers that must be seen.
    pub features: Vec<FeatureMeasure>,
    /// All line features together (amounts are lengths); `None` without lines.
    pub lines: Option<FeatureMeasure>,
    /// All area features together (amounts are areas in plan); `None` without areas.
    pub areas: Option<FeatureMeasure>,
    /// All point features together (amounts are counts); `None` without points.
    pub points: Option<FeatureMeasure>,
    /// All surfaces in space together (amounts are areas of surface, of a closed one hardly more than half faces the eye); `None`
    /// without any.
    pub surfaces: Option<FeatureMeasure>,
    /// Largest difference between the two methods over lines, areas, points and surfaces, straight and bent, after leaving out
    /// near misses; `None` without a renderer.
    pub largest_difference: Option<f64>,
    /// Displacement, distortion and folds by the bend.
    pub bend: BendMeasure,
    /// Oddities, one sentence each.
    pub warnings: Vec<Warning>,
}

/// Visibility of one feature in two pictures.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct FeatureMeasure {
    /// Id of the layer.
    pub layer: String,
    /// Index of the feature in its layer; for sums the number of features.
    pub feature: usize,
    /// Name, possibly empty.
    pub name: String,
    /// Unit of the amounts.
    pub unit: Amount,
    /// Number of samples.
    pub samples: usize,
    /// Length, area or count of the whole feature.
    pub total: f64,
    /// Mean distance between the samples of a surface, scene units.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub surface_spacing: Option<f64>,
    /// Visibility in the picture without bends.
    pub straight: Visibility,
    /// Visibility in the picture as it is.
    pub bent: Visibility,
    /// Largest displacement by the bends of a sample in either picture, scene units.
    pub displacement_max: f64,
    /// Root mean square of these displacements, scene units.
    pub displacement_rms: f64,
    /// Largest distance between the two images of a sample that is in both, pixels.
    pub displacement_max_px: f64,
}

/// Visibility of one feature in one picture.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Visibility {
    /// Length, area or count inside the image.
    pub in_frame: f64,
    /// Share of the whole feature inside the image, 0..=1; `None` if it has no amount.
    pub in_frame_share: Option<f64>,
    /// Visible share of the whole feature by line of sight, 0..=1: what lies outside the image is not visible. `None` if it has no amount.
    pub visible_share: Option<f64>,
    /// Visible amount by line of sight along the ray.
    pub sight: MethodShare,
    /// Visible amount by the depth buffer; `None` without a renderer.
    pub buffer: Option<MethodShare>,
    /// Difference of the two shares over the samples that are not near misses.
    pub difference: Option<f64>,
    /// Share of those samples on which the methods disagree, either way.
    pub mismatched_share: Option<f64>,
    /// Share of the in-frame amount whose ground the renderer left out or drew too far away; `None` without a renderer.
    pub surface_missed_share: Option<f64>,
    /// Share of the in-frame amount whose sight line passes nearer to the edge of visibility than the near-miss distance; of surfaces
    /// the share that is seen edge-on.
    pub near_miss_share: f64,
    /// Clearances of the sight lines; `None` if nothing is in the frame.
    pub clearance: Option<Clearance>,
    /// Share of the in-frame amount that lies where the picture folds over.
    pub folded_share: f64,
}

/// Visible amount by one method.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct MethodShare {
    /// Visible length, area or count.
    pub visible: f64,
    /// Visible share of the in-frame amount, 0..=1; `None` if nothing is in the frame.
    pub share: Option<f64>,
    /// Visible share without near misses.
    pub share_without_near_misses: Option<f64>,
}

/// Heights of the sight lines over the ground, scene units; negative = under ground, that is hidden. Capped above.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Clearance {
    /// Smallest.
    pub min: f64,
    /// Median over samples.
    pub median: f64,
    /// Largest (at most the cap).
    pub max: f64,
}

/// What of the sources of features lies beyond the ground, by what amounts measure.
pub(super) type Beyond<'a> = &'a dyn Fn(Amount) -> f64;

pub(super) fn summarise(
    (features, beyond): (&[SampledFeature], Beyond<'_>),
    straight: &[Vec<SampleImage>],
    bent: &[Vec<SampleImage>],
    near_miss: f64,
    bend: BendMeasure,
    warnings: Vec<Warning>,
) -> Measures {
    let all: Vec<usize> = (0..features.len()).collect();
    let one = |members: &[usize], beyond| summarise_group((features, beyond), straight, bent, members, near_miss);
    let group = |unit: Amount, name: &str| {
        let members: Vec<usize> = all.iter().copied().filter(|&i| features[i].amount == unit).collect();
        let whole = || FeatureMeasure { name: name.to_owned(), feature: members.len(), ..one(&members, beyond(unit)) };
        (!members.is_empty()).then(whole)
    };
    let (lines, areas, points) =
        (group(Amount::Length, "all lines"), group(Amount::Area, "all areas"), group(Amount::Count, "all points"));
    let surfaces = group(Amount::Surface, "all surfaces");
    let largest_difference = [&lines, &areas, &points, &surfaces]
        .into_iter()
        .flatten()
        .flat_map(|f| [f.straight.difference, f.bent.difference])
        .flatten()
        .reduce(f64::max);
    let features = all.iter().map(|&i| one(&[i], 0.0)).collect();
    Measures { features, lines, areas, points, surfaces, largest_difference, bend, warnings }
}

fn summarise_group(
    (features, beyond): (&[SampledFeature], f64),
    straight: &[Vec<SampleImage>],
    bent: &[Vec<SampleImage>],
    members: &[usize],
    near_miss: f64,
) -> FeatureMeasure {
    let first = &features[members[0]];
    let samples = members.iter().flat_map(|&i| features[i].samples.iter());
    let rows = |images: &[Vec<SampleImage>]| -> Vec<(f64, SampleImage)> {
        let pairs = members.iter().flat_map(|&i| features[i].samples.iter().zip(&images[i]));
        pairs.map(|(s, j)| (s.amount, *j)).collect()
    };
    let (straight_rows, bent_rows) = (rows(straight), rows(bent));
    let displacement = displacement(&straight_rows, &bent_rows);
    let total = samples.map(|s| s.amount).sum::<f64>() + beyond;
    let is_surface = first.amount == Amount::Surface && !straight_rows.is_empty();
    FeatureMeasure {
        layer: first.layer_id.clone(),
        feature: first.feature,
        name: first.name.clone(),
        unit: first.amount,
        samples: straight_rows.len(),
        total,
        surface_spacing: is_surface.then(|| (total / straight_rows.len() as f64).sqrt()),
        straight: visibility(&straight_rows, total, near_miss),
        bent: visibility(&bent_rows, total, near_miss),
        displacement_max: displacement.max,
        displacement_rms: displacement.rms,
        displacement_max_px: displacement.max_px,
    }
}

fn ratio(part: f64, whole: f64) -> Option<f64> {
    (whole > 0.0).then(|| part / whole)
}

fn visibility(rows: &[(f64, SampleImage)], total: f64, near_miss: f64) -> Visibility {
    let framed: Vec<&(f64, SampleImage)> = rows.iter().filter(|(_, j)| j.in_frame).collect();
    // From 0.0, for the sum of nothing is -0.0.
    let sum =
        |keep: &dyn Fn(&SampleImage) -> bool| framed.iter().filter(|(_, j)| keep(j)).fold(0.0, |sum, (a, _)| sum + a);
    let sharp = |j: &SampleImage| match j.edge_on {
        Some(edge_on) => !edge_on,
        None => j.clearance.is_some_and(|c| c.abs() >= near_miss),
    };
    let in_frame = sum(&|_| true);
    let clear_cut = sum(&sharp);
    let method = |seen: &dyn Fn(&SampleImage) -> bool| MethodShare {
        visible: sum(seen),
        share: ratio(sum(seen), in_frame),
        share_without_near_misses: ratio(sum(&|j| sharp(j) && seen(j)), clear_cut),
    };
    let sight = method(&SampleImage::visible);
    let has_buffer = framed.iter().any(|(_, j)| j.in_buffer.is_some());
    let buffer = has_buffer.then(|| method(&|j: &SampleImage| j.in_buffer.is_some_and(|b| b.seen)));
    let difference = buffer.and_then(|b| {
        let (a, b) = (sight.share_without_near_misses?, b.share_without_near_misses?);
        Some((a - b).abs())
    });
    let mismatched = sum(&|j| sharp(j) && j.in_buffer.is_some_and(|b| b.seen != j.visible()));
    let missed = sum(&|j| j.in_buffer.is_some_and(|b| b.missed));
    Visibility {
        in_frame,
        in_frame_share: ratio(in_frame, total),
        visible_share: ratio(sight.visible, total),
        sight,
        buffer,
        difference,
        mismatched_share: if has_buffer { ratio(mismatched, clear_cut) } else { None },
        surface_missed_share: if has_buffer { ratio(missed, in_frame) } else { None },
        near_miss_share: ratio(in_frame - clear_cut, in_frame).unwrap_or(0.0).max(0.0),
        clearance: clearances(&framed),
        folded_share: ratio(sum(&|j| j.folded), in_frame).unwrap_or(0.0).max(0.0),
    }
}

fn clearances(framed: &[&(f64, SampleImage)]) -> Option<Clearance> {
    let mut all: Vec<f64> = framed.iter().filter_map(|(_, j)| j.clearance).collect();
    all.sort_by(f64::total_cmp);
    Some(Clearance { min: *all.first()?, median: *all.get(all.len() / 2)?, max: *all.last()? })
}
