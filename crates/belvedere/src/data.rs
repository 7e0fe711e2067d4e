//! Terrain and features straight from their files, without a scene file.

mod classes;
mod ids;
mod tiles;

pub use tiles::without_terrain;

use crate::record::{AreaRecord, InputFile};
use crate::scene_file::paths::{Roots, folder_of};
use crate::scene_file::request::Stated;
use crate::scene_file::{
    AreaDoc, AreaStyleDoc, CameraDoc, Document, EarthDoc, FurnitureDoc, LayerDoc, LightDoc, LineDoc, LineStyleDoc,
    Origin, PaletteDoc, Paths, PointLayerDoc, PointStyleDoc, SourceDocument, StageDoc, SurfaceDoc, TerrainDoc,
    TerrainStyleDoc, TextDoc,
};
use crate::session::{Description, Loaded};
use crate::{BelvedereError, OpenOptions, Session};
use belvedere_core::View;
use belvedere_core::{Warning, WarningKind};
use belvedere_io::Vectors;
use belvedere_io::arrays::{self, Arrays};
use belvedere_io::terrain::OriginalTerrain;
use belvedere_io::{Known, join_table, split_table};
use belvedere_overlay::notes::LayerNotes;
use belvedere_resolve::vectors::{self, FeatureKind, kind_of, kinds_of};
use belvedere_resolve::{self, LayerRequest};
use belvedere_scene::{Hidden, Layer, Light, LineClass, Scene, Unit};
use std::collections::BTreeMap;
use std::mem::take;
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// Largest hole that is filled, as a share of the ground: heights made up for a larger one would be arbitrary.
pub const LARGEST_HOLE: f64 = 0.03;

/// Id and name of the layer of the points of a file that also has lines.
const WAYPOINTS: &str = "Waypoints";

/// Files of a terrain and of features on it; any of them may be an array, `array:NAME` of [`OpenOptions::arrays`].
#[derive(Debug, Clone, Default)]
pub struct DataFiles {
    /// Terrain: a file, a folder of tiles, or `builtin:massif?seed=7`.
    pub dem: String,
    /// Routes, areas or points: files, or `builtin:massif?seed=7`. Elevation models among them are further tiles of the terrain.
    pub features: Vec<String>,
    /// Whether only the first file of features must be seen, and later ones are context: drawn, whatever of them is seen. Else all must be
    /// seen.
    pub first_is_subject: bool,
    /// Rivers that must not run uphill where the ground moves: files with lines.
    pub rivers: Vec<String>,
    /// Coordinate system of the scene; automatic if left out.
    pub crs: Option<String>,
    /// Leaves holes of the terrain open; else those of at most [`LARGEST_HOLE`] are filled.
    pub keep_voids: bool,
    /// Fills larger holes too.
    pub fill_all_voids: bool,
    /// Georeferenced pictures laid over the ground, later ones on top.
    pub drape: Vec<String>,
    /// Whether names of features are written.
    pub labels: bool,
    /// What happens to hidden parts of features; by default lines are dashed, outlines cut, points faint.
    pub hidden: Option<Hidden>,
    /// Tint of the terrain by height.
    pub palette: PaletteDoc,
    /// Draws the sea like other ground.
    pub no_sea: bool,
    /// Surface that areas are drawn as; automatic if left out.
    pub area_style: Option<SurfaceDoc>,
    /// What the lines of files are, as `FILE=CLASS`; automatic for others.
    pub line_class: Vec<String>,
    /// What the files do not say.
    pub stated: Stated,
}

/// Contents of the files.
pub(crate) struct Data {
    pub(crate) scene: Arc<Scene>,
    pub(crate) warnings: Vec<Warning>,
    /// Unchanged samples of the terrain's file, if they are to be kept.
    pub(crate) original: Option<OriginalTerrain>,
    /// Ids of the layers of rivers.
    pub(crate) rivers: Vec<String>,
    areas: Vec<AreaRecord>,
    notes: LayerNotes,
    inputs: Vec<InputFile>,
    layers: Vec<LayerDoc>,
    names: BTreeMap<String, String>,
    text: Option<TextDoc>,
    roots: Roots,
    arrays: Arrays,
}

impl DataFiles {
    /// Reads the files, each once.
    pub(crate) fn load(&self, keep_original: bool, options: &OpenOptions) -> Result<Data, BelvedereError> {
        let Layers { mut layers, known, rivers, context, names, mut roots } = self.layers(options)?;
        let crs = self.crs.as_deref().unwrap_or("auto");
        let mut options = OpenOptions { area_style: self.area_style.or(options.area_style), ..options.clone() };
        let text = text_of(take(&mut options.fonts), &mut roots.files)?;
        let request = LayerRequest {
            vectors: known,
            keep_original,
            text: text.as_ref(),
            ..LayerRequest::new(&Origin::MEMORY, &layers, crs, &roots)
        };
        let loaded = belvedere_resolve::load(request, &options)?;
        let (inputs, mut warnings, areas, original) = (loaded.inputs, loaded.warnings, loaded.areas, loaded.original);
        warnings.extend(of_context(&context));
        let notes = loaded.notes;
        let scene = Scene {
            title: title_of(&loaded.layers),
            crs: loaded.crs,
            layers: loaded.layers,
            fonts: loaded.fonts,
            drawings: loaded.drawings,
            ..Scene::default()
        };
        belvedere_resolve::fill_surfaces(&mut layers, &scene);
        let arrays = options.arrays;
        Ok(Data {
            scene: Arc::new(scene),
            warnings,
            original,
            rivers,
            areas,
            notes,
            inputs,
            layers,
            names,
            text,
            roots,
            arrays,
        })
    }
}

/// The layers of files.
struct Layers {
    layers: Vec<LayerDoc>,
    /// Features that were read to tell their kinds.
    known: BTreeMap<PathBuf, belvedere_io::Loaded<Vectors>>,
    /// Ids of rivers.
    rivers: Vec<String>,
    /// Names of files of features that are context.
    context: Vec<String>,
    /// Names in the legend of layers whose features do not tell them.
    names: BTreeMap<String, String>,
    roots: Roots,
}

impl DataFiles {
    fn layers(&self, options: &OpenOptions) -> Result<Layers, BelvedereError> {
        let mut roots = Roots::default();
        let classes = classes::of(&self.line_class, &self.features)?;
        let tiles = tiles::of(&self.dem, &self.features)?;
        let ground = self.ground(&tiles.ground, options, &mut roots)?;
        if tiles.features.is_empty() {
            return Err(tiles::without_features(&self.dem, &self.features));
        }
        let (known, rivers, context, names) = Default::default();
        let mut out = Layers { layers: vec![ground], known, rivers, context, names, roots };
        for (i, name) in tiles.features.iter().enumerate() {
            let source = locate(name, &mut out.roots)?;
            let is_builtin = source.starts_with("builtin:");
            let is_context = i > 0 && self.first_is_subject;
            out.context.extend(is_context.then(|| shown_name(name)));
            let kinds = if is_builtin { vec![FeatureKind::Lines] } else { out.kinds(&source, &options.arrays)? };
            let has_lines = kinds.contains(&FeatureKind::Lines);
            for kind in kinds {
                let waypoints = has_lines && kind == FeatureKind::Points;
                let id = match waypoints {
                    true => ids::free(WAYPOINTS, &out.layers),
                    false => ids::of_file(&source, kind, &out.layers),
                };
                if waypoints {
                    out.names.insert(id.clone(), WAYPOINTS.into());
                }
                let mut layer = feature_layer(id, Paths::One(source.clone()), kind);
                if let (LayerDoc::Line(line), Some(class)) = (&mut layer, classes.get(name)) {
                    line.style.class = Some(*class);
                }
                self.describe(&mut layer, is_builtin);
                layer.set_must_see(!is_context);
                out.layers.push(layer);
            }
        }
        for (i, name) in self.rivers.iter().enumerate() {
            let source = locate(name, &mut out.roots)?;
            if !out.kinds(&source, &options.arrays)?.contains(&FeatureKind::Lines) {
                return Err(belvedere_io::IoError::format(Path::new(name), "holds no lines; rivers are lines").into());
            }
            let id = format!("rivers{}", i + 1);
            out.layers.push(LayerDoc::Line(river_layer(id.clone(), Paths::One(source))));
            out.rivers.push(id);
        }
        Ok(out)
    }

    /// The layer of elevation models.
    fn ground(&self, tiles: &[String], options: &OpenOptions, roots: &mut Roots) -> Result<LayerDoc, BelvedereError> {
        let mut located =
            |names: &[String]| names.iter().map(|name| locate(name, roots)).collect::<Result<Vec<_>, _>>();
        let (source, drape) = (located(tiles)?, located(&self.drape)?);
        Ok(LayerDoc::Terrain(TerrainDoc {
            id: "ground".into(),
            source: tiles::paths(source),
            fill_voids: !self.keep_voids,
            largest_hole: (!self.keep_voids && !self.fill_all_voids).then_some(LARGEST_HOLE),
            source_crs: self.stated.raster.source_crs.clone(),
            nodata: self.stated.raster.nodata,
            vertical_unit: self.stated.raster.vertical_unit,
            land_cover: options.land_cover.as_ref().map(|name| locate(name, roots)).transpose()?.map(Paths::One),
            drape: (!drape.is_empty()).then(|| tiles::paths(drape)),
            style: TerrainStyleDoc {
                palette: self.palette.located(&mut roots.allowed)?,
                sea: !self.no_sea,
                materials: options.materials.unwrap_or(true),
                contours: options.contours,
                edge: options.edge.unwrap_or_default(),
                ..TerrainStyleDoc::default()
            },
        }))
    }

    /// Puts what is asked of all features into the layer of some.
    fn describe(&self, layer: &mut LayerDoc, is_builtin: bool) {
        if let LayerDoc::Line(LineDoc { name_field, .. })
        | LayerDoc::Area(AreaDoc { name_field, .. })
        | LayerDoc::Point(PointLayerDoc { name_field, .. }) = layer
            && !is_builtin
        {
            name_field.clone_from(&self.stated.name_field);
        }
        if self.labels {
            write_names(layer);
        }
        if let Some(hidden) = self.hidden {
            draw_hidden(layer, hidden);
        }
    }
}

impl Layers {
    /// Kinds of the features of a file or array, which is read.
    fn kinds(&mut self, source: &str, arrays: &Arrays) -> Result<Vec<FeatureKind>, BelvedereError> {
        let read = vectors::read(Path::new(source), arrays)?;
        let kinds = kinds_of(&read.value);
        self.known.insert(PathBuf::from(source), read);
        Ok(kinds)
    }
}

impl Data {
    /// A session of the data in a view, which camera and stages describe.
    pub(crate) fn session(self, view: View, camera: CameraDoc, stage: Vec<StageDoc>, earth: EarthDoc) -> Session {
        // The light of a found view is chosen with it, and from then on fixed to the map.
        let azimuth = Light::azimuth_at_upper_left(view.pinhole()).filter(|_| self.scene.terrain().is_some());
        let light = Light { azimuth: azimuth.unwrap_or(Light::default().azimuth), ..Light::default() };
        let document = Document {
            format: 1,
            title: self.scene.title.clone(),
            crs: self.scene.crs.to_string(),
            unit: Unit::Metre,
            earth,
            camera,
            overlay: None,
            furniture: (!self.names.is_empty()).then(|| FurnitureDoc { names: self.names, ..FurnitureDoc::default() }),
            stylisation: None,
            renderer: None,
            print: None,
            text: self.text,
            light: azimuth.map(LightDoc::from_azimuth),
            representations: Default::default(),
            hidden: Vec::new(),
            layer: self.layers,
            stage,
            constructor: None,
            animation: None,
        };
        let (source, resolved) = (SourceDocument::new(document.clone()), document);
        let Self { scene, areas, notes, inputs, warnings, roots, arrays, .. } = self;
        let loaded = Loaded { scene, motions: None, areas, notes, inputs, arrays, warnings };
        Session::of_view(loaded, view, Description { source, resolved, roots }).with_light(light)
    }
}

/// A file as a message names it: by its name alone.
fn shown_name(name: &str) -> String {
    Path::new(name).file_name().map_or_else(|| name.to_owned(), |file| file.to_string_lossy().into_owned())
}

/// What is said of files of context; their names are told while they are few.
fn of_context(files: &[String]) -> Option<Warning> {
    let named = match files {
        [] => return None,
        [one] => format!("{one} is"),
        [first, second] => format!("{first} and {second} are"),
        _ => format!("{} and {} later files are", files[0], files.len() - 1),
    };
    let text = format!(
        "{named} context: drawn, but the view is chosen, and visibility measured, for the first file of features alone; give what must \
         be seen first"
    );
    Some(Warning::new(WarningKind::Assumed, text).with("files", files.len() as f64))
}

/// The name of what must be seen: of its lines, if it has any, for waypoints belong to them; empty if it has several, or none.
fn title_of(layers: &[Layer]) -> String {
    let subject = |lines: bool| layers.iter().filter(move |l| l.must_see && (!lines || l.kind.lines().is_some()));
    let names: Vec<Option<&str>> =
        subject(subject(true).next().is_some()).map(|layer| layer.kind.only_name()).collect();
    let only = names.first().copied().flatten().filter(|first| names.iter().all(|name| *name == Some(first)));
    only.unwrap_or_default().to_owned()
}

/// Fonts that the user named, as a scene states them; the scene may then read their files.
pub(crate) fn text_of(fonts: Vec<PathBuf>, allowed: &mut Vec<PathBuf>) -> Result<Option<TextDoc>, BelvedereError> {
    let mut names = Vec::new();
    for font in &fonts {
        let real = belvedere_io::fs::canonicalize(font).map_err(|e| belvedere_io::IoError::os(font, e))?;
        let name = real.to_str().ok_or_else(|| BelvedereError::not_utf8(&font.display().to_string()))?;
        names.push(name.to_owned());
        allowed.push(real);
    }
    Ok((!names.is_empty()).then(|| TextDoc { fonts: Some(tiles::paths(names)), ..TextDoc::default() }))
}

/// The absolute path of a file that the user named, whose folder is then allowed; names of built-in scenes and arrays stay.
pub(crate) fn locate(name: &str, roots: &mut Roots) -> Result<String, BelvedereError> {
    if name.starts_with("builtin:") || arrays::is_name(name) {
        return Ok(name.to_owned());
    }
    let (file, table) = split_table(Path::new(name));
    let real = belvedere_io::fs::canonicalize(file).map_err(|e| belvedere_io::IoError::os(file, e))?;
    let shelf = belvedere_io::fs::shelf(&real);
    // A store of hashes keeps neighbours apart: they are found by the name that the link gives the file.
    let named = file.file_name().filter(|_| real.parent() != Some(&shelf)).map(|name| folder_of(file).join(name));
    roots.allowed.push(shelf);
    roots.allowed.extend(named.as_deref().and_then(Path::parent).map(Path::to_owned));
    let path = join_table(named.unwrap_or(real), table);
    path.to_str().map(str::to_owned).ok_or_else(|| BelvedereError::not_utf8(name))
}

/// The elevation models of a terrain: its file, or those of its folder.
pub(crate) fn ground_files(dem: &str) -> Result<Vec<String>, BelvedereError> {
    Ok(tiles::of(dem, &[])?.ground)
}

/// A layer of the features of a file or array, with an id from its name.
pub(crate) fn features_of(known: &Known, others: &[LayerDoc]) -> Result<LayerDoc, BelvedereError> {
    let (kind, path) = (kind_of(known.features()?), &known.path);
    let name = path.to_str().ok_or_else(|| BelvedereError::not_utf8(&path.display().to_string()))?;
    let id = ids::of_file(name, kind, others);
    Ok(feature_layer(id, Paths::One(name.to_owned()), kind))
}

/// A layer of rivers: drawn, but not a required feature.
fn river_layer(id: String, source: Paths) -> LineDoc {
    let style = LineStyleDoc { class: Some(LineClass::River), ..LineStyleDoc::default() };
    LineDoc { id, source: Some(source), select: None, route: None, name_field: None, must_see: false, style }
}

fn write_names(layer: &mut LayerDoc) {
    match layer {
        LayerDoc::Line(line) => line.style.labels = true,
        LayerDoc::Area(area) => area.style.labels = true,
        LayerDoc::Point(point) => point.style.labels = true,
        _ => {}
    }
}

fn draw_hidden(layer: &mut LayerDoc, hidden: Hidden) {
    match layer {
        LayerDoc::Line(line) => line.style.hidden = hidden,
        LayerDoc::Area(area) => area.style.hidden = hidden,
        LayerDoc::Point(point) => point.style.hidden = hidden,
        _ => {}
    }
}

fn feature_layer(id: String, source: Paths, kind: FeatureKind) -> LayerDoc {
    let (must_see, name_field) = (true, None);
    match kind {
        FeatureKind::Lines => LayerDoc::Line(LineDoc {
            id,
            source: Some(source),
            select: None,
            route: None,
            name_field,
            must_see,
            style: LineStyleDoc::default(),
        }),
        FeatureKind::Areas => {
            LayerDoc::Area(AreaDoc { id, source, name_field, must_see, style: AreaStyleDoc::default() })
        }
        FeatureKind::Points => {
            LayerDoc::Point(PointLayerDoc { id, source, name_field, must_see, style: PointStyleDoc::default() })
        }
    }
}
