//! Warnings about preset documents that are valid but will look bad.

use super::{ReferencePlane, SplineBend};
use crate::presets::PresetDocument;
use crate::{Pinhole, Projection, Warning, WarningKind};
use glam::DVec3;

/// A warning about a valid preset document. `preset` is the name in quotes, or the position from 1.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum PresetWarning {
    /// Plateaus of neighbours overlap and are shrunk.
    #[error(
        "presets {first} and {second} hold over {plateaus} degrees in total but lie only {gap} degrees apart; their tau is shrunk to fit"
    )]
    PlateausOverlap {
        /// Lower preset.
        first: String,
        /// Upper preset.
        second: String,
        /// Sum of both tau, degrees.
        plateaus: f64,
        /// Difference of both phi, degrees.
        gap: f64,
    },
    /// More than three sections.
    #[error("preset {preset} has {sections} styling sections; more than 3 are hard to read")]
    ManySections {
        /// Preset.
        preset: String,
        /// Number of sections.
        sections: usize,
    },
    /// A transition wider than a third of a section beside it.
    #[error(
        "preset {preset}: the transition at tag {number} is {width:.3} wide, more than a third of the section beside it ({section:.3}); lower its delta"
    )]
    WideTransition {
        /// Preset.
        preset: String,
        /// Tag, 1 = the nearest.
        number: usize,
        /// Full width, share of the curve.
        width: f64,
        /// Width of the smaller neighbour, share of the curve.
        section: f64,
    },
    /// The deformed ground turns its back on the camera.
    #[error(
        "at a viewing angle of {phi_deg} degrees the ground faces away from the eye (facing {facing:.4}, it must be above 0); lower the far end of the curve"
    )]
    FacesAway {
        /// Viewing angle with the worst facing, degrees.
        phi_deg: f64,
        /// Facing there, a sine.
        facing: f64,
    },
    /// The data reach beyond the fold limit.
    #[error(
        "at a viewing angle of {phi_deg} degrees space folds beyond heights {fold_min:.1}..{fold_max:.1} over the reference plane but the data reach {data_min:.1}..{data_max:.1}; soften the curve, widen s..e or move the plane"
    )]
    Folds {
        /// Viewing angle with the tightest fold limit, degrees.
        phi_deg: f64,
        /// Lower limit, scene units.
        fold_min: f64,
        /// Upper limit, scene units.
        fold_max: f64,
        /// Lowest data, scene units.
        data_min: f64,
        /// Highest data, scene units.
        data_max: f64,
    },
}

impl From<&PresetWarning> for Warning {
    fn from(said: &PresetWarning) -> Self {
        let of = |kind| Self::new(kind, said.to_string());
        match said {
            PresetWarning::PlateausOverlap { first, plateaus, gap, .. } => {
                of(WarningKind::Limited).about(first).with("plateaus_deg", *plateaus).with("gap_deg", *gap)
            }
            PresetWarning::ManySections { preset, sections } => {
                of(WarningKind::Suspect).about(preset).with("sections", *sections as f64)
            }
            PresetWarning::WideTransition { preset, number, width, section } => {
                let tag = of(WarningKind::Suspect).about(preset).with("tag", *number as f64);
                tag.with("width_share", *width).with("section_share", *section)
            }
            PresetWarning::FacesAway { phi_deg, facing } => {
                of(WarningKind::Hidden).about("spline_bend").with("phi_deg", *phi_deg).with("facing", *facing)
            }
            PresetWarning::Folds { phi_deg, fold_min, fold_max, data_min, data_max } => {
                let folds = of(WarningKind::Hidden).about("spline_bend").with("phi_deg", *phi_deg);
                let folds = folds.with("fold_min", *fold_min).with("fold_max", *fold_max);
                folds.with("data_min", *data_min).with("data_max", *data_max)
            }
        }
    }
}

/// Facing, a sine, that counts as 0: ground that is seen edge-on does not face away, such as level ground from an eye on it.
pub const EDGE_ON: f64 = 1e-9;

/// Warnings about a valid `document`, seen with its pivot in the image centre at `distance` scene units, over viewing angles from the first to
/// the last preset in steps of at most one degree. `heights`: lowest and highest data over the reference plane, scene units, if known.
pub fn check_presets(document: &PresetDocument, distance: f64, heights: Option<[f64; 2]>) -> Vec<PresetWarning> {
    let mut warnings = static_warnings(document);
    let sorted = document.sorted();
    let (Some(first), Some(last)) = (sorted.first(), sorted.last()) else { return warnings };
    let steps = (last.phi - first.phi).ceil().clamp(1.0, 180.0) as u32;
    let angles = (0..=steps).map(|i| first.phi + (last.phi - first.phi) * f64::from(i) / f64::from(steps));
    let bends: Vec<(f64, SplineBend)> = angles.filter_map(|a| Some((a, bend_at(document, a, distance)?))).collect();
    let facing = bends.iter().map(|(a, b)| (*a, b.facing())).min_by(|a, b| a.1.total_cmp(&b.1));
    if let Some((phi_deg, facing)) = facing.filter(|f| f.1 < -EDGE_ON) {
        warnings.push(PresetWarning::FacesAway { phi_deg, facing });
    }
    let Some([data_min, data_max]) = heights else { return warnings };
    let reach = |[low, high]: [f64; 2]| (data_min / low).max(data_max / high);
    let tightest = bends
        .iter()
        .map(|(a, b)| (*a, b.fold_heights()))
        .max_by(|a, b| reach(a.1).total_cmp(&reach(b.1)))
        .filter(|t| reach(t.1) >= 1.0);
    if let Some((phi_deg, [fold_min, fold_max])) = tightest {
        warnings.push(PresetWarning::Folds { phi_deg, fold_min, fold_max, data_min, data_max });
    }
    warnings
}

fn static_warnings(document: &PresetDocument) -> Vec<PresetWarning> {
    let mut warnings = Vec::new();
    let sorted = document.sorted();
    for (i, pair) in sorted.windows(2).enumerate() {
        let (gap, plateaus) = (pair[1].phi - pair[0].phi, pair[0].tau + pair[1].tau);
        if plateaus >= gap {
            let (first, second) = (pair[0].label(i), pair[1].label(i + 1));
            warnings.push(PresetWarning::PlateausOverlap { first, second, plateaus, gap });
        }
    }
    for (i, preset) in sorted.iter().enumerate() {
        let sections = preset.sections.len();
        if sections > 3 {
            warnings.push(PresetWarning::ManySections { preset: preset.label(i), sections });
        }
        for (index, tag) in preset.tags.iter().enumerate() {
            let before = if index == 0 { 0.0 } else { preset.tags[index - 1].u };
            let after = preset.tags.get(index + 1).map_or(1.0, |t| t.u);
            let (width, section) = (2.0 * tag.delta, (tag.u - before).min(after - tag.u));
            if width > section / 3.0 + 1e-12 {
                warnings.push(PresetWarning::WideTransition {
                    preset: preset.label(i),
                    number: index + 1,
                    width,
                    section,
                });
            }
        }
    }
    warnings
}

/// The bend of a document for a camera `distance` from the pivot at viewing angle `phi_deg`.
fn bend_at(document: &PresetDocument, phi_deg: f64, distance: f64) -> Option<SplineBend> {
    let (sin, cos) = phi_deg.to_radians().sin_cos();
    let eye = DVec3::new(0.0, -cos * distance, sin * distance);
    let up = DVec3::new(0.0, sin, cos);
    let projection = Projection::Perspective { fov_y: 45f64.to_radians() };
    let camera = Pinhole::look_at(eye, DVec3::ZERO, up, projection, [640, 480], 1e-3 * distance, None).ok()?;
    SplineBend::new(&camera, document, &ReferencePlane::level(0.0), DVec3::ZERO).ok()
}
