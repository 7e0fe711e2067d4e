//! Pictures on paper and as vectors.

use crate::outputs::named;
use belvedere::picture::PictureOptions;
use belvedere::print::Sheet;
use belvedere::request::Paper;
use belvedere::scene_file::PrintDoc;
use belvedere::vectors::VectorContent;
use clap::Args;
use std::path::Path;

/// Paper of a picture of a scene.
#[derive(Debug, Clone, Default, Args)]
pub(crate) struct PrintArgs {
    #[command(flatten)]
    pub(crate) paper: Paper,
    /// Leave the raster of the surfaces out of an SVG or PDF
    #[arg(long)]
    pub(crate) vectors_only: bool,
}

impl PrintArgs {
    /// The paper that arguments and scene ask for.
    ///
    /// * `size`: size in pixels that was asked for; `shape`: that of the scene.
    pub(crate) fn sheet(
        &self,
        scene: Option<&PrintDoc>,
        size: Option<[u32; 2]>,
        shape: [u32; 2],
    ) -> anyhow::Result<Option<Sheet>> {
        if scene.is_some_and(|scene| Sheet::of(scene, None, shape).is_err()) {
            // Opening the scene tells the line of the mistake.
            return Ok(None);
        }
        Ok(Sheet::asked(&self.paper.document(), scene, size, shape)?)
    }

    /// Options of a picture in the format of its name, on its paper.
    pub(crate) fn apply(&self, request: PictureOptions, out: &Path, sheet: Option<Sheet>) -> PictureOptions {
        let request = PictureOptions { vectors: vectors(out, self.vectors_only), ..request };
        match sheet {
            Some(sheet) => request.on(sheet),
            None => request,
        }
    }
}

/// Refuses names of pictures with the ending of a format that is not written.
pub(crate) fn check_name(out: &Path, vectors_only: bool) -> anyhow::Result<()> {
    let what = "pictures are written as PNG, TIFF, JPEG, WebP, SVG or PDF";
    named(out, &["png", "tif", "tiff", "jpg", "jpeg", "webp", "svg", "pdf"], what)?;
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
