//! GeoTIFF and cloud-optimised GeoTIFF, classic and BigTIFF.
//!
//! [`GeoTiff::open`] reads headers only; [`GeoTiff::read`] decodes a whole level (the image or one of its overviews),
//! [`GeoTiff::read_window`] a part of it. What is refused is listed in `docs/unsupported.md`.

mod cloud;
mod codec;
mod geokeys;
mod ifd;
mod layout;
mod meta;
mod overview;
mod pages;
mod read;
mod shared;
mod source;
mod write;

pub use cloud::write_cloud_geotiff;
pub(crate) use codec::unpack_bits;
pub(crate) use geokeys::system_of_keys;
pub(crate) use pages::Pages;
pub(crate) use source::Source;
pub use write::write_geotiff;

use crate::raster::{Limits, Raster, RasterInfo, SampleType, Samples};
use crate::{Fault, InputFile, IoError, Loaded};
use belvedere_core::{Warning, WarningKind};
use belvedere_scene::Progress;
use ifd::{Container, Ifd, tag};
use layout::Layout;
use std::ops::Range;
use std::path::{Path, PathBuf};

/// An opened file: everything but the pixels.
#[derive(Debug)]
pub struct GeoTiff {
    container: Container,
    info: RasterInfo,
    /// What the tags Copyright and Artist say.
    credit: Option<String>,
    limits: Limits,
    /// The image, then its overviews, largest first.
    levels: Vec<Level>,
}

#[derive(Debug)]
struct Level {
    layout: Layout,
    mask: Option<Layout>,
}

/// Whether a file that begins with these four bytes is a TIFF.
pub(crate) fn is_tiff(magic: &[u8]) -> bool {
    matches!(magic, b"II*\0" | b"MM\0*" | b"II+\0" | b"MM\0+")
}

impl GeoTiff {
    /// Opens a file and reads its headers; `limits` bounds every later read.
    ///
    /// # Errors
    /// [`IoError`] if it cannot be read, is not a TIFF, is damaged, or uses what is not supported.
    pub fn open(path: &Path, limits: Limits) -> Result<Loaded<Self>, IoError> {
        let source = Source::open(path).map_err(|e| IoError::os(path, e))?;
        Self::new(path.to_path_buf(), source, limits).map_err(crate::recognise::explain)
    }

    /// As [`Self::open`] from the bytes of a file; `path` only names it in messages.
    ///
    /// # Errors
    /// As [`Self::open`].
    pub fn from_bytes(path: impl Into<PathBuf>, bytes: Vec<u8>, limits: Limits) -> Result<Loaded<Self>, IoError> {
        Self::new(path.into(), Source::bytes(bytes), limits)
    }

    fn new(path: PathBuf, source: Source, limits: Limits) -> Result<Loaded<Self>, IoError> {
        Self::parse(&path, source, limits).map_err(|reason| IoError::format(path, reason))
    }

    fn parse(path: &Path, source: Source, limits: Limits) -> Result<Loaded<Self>, String> {
        let container = Container::new(source)?;
        let (directories, cut) = container.directories()?;
        let mut warnings: Vec<Warning> = cut.into_iter().collect();
        let (first, others) = directories.split_first().ok_or("holds no image directory")?;
        let layout = Layout::new(&container, first)?;
        let mut info = RasterInfo::new(path, layout.width, layout.height, layout.stored.sample_type());
        info.bands = layout.bands;
        warnings.extend(geokeys::georeference(&container, first, &mut info)?);
        warnings.extend(meta::meaning(&container, first, &layout, &mut info)?);
        let said = |number: u16| container.text(first, number).ok().flatten().filter(|text| !text.trim().is_empty());
        let credit = said(tag::COPYRIGHT).or_else(|| said(tag::ARTIST));
        let mut levels = vec![Level { layout, mask: None }];
        let (subs, lost) = sub_directories(&container, first)?;
        warnings.extend(lost);
        add_levels(&container, others.iter().chain(&subs), &mut levels, &mut warnings)?;
        info.overviews = levels.iter().skip(1).map(|l| [l.layout.width, l.layout.height]).collect();
        let warnings = warnings.into_iter().map(|w| w.in_file(path)).collect();
        Ok(Loaded::new(Self { container, info, credit, limits, levels }, warnings))
    }

    /// Path, size and sha256 of the file, see [`InputFile::sampled`]. Hashing takes as long as a fast reading: ask once.
    ///
    /// # Errors
    /// [`IoError`] if a part cannot be read.
    pub fn input(&self) -> Result<InputFile, IoError> {
        self.container.source.input(&self.info.path)
    }

    /// Whom the file asks to be named: its tag Copyright, else Artist.
    pub fn credit(&self) -> Option<String> {
        self.credit.clone()
    }

    /// The full image.
    pub fn info(&self) -> &RasterInfo {
        &self.info
    }

    /// Number of levels: 1 + overviews.
    pub fn levels(&self) -> usize {
        self.levels.len()
    }

    /// Level `level` (0 = the image); width, height and transform are its own. `None` if there is no such level.
    pub fn level_info(&self, level: usize) -> Option<RasterInfo> {
        let layout = &self.levels.get(level)?.layout;
        let mut info = self.info.clone();
        let scale = [info.width as f64 / layout.width as f64, info.height as f64 / layout.height as f64];
        info.pixel_to_model = info.pixel_to_model.map(|t| t.after_scale_and_shift(scale[0], scale[1], 0.0, 0.0));
        (info.width, info.height) = (layout.width, layout.height);
        info.overviews = self.info.overviews.get(level..).unwrap_or(&[]).to_vec();
        Some(info)
    }

    /// The smallest level whose longer side is at least `side` pixels; the image itself if none is.
    pub fn level_for(&self, side: usize) -> usize {
        self.levels.iter().rposition(|l| l.layout.width.max(l.layout.height) >= side).unwrap_or(0)
    }

    /// Rows of a level that are decoded together: the height of its strips or tiles.
    pub(crate) fn rows_together(&self, level: usize) -> usize {
        self.levels.get(level).map_or(1, |l| l.layout.chunk_height.clamp(1, l.layout.height.max(1)))
    }

    /// Columns and rows of a level outside of which nothing is stored, because tiles or strips without data were left out; all of it in
    /// files without a value for no data, where what is left out is 0.
    pub(crate) fn stored(&self, level: usize) -> [Range<usize>; 2] {
        let Some(Level { layout, .. }) = self.levels.get(level) else { return [0..0, 0..0] };
        let all = || [0..layout.width, 0..layout.height];
        if self.info.nodata.is_some() { layout.stored().unwrap_or_else(all) } else { all() }
    }

    /// Type, compression and chunks for reports, such as `int16, deflate, 256 x 256 tiles`.
    pub fn encoding(&self) -> String {
        let Some(Level { layout, .. }) = self.levels.first() else { return String::new() };
        let kind = layout.kind();
        let size = format!("{} x {} {kind}s", layout.chunk_width, layout.chunk_height);
        let big = if self.container.big { ", BigTIFF" } else { "" };
        let planar = if layout.planar { ", band by band" } else { "" };
        let compression = layout.compression.name();
        format!("{}, compression {compression}, {size}{planar}{big}", self.info.sample_type.name())
    }

    /// Decodes a whole level; 0 is the image itself.
    ///
    /// # Errors
    /// [`IoError`] if the level does not exist, needs more memory than allowed, or is damaged; cancelled.
    pub fn read(&self, level: usize, progress: &Progress) -> Result<Raster, IoError> {
        let [width, height] = self.levels.get(level).map_or([0, 0], |l| [l.layout.width, l.layout.height]);
        self.read_window(level, 0..width, 0..height, progress)
    }

    /// Decodes columns `cols` and rows `rows` of a level, touching only the strips or tiles they need.
    ///
    /// # Errors
    /// As [`Self::read`]; also if the window is empty or not inside the level.
    pub fn read_window(
        &self,
        level: usize,
        cols: Range<usize>,
        rows: Range<usize>,
        progress: &Progress,
    ) -> Result<Raster, IoError> {
        let fail = |fault: Fault| {
            if progress.is_cancelled() {
                return IoError::Cancelled(belvedere_scene::Cancelled);
            }
            IoError::format(&self.info.path, fault)
        };
        let (Some(found), Some(info)) = (self.levels.get(level), self.level_info(level)) else {
            return Err(fail(format!("has {} levels, level {level} was asked for", self.levels.len()).into()));
        };
        if cols.is_empty() || rows.is_empty() || cols.end > info.width || rows.end > info.height {
            let (width, height) = (info.width, info.height);
            let reason = format!("columns {cols:?}, rows {rows:?} are not a part of {width} x {height} pixels");
            return Err(fail(reason.into()));
        }
        let read = |layout, fill| {
            let (cols, rows) = (cols.clone(), rows.clone());
            let container = &self.container;
            read::Window { container, layout, cols, rows, fill, limits: self.limits, progress }.read()
        };
        let samples = read(&found.layout, info.nodata.unwrap_or(0.0)).map_err(fail)?;
        let mask = match &found.mask {
            None => None,
            Some(layout) => match read(layout, 0.0).map_err(|e| fail(e.placed("mask")))? {
                Samples::U8(bytes) => Some(bytes.iter().map(|&b| b != 0).collect()),
                _ => None,
            },
        };
        Ok(Raster { info: info.window(&cols, &rows), samples, mask })
    }
}

/// Directories that the first one points to, and warnings about those that cannot be read.
fn sub_directories(container: &Container, first: &Ifd) -> Result<(Vec<Ifd>, Vec<Warning>), String> {
    const MOST_SUB_IFDS: usize = 64;
    let (mut found, mut warnings) = (Vec::new(), Vec::new());
    for at in container.uints(first, tag::SUB_IFDS)?.unwrap_or_default().into_iter().take(MOST_SUB_IFDS) {
        match container.directory(at) {
            Ok(ifd) => found.push(ifd),
            Err(reason) => warnings.push(no_overview(&reason)),
        }
    }
    Ok((found, warnings))
}

/// Sorts the other directories into overviews and masks of the image.
fn add_levels<'a>(
    container: &Container,
    others: impl Iterator<Item = &'a Ifd>,
    levels: &mut Vec<Level>,
    warnings: &mut Vec<Warning>,
) -> Result<(), String> {
    let mut masks = Vec::new();
    let mut pages = 0;
    for ifd in others {
        let kind = container.uint_tag(ifd, tag::NEW_SUBFILE_TYPE)?.unwrap_or(0);
        if kind & 5 == 0 {
            pages += 1;
            continue;
        }
        let layout = match Layout::new(container, ifd) {
            Ok(layout) => layout,
            Err(reason) if kind & 4 != 0 => return Err(format!("mask: {reason}")),
            Err(reason) => {
                warnings.push(no_overview(&reason));
                continue;
            }
        };
        if kind & 4 != 0 {
            masks.push(layout);
            continue;
        }
        let image = levels.first().map(|l| (l.layout.bands, l.layout.stored));
        if image == Some((layout.bands, layout.stored)) {
            levels.push(Level { layout, mask: None });
        } else {
            warnings.push(no_overview("its bands differ from those of the image"));
        }
    }
    if let Some((_, overviews)) = levels.split_first_mut() {
        overviews.sort_by_key(|l| std::cmp::Reverse((l.layout.width, l.layout.height)));
    }
    for mask in masks {
        let size = [mask.width, mask.height];
        let usable = mask.bands == 1 && mask.stored.sample_type() == SampleType::U8;
        let level = levels.iter_mut().find(|l| [l.layout.width, l.layout.height] == size && l.mask.is_none());
        match level {
            Some(level) if usable => level.mask = Some(mask),
            _ => {
                let text = format!("a mask of {} x {} pixels fits no level; it is ignored", size[0], size[1]);
                warnings.push(Warning::new(WarningKind::Ignored, text));
            }
        }
    }
    warnings.extend(Warning::counted(WarningKind::Ignored, pages, "further pages are ignored"));
    Ok(())
}

fn no_overview(reason: &str) -> Warning {
    Warning::new(WarningKind::Ignored, format!("an overview is ignored: {reason}"))
}
