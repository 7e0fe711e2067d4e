//! A scene from whatever files somebody drops.

use super::{Editor, Place, framed, set_camera};
use crate::scene_file::paths::Roots;
use crate::scene_file::{self, CameraDoc, Document, LayerDoc, Paths, SourceDocument, TerrainDoc, TerrainStyleDoc};
use crate::verbs::info::{self, FileInfo};
use crate::verbs::reveal::{RevealRequest, reveal};
use crate::verbs::reveal_target::{layer, unit_of};
use crate::{BelvedereError, DataFiles, OpenOptions, Session};
use belvedere_core::DVec3;
use belvedere_io::{fs, join_table, split_table};
use belvedere_scene::Progress;
use std::path::{Path, PathBuf};

/// What fits together.
const REMEDY: &str = "give one scene file, models (meshes, cities, molecules, volumes), an elevation model, or an elevation model together with routes, areas or points";

/// Opens a scene file, or makes a scene of data: an elevation model and features become a picture in which those are visible, anything
/// else is shown from the south.
///
/// * `allowed`: folders beside that of a scene file from which its files may come.
///
/// # Errors
/// [`BelvedereError`] of the first file that cannot be read; [`BelvedereError::Target`] for files that make no scene together.
pub fn open_files(paths: &[PathBuf], allowed: &[PathBuf], progress: &Progress) -> Result<Editor, BelvedereError> {
    if let [path] = paths
        && (path.extension().is_some_and(|e| e.eq_ignore_ascii_case("toml")) || is_json_scene(path))
    {
        return Editor::open(path, allowed.to_vec());
    }
    let (mut grounds, mut features, mut models) = (Vec::new(), Vec::new(), Vec::new());
    for path in paths {
        let (file, table) = split_table(path);
        let real = join_table(fs::canonicalize(file).map_err(|e| belvedere_io::IoError::os(file, e))?, table);
        let name = real.to_str().ok_or_else(|| BelvedereError::not_utf8(&path.display().to_string()))?.to_owned();
        match info::describe(&name, progress)? {
            FileInfo::Terrain(_) => grounds.push(name),
            FileInfo::Features(_) => features.push(name),
            FileInfo::Mesh(_) | FileInfo::City(_) | FileInfo::Molecule(_) | FileInfo::Volume(_) => models.push(real),
            FileInfo::Unread(unread) => {
                return Err(BelvedereError::Target(format!("{name} is {}: {}", unread.format, unread.note)));
            }
            FileInfo::Picture(_) | FileInfo::Raster(_) | FileInfo::Builtin(_) => {
                return Err(BelvedereError::Target(format!("{name} makes no scene; {REMEDY}")));
            }
        }
    }
    let options = OpenOptions { progress: progress.clone(), ..OpenOptions::default() };
    let folders =
        paths.iter().filter_map(|path| fs::canonicalize(split_table(path).0).ok()?.parent().map(Path::to_owned));
    let place = Place { scene: None, roots: Roots { scene_dir: PathBuf::new(), allowed: folders.collect() } };
    let title = paths.first().and_then(|path| path.file_name()?.to_str()?.split('.').next().map(str::to_owned));
    let mut document = match (grounds.as_slice(), features.is_empty(), models.is_empty()) {
        ([dem], false, true) => {
            let data = DataFiles { dem: dem.clone(), features, ..DataFiles::default() };
            let found = reveal(&RevealRequest { data, ..RevealRequest::default() }, &options)?.session;
            found.resolved().cloned().ok_or(BelvedereError::NoFeatures)?
        }
        ([_, ..], true, true) => shown(vec![ground(grounds)], "auto", &place, &options)?,
        ([], true, false) => {
            let layers = models.iter().try_fold(Vec::new(), |mut layers, path| {
                layers.push(layer(path, &layers)?);
                Ok::<_, BelvedereError>(layers)
            })?;
            shown(layers, "local", &place, &options)?
        }
        _ => return Err(BelvedereError::Target(format!("these files make no scene together; {REMEDY}"))),
    };
    document.title = title.unwrap_or(document.title);
    Ok(Editor::new(document, place))
}

fn is_json_scene(path: &Path) -> bool {
    path.extension().is_some_and(|e| e.eq_ignore_ascii_case("json")) && scene_file::read(path).is_ok()
}

fn ground(mut files: Vec<String>) -> LayerDoc {
    let source = if files.len() == 1 { Paths::One(files.remove(0)) } else { Paths::Many(files) };
    LayerDoc::Terrain(TerrainDoc {
        id: "ground".into(),
        source,
        fill_voids: true,
        largest_hole: Some(crate::LARGEST_HOLE),
        source_crs: None,
        nodata: None,
        drape: None,
        style: TerrainStyleDoc::default(),
    })
}

/// A document of layers, all of them in the picture.
fn shown(layers: Vec<LayerDoc>, crs: &str, place: &Place, options: &OpenOptions) -> Result<Document, BelvedereError> {
    let camera = CameraDoc::looking(DVec3::new(0.0, -1.0, 0.0), DVec3::ZERO);
    let unit = unit_of(&layers);
    let mut document = Document { crs: crs.into(), unit, layer: layers, ..Document::seen_by(camera) };
    let options = OpenOptions { allow_roots: place.roots.allowed.clone(), ..options.clone() };
    let session = Session::from_document(SourceDocument::new(document.clone()), &options)?;
    let view = framed(&session.scene().bounds(), 20.0, 30.0, document.camera.image);
    let view =
        view.ok_or_else(|| BelvedereError::Target(format!("there is nothing to see in these files; {REMEDY}")))?;
    document.camera.near = view.pinhole.near;
    set_camera(&mut document, &view);
    Ok(document)
}
