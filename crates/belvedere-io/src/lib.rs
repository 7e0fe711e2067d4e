//! Loaders and writers, one file per format: bytes in, [`Loaded`] values and warnings out.

pub mod atomic;
pub mod crs;
mod error;
pub mod geotiff;
pub mod png;
pub mod raster;

pub use error::{IoError, Loaded};
pub use geotiff::GeoTiff;
pub use raster::{Affine, Alpha, CrsKind, Limits, Photometric, Raster, RasterInfo, SampleType, Samples, SourceCrs};
