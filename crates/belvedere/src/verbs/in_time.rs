//! Measures visibility within the time limit.

use crate::BelvedereError;
use belvedere_construct::measure::{HiddenRun, measure_and_hidden};
use belvedere_construct::{MeasureOptions, Measures, default_spacing};
use belvedere_core::View;
use belvedere_scene::{Instant, Progress, Scene};

/// Factors of the sample spacing that are tried in turn, from coarse to fine.
const COARSER: [u32; 3] = [16, 4, 1];
/// Largest factor of time to the next finer spacing: samples of areas lie in two dimensions.
const DEARER: f64 = 16.0;
/// Largest share of the remaining time that the next measurement may take.
const SHARE: f64 = 0.3;

/// What lines of sight found.
pub(super) struct Judged {
    pub(super) measures: Measures,
    /// Hidden parts in the bent picture.
    pub(super) hidden: Vec<HiddenRun>,
    /// Factor of the sample spacing.
    pub(super) every: u32,
}

/// Measures by lines of sight, as finely as the time limit allows.
///
/// # Errors
/// Those of [`belvedere_construct::measure()`].
pub(super) fn judged(scene: &Scene, view: &View, progress: &Progress) -> Result<Judged, BelvedereError> {
    let of = |every: u32| {
        let (measures, hidden) = measure_and_hidden(scene, view, None, &options(scene, every), progress)?;
        Ok::<_, BelvedereError>(Judged { measures, hidden, every })
    };
    if !progress.is_limited() {
        return of(1);
    }
    let mut out = None;
    for coarser in COARSER {
        let began = Instant::now();
        out = Some(of(coarser)?);
        let next = began.elapsed().mul_f64(DEARER);
        if progress.left().is_some_and(|left| next > left.mul_f64(SHARE)) {
            break;
        }
    }
    out.map_or_else(|| of(1), Ok)
}

/// Options for measuring with a factor of the sample spacing.
fn options(scene: &Scene, coarser: u32) -> MeasureOptions {
    let spacing_m = (coarser > 1).then(|| f64::from(coarser) * default_spacing(scene));
    MeasureOptions { spacing_m, ..MeasureOptions::default() }
}
