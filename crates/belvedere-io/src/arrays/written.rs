//! Arrays as files, for scenes that leave the memory in which they were made.

use super::{Arrays, Content};
use crate::IoError;
use crate::atomic::write_atomic;
use crate::geotiff::write_geotiff;
use std::path::{Path, PathBuf};

impl Content {
    fn ending(&self) -> &'static str {
        match self {
            Self::Heights(_) => "tif",
            Self::Voxels(_) => "nrrd",
            Self::Triangles(_) => "ply",
            Self::Atoms(_) => "cif",
            Self::Features(_) | Self::Collection(_) => "geojson",
        }
    }

    fn write(&self, path: &Path, overwrite: bool) -> Result<(), IoError> {
        match self {
            Self::Heights(grid) => write_geotiff(path, &grid.raster(path), overwrite),
            Self::Voxels(voxels) => write_atomic(path, overwrite, |out| voxels.write_nrrd(out)),
            Self::Triangles(triangles) => write_atomic(path, overwrite, |out| out.write_all(&triangles.ply())),
            Self::Atoms(table) => write_atomic(path, overwrite, |out| out.write_all(table.mmcif().as_bytes())),
            Self::Features(features) => {
                write_atomic(path, overwrite, |out| out.write_all(features.geojson().as_bytes()))
            }
            Self::Collection(text) => write_atomic(path, overwrite, |out| out.write_all(text.text().as_bytes())),
        }
    }
}

impl Arrays {
    /// The name of the file that an array is written as: GeoTIFF, NRRD, PLY, mmCIF or GeoJSON; `None` if there is no such array.
    pub fn file_name(&self, name: &str) -> Option<String> {
        self.get(name).map(|array| format!("{name}.{}", array.content.ending()))
    }

    /// Writes arrays of these names as files of a folder; they hold the same numbers. Returns their paths.
    ///
    /// # Errors
    /// [`IoError::Exists`] unless files may be replaced; [`IoError`] for a file that cannot be written.
    pub fn write(&self, names: &[&str], folder: &Path, overwrite: bool) -> Result<Vec<PathBuf>, IoError> {
        let mut written = Vec::new();
        for (name, array) in names.iter().filter_map(|name| Some((name, self.get(name)?))) {
            let path = folder.join(format!("{name}.{}", array.content.ending()));
            array.content.write(&path, overwrite)?;
            written.push(path);
        }
        Ok(written)
    }
}
