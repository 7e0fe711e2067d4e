//! Loaders and writers, one file per format: bytes in, [`Loaded`] values and warnings out.

pub mod atomic;
mod base64;
pub mod city;
pub mod city_write;
pub mod crs;
pub mod drape;
mod error;
pub mod esri_ascii;
pub mod formats;
pub mod fs;
pub mod geotiff;
pub mod hgt;
mod input;
mod loaded;
pub mod mesh;
pub mod molecule;
pub mod open_exr;
mod packed;
pub mod png;
pub mod ramp;
pub mod raster;
mod recognise;
mod table;
pub mod terrain;
mod text;
pub mod vector;
pub mod volume;

pub use city::{CityFile, load_city};
pub use drape::{DrapeRequest, load_drape};
pub use error::{IoError, json_fault, said};
pub use geotiff::GeoTiff;
pub use input::{InputFile, sha256, sha256_of_file};
pub use loaded::Loaded;
pub use mesh::{MeshFile, load_mesh};
pub use molecule::{MoleculeFile, load_molecule};
pub use packed::inside;
pub use ramp::load_ramp;
pub use raster::{Affine, Alpha, CrsKind, Limits, Photometric, Raster, RasterInfo, SampleType, Samples, SourceCrs};
pub use recognise::{Recognised, readable, recognise};
pub use table::{join_table, split_table};
pub use terrain::{CrsChoice, LoadedTerrain, ResampleError, TerrainRequest, load_terrain};
pub use vector::{
    Geometry, VectorFeature, Vectors, Vertex, areas_on_terrain, lines_on_terrain, load_vectors, points_on_terrain,
};
pub use volume::{ByteOrder, Number, RawLayout, VolumeFile, VolumeRequest, load_volume};
