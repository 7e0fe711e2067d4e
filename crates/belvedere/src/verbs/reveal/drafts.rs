//! Several views of the same subject on one sheet, to choose from.

use super::answer::FinalShares;
use super::appearance::softly_ended;
use super::opened::Opened;
use super::request::{Request, Setting};
use super::revealed;
use crate::BelvedereError;
use crate::guard::guarded;
use crate::places::Place;
use crate::request::Reveal;
use belvedere_construct::measure::percent;
use belvedere_construct::rays::{AroundOptions, bend_around_by};
use belvedere_construct::reveal::thresholds;
use belvedere_core::{DVec3, Projection, View};
use belvedere_io::png::{self, Channels};
use belvedere_overlay::badge;
use schemars::JsonSchema;
use serde::Serialize;
use std::path::Path;

/// Most drafts of a sheet.
pub const MOST_DRAFTS: usize = 24;
/// Width of a draft on the sheet at most, pixels.
const WIDTH: usize = 640;
/// Distance at which a point is told that a view of features looks at, metres: far enough that tenths of it do not turn the view.
const FAR: f64 = 10_000.0;
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

/// Chooses up to `count` views from different directions, and reveals what is asked for in each. A draft's `eye`, `look` and `fov_y_deg` given to
/// [`super::reveal()`] make the same picture.
///
/// # Errors
/// [`BelvedereError::Target`] unless `count` is 1 to [`MOST_DRAFTS`] and no view is given, also by a scene file; those of
/// [`super::reveal()`].
pub fn drafts(asked: &Reveal, count: usize, setting: &Setting) -> Result<DraftsAnswer, BelvedereError> {
    guarded(|| drafted(&Request::of(asked, setting)?, count))
}

fn drafted(request: &Request<'_>, count: usize) -> Result<DraftsAnswer, BelvedereError> {
    if !(1..=MOST_DRAFTS).contains(&count) {
        return Err(BelvedereError::Target(format!("{count} drafts were asked for; give 1 to {MOST_DRAFTS}")));
    }
    if request.places.is_some() {
        return Err(BelvedereError::Target("drafts choose their views themselves; leave eye and look out".into()));
    }
    let views = if request.models { of_target(request, count)? } else { of_features(request, count)? };
    let mut out = DraftsAnswer { drafts: Vec::new(), warnings: Vec::new() };
    for (i, view) in views.into_iter().enumerate() {
        let places = [view.eye, view.look].map(|[x, y, z]| Place::of([x, y], Some(z)));
        let request = Request { places: Some(places), fov_y_deg: Some(view.fov_y_deg), ..request.clone() };
        let found = revealed(&request)?;
        if i == 0 {
            out.warnings = found.warnings();
        }
        let frame = &found.picture.frame;
        let pixels = smaller(frame.width, frame.height, &frame.color);
        out.drafts.push(Draft { shares: found.shares, pixels, ..view });
    }
    Ok(out)
}

/// The views of features, without their pictures.
fn of_features(request: &Request<'_>, count: usize) -> Result<Vec<Draft>, BelvedereError> {
    let mut data = request.data().load(false, &softly_ended(&request.open))?;
    let search = request.search_options(&mut data)?;
    let taller = request.taller(&data)?;
    let scene = taller.as_ref().map_or(&data.scene, |taller| &taller.scene);
    let views = belvedere_construct::reveal::views(scene, count, &search, &request.open.progress)?;
    Ok(views.iter().filter_map(|view| Draft::of(view, FAR, 1)).collect())
}

/// The views of a target, without their pictures.
fn of_target(request: &Request<'_>, count: usize) -> Result<Vec<Draft>, BelvedereError> {
    let opened = Opened::of(request)?;
    if opened.session.path().is_some() {
        let reason = "drafts choose their views themselves; give data instead of a scene file";
        return Err(BelvedereError::Target(reason.into()));
    }
    let mut views: Vec<View> = Vec::new();
    let sight = opened.sight();
    for view in opened.views(&sight, Some(thresholds::DRAFT_VIEWS))? {
        let ahead = view.pinhole().forward;
        let is_apart = |other: &View| other.pinhole().forward.angle_between(ahead) > thresholds::DRAFTS_APART;
        if views.len() < count && views.iter().all(is_apart) {
            views.push(view);
        }
    }
    let center = opened.targets.search.center();
    let mut out = Vec::new();
    for view in &views {
        let found = bend_around_by(&sight, view, &AroundOptions::default(), &request.open.progress)?;
        let moved = opened.refitted(&sight, view, found.bent.as_ref().map(|(_, sidestep)| sidestep));
        let view = moved.as_ref().map_or(view, |moved| &moved.straight);
        let pinhole = view.pinhole();
        let distance = (center - pinhole.eye).dot(pinhole.forward).max(pinhole.near);
        // Exact to a ten-thousandth of the distance of the target.
        let digits = (4 - distance.log10().floor() as i32).clamp(0, 12);
        out.extend(Draft::of(view, distance, digits));
    }
    Ok(out)
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
    /// A view in numbers that are short enough to be typed, by which it is drawn later; `None` in parallel projection.
    ///
    /// * `distance`: of the point looked at, scene units; `digits`: of its numbers after the point.
    fn of(view: &View, distance: f64, digits: i32) -> Option<Self> {
        let pinhole = view.pinhole();
        let Projection::Perspective { fov_y } = pinhole.projection else { return None };
        let digits = digits as usize;
        let short = |v: f64| format!("{v:.digits$}").parse().unwrap_or(v);
        let eye = pinhole.eye.to_array().map(short);
        let look = (DVec3::from_array(eye) + distance * pinhole.forward).to_array().map(short);
        let fov_y_deg = (100.0 * fov_y.to_degrees()).round() / 100.0;
        Some(Self { eye, look, fov_y_deg, shares: FinalShares::default(), pixels: (0, 0, Vec::new()) })
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
