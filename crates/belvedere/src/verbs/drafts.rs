//! `reveal --drafts`: several views of the same features on one sheet, to choose from.

use super::appearance::softly_ended;
use super::reveal::{FinalShares, RevealRequest, Viewpoint, reveal, search_options, taller};
use crate::guard::guarded;
use crate::overlays::badge;
use crate::{BelvedereError, OpenOptions};
use belvedere_construct::measure::percent;
use belvedere_core::{DVec3, Projection, View};
use belvedere_io::png::{self, Channels};
use schemars::JsonSchema;
use serde::Serialize;
use std::path::Path;

/// Most drafts of a sheet.
pub const MOST_DRAFTS: usize = 24;
/// Width of a draft on the sheet at most, pixels.
const WIDTH: usize = 640;
/// Gap between drafts, pixels.
const GAP: usize = 8;

/// One view, judged as `reveal` judges it.
#[derive(Debug, Clone, JsonSchema, Serialize)]
pub struct Draft {
    /// Eye, scene x, y, z.
    pub eye: [f64; 3],
    /// Point looked at, scene x, y, z.
    pub look: [f64; 3],
    /// Full vertical field of view, degrees.
    pub fov_y_deg: f64,
    /// Shares of the whole features.
    #[serde(flatten)]
    pub shares: FinalShares,
    /// Width, height and colours of its picture on the sheet.
    #[serde(skip)]
    pixels: (usize, usize, Vec<[u8; 3]>),
}

/// Several views, and warnings that hold for all of them.
#[derive(Debug, Clone)]
pub struct DraftsAnswer {
    /// The views, that of `reveal` first.
    pub drafts: Vec<Draft>,
    /// Warnings of the data.
    pub warnings: Vec<belvedere_core::Warning>,
}

/// Chooses up to `count` views from different directions, and reveals the features in each. A draft's `eye`, `look` and `fov_y_deg` given to
/// [`reveal`] make the same picture.
///
/// # Errors
/// [`BelvedereError::Target`] unless `count` is 1 to [`MOST_DRAFTS`] and no view is given; those of [`reveal`].
pub fn drafts(request: &RevealRequest, count: usize, options: &OpenOptions) -> Result<DraftsAnswer, BelvedereError> {
    guarded(|| drafted(request, count, options))
}

fn drafted(request: &RevealRequest, count: usize, options: &OpenOptions) -> Result<DraftsAnswer, BelvedereError> {
    if !(1..=MOST_DRAFTS).contains(&count) {
        return Err(BelvedereError::Target(format!("{count} drafts were asked for; give 1 to {MOST_DRAFTS}")));
    }
    if request.viewpoint.is_some() || request.places.is_some() {
        return Err(BelvedereError::Target("drafts choose their views themselves; leave eye and look out".into()));
    }
    let mut data = request.data.load(false, &softly_ended(options))?;
    let search = search_options(request, &mut data)?;
    let taller = taller(request, &data)?;
    let scene = taller.as_ref().map_or(&data.scene, |taller| &taller.scene);
    let views = belvedere_construct::reveal::views(scene, count, &search, &options.progress)?;
    let mut out = DraftsAnswer { drafts: Vec::new(), warnings: Vec::new() };
    for (i, view) in views.iter().enumerate() {
        let Some((viewpoint, fov_y_deg)) = rounded(view) else { continue };
        let request = RevealRequest { viewpoint: Some(viewpoint), fov_y_deg: Some(fov_y_deg), ..request.clone() };
        let found = reveal(&request, options)?;
        if i == 0 {
            out.warnings = found.session.warnings();
        }
        let Viewpoint { eye, target: [x, y], target_height } = viewpoint;
        let frame = &found.picture.frame;
        out.drafts.push(Draft {
            eye,
            look: [x, y, target_height.unwrap_or_default()],
            fov_y_deg,
            shares: found.shares,
            pixels: smaller(frame.width, frame.height, &frame.color),
        });
    }
    Ok(out)
}

/// The view in numbers that are short enough to be typed; the drafts are drawn by these.
fn rounded(view: &View) -> Option<(Viewpoint, f64)> {
    let pinhole = view.pinhole();
    let Projection::Perspective { fov_y } = pinhole.projection else { return None };
    let tenth = |v: f64| (10.0 * v).round() / 10.0;
    let eye = pinhole.eye.to_array().map(tenth);
    let look = DVec3::from_array(eye) + 10_000.0 * pinhole.forward;
    let [x, y, z] = look.to_array().map(tenth);
    let fov_y_deg = (100.0 * fov_y.to_degrees()).round() / 100.0;
    Some((Viewpoint { eye, target: [x, y], target_height: Some(z) }, fov_y_deg))
}

/// The picture at most [`WIDTH`] wide, by the mean of squares of pixels.
fn smaller(width: usize, height: usize, pixels: &[[u8; 3]]) -> (usize, usize, Vec<[u8; 3]>) {
    let by = width.div_ceil(WIDTH).max(1);
    let (w, h) = ((width / by).max(1), (height / by).max(1));
    let mean = |x: usize, y: usize| {
        let mut sums = [0u32; 3];
        for row in 0..by.min(height) {
            for col in 0..by.min(width) {
                let pixel = pixels[(y * by + row) * width + x * by + col];
                (0..3).for_each(|c| sums[c] += u32::from(pixel[c]));
            }
        }
        let count = (by.min(height) * by.min(width)) as u32;
        sums.map(|sum| ((sum + count / 2) / count) as u8)
    };
    let out = (0..h).flat_map(|y| (0..w).map(move |x| (x, y))).map(|(x, y)| mean(x, y)).collect();
    (w, h, out)
}

impl Draft {
    /// * `eye`, `look`, `fov_y_deg`: the view; `frame`: its picture.
    pub(super) fn new(
        (eye, look, fov_y_deg): ([f64; 3], [f64; 3], f64),
        shares: FinalShares,
        frame: &belvedere_scene::Frame,
    ) -> Self {
        Self { eye, look, fov_y_deg, shares, pixels: smaller(frame.width, frame.height, &frame.color) }
    }

    /// Its shares in words.
    pub fn words(&self) -> String {
        let [straight, bent] = self.shares.both();
        match self.shares.technique {
            Some(_) => format!("visible {bent}, straight {}", percent(straight.visible)),
            None => format!("visible {bent} without any bend"),
        }
    }
}

impl DraftsAnswer {
    /// Width, height and colours of the sheet: the drafts in rows, each with its number and its shares below.
    pub fn sheet(&self) -> (usize, usize, Vec<[u8; 3]>) {
        let columns = (1..).find(|c| c * c >= self.drafts.len()).unwrap_or(1);
        let cells: Vec<_> = self
            .drafts
            .iter()
            .enumerate()
            .map(|(i, draft)| {
                let label = format!("{}: {}", i + 1, draft.words());
                badge::titled(draft.pixels.clone(), &[(&label, 0)])
            })
            .collect();
        let (w, h) = cells.iter().fold((0, 0), |(w, h), cell| (w.max(cell.0), h.max(cell.1)));
        let rows = cells.len().div_ceil(columns);
        let width = columns * (w + GAP) - GAP.min(columns * (w + GAP));
        let height = rows * (h + GAP) - GAP.min(rows * (h + GAP));
        let mut pixels = vec![[255; 3]; width * height];
        for (i, (cell_width, cell_height, colors)) in cells.iter().enumerate() {
            let (left, top) = ((i % columns) * (w + GAP), (i / columns) * (h + GAP));
            for row in 0..*cell_height {
                let to = (top + row) * width + left;
                pixels[to..to + cell_width].copy_from_slice(&colors[row * cell_width..(row + 1) * cell_width]);
            }
        }
        (width, height, pixels)
    }

    /// Writes the sheet.
    ///
    /// # Errors
    /// [`BelvedereError::Io`].
    pub fn write(&self, out: &Path, overwrite: bool) -> Result<(), BelvedereError> {
        let (width, height, pixels) = self.sheet();
        let title = [("Software", concat!("belvedere ", env!("CARGO_PKG_VERSION"))), ("Comment", "drafts")];
        Ok(png::write(out, overwrite, width, height, Channels::Rgb, pixels.as_flattened(), &title)?)
    }
}
