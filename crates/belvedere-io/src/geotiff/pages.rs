//! Pages of a TIFF that is no map: several images of one size, and what the first says of them.

use super::ifd::{Container, Ifd, tag};
use super::layout::{Compression, Layout};
use super::source::Source;
use super::{meta, read};
use crate::raster::{Limits, Raster, RasterInfo};
use crate::{Fault, InputFile, IoError};
use belvedere_scene::Progress;
use std::path::Path;

/// Images of a TIFF that are neither overviews nor masks.
#[derive(Debug)]
pub(crate) struct Pages {
    container: Container,
    pages: Vec<Ifd>,
    first: Layout,
    /// Of the first page, without a place.
    pub(crate) info: RasterInfo,
    /// Text about the content, in the first page.
    pub(crate) description: String,
    /// Pixels per unit along x and y; `None` where not stated.
    pub(crate) resolution: Option<[f64; 2]>,
    /// Whether the first page has a place on the earth.
    pub(crate) is_placed: bool,
    limits: Limits,
}

impl Pages {
    /// Reads the headers of a file.
    ///
    /// # Errors
    /// As [`super::GeoTiff::open`].
    pub(crate) fn open(path: &Path, limits: Limits) -> Result<Self, IoError> {
        let source = Source::in_parts(path).map_err(|e| IoError::os(path, e))?;
        Self::parse(path, source, limits).map_err(|reason| IoError::format(path, reason))
    }

    fn parse(path: &Path, source: Source, limits: Limits) -> Result<Self, String> {
        let container = Container::new(source)?;
        let (directories, cut) = container.directories()?;
        if let Some(said) = cut {
            return Err(said.text().to_owned());
        }
        let mut pages = Vec::new();
        for ifd in directories {
            if container.uint_tag(&ifd, tag::NEW_SUBFILE_TYPE)?.unwrap_or(0) & 5 == 0 {
                pages.push(ifd);
            }
        }
        let page = pages.first().ok_or("holds no image directory")?;
        let first = Layout::new(&container, page)?;
        let mut info = RasterInfo::new(path, first.width, first.height, first.stored.sample_type());
        info.bands = first.bands;
        meta::meaning(&container, page, &first, &mut info)?;
        let description = container.text(page, tag::DESCRIPTION)?.unwrap_or_default();
        let per_unit = |number| container.rational(page, number).ok().flatten().filter(|v| v.is_finite() && *v > 0.0);
        let resolution = per_unit(tag::X_RESOLUTION).zip(per_unit(tag::Y_RESOLUTION)).map(|(x, y)| [x, y]);
        let places = [tag::PIXEL_SCALE, tag::TIEPOINT, tag::TRANSFORMATION, tag::GEO_KEYS];
        let is_placed = places.into_iter().any(|number| page.has(number));
        Ok(Self { first, info, description, resolution, is_placed, limits, pages, container })
    }

    /// Number of pages.
    pub(crate) fn count(&self) -> usize {
        self.pages.len()
    }

    /// The first page that differs from the first one in size, bands or type of samples, or cannot be read, and why.
    pub(crate) fn odd_one(&self) -> Option<(usize, String)> {
        self.pages.iter().enumerate().skip(1).find_map(|(i, page)| {
            let reason = match Layout::new(&self.container, page) {
                Ok(layout) if self.is_alike(&layout) => return None,
                Ok(layout) => {
                    let Layout { width, height, bands, .. } = layout;
                    format!("has {width} x {height} pixels of {bands} {}", layout.stored.sample_type().name())
                }
                Err(reason) => reason,
            };
            Some((i, reason))
        })
    }

    fn is_alike(&self, other: &Layout) -> bool {
        let of = |l: &Layout| (l.width, l.height, l.bands, l.stored, l.photometric);
        of(&self.first) == of(other)
    }

    /// Images that lie one after the other behind the first, in a file whose only page describes all of them; 1 unless they are stored as
    /// they are.
    pub(crate) fn in_a_row(&self) -> u64 {
        let Some((start, bytes)) = self.run() else { return 1 };
        (self.container.source.len().saturating_sub(start) / bytes.max(1)).max(1)
    }

    /// Where the samples of the first page begin, and how many bytes they are, if they lie in one piece.
    fn run(&self) -> Option<(u64, u64)> {
        let layout = &self.first;
        if layout.compression != Compression::None || layout.tiled || layout.planar {
            return None;
        }
        let bytes = layout.chunk_bytes(layout.height).ok()?;
        let mut end = None;
        for row in 0..layout.chunks[1] {
            let (at, _) = layout.chunk(0, row, 0)?;
            if end.is_some_and(|end| end != at) {
                return None;
            }
            end = at.checked_add(layout.chunk_bytes(layout.rows_in(row)).ok()?);
        }
        Some((end?.checked_sub(bytes)?, bytes))
    }

    /// Decodes page `index`.
    ///
    /// # Errors
    /// A fault of a page that does not exist, is damaged, differs from the first, or needs more memory than allowed.
    pub(crate) fn read(&self, index: usize) -> Result<Raster, Fault> {
        let own = match (index, self.pages.len()) {
            (0, _) => None,
            (_, 1) => Some(self.first.moved(self.run().map_or(0, |(_, bytes)| bytes).saturating_mul(index as u64))),
            _ => {
                let page = self.pages.get(index).ok_or_else(|| format!("has no page {}", index + 1))?;
                Some(Layout::new(&self.container, page)?)
            }
        };
        let layout = own.as_ref().unwrap_or(&self.first);
        if !self.is_alike(layout) {
            return Err("differs from the first page in size or samples".into());
        }
        let (cols, rows, progress) = (0..layout.width, 0..layout.height, &Progress::silent());
        let fill = self.info.nodata.unwrap_or(0.0);
        let window =
            read::Window { container: &self.container, layout, cols, rows, fill, limits: self.limits, progress };
        Ok(Raster { info: self.info.clone(), samples: window.read()?, mask: None })
    }

    /// Path, size and sha256 of the file.
    ///
    /// # Errors
    /// As [`super::GeoTiff::input`].
    pub(crate) fn input(&self) -> Result<InputFile, IoError> {
        self.container.source.input(&self.info.path)
    }
}
