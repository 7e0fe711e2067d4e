//! Tests of the loaders and writers.

mod assemblies;
mod atomic;
mod bad_cities;
mod budget;
mod cities;
mod city_gml;
mod city_osm;
mod city_pictures;
mod crs;
mod drape;
#[cfg(feature = "geopackage")]
mod geopackage;
mod geotiff;
mod geotiff_cloud;
mod geotiff_made;
mod kinds_crs;
mod kinds_files;
mod kinds_packed;
mod kinds_seeded;
mod links;
mod meshes;
mod molecules;
mod open_exr;
mod picture_files;
mod png;
mod rasters;
mod support_files;
mod terrain;
mod textures;
mod tiff_writer;
mod vectors;
mod volume_kinds;
mod volumes;
