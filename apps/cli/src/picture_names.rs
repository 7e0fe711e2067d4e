//! Names of pictures, and what of them becomes vectors.

use crate::outputs::only;
use belvedere::vectors::VectorContent;
use std::path::Path;

/// Refuses names of pictures with the ending of a format that is not written.
pub(crate) fn check_name(out: &Path, vectors_only: bool) -> anyhow::Result<()> {
    let what = "pictures are written as PNG, TIFF, JPEG, WebP, SVG or PDF";
    only(out, &["png", "tif", "tiff", "jpg", "jpeg", "webp", "svg", "pdf"], what)?;
    anyhow::ensure!(!vectors_only || is_vectors(out), "--vectors-only needs an output named .svg or .pdf");
    Ok(())
}

/// What of a picture of this name becomes shapes.
pub(crate) fn vectors(out: &Path, alone: bool) -> VectorContent {
    match (is_vectors(out), alone) {
        (false, _) => VectorContent::Nothing,
        (true, false) => VectorContent::OverRaster,
        (true, true) => VectorContent::Alone,
    }
}

/// Whether a picture of this name is one of vectors.
pub(crate) fn is_vectors(out: &Path) -> bool {
    out.extension().is_some_and(|ending| ending.eq_ignore_ascii_case("svg") || ending.eq_ignore_ascii_case("pdf"))
}
