//! Files that end too early, at every hundredth of their length: one error, or what is whole before the end, with a word.

use belvedere::core::Warning;
use belvedere::io::formats::Reader as Loader;
use belvedere::io::{
    Arrays, IoError, Known, Limits, Loaded, TerrainRequest, VolumeRequest, load_city, load_mesh, load_molecule,
    load_terrain, load_vectors, load_volume,
};
use belvedere::scene::{NodeState, Progress};
use belvedere_fuzz::readers::{READERS, Reader};
use std::path::Path;

/// Readers of files beside another one, of documents, and of the same seeds as another reader.
const OTHERS: [&str; 25] = [
    // Tiles of a few samples are tiles of another size where they are cut.
    "srtm",
    "geotiff_described",
    "projection_file",
    "drape_tiff",
    "drape_png",
    "world_file",
    "delta",
    "palette_cpt",
    "palette_gdal",
    "features_described",
    "shapefile_table",
    "osm_features",
    "footprints",
    "mtl",
    "texture_png",
    "texture_jpeg",
    "tiff_stack_described",
    "transfer",
    "boxes_csv",
    "boxes_json",
    "motion",
    "path",
    "zip",
    "gzip",
    "raw",
];

/// Readers of texts and streams, of which the whole part is read.
const IN_PART: [&str; 14] = [
    "gpx",
    "kml",
    "tcx",
    "csv",
    "xyz",
    "xyz_atoms",
    "obj",
    "pdb",
    "mmcif",
    "stl",
    "ply",
    "osm_xml",
    "osm_pbf",
    "cityjson_sequence",
];

/// Texts of lines without a count and a mark of their end.
const NO_END: [&str; 6] = ["csv", "xyz", "obj", "pdb", "mmcif", "cityjson_sequence"];

fn counted<T>(loaded: Loaded<T>, count: impl Fn(&T) -> usize) -> (usize, Vec<Warning>) {
    (count(&loaded.value), loaded.warnings)
}

/// Things that a file holds for the loader that reads it, and what is said.
fn read(path: &Path) -> Result<(usize, Vec<Warning>), IoError> {
    let limits = Limits::default();
    Ok(match Known::of(path, &Arrays::default())?.reader {
        Some(Loader::Terrain) => {
            let paths = [path.to_owned()];
            let request = TerrainRequest { source_crs: Some(32632), ..TerrainRequest::default() };
            let loaded = load_terrain(&paths, &request, &Progress::silent())?;
            counted(loaded, |t| t.heightfield.states().iter().filter(|s| **s == NodeState::Measured).count())
        }
        Some(Loader::Features) => {
            counted(load_vectors(path)?, |v| v.features.iter().map(|feature| feature.geometry.vertices().count()).sum())
        }
        Some(Loader::City) => counted(load_city(path, None, &limits)?, |c| {
            c.city.buildings.len() + c.city.structures.len() + c.city.ways.len() + c.city.areas.len()
        }),
        Some(Loader::Mesh) => counted(load_mesh(path, &limits)?, |m| m.triangles.len()),
        Some(Loader::Molecule) => counted(load_molecule(path, &limits)?, |m| m.molecule.atoms().len()),
        Some(Loader::Volume) => counted(load_volume(path, &VolumeRequest::default())?, |v| v.dims.iter().product()),
        None => return Err(IoError::format(path, "is of no known kind")),
    })
}

/// What is wrong with a reader under files that are cut.
fn faults(reader: &Reader) -> Vec<String> {
    let mut out = Vec::new();
    for (seed, bytes) in (reader.seeds)().iter().enumerate() {
        let folder = tempfile::tempdir().expect("a folder");
        reader.prepare(folder.path()).expect("files beside");
        let path = folder.path().join(reader.file);
        let of = |length: usize| {
            std::fs::write(&path, &bytes[..length]).expect("written");
            read(&path)
        };
        let whole = match of(bytes.len()) {
            Ok((count, _)) => count,
            Err(e) => {
                out.push(format!("seed {seed}: whole: {e}"));
                continue;
            }
        };
        let mut before = 0;
        let mut had_any = false;
        let is_text = !bytes.contains(&0);
        let in_part = is_text && IN_PART.contains(&reader.name);
        for percent in 1..100 {
            let length = bytes.len() * percent / 100;
            // Where lines have no end of their own, nothing tells that others followed; a number may be cut, too.
            let may_be_silent = NO_END.contains(&reader.name);
            let mut say = |what: String| out.push(format!("seed {seed} at {percent} %: {what}"));
            match of(length) {
                Err(e) if e.to_string().contains('\n') || e.to_string().len() > 600 => say(format!("{e:?}")),
                Err(e) if had_any && in_part => say(format!("read before, refused now: {e}")),
                Err(_) => {}
                Ok((count, _)) if count > whole => say(format!("{count} of {whole}")),
                Ok((count, _)) if count < before && in_part => say(format!("{count} after {before}")),
                Ok((count, warnings)) => {
                    if count < whole && warnings.is_empty() && !may_be_silent {
                        say(format!("{count} of {whole} without a word"));
                    }
                    (before, had_any) = (count, true);
                }
            }
        }
        if !had_any && in_part {
            out.push(format!("seed {seed}: nothing of it is read unless it is whole"));
        }
    }
    out
}

#[test]
fn a_file_cut_at_every_hundredth_gives_one_error_or_what_is_whole() {
    belvedere::io::budget::set(256 << 20);
    let is_file = |reader: &&Reader| {
        !OTHERS.contains(&reader.name)
            && !matches!(reader.way, belvedere_fuzz::readers::Way::Text(_) | belvedere_fuzz::readers::Way::File(_))
    };
    let mut out = Vec::new();
    for reader in READERS.iter().filter(is_file) {
        out.extend(faults(reader).into_iter().map(|fault| format!("{}: {fault}", reader.name)));
    }
    assert!(out.is_empty(), "{} faults:\n{}", out.len(), out.join("\n"));
}
