//! Arguments of pictures on paper.

use crate::outputs::named;
use crate::parse::parse_number;
use belvedere::picture::PictureOptions;
use belvedere::print::{Sheet, parse_paper};
use belvedere::scene_file::PrintDoc;
use belvedere::vectors::VectorContent;
use clap::Args;
use std::path::Path;

/// Paper of a picture.
#[derive(Debug, Clone, Default, Args)]
pub(crate) struct PrintArgs {
    /// Paper: A0 to A6 (landscape where the picture is wider than high), A3-portrait, A3-landscape, or a size such as 420x297mm; pixels,
    /// widths of lines and heights of letters follow from it
    #[arg(long, value_name = "PAPER", value_parser = paper)]
    pub(crate) paper: Option<String>,
    /// Pixels per inch, 300 with --paper unless --size is given; lengths that the scene states in pixels are 1/96 inch each
    #[arg(long, value_name = "DPI", allow_negative_numbers = true, value_parser = parse_number)]
    pub(crate) dpi: Option<f64>,
    /// White margin of the paper on every side, millimetres; PNG, TIFF, JPEG and WebP leave it out
    #[arg(long, value_name = "MM", allow_negative_numbers = true, value_parser = parse_number)]
    pub(crate) margin_mm: Option<f64>,
    /// Leave the raster of the surfaces out of an SVG or PDF
    #[arg(long)]
    pub(crate) vectors_only: bool,
}

fn paper(text: &str) -> Result<String, String> {
    parse_paper(text, [1, 1]).map(|_| text.to_owned())
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
        let asked = PrintDoc { paper: self.paper.clone(), dpi: self.dpi, margin_mm: self.margin_mm };
        Ok(Sheet::asked(&asked, scene, size, shape)?)
    }

    /// Refuses names of pictures with the ending of a format that is not written.
    pub(crate) fn check_name(&self, out: &Path) -> anyhow::Result<()> {
        let what = "pictures are written as PNG, TIFF, JPEG, WebP, SVG or PDF";
        named(out, &["png", "tif", "tiff", "jpg", "jpeg", "webp", "svg", "pdf"], what)?;
        anyhow::ensure!(!self.vectors_only || is_vectors(out), "--vectors-only needs an output named .svg or .pdf");
        Ok(())
    }

    /// Options of a picture in the format of its name, on its paper.
    pub(crate) fn apply(&self, request: PictureOptions, out: &Path, sheet: Option<Sheet>) -> PictureOptions {
        let vectors = match (is_vectors(out), self.vectors_only) {
            (false, _) => VectorContent::Nothing,
            (true, false) => VectorContent::OverRaster,
            (true, true) => VectorContent::Alone,
        };
        let request = PictureOptions { vectors, ..request };
        match sheet {
            Some(sheet) => request.on(sheet),
            None => request,
        }
    }
}

/// Whether a picture of this name is one of vectors.
pub(crate) fn is_vectors(out: &Path) -> bool {
    out.extension().is_some_and(|ending| ending.eq_ignore_ascii_case("svg") || ending.eq_ignore_ascii_case("pdf"))
}
