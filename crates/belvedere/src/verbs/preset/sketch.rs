//! Data for drawing a preset: the curve, its tags, the eye and its field of view.

use super::{DISTANCE, seen_from};
use belvedere_core::presets::PresetDocument;
use belvedere_core::{DVec2, Projection};

/// Number of pieces in which the curve is sampled.
const PIECES: usize = 160;
/// Sampled length of the extensions, curve units.
const EXTENSION: f64 = 0.45;

/// A preset in its plane, curve units.
#[derive(Debug, Clone)]
pub struct Sketch {
    /// The curve, near to far, with its extensions.
    pub curve: Vec<SketchPoint>,
    /// Its control points on the pinned curve.
    pub control: Vec<DVec2>,
    /// Shift of the curve by the pin, from its position in the document.
    pub pinned_by: DVec2,
    /// Borders of the sections.
    pub tags: Vec<SketchTag>,
    /// Position of the eye; `wedge` holds the directions of the lower and upper edge of the picture.
    pub eye: DVec2,
    /// Directions of the lower and upper edge of the picture.
    pub wedge: [DVec2; 2],
    /// Least height below and above the curve at which space folds, curve units; infinite where it does not.
    pub fold_heights: [f64; 2],
    /// Viewing angle, degrees.
    pub phi_deg: f64,
}

/// A point of the curve.
#[derive(Debug, Clone, Copy)]
pub struct SketchPoint {
    /// Position.
    pub at: DVec2,
    /// Unit normal, up over level ground.
    pub normal: DVec2,
    /// Share of the arc length; below 0 and above 1 on the extensions.
    pub share: f64,
    /// Sine of the angle at which the eye sees the ground there; negative = from below.
    pub facing: f64,
}

/// A border between sections.
#[derive(Debug, Clone, Copy)]
pub struct SketchTag {
    /// Position.
    pub at: DVec2,
    /// Unit normal there.
    pub normal: DVec2,
    /// Share of the arc length.
    pub share: f64,
    /// Half width of the transition, share of the arc length.
    pub half_width: f64,
}

/// The sketch of a document at a viewing angle, degrees; `None` if it gives no valid bend there.
///
/// * `distance`: distance of the eye from the pivot, scene units; used for documents whose depths are scene units.
pub fn sketch(document: &PresetDocument, phi_deg: f64, distance: Option<f64>) -> Option<Sketch> {
    let (pinhole, bend) = seen_from(document, phi_deg, distance.unwrap_or(DISTANCE))?;
    let curve = bend.curve();
    let eye = bend.curve_position(pinhole.eye);
    let point = |l: f64| {
        let (at, tangent) = curve.at(l);
        let normal = tangent.perp();
        let facing = (eye - at).normalize_or_zero().dot(normal);
        SketchPoint { at, normal, share: l / curve.length(), facing }
    };
    let step = (curve.length() + 2.0 * EXTENSION) / PIECES as f64;
    let [u, v] = bend.curve_axes();
    let flat = |d: belvedere_core::DVec3| DVec2::new(d.dot(u), d.dot(v)).normalize_or_zero();
    let half = match pinhole.projection {
        Projection::Perspective { fov_y } => (0.5 * fov_y).tan(),
        Projection::Orthographic { .. } => 0.0,
    };
    let control = bend.control();
    let pinned_by = *control.first()? - DVec2::from(*bend.resolved().control.first()?);
    let tags = bend.sections().tags().iter().map(|tag| {
        let SketchPoint { at, normal, .. } = point(tag.u * curve.length());
        SketchTag { at, normal, share: tag.u, half_width: tag.delta }
    });
    Some(Sketch {
        curve: (0..=PIECES).map(|k| point(k as f64 * step - EXTENSION)).collect(),
        control,
        pinned_by,
        tags: tags.collect(),
        eye,
        wedge: [half, -half].map(|h| flat(pinhole.forward + h * pinhole.down)),
        fold_heights: bend.fold_heights(),
        phi_deg: bend.resolved().phi_deg,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_builtin_is_drawn_and_seen_from_above() {
        for name in belvedere_core::presets::BUILTIN_NAMES {
            let document = PresetDocument::builtin(name).expect("built in");
            for preset in document.sorted() {
                let drawn = sketch(&document, preset.phi, None).expect("drawn");
                let inside = drawn.curve.iter().filter(|p| (0.0..=1.0).contains(&p.share));
                // Level ground is seen edge on from its own height.
                assert!(preset.phi == 0.0 || inside.clone().all(|p| p.facing > 0.0), "{name} {}", preset.phi);
                assert!(inside.count() > 50 && drawn.tags.len() == preset.tags.len());
            }
        }
    }
}
