//! Arrays in memory as inputs: handed over by name where a scene would name files, hashed and recorded as files are.

mod grid;
mod triangles;
mod written;

pub use grid::HeightGrid;
pub use triangles::Triangles;

pub use crate::shared_bytes::SharedBytes;

use crate::formats::Reader;
use crate::molecule::AtomTable;
use crate::vector::{FeatureArray, FeatureText, Vectors};
use crate::volume::Voxels;
use crate::{InputFile, IoError, Loaded};
use sha2::{Digest, Sha256};
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// Beginning of the names of arrays where names of files may stand, as in `array:ground`.
pub const SCHEME: &str = "array:";

/// Whether a source names an array.
pub fn is_name(source: &str) -> bool {
    source.starts_with(SCHEME)
}

/// What an array holds.
#[derive(Clone)]
pub enum Content {
    /// Ground.
    Heights(HeightGrid),
    /// A volume.
    Voxels(Voxels),
    /// A mesh.
    Triangles(Triangles),
    /// A molecule.
    Atoms(AtomTable),
    /// Lines, areas or points by their positions.
    Features(FeatureArray),
    /// Lines, areas and points with properties.
    Collection(FeatureText),
}

impl Content {
    /// The header of the layout that is hashed, its keys in alphabetical order, and the bytes after it.
    fn layout(&self) -> (serde_json::Value, Vec<&[u8]>) {
        match self {
            Self::Heights(grid) => grid.layout(),
            Self::Voxels(voxels) => voxels.layout(),
            Self::Triangles(triangles) => triangles.layout(),
            Self::Atoms(table) => table.layout(),
            Self::Features(features) => features.layout(),
            Self::Collection(text) => text.layout(),
        }
    }

    fn kind(&self) -> &'static str {
        match self {
            Self::Heights(_) => "heights",
            Self::Voxels(_) => "voxels",
            Self::Triangles(_) => "triangles",
            Self::Atoms(_) => "atoms",
            Self::Features(_) | Self::Collection(_) => "features",
        }
    }
}

/// One array.
pub struct Array {
    content: Content,
    record: InputFile,
}

impl Array {
    /// The array under a name. Its sha256 is that of a line of JSON, which says its kind, shape and place, and of its bytes.
    fn new(path: PathBuf, content: Content) -> Self {
        let (header, parts) = content.layout();
        let header = format!("{header}\n");
        let mut hasher = Sha256::new_with_prefix(&header);
        parts.iter().for_each(|part| hasher.update(part));
        let bytes = header.len() + parts.iter().map(|part| part.len()).sum::<usize>();
        let sha256 = crate::input::hexadecimal(hasher);
        let record = InputFile { path, bytes: bytes as u64, sha256, sampled: false };
        Self { content, record }
    }

    /// Its record among the inputs, under the name `array:NAME`.
    pub fn record(&self) -> &InputFile {
        &self.record
    }

    /// The loader of files of the same content.
    pub fn reader(&self) -> Reader {
        match self.content {
            Content::Heights(_) => Reader::Terrain,
            Content::Voxels(_) => Reader::Volume,
            Content::Triangles(_) => Reader::Mesh,
            Content::Atoms(_) => Reader::Molecule,
            Content::Features(_) | Content::Collection(_) => Reader::Features,
        }
    }

    /// Heights.
    ///
    /// # Errors
    /// [`IoError::Format`] if it holds something else; likewise the other kinds.
    pub fn heights(&self) -> Result<&HeightGrid, IoError> {
        match &self.content {
            Content::Heights(grid) => Ok(grid),
            _ => Err(self.is_no("heights")),
        }
    }

    /// Voxels.
    ///
    /// # Errors
    /// As [`Array::heights`].
    pub fn voxels(&self) -> Result<&Voxels, IoError> {
        match &self.content {
            Content::Voxels(voxels) => Ok(voxels),
            _ => Err(self.is_no("voxels")),
        }
    }

    /// Triangles.
    ///
    /// # Errors
    /// As [`Array::heights`].
    pub fn triangles(&self) -> Result<&Triangles, IoError> {
        match &self.content {
            Content::Triangles(triangles) => Ok(triangles),
            _ => Err(self.is_no("triangles")),
        }
    }

    /// Atoms.
    ///
    /// # Errors
    /// As [`Array::heights`].
    pub fn atoms(&self) -> Result<&AtomTable, IoError> {
        match &self.content {
            Content::Atoms(table) => Ok(table),
            _ => Err(self.is_no("atoms")),
        }
    }

    /// Features.
    ///
    /// # Errors
    /// As [`Array::heights`]; [`IoError::Format`] for features that no file may hold either.
    pub fn features(&self) -> Result<Loaded<Vectors>, IoError> {
        match &self.content {
            Content::Features(features) => features.vectors(&self.record.path),
            Content::Collection(text) => text.vectors(&self.record.path),
            _ => Err(self.is_no("features")),
        }
    }

    fn is_no(&self, wanted: &str) -> IoError {
        let reason = format!("it holds {}, and {wanted} are needed; name another array", self.content.kind());
        IoError::format(&self.record.path, reason)
    }
}

/// Arrays by their names; clones share them.
#[derive(Clone, Default)]
pub struct Arrays(Arc<BTreeMap<String, Arc<Array>>>);

impl Arrays {
    /// Adds an array: a layer names it `array:NAME`.
    ///
    /// * `name`: letters, digits, `-` and `_`, 1 to 100 of them.
    ///
    /// # Errors
    /// [`IoError::Format`] for another name, or one that is taken.
    pub fn add(&mut self, name: &str, content: Content) -> Result<(), IoError> {
        let path = PathBuf::from(format!("{SCHEME}{name}"));
        let is_plain = |c: char| c.is_alphanumeric() || c == '-' || c == '_';
        if !name.chars().all(is_plain) || !(1..=100).contains(&name.chars().count()) {
            let reason = "is no name of an array; give 1 to 100 letters, digits, hyphens and underscores";
            return Err(IoError::format(path, reason));
        }
        if self.0.contains_key(name) {
            return Err(IoError::format(path, "there is an array of this name already; give another name"));
        }
        Arc::make_mut(&mut self.0).insert(name.to_owned(), Arc::new(Array::new(path, content)));
        Ok(())
    }

    /// The array that a path names; `None` for the path of a file.
    ///
    /// # Errors
    /// [`IoError::Format`] if there is no array of this name.
    pub fn find(&self, path: &Path) -> Result<Option<&Array>, IoError> {
        let Some(name) = path.to_str().and_then(|path| path.strip_prefix(SCHEME)) else { return Ok(None) };
        let known = || match self.names().collect::<Vec<_>>().join(", ") {
            names if names.is_empty() => "none is in memory".to_owned(),
            names => format!("those in memory are {names}"),
        };
        let found = self.0.get(name).map(|array| Some(&**array));
        found.ok_or_else(|| {
            let reason = format!(
                "there is no such array, {}; hand it over when the scene is opened, or save the scene with its arrays where it was made",
                known()
            );
            IoError::format(path, reason)
        })
    }

    /// Names in their order.
    pub fn names(&self) -> impl Iterator<Item = &str> {
        self.0.keys().map(String::as_str)
    }

    /// Whether there is none.
    pub fn is_empty(&self) -> bool {
        self.0.is_empty()
    }

    fn get(&self, name: &str) -> Option<&Array> {
        self.0.get(name).map(|array| &**array)
    }
}

impl std::fmt::Debug for Arrays {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_list().entries(self.0.values().map(|array| &array.record)).finish()
    }
}

impl PartialEq for Arrays {
    fn eq(&self, other: &Self) -> bool {
        self.0.values().map(|array| &array.record).eq(other.0.values().map(|array| &array.record))
    }
}
