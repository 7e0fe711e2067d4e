//! What a picture shows, judged in the time that there is.

use crate::BelvedereError;
use belvedere_construct::{MeasureOptions, Measures, default_spacing, measure};
use belvedere_core::View;
use belvedere_scene::{Instant, Progress, Scene};

/// Samples are first taken so many times as far apart as they should be, then at the others.
const COARSER: [u32; 3] = [16, 4, 1];
/// The next finer samples take at most so many times as long: those of areas lie in two directions.
const DEARER: f64 = 16.0;
/// They are not to take more than this share of the time that is left.
const SHARE: f64 = 0.3;

/// Measures by lines of sight, as finely as there is time for; also the spacing of the samples against what it is without a limit.
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

/// How to measure with samples so many times as far apart as usual.
pub(super) fn options(scene: &Scene, coarser: u32) -> MeasureOptions {
    let spacing_m = (coarser > 1).then(|| f64::from(coarser) * default_spacing(scene));
    MeasureOptions { spacing_m, ..MeasureOptions::default() }
}
