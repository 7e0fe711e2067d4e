//! Displacement of the points in a picture.

use crate::bodies::RigidLayers;
use belvedere_core::{DVec2, DVec3, View};
use belvedere_scene::Frame;
use serde::{Deserialize, Serialize};

/// Displacement of the points in a picture against the same camera without bends, sampled every few pixels. Ground outside the picture
/// may have moved farther.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize, Deserialize)]
pub struct DisplacementReport {
    /// Largest displacement, scene units; refined pixel by pixel around the largest samples.
    pub max_m: f64,
    /// Root mean square displacement, scene units.
    pub rms_m: f64,
    /// Largest distance between the bent and the straight image of a point, pixels. Points whose straight image lies more than one picture
    /// beside the picture do not count, since beside the eye images lie arbitrarily far.
    pub max_px: f64,
    /// Root mean square of that distance, pixels.
    pub rms_px: f64,
    /// Share of samples where the picture folds over, 0..=1.
    pub folded_share: f64,
    /// Pixels sampled.
    pub samples: usize,
}

/// Number of samples around which every pixel is measured.
const LARGEST: usize = 24;

/// Displacement of the point at a pixel.
struct Moved {
    pixel: [usize; 2],
    by_m: f64,
    by_px: Option<f64>,
    folded: bool,
}

/// Distance from a pixel to the straight image of its point, pixels; `None` if that lies more than one picture beside the picture.
fn distance_px(straight: &View, point: DVec3, pixel: DVec2) -> Option<f64> {
    let image = straight.project(point).ok()?;
    let size = DVec2::from(straight.pinhole().image.map(f64::from));
    let near =
        image.depth >= straight.pinhole().near && image.pixel.cmpge(-size).all() && image.pixel.cmple(2.0 * size).all();
    near.then(|| image.pixel.distance(pixel))
}

fn at_pixel(
    (view, straight): (&View, &View),
    rigid: &RigidLayers,
    frame: &Frame,
    [col, row]: [usize; 2],
) -> Option<Moved> {
    let depth = f64::from(frame.depth[row * frame.width + col]);
    let pixel = DVec2::new(col as f64 + 0.5, row as f64 + 0.5);
    let i = row * frame.width + col;
    if rigid.shown_at(frame, i) {
        // Rays of other points do not apply to a carried body; the picture's own world point does.
        let point = DVec3::from_array(*frame.world.as_ref()?.get(i)?);
        let (bent, plain) = (rigid.displaced(view, frame, i, point)?, straight.displace(point).ok()?.point);
        let by_px = distance_px(straight, point, pixel);
        return Some(Moved { pixel: [col, row], by_m: bent.distance(plain), by_px, folded: false });
    }
    let seen = view.ray(pixel).at(if depth.is_finite() { depth } else { -1.0 }).ok()?;
    let (bent, plain) = (view.displace(seen.point).ok()?, straight.displace(seen.point).ok()?);
    let by_px = distance_px(straight, seen.point, pixel);
    Some(Moved { pixel: [col, row], by_m: bent.point.distance(plain.point), by_px, folded: bent.folded })
}

/// Samples the displacement of points in the picture, in space and on the image.
/// * `frame`: needs world points if it shows rigid layers.
pub(super) fn measure(view: &View, rigid: &RigidLayers, frame: &Frame) -> DisplacementReport {
    let straight = view.straightened();
    let step = (frame.width.max(frame.height) / 128).max(1);
    let rows = (step / 2..frame.height).step_by(step);
    let pixels = rows.flat_map(|row| (step / 2..frame.width).step_by(step).map(move |col| [col, row]));
    let mut all: Vec<Moved> = pixels.filter_map(|at| at_pixel((view, &straight), rigid, frame, at)).collect();
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
    for [col, row] in all.iter().take(LARGEST).map(|m| m.pixel) {
        let around = |at: usize, end: usize| at.saturating_sub(step)..(at + step + 1).min(end);
        for row in around(row, frame.height) {
            let near = around(col, frame.width).filter_map(|col| at_pixel((view, &straight), rigid, frame, [col, row]));
            report.max_m = largest(&mut near.map(|m| m.by_m).chain([report.max_m]));
        }
    }
    report
}
