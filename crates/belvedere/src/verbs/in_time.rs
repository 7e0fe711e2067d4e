//! Measures visibility within the time limit.

use crate::BelvedereError;
use belvedere_construct::{MeasureOptions, Measures, default_spacing, measure};
use belvedere_core::View;
use belvedere_scene::{Instant, Progress, Scene};

/// Factors of the sample spacing that are tried in turn, from coarse to fine.
const COARSER: [u32; 3] = [16, 4, 1];
/// Largest factor of time to the next finer spacing: samples of areas lie in two dimensions.
const DEARER: f64 = 16.0;
/// Largest share of the remaining time that the next measurement may take.
const SHARE: f64 = 0.3;

/// Measures by lines of sight, as finely as the time limit allows; also returns the factor of the sample spacing.
///
/// # Errors
/// Those of [`measure()`].
pub(super) fn measured(scene: &Scene, view: &View, progress: &Progress) -> Result<(Measures, u32), BelvedereError> {
    let of = |coarser: u32| measure(scene, view, None, &options(scene, coarser), progress);
    if !progress.is_limited() {
        return Ok((of(1)?, 1));
    }
    let mut out = None;
    for coarser in COARSER {
        let began = Instant::now();
        out = Some((of(coarser)?, coarser));
        let next = began.elapsed().mul_f64(DEARER);
        if progress.left().is_some_and(|left| next > left.mul_f64(SHARE)) {
            break;
        }
    }
    match out {
        Some(found) => Ok(found),
        None => Ok((of(1)?, 1)),
    }
}

/// Options for measuring with a factor of the sample spacing.
pub(super) fn options(scene: &Scene, coarser: u32) -> MeasureOptions {
    let spacing_m = (coarser > 1).then(|| f64::from(coarser) * default_spacing(scene));
    MeasureOptions { spacing_m, ..MeasureOptions::default() }
}
