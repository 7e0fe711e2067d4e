//! Opens files of any kind as one scene.

use super::model_layers::{ground, layer, unit_of};
use super::reveal::reveal;
use crate::data::{features_of, ground_files, locate};
use crate::placed::{Place, PlacedDocument};
use crate::request::Reveal;
use crate::request::{OfData, given_of};
use crate::scene_file::paths::Roots;
use crate::scene_file::{self, Document, EarthDoc, LayerDoc, Paths, SourceDocument};
use crate::{Advice, BelvedereError, OpenOptions, Session, Trust};
use belvedere_io::formats::Reader;
use belvedere_io::{Arrays, Known, Limits, fs, load_city, split_table};
use belvedere_scene::Progress;
use std::path::{Path, PathBuf};

/// Files that can be opened together.
const REMEDY: &str = "give one scene file, models (meshes, cities, molecules, volumes), an elevation model, or an elevation model together with routes, areas or points";

/// Opens a scene file, or makes a scene of data: an elevation model and features become a picture in which the features are visible,
/// other data are shown from the south.
///
/// * `allowed`: folders beside that of a scene file from which its files may come.
///
/// # Errors
/// [`BelvedereError`] of the first file that cannot be read; [`BelvedereError::Target`] for files that make no scene together.
pub fn open_files(
    paths: &[PathBuf],
    allowed: &[PathBuf],
    progress: &Progress,
) -> Result<PlacedDocument, BelvedereError> {
    open_trusted(paths, allowed, &Trust::default(), progress)
}

/// The same, where a scene file has the consent that was given to it.
///
/// # Errors
/// As [`open_files`].
pub fn open_trusted(
    paths: &[PathBuf],
    allowed: &[PathBuf],
    trust: &Trust,
    progress: &Progress,
) -> Result<PlacedDocument, BelvedereError> {
    if let [path] = paths
        && (path.extension().is_some_and(|e| e.eq_ignore_ascii_case("toml")) || is_json_scene(path))
    {
        return PlacedDocument::read(path, allowed.to_vec(), trust);
    }
    let (mut grounds, mut features, mut models) = (Vec::new(), Vec::new(), Vec::new());
    for path in paths {
        let known = Known::of(path, &Arrays::default())?;
        let name = known.path.to_str().ok_or_else(|| BelvedereError::not_utf8(&path.display().to_string()))?.to_owned();
        match known.reader {
            Some(Reader::Terrain) => grounds.push(name),
            Some(Reader::Features) => features.push(name),
            Some(Reader::Mesh | Reader::City | Reader::Molecule | Reader::Volume) => models.push(known),
            None => {
                return Err(BelvedereError::Target(
                    known.refusal()?.unwrap_or_else(|| format!("{name} makes no scene; {REMEDY}")),
                ));
            }
        }
    }
    let options = OpenOptions { progress: progress.clone(), ..OpenOptions::default() };
    let folders =
        paths.iter().filter_map(|path| fs::canonicalize(split_table(path).0).ok()?.parent().map(Path::to_owned));
    let place = Place { scene: None, roots: Roots { allowed: folders.collect(), ..Roots::default() } };
    let title = paths.first().and_then(|path| path.file_name()?.to_str()?.split('.').next().map(str::to_owned));
    let mut document = match (grounds.as_slice(), features.is_empty(), models.is_empty()) {
        ([dem], false, true) => {
            let asked = Reveal { data: dem.clone(), features, ..Reveal::default() };
            let found = reveal(&asked, &options.into())?.session;
            found.resolved().cloned().ok_or(BelvedereError::NoFeatures)?
        }
        ([_, ..], true, true) => shown(vec![ground(grounds)], &place, &options)?,
        ([], true, false) => {
            let layers = models.iter().try_fold(Vec::new(), |mut layers, known: &Known| {
                layers.push(layer(&known.path, known.reader, &layers)?);
                Ok::<_, BelvedereError>(layers)
            })?;
            shown(layers, &place, &options)?
        }
        _ => return Err(BelvedereError::Target(format!("these files make no scene together; {REMEDY}"))),
    };
    document.title = title.unwrap_or(document.title);
    Ok(PlacedDocument { document, place, text: None })
}

/// Result of opening files beside an open scene.
#[derive(Debug, Clone)]
pub enum Opened {
    /// A new scene.
    Scene(Box<PlacedDocument>),
    /// Routes, areas or points for the open terrain, and their folders.
    Layers(Vec<LayerDoc>, Vec<PathBuf>),
}

/// Like [`open_files`]; but if all files are features and `current` has terrain, they become further layers of it.
///
/// # Errors
/// As [`open_files`].
pub fn open_beside(
    current: &Document,
    paths: &[PathBuf],
    allowed: &[PathBuf],
    trust: &Trust,
    progress: &Progress,
) -> Result<Opened, BelvedereError> {
    let has_terrain = current.layer.iter().any(|layer| matches!(layer, LayerDoc::Terrain(_)));
    let (mut layers, mut folders) = (current.layer.clone(), Vec::new());
    for path in paths.iter().filter(|_| has_terrain) {
        let known = Known::of(path, &Arrays::default())?;
        if known.reader != Some(Reader::Features) {
            return open_trusted(paths, allowed, trust, progress).map(|scene| Opened::Scene(Box::new(scene)));
        }
        layers.push(features_of(&known, &layers)?);
        folders.extend(split_table(&known.path).0.parent().map(Path::to_owned));
    }
    let new = layers.split_off(current.layer.len());
    match new.is_empty() {
        true => open_trusted(paths, allowed, trust, progress).map(|scene| Opened::Scene(Box::new(scene))),
        false => Ok(Opened::Layers(new, folders)),
    }
}

fn is_json_scene(path: &Path) -> bool {
    path.extension().is_some_and(|e| e.eq_ignore_ascii_case("json")) && scene_file::read(path).is_ok()
}

/// A document of layers with a camera that shows all of them.
fn shown(layers: Vec<LayerDoc>, place: &Place, options: &OpenOptions) -> Result<Document, BelvedereError> {
    let session = Session::from_document(whole(layers, place.roots.allowed.clone()), options)?;
    session.stated().cloned().ok_or(BelvedereError::NoFeatures)
}

/// A document of layers whose camera is found when they are read.
fn whole(layers: Vec<LayerDoc>, folders: Vec<PathBuf>) -> SourceDocument {
    // Models have no place on the earth; ground and cities may, in degrees too.
    let is_placed = layers.iter().any(|layer| matches!(layer, LayerDoc::Terrain(_) | LayerDoc::City(_)));
    let crs = if is_placed { "auto" } else { "local" };
    let provisional = super::found_view::provisional_camera();
    let unit = unit_of(&layers);
    let document = Document { crs: crs.into(), unit, layer: layers, ..Document::seen_by(provisional) };
    SourceDocument::of_files(document, folders)
}

/// A scene file, whatever its name, or the [scene of data](scene_of_data) with what is said of them.
///
/// # Errors
/// As [`scene_file::read`] and [`scene_of_data`]; [`BelvedereError::Argument`] where something is said of a scene file, which says it itself,
/// or of data that have no such thing; [`BelvedereError::Target`] for a scene file among several files.
pub fn scene_or_data(paths: &[PathBuf], said: &OfData) -> Result<SourceDocument, BelvedereError> {
    let read = match paths {
        [path] => scene_file::read(path),
        paths => {
            if let Some(path) = paths.iter().find(|path| scene_file::read(path).is_ok()) {
                let others: Vec<String> =
                    paths.iter().filter(|other| *other != path).map(|other| other.display().to_string()).collect();
                let text = format!(
                    "{} is a scene file, which is drawn alone; leave out {}, or name data in the scene file",
                    path.display(),
                    others.join(" and ")
                );
                return Err(BelvedereError::Target(text));
            }
            scene_file::read(paths.first().ok_or(BelvedereError::NoFeatures)?)
        }
    };
    match read {
        Err(error) => {
            let found = scene_of_data(paths)?;
            let mut source = found.ok_or_else(|| if paths.len() > 1 { undrawable(paths) } else { error.into() })?;
            say_of_data(&mut source.document, said)?;
            Ok(source)
        }
        Ok(source) => match given_of(said, &OfData::OPTIONS)[..] {
            [] => Ok(source),
            ref options => Err(not_said(options, "for data alone, and a scene file says it itself")),
        },
    }
}

fn undrawable(paths: &[PathBuf]) -> BelvedereError {
    let names: Vec<String> = paths.iter().map(|path| path.display().to_string()).collect();
    BelvedereError::Target(format!("{} make no picture together; {REMEDY}", names.join(", ")))
}

fn not_said(options: &[&'static str], what: &str) -> BelvedereError {
    BelvedereError::Argument(Advice::of_options(options, what))
}

/// Puts what is said of data into their document.
fn say_of_data(document: &mut Document, said: &OfData) -> Result<(), BelvedereError> {
    let raster = &said.raster;
    let has_terrain = document.layer.iter().any(|layer| matches!(layer, LayerDoc::Terrain(_)));
    let wrong = given_of(said, &OfData::OF_TERRAIN);
    if !has_terrain && !wrong.is_empty() {
        return Err(not_said(&wrong, "for an elevation model, and this is none"));
    }
    let has_place = has_terrain || document.layer.iter().any(|layer| matches!(layer, LayerDoc::City(_)));
    for layer in &mut document.layer {
        match layer {
            LayerDoc::Terrain(terrain) => {
                terrain.source_crs = raster.source_crs.clone();
                (terrain.nodata, terrain.vertical_unit) = (raster.nodata, raster.vertical_unit);
            }
            LayerDoc::City(city) => city.crs = raster.source_crs.clone(),
            _ if !has_place && (raster.source_crs.is_some() || said.crs.is_some()) => {
                let wrong = given_of(said, &["crs", "source_crs"]);
                return Err(not_said(&wrong, "for elevation models and cities, and this is neither"));
            }
            _ => {}
        }
    }
    document.crs = said.crs.clone().unwrap_or_else(|| std::mem::take(&mut document.crs));
    if said.curved_earth {
        document.earth = EarthDoc::Curved;
    }
    Ok(())
}

/// The scene of data that can be drawn without a scene file, seen from the south: elevation models and folders of their tiles, which are one
/// terrain; routes, areas and points on it; cities, footprints of buildings with their streets, meshes, molecules, volumes, and built-in
/// ones. `None` for scene files, for data of other kinds, and for other features without terrain.
///
/// # Errors
/// [`BelvedereError`] of a file that cannot be read.
pub fn scene_of_data(paths: &[PathBuf]) -> Result<Option<SourceDocument>, BelvedereError> {
    let mut roots = Roots::default();
    let (mut tiles, mut layers, mut features) = (Vec::new(), Vec::new(), Vec::new());
    for path in paths {
        let name = path.to_str().ok_or_else(|| BelvedereError::not_utf8(&path.display().to_string()))?;
        // A file that is not there is told by whoever reads it as a scene.
        let Ok(file) = locate(name, &mut roots) else { return Ok(None) };
        let known = match file.strip_prefix("builtin:") {
            Some(_) => None,
            None => Some(Known::of(Path::new(&file), &Arrays::default())?),
        };
        let built_in_ground = ["builtin:massif", "builtin:canyon"].iter().any(|ground| file.starts_with(ground));
        match (known.as_ref().map(|known| known.reader), known) {
            (None, _) if built_in_ground => tiles.push(file),
            (None, _) => layers.push(layer(Path::new(&file), Some(Reader::Mesh), &layers)?),
            (Some(Some(Reader::Terrain)), _) => {
                let of_file = ground_files(&file)?;
                tiles.extend(of_file.iter().map(|tile| locate(tile, &mut roots)).collect::<Result<Vec<_>, _>>()?);
            }
            (Some(Some(Reader::Features)), Some(known)) => features.push(known),
            (Some(None), _) => return Ok(None),
            (Some(reader), _) => layers.push(layer(Path::new(&file), reader, &layers)?),
        }
    }
    if tiles.is_empty() && !features.is_empty() {
        let Some(town) = town(&std::mem::take(&mut features), &layers)? else { return Ok(None) };
        layers.push(town);
    }
    if !tiles.is_empty() {
        layers.insert(0, ground(tiles));
    }
    for known in &features {
        layers.push(features_of(known, &layers)?);
    }
    let mut source = whole(layers, roots.allowed);
    let title = paths.first().map(|path| path.file_name().unwrap_or(path.as_os_str()).to_string_lossy());
    let title = title.unwrap_or_default();
    source.document.title = title.trim_start_matches("builtin:").split(['.', '?']).next().unwrap_or_default().into();
    Ok(Some(source))
}

/// Files of features of which one holds buildings as a city; `None` if none does, or if one cannot be read as a part of a city.
fn town(features: &[Known], others: &[LayerDoc]) -> Result<Option<LayerDoc>, BelvedereError> {
    let buildings =
        |known: &Known| Some(load_city(&known.path, None, &Limits::default()).ok()?.value.city.buildings.len());
    let Some(counts) = features.iter().map(buildings).collect::<Option<Vec<usize>>>() else { return Ok(None) };
    let Some(first) = counts.iter().position(|count| *count > 0) else { return Ok(None) };
    let LayerDoc::City(mut city) = layer(&features[first].path, Some(Reader::City), others)? else { return Ok(None) };
    let names: Option<Vec<String>> = features.iter().map(|known| Some(known.path.to_str()?.to_owned())).collect();
    city.source = Paths::Many(names.unwrap_or_default());
    Ok(Some(LayerDoc::City(city)))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene_file::parse;

    #[test]
    fn features_are_laid_on_the_terrain_that_is_open_and_other_files_are_scenes() {
        let dir = tempfile::tempdir().expect("folder");
        let ground = "format = 1\n[camera]\neye = [0, -900, 4000]\nlook_at = [0, 0, 300]\n\
            [[layer]]\nkind = 'terrain'\nid = 'ground'\nsource = 'builtin:massif?seed=7&size=65'\n";
        let document = parse(Path::new("s.toml"), ground).expect("scene").document;
        let way = dir.path().join("way.geojson");
        let line = r#"{"type":"LineString","coordinates":[[1.50,42.50],[1.51,42.51],[1.52,42.50]]}"#;
        std::fs::write(&way, line).expect("file");
        let open = |paths: &[PathBuf]| open_beside(&document, paths, &[], &Trust::default(), &Progress::silent());
        let Ok(Opened::Layers(layers, folders)) = open(&[way.clone(), way.clone()]) else { panic!("no layers") };
        let ids: Vec<&str> = layers.iter().map(LayerDoc::id).collect();
        assert_eq!((ids, folders.len()), (vec!["way", "way-2"], 2));
        assert!(layers.iter().all(LayerDoc::must_see));
        let scene = dir.path().join("other.toml");
        std::fs::write(&scene, ground).expect("scene");
        assert!(matches!(open(&[scene]), Ok(Opened::Scene(_))));
    }
}
