//! Layers of files.

use crate::scene_file::{CityDoc, LayerDoc, MeshDoc, MoleculeDoc, Paths, TerrainDoc, TerrainStyleDoc, VolumeDoc};
use crate::{Advice, BelvedereError, OpenOptions};
use belvedere_io::arrays::SCHEME;
use belvedere_io::formats::Reader;
use belvedere_scene::Unit;
use belvedere_scene::molecule::Representation;
use std::path::Path;

/// The unit of a scene of such layers.
pub(super) fn unit_of(layers: &[LayerDoc]) -> Unit {
    match layers.first() {
        Some(LayerDoc::Molecule(_)) => Unit::Angstrom,
        Some(LayerDoc::Volume(_)) => Unit::Voxel,
        _ => Unit::Metre,
    }
}

/// The layer of built-in data, by their name, or of a file or array.
///
/// * `known`: the loader that reads a file.
pub(super) fn layer(path: &Path, known: Option<Reader>, others: &[LayerDoc]) -> Result<LayerDoc, BelvedereError> {
    let name = path.to_str().ok_or_else(|| BelvedereError::not_utf8(&path.display().to_string()))?;
    let file = path.file_name().and_then(|n| n.to_str()).unwrap_or_default().to_ascii_lowercase();
    let file = file.strip_suffix(".gz").unwrap_or(&file);
    let (builtin, file) = file.strip_prefix("builtin:").map_or((false, file), |name| (true, name));
    let file = file.strip_prefix(SCHEME).unwrap_or(file);
    let stem = file.split(['.', '?']).next().unwrap_or(file);
    let taken = |id: &str| others.iter().any(|l| l.id() == id);
    let id = (1..).map(|k| if k == 1 { stem.to_owned() } else { format!("{stem}-{k}") }).find(|id| !taken(id));
    let id = id.unwrap_or_default();
    // Names of cities that tell nothing else may hold them.
    let is_city = file.ends_with(".jsonl") || file.ends_with(".gml");
    match known {
        _ if builtin && stem == "dna" => Ok(LayerDoc::Molecule(MoleculeDoc::of(id, name))),
        _ if builtin && (stem == "engine" || stem == "tube") => Ok(LayerDoc::Volume(VolumeDoc::of(id, name))),
        _ if is_city || (builtin && stem == "town") => Ok(LayerDoc::City(CityDoc::of(id, name))),
        // Unknown names go on to the error that suggests the nearest one.
        _ if builtin && !matches!(stem, "massif" | "canyon" | "street") => Ok(LayerDoc::Mesh(MeshDoc::of(id, name))),
        Some(Reader::Molecule) => {
            let mut molecule = MoleculeDoc::of(id, name);
            molecule.style.representation = Representation::Auto;
            Ok(LayerDoc::Molecule(molecule))
        }
        Some(Reader::Mesh) => Ok(LayerDoc::Mesh(MeshDoc::of(id, name))),
        Some(Reader::City) => Ok(LayerDoc::City(CityDoc::of(id, name))),
        Some(Reader::Volume) => Ok(LayerDoc::Volume(VolumeDoc::of(id, name))),
        _ => {
            let text = " is no model that can be looked into; give meshes (OBJ, PLY, STL, glTF), cities (CityJSON, CityGML, OSM PBF), molecules (PDB, mmCIF, XYZ), volumes (VTI, VTK, NRRD, MetaImage, NIfTI, MRC, NumPy, TIFF stacks, DICOM, raw) or a scene file; for an elevation model give its features instead of {}";
            Err(BelvedereError::Argument(Advice::new(text, &["see"]).before(name)))
        }
    }
}

/// The layer of elevation models.
pub(super) fn ground(mut files: Vec<String>) -> LayerDoc {
    let source = if files.len() == 1 { Paths::One(files.remove(0)) } else { Paths::Many(files) };
    LayerDoc::Terrain(TerrainDoc {
        id: "ground".into(),
        source,
        fill_voids: true,
        largest_hole: Some(crate::LARGEST_HOLE),
        source_crs: None,
        nodata: None,
        vertical_unit: None,
        drape: None,
        land_cover: None,
        style: TerrainStyleDoc::default(),
    })
}

/// Sets the transfer function of all volumes; its file may lie in any folder.
pub(super) fn set_transfer(
    layers: &mut [LayerDoc],
    transfer: &str,
    options: &mut OpenOptions,
) -> Result<(), BelvedereError> {
    let is_file = [".toml", ".json"].iter().any(|e| transfer.to_ascii_lowercase().ends_with(e));
    let mut name = transfer.to_owned();
    if is_file {
        let path =
            belvedere_io::fs::canonicalize(transfer).map_err(|e| belvedere_io::IoError::os(Path::new(transfer), e))?;
        options.allow_roots.extend(path.parent().map(Path::to_owned));
        name = path.to_str().ok_or_else(|| BelvedereError::not_utf8(&path.display().to_string()))?.to_owned();
    }
    let mut volumes = layers.iter_mut().filter_map(|l| match l {
        LayerDoc::Volume(v) => Some(v),
        _ => None,
    });
    let Some(first) = volumes.next() else {
        let text = "{} is for volumes, and none is given; leave it out";
        return Err(BelvedereError::Argument(Advice::new(text, &["transfer"])));
    };
    first.transfer.clone_from(&name);
    volumes.for_each(|v| v.transfer.clone_from(&name));
    Ok(())
}
