//! How far a picture moves what it shows.

use belvedere_core::{DVec2, View};
use belvedere_scene::Frame;
use serde::{Deserialize, Serialize};

/// How far a picture moves what it shows, against the same camera without bends; sampled every few pixels. Ground that it does not
/// show may have moved farther.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize, Deserialize)]
pub struct DisplacementReport {
    /// Largest, scene units.
    pub max_m: f64,
    /// Root mean square, scene units.
    pub rms_m: f64,
    /// Largest distance between the bent and the straight image of a point, pixels.
    pub max_px: f64,
    /// Root mean square of that distance, pixels.
    pub rms_px: f64,
    /// Share of samples where the picture folds over, 0..=1.
    pub folded_share: f64,
    /// Pixels sampled.
    pub samples: usize,
}

/// Samples the ground in view: where it would be without bends, in space and on the image.
pub(super) fn measure(view: &View, frame: &Frame) -> DisplacementReport {
    let straight = view.straightened();
    let step = (frame.width.max(frame.height) / 128).max(1);
    let mut report = DisplacementReport::default();
    let (mut sum_m, mut sum_px, mut in_both, mut folded) = (0.0, 0.0, 0usize, 0usize);
    for row in (step / 2..frame.height).step_by(step) {
        for col in (step / 2..frame.width).step_by(step) {
            let depth = f64::from(frame.depth[row * frame.width + col]);
            let pixel = DVec2::new(col as f64 + 0.5, row as f64 + 0.5);
            let Ok(seen) = view.ray(pixel).at(if depth.is_finite() { depth } else { -1.0 }) else { continue };
            let (Ok(bent), Ok(plain)) = (view.displace(seen.point), straight.displace(seen.point)) else { continue };
            let moved = bent.point.distance(plain.point);
            report.samples += 1;
            report.max_m = report.max_m.max(moved);
            sum_m += moved * moved;
            folded += usize::from(bent.folded);
            if let Ok(image) = straight.project(seen.point) {
                let moved_px = image.pixel.distance(pixel);
                in_both += 1;
                report.max_px = report.max_px.max(moved_px);
                sum_px += moved_px * moved_px;
            }
        }
    }
    let mean = |sum: f64, count: usize| if count == 0 { 0.0 } else { sum / count as f64 };
    report.rms_m = mean(sum_m, report.samples).sqrt();
    report.rms_px = mean(sum_px, in_both).sqrt();
    report.folded_share = mean(folded as f64, report.samples);
    report
}
