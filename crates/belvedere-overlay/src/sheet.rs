//! Pictures on paper: sizes of sheets, pixels per inch, and how large lines and letters are.

use belvedere_document::PrintDoc;
use belvedere_document::paper::SIDE_MM;
pub use belvedere_document::paper::parse_paper;
use schemars::JsonSchema;
use serde::Serialize;

/// Pixels per inch at which lengths that scenes state in pixels are drawn as they are: one of them is 0.75 points, 0.2646 mm.
pub const REFERENCE_DPI: f64 = 96.0;
/// Pixels per inch of a sheet whose resolution is not stated.
pub const USUAL_DPI: f64 = 300.0;
/// Least and most pixels per inch.
pub const DPI: [f64; 2] = [10.0, 2400.0];
/// Most pixels along a side of a picture.
const MOST_SIDE: f64 = 65_535.0;
const MM_PER_INCH: f64 = 25.4;

/// A paper that a picture cannot have.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[error("{reason}")]
pub struct PaperError {
    /// Key of `[print]` that is at fault.
    pub key: &'static str,
    /// The measured value, the limit, and what to do.
    pub reason: String,
}

/// A picture's place on paper.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, JsonSchema)]
pub struct Sheet {
    /// Width and height of the paper, millimetres.
    pub paper_mm: [f64; 2],
    /// Width of the white margin on every side, millimetres. Files of pixels leave it out.
    pub margin_mm: f64,
    /// Pixels per inch.
    pub dpi: f64,
}

impl Sheet {
    /// Width and height of the picture on the paper, millimetres.
    pub fn picture_mm(&self) -> [f64; 2] {
        self.paper_mm.map(|side| side - 2.0 * self.margin_mm)
    }

    /// Size of the picture, pixels, at least 1.
    pub fn pixels(&self) -> [u32; 2] {
        self.picture_mm().map(|side| (side / MM_PER_INCH * self.dpi).round().clamp(1.0, MOST_SIDE) as u32)
    }

    /// Pixels per pixel of [`REFERENCE_DPI`]: see [`Sheet::density`].
    pub fn density(&self) -> f64 {
        self.dpi / REFERENCE_DPI
    }

    /// The sheet as a scene states it.
    pub fn document(&self) -> PrintDoc {
        let [w, h] = self.paper_mm;
        PrintDoc { paper: Some(format!("{w}x{h}mm")), dpi: Some(self.dpi), margin_mm: Some(self.margin_mm) }
    }

    /// The sheet that a caller and the `[print]` of a scene ask for: what the caller says goes before, and a size in pixels alone sets
    /// the paper of the scene aside.
    ///
    /// * `size`, `shape`: as of [`Sheet::of`].
    ///
    /// # Errors
    /// As [`Sheet::of`]; [`PaperError`] if the caller states paper, size and pixels per inch.
    pub fn asked(
        asked: &PrintDoc,
        scene: Option<&PrintDoc>,
        size: Option<[u32; 2]>,
        shape: [u32; 2],
    ) -> Result<Option<Self>, PaperError> {
        if size.is_some() && *asked == PrintDoc::default() {
            return Ok(None);
        }
        let scene = scene.cloned().unwrap_or_default();
        let paper = asked.paper.clone().or(scene.paper);
        if paper.is_some() && asked.dpi.is_some() && size.is_some() {
            let reason = "size and dpi contradict each other on a paper; give one of them, the other follows";
            return Err(PaperError { key: "dpi", reason: reason.into() });
        }
        let dpi = asked.dpi.or(scene.dpi.filter(|_| size.is_none() || paper.is_none()));
        Self::of(&PrintDoc { paper, dpi, margin_mm: asked.margin_mm.or(scene.margin_mm) }, size, shape)
    }

    /// The sheet that a document asks for; `None` for an empty one.
    ///
    /// A sheet without a size in pixels is as large as its paper and its pixels per inch say. With one, the pixels per inch follow from the
    /// width unless they are stated as well without a paper; then the paper follows.
    ///
    /// * `size`: size of the picture in pixels, if it is asked for; `shape`: size of the scene's own picture, which tells whether a sheet
    ///   lies or stands.
    ///
    /// # Errors
    /// [`PaperError`] for a paper that does not exist, a margin that leaves nothing, a resolution out of range, or more pixels
    /// along a side than pictures have.
    pub fn of(doc: &PrintDoc, size: Option<[u32; 2]>, shape: [u32; 2]) -> Result<Option<Self>, PaperError> {
        let wrong = |key: &'static str, reason: String| PaperError { key, reason };
        let margin_mm = doc.margin_mm.unwrap_or(0.0);
        if !(0.0..=1000.0).contains(&margin_mm) {
            return Err(wrong("margin_mm", format!("the margin is {margin_mm} mm, it must be in 0..=1000")));
        }
        if let Some(dpi) = doc.dpi {
            checked_dpi(dpi).map_err(|reason| wrong("dpi", reason))?;
        }
        let across = |px: u32, mm: f64| f64::from(px) * MM_PER_INCH / mm;
        let sheet = match (&doc.paper, doc.dpi) {
            (None, None) if doc.margin_mm.is_none() => return Ok(None),
            (None, None) => {
                return Err(wrong("margin_mm", "a margin needs a paper, or pixels per inch; state one of them".into()));
            }
            (None, Some(dpi)) => {
                let paper_mm = size.unwrap_or(shape).map(|px| f64::from(px) / dpi * MM_PER_INCH + 2.0 * margin_mm);
                let [least, most] = SIDE_MM;
                if !paper_mm.iter().all(|side| (least..=most).contains(side)) {
                    let [w, h] = paper_mm;
                    let reason = format!(
                        "{dpi} pixels per inch make a sheet of {w:.1} x {h:.1} mm, each side must be in {least}..={most} mm; give fewer or more"
                    );
                    return Err(wrong("dpi", reason));
                }
                Self { paper_mm, margin_mm, dpi }
            }
            (Some(paper), dpi) => {
                let paper_mm = parse_paper(paper, size.unwrap_or(shape)).map_err(|reason| wrong("paper", reason))?;
                let sheet = Self { paper_mm, margin_mm, dpi: dpi.unwrap_or(USUAL_DPI) };
                let [w, h] = sheet.picture_mm();
                if w < 1.0 || h < 1.0 {
                    let [w, h] = paper_mm;
                    let reason = format!("a margin of {margin_mm} mm leaves nothing of {w} x {h} mm; make it smaller");
                    return Err(wrong("margin_mm", reason));
                }
                let dpi = size.map_or(sheet.dpi, |[px, _]| across(px, w));
                checked_dpi(dpi).map_err(|reason| wrong("dpi", reason))?;
                let sheet = Self { dpi, ..sheet };
                if let Some([px, py]) = size
                    && sheet.pixels()[1].abs_diff(py) > 1
                {
                    let fits = sheet.pixels()[1];
                    let reason = format!("{px} x {py} pixels do not have the shape of the paper; give {px}x{fits}");
                    return Err(wrong("paper", reason));
                }
                sheet
            }
        };
        let longest = sheet.picture_mm().into_iter().fold(0.0, f64::max) / MM_PER_INCH * sheet.dpi;
        if longest.round() > MOST_SIDE {
            let most = (MOST_SIDE / longest * sheet.dpi).floor();
            let (dpi, reason) = (sheet.dpi, format!("pictures have at most {MOST_SIDE} pixels along a side"));
            return Err(wrong(
                "dpi",
                format!("{dpi} pixels per inch make {longest:.0} pixels, {reason}; give at most {most}"),
            ));
        }
        Ok(Some(sheet))
    }
}

fn checked_dpi(dpi: f64) -> Result<(), String> {
    let [least, most] = DPI;
    let fits = (least..=most).contains(&dpi);
    if fits { Ok(()) } else { Err(format!("{dpi:.4} pixels per inch are asked for, they must be in {least}..={most}")) }
}

#[cfg(test)]
mod tests;
