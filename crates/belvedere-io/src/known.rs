//! What a file is: asked once, where its name comes in, and handed on.

use crate::formats::{self, Format, Reader};
use crate::recognise::{self, recognise};
use crate::{
    Arrays, GeoTiff, IoError, Limits, Loaded, Photometric, RasterInfo, Vectors, fs, join_table, load_vectors, packed,
    split_table, volume,
};
use std::path::{Path, PathBuf};
use std::sync::OnceLock;

/// A file, a folder or archive of tiles, or an array that was asked what it is.
#[derive(Debug)]
pub struct Known {
    /// As it was named.
    pub name: PathBuf,
    /// Its canonical path, with the table of a database that was named.
    pub path: PathBuf,
    /// The file inside an archive; else the path again.
    pub inner: PathBuf,
    /// The loader that reads it: told by the content of cities, else by the name, else by the content. `None` for scene files, pictures
    /// without heights, and what no loader reads.
    pub reader: Option<Reader>,
    features: OnceLock<Loaded<Vectors>>,
}

impl Known {
    /// # Errors
    /// [`IoError::Os`]; [`IoError::Format`] of an archive that holds no such file, or several, and for an array that there is not.
    pub fn of(name: &Path, arrays: &Arrays) -> Result<Self, IoError> {
        if let Some(array) = arrays.find(name)? {
            let features = OnceLock::new();
            if array.reader() == Reader::Features {
                let _ = features.set(array.features()?.with_file(array.record().clone()));
            }
            let [name, path, inner] = [(); 3].map(|()| name.to_owned());
            return Ok(Self { name, path, inner, reader: Some(array.reader()), features });
        }
        let (file, table) = split_table(name);
        let path = join_table(fs::canonicalize(file).map_err(|e| IoError::os(file, e))?, table);
        let is_scene = path.extension().is_some_and(|ending| ending.eq_ignore_ascii_case("toml"));
        let (inner, reader) = match table {
            Some(_) => (path.clone(), Some(Reader::Features)),
            None if path.is_dir() => {
                let is_volume = volume::is_volume_folder(&path);
                (path.clone(), Some(if is_volume { Reader::Volume } else { Reader::Terrain }))
            }
            None if is_scene => (path.clone(), None),
            None if !packed::tiles(&path)?.is_empty() => (path.clone(), Some(Reader::Terrain)),
            None => {
                let inner = packed::inside(&path)?;
                let reader = reader_of(&inner)?;
                (inner, reader)
            }
        };
        Ok(Self { name: name.to_owned(), path, inner, reader, features: OnceLock::new() })
    }

    /// Its features, read once.
    ///
    /// # Errors
    /// As [`load_vectors`].
    pub fn features(&self) -> Result<&Vectors, IoError> {
        if self.features.get().is_none() {
            let _ = self.features.set(load_vectors(&self.path)?);
        }
        self.features.get().map(|loaded| &loaded.value).ok_or_else(|| IoError::format(&self.path, "holds no features"))
    }

    /// Why no loader reads it, in a sentence, if its format is known.
    ///
    /// # Errors
    /// [`IoError::Os`].
    pub fn refusal(&self) -> Result<Option<String>, IoError> {
        let unread = if self.reader.is_none() { recognise(&self.inner)? } else { None };
        Ok(unread.map(|known| format!("{} {}", self.path.display(), known.reason())))
    }

    /// Whether it may be a scene file: TOML, or JSON of no other kind.
    pub fn may_be_scene(&self) -> bool {
        let ending = self.path.extension().map(|ending| ending.to_ascii_lowercase());
        self.reader.is_none() && ending.is_some_and(|ending| ending == "toml" || ending == "json")
    }

    /// Whether two names mean one file.
    pub fn is_file_of(&self, other: &Self) -> bool {
        split_table(&self.path).0 == split_table(&other.path).0
    }
}

fn reader_of(file: &Path) -> Result<Option<Reader>, IoError> {
    let is_city = |format: &&Format| format.reader == Some(Reader::City);
    if recognise::of_content(file)?.as_ref().is_some_and(is_city) {
        return Ok(Some(Reader::City));
    }
    let Some(format) = readable(file)? else { return Ok(None) };
    // A GeoTIFF that cannot be read is told by its loader.
    let holds_colors = || GeoTiff::open(file, Limits::default()).is_ok_and(|tiff| is_picture(tiff.value.info()));
    Ok(format.reader.filter(|_| format.name != "GeoTIFF" || !holds_colors()))
}

/// The format of a file that a loader reads: by its name, or by its first bytes where the name tells none. TIFFs are asked whether they are
/// stacks.
///
/// # Errors
/// [`IoError::Os`].
pub fn readable(path: &Path) -> Result<Option<&'static Format>, IoError> {
    let found = recognise::readable(path)?;
    let is_stack = found.is_some_and(|format| format.name == "GeoTIFF") && volume::is_stack(path);
    Ok(if is_stack { formats::named(formats::TIFF_STACK) } else { found })
}

/// Whether a raster holds colours rather than heights.
pub fn is_picture(info: &RasterInfo) -> bool {
    info.bands >= 3 || matches!(info.photometric, Photometric::Palette(_))
}
