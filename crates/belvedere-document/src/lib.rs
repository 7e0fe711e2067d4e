//! Scene files: TOML or JSON to a [`Document`], with mistakes named by file, line and nearest valid key.

mod by_property;
pub mod camera;
mod choices;
mod city;
mod common;
mod de;
mod doc_error;
mod document;
mod error;
mod fallback;
mod furniture;
mod ground_moves;
mod intent;
mod json;
pub mod layer_names;
mod layers;
mod mesh;
mod molecule;
mod node;
mod opacity;
pub mod other_kind;
mod overlay;
mod palette;
pub mod paper;
pub mod paths;
pub mod place;
mod points;
mod print;
mod relief;
mod renderer;
pub mod request;
mod rewritten;
mod stages;
mod strip;
mod stylisation;
pub mod sun;
mod symbol;
mod text;
mod toml_tree;
mod tube;
mod unroll;
mod volume;

pub use by_property::{ColorByDoc, ScaleName, SizeByDoc, StepsDoc};
pub use choices::choices;
pub use city::{CityDoc, CityStyleDoc};
pub use common::{Paths, PlaneDoc, TransformDoc};
pub use doc_error::{DocError, suggestion};
pub use document::{CameraDoc, Document, EarthDoc, LightDoc, MapPointDoc, PointDoc, ProjectionDoc, SwitchOrVisibility};
pub use error::{DocumentError, DocumentKind};
pub use fallback::{Fallback, FallbackKind};
pub use furniture::{
    CompassDoc, CompassPlace, Corner, FurnitureDoc, FurnitureItem, FurnitureWish, ScaleDoc, SwitchOrText,
};
pub use ground_moves::{GroundMovesStageDoc, MoveDoc, MoveKindDoc};
pub use intent::{AnimationDoc, CentrelineDoc, ConstructorDoc, ConstructorKind, SweepDoc, TurntableDoc};
pub use layers::{
    AreaDoc, AreaStyleDoc, BoxDoc, BoxStyleDoc, BoxesDoc, LayerDoc, LineDoc, LineStyleDoc, LonLatDoc, PositionDoc,
    RouteDoc, SurfaceDoc, TerrainDoc, TerrainStyleDoc, VerticalUnit,
};
pub use mesh::{MeshDoc, MeshStyleDoc};
pub use molecule::{AllWord, ModelsDoc, MoleculeDoc, MoleculeStyleDoc, PaintDoc};
pub use node::{Node, Value};
pub use overlay::{AutoOrLength, AutoWord, HighlightMark, Inset, OverlayDoc, SwitchOrLength};
pub use palette::{PaletteDoc, PaletteName};
pub use points::{PointLayerDoc, PointStyleDoc};
pub use print::PrintDoc;
pub use relief::{OneOrTwo, ReliefStageDoc};
pub use rewritten::{is_json, rewritten};
pub use stages::{
    AxisDoc, DetailDoc, MergeDoc, PresetsDoc, RaysStageDoc, SolverMode, SplineStageDoc, SplitDoc, StageDoc,
    TerrainStageDoc, TurnDoc, WayDoc,
};
pub use strip::StripStageDoc;
pub use stylisation::{StylisationDoc, SwitchOrStrength};
pub use symbol::SymbolDoc;
pub use text::{HeightUnit, TextDoc};
pub use tube::TubeStageDoc;
pub use unroll::UnrollStageDoc;
pub use volume::VolumeDoc;

use belvedere_core::presets::PresetDocument;
use belvedere_io::InputFile;
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// Largest document, bytes.
pub const MAX_BYTES: u64 = 16 << 20;

/// Where a document was written: its file and the lines of its keys, for messages about what they mean.
#[derive(Debug, Clone, Default)]
pub struct Origin(Option<Arc<(InputFile, Node)>>);

impl Origin {
    /// A document that was made in memory: its mistakes have no line.
    pub const MEMORY: Self = Self(None);

    /// An error at the line of the key that `keys` leads to.
    pub fn error(&self, keys: &[&str], reason: impl std::fmt::Display) -> DocumentError {
        let (path, line) = self.place(keys);
        DocumentError::Scene { path, line, reason: reason.to_string(), key: innermost(keys), source: None }
    }

    /// The same for a refused file, which stays the source of the error.
    pub fn refusal(&self, keys: &[&str], about: &str, refused: DocumentError) -> DocumentError {
        self.caused(keys, format!("{about}{refused}"), refused)
    }

    /// An error at a key, and the error that caused it.
    pub fn caused(&self, keys: &[&str], reason: String, source: DocumentError) -> DocumentError {
        let (path, line) = self.place(keys);
        DocumentError::Scene { path, line, reason, key: innermost(keys), source: Some(Box::new(source)) }
    }

    /// Whether the document was made in memory.
    pub fn is_memory(&self) -> bool {
        self.0.is_none()
    }

    fn place(&self, keys: &[&str]) -> (Option<PathBuf>, Option<usize>) {
        self.0.as_ref().map(|o| (o.0.path.clone(), o.1.line_of(keys))).unzip()
    }
}

/// The last of some keys that is no number of an element.
fn innermost(keys: &[&str]) -> Option<String> {
    keys.iter().rev().find(|key| key.parse::<usize>().is_err()).map(|key| (*key).to_owned())
}

/// A table of a document, such as a stage: makes errors at its keys.
#[derive(Debug, Clone, Copy)]
pub struct Table<'a> {
    /// Of the document.
    pub origin: &'a Origin,
    /// Key of the list that holds it.
    pub list: &'a str,
    /// Place in the list, from 0.
    pub index: usize,
}

impl Table<'_> {
    fn path<T>(&self, keys: &[&str], then: impl FnOnce(&[&str]) -> T) -> T {
        then(&[&[self.list, &self.index.to_string()], keys].concat())
    }

    /// An error at a key of the table.
    pub fn error(&self, keys: &[&str], reason: impl std::fmt::Display) -> DocumentError {
        self.path(keys, |path| self.origin.error(path, reason))
    }

    /// The same for a refused file.
    pub fn refusal(&self, keys: &[&str], refused: DocumentError) -> DocumentError {
        self.path(keys, |path| self.origin.refusal(path, "", refused))
    }
}

/// A document and where it was written.
#[derive(Debug, Clone)]
pub struct SourceDocument {
    /// Where its keys were written.
    pub origin: Origin,
    /// The document.
    pub document: Document,
    /// Folders of the files that it was made of; its camera is to show all of them. `None` for a document that states its camera.
    pub of_files: Option<Vec<PathBuf>>,
}

impl SourceDocument {
    /// A document that was made in memory rather than read.
    pub fn new(document: Document) -> Self {
        Self { origin: Origin::MEMORY, document, of_files: None }
    }

    /// A document of files that the user named, whose camera is found when they are read: it shows all of them.
    pub fn of_files(document: Document, folders: Vec<PathBuf>) -> Self {
        Self { of_files: Some(folders), ..Self::new(document) }
    }

    /// File it came from; `None` if it was made in memory.
    pub fn path(&self) -> Option<&Path> {
        self.input().map(|file| file.path.as_path())
    }

    /// The same with the hash of its text.
    pub fn input(&self) -> Option<&InputFile> {
        self.origin.0.as_ref().map(|o| &o.0)
    }

    /// An error at the line of the key that `keys` leads to.
    pub fn error(&self, keys: &[&str], reason: impl std::fmt::Display) -> DocumentError {
        self.origin.error(keys, reason)
    }
}

/// Reads a scene file; JSON if its name ends in `.json` or its text starts with `{`, else TOML.
///
/// # Errors
/// [`DocumentError::Scene`] with the line of the mistake; [`DocumentError::Io`] if the file cannot be read.
pub fn read(path: &Path) -> Result<SourceDocument, DocumentError> {
    read_with_text(path).map(|(source, _)| source)
}

/// The same, and the text of the file with its byte order mark, if it has one.
pub fn read_with_text(path: &Path) -> Result<(SourceDocument, String), DocumentError> {
    let read = read_raw(path).and_then(|(text, file)| Ok((parse_as(file, plain(&text))?, text)));
    read.map_err(|e| other_kind::explained(path, DocumentKind::Scene, e))
}

/// Parses the text of a scene file; `path` serves messages only.
///
/// # Errors
/// As [`read`].
pub fn parse(path: &Path, text: &str) -> Result<SourceDocument, DocumentError> {
    parse_as(InputFile::of(path, text.as_bytes()), text)
}

fn parse_as(file: InputFile, text: &str) -> Result<SourceDocument, DocumentError> {
    let root = tree(&file.path, text).map_err(|e| e.in_file(&file.path))?;
    let document = document(&root).map_err(|e| e.in_file(&file.path))?;
    Ok(SourceDocument { origin: Origin(Some(Arc::new((file, root)))), ..SourceDocument::new(document) })
}

/// Parses a preset document, TOML or JSON; `path` serves messages only.
///
/// # Errors
/// As [`read`].
pub fn parse_presets(path: &Path, text: &str) -> Result<PresetDocument, DocumentError> {
    let root = tree(path, text).map_err(|e| e.in_file(path))?;
    if root.get("camera").is_some() && root.get("presets").is_none() {
        return Err(DocError::whole("is a scene document, not a preset document").in_file(path));
    }
    de::from_node(&root).map_err(|e| e.in_file(path))
}

/// That there is no built-in preset of a name, and which are near.
pub fn no_preset(name: &str) -> String {
    let names = &belvedere_core::presets::BUILTIN_NAMES;
    format!("there is no built-in preset \"{}\"; {}", doc_error::shorten(name), suggestion(name, names))
}

/// Whether a text means the file of a preset document, not a built-in one.
pub fn names_a_preset_file(name: &str) -> bool {
    let small = name.to_lowercase();
    name.contains(['/', '\\']) || small.ends_with(".toml") || small.ends_with(".json")
}

/// Reads a text file of at most [`MAX_BYTES`].
///
/// # Errors
/// [`DocumentError::Scene`] if it is too large or not UTF-8, [`DocumentError::Io`] if it cannot be read.
pub fn read_text(path: &Path) -> Result<(String, InputFile), DocumentError> {
    read_raw(path).map(|(text, file)| (plain(&text).to_owned(), file))
}

/// A text without its byte order mark.
fn plain(text: &str) -> &str {
    text.strip_prefix('\u{feff}').unwrap_or(text)
}

/// As [`read_text`], with the byte order mark.
fn read_raw(path: &Path) -> Result<(String, InputFile), DocumentError> {
    use std::io::Read;
    let os = |e| belvedere_io::IoError::os(path, e);
    let refuse = |reason: String| DocError::whole(reason).in_file(path);
    let meta = belvedere_io::fs::metadata(path).map_err(os)?;
    if meta.is_dir() {
        return Err(refuse("is a folder; give a file".into()));
    }
    if !meta.is_file() {
        return Err(refuse("is a device or pipe; give a file".into()));
    }
    let too_large = |bytes: u64| {
        refuse(format!(
            "the document has {bytes} bytes, at most {MAX_BYTES} are read; move bulk data into files of their own"
        ))
    };
    if meta.len() > MAX_BYTES {
        return Err(too_large(meta.len()));
    }
    let mut bytes = Vec::new();
    belvedere_io::fs::File::open(path).and_then(|f| f.take(MAX_BYTES + 1).read_to_end(&mut bytes)).map_err(os)?;
    if bytes.len() as u64 > MAX_BYTES {
        return Err(too_large(bytes.len() as u64));
    }
    let file = InputFile::of(path, &bytes);
    let text = String::from_utf8(bytes).map_err(|e| {
        refuse(format!("byte {} is not UTF-8 text; save the document as UTF-8", e.utf8_error().valid_up_to()))
    })?;
    Ok((text, file))
}

/// Parses TOML or JSON into a tree.
pub fn tree(path: &Path, text: &str) -> Result<Node, DocError> {
    let named_json = path.extension().is_some_and(|e| e.eq_ignore_ascii_case("json"));
    let root =
        if named_json || text.trim_start().starts_with('{') { json::parse(text)? } else { toml_tree::parse(text)? };
    root.check_limits()?;
    Ok(root)
}

/// Parses the JSON of a list of points: as many values as the file holds.
pub fn json_points(text: &str) -> Result<Node, DocError> {
    json::parse(text)
}

/// Reads a `T` out of a tree.
pub fn decode<'a, T: serde::Deserialize<'a>>(node: &'a Node) -> Result<T, DocError> {
    de::from_node(node)
}

fn document(root: &Node) -> Result<Document, DocError> {
    if !matches!(root.value, Value::Table(_)) {
        return Err(DocError::at(root.line, format!("a scene document is a table of keys, found {}", root.describe())));
    }
    if root.get("presets").is_some() && root.get("camera").is_none() {
        let reason = "is a preset document, not a scene document; name it as presets of a stage spline_bend";
        return Err(DocError::at(root.line, reason));
    }
    if let Some(version) = root.get("format").filter(|n| matches!(n.value, Value::Int(v) if v != 1)) {
        return Err(DocError::at(
            version.line,
            format!("format is {}, this program reads format 1; use a newer version", version.describe()),
        ));
    }
    let head: document::Head = de::from_node(root)?;
    Ok(Document {
        format: head.format,
        title: head.title,
        crs: head.crs,
        unit: head.unit,
        earth: head.earth,
        camera: head.camera,
        light: head.light,
        overlay: head.overlay,
        furniture: head.furniture,
        stylisation: head.stylisation,
        renderer: head.renderer,
        print: head.print,
        text: head.text,
        representations: head.representations,
        hidden: head.hidden,
        layer: each(root, "layer", layers::LAYER_KINDS, layer)?,
        stage: each(root, "stage", stages::STAGE_KINDS, stage)?,
        constructor: head.constructor,
        animation: head.animation,
    })
}

/// Reads every table of the list `key` by its `kind`.
fn each<T>(
    root: &Node,
    key: &str,
    kinds: &'static [&'static str],
    read: impl Fn(&str, &Node) -> Result<Option<T>, DocError>,
) -> Result<Vec<T>, DocError> {
    let Some(node) = root.get(key).filter(|n| n.value != Value::Null) else { return Ok(Vec::new()) };
    let Some(items) = node.list() else {
        return Err(DocError::at(
            node.line,
            format!("a list of tables ([[{key}]]) was expected, found {}", node.describe()),
        )
        .inside(key));
    };
    items
        .iter()
        .enumerate()
        .map(|(i, item)| one_of(item, kinds, &read).map_err(|e| e.inside(format!("{key} {}", i + 1))))
        .collect()
}

/// The entry of a table whose key is one slip away from the wanted one.
fn misspelt<'n>(table: &'n Node, wanted: &str) -> Option<&'n node::Entry> {
    let Value::Table(entries) = &table.value else { return None };
    entries.iter().find(|e| e.key != "id" && strsim::damerau_levenshtein(&e.key.to_lowercase(), wanted) <= 1)
}

fn one_of<T>(
    item: &Node,
    kinds: &'static [&'static str],
    read: impl Fn(&str, &Node) -> Result<Option<T>, DocError>,
) -> Result<T, DocError> {
    if !matches!(item.value, Value::Table(_)) {
        return Err(DocError::at(item.line, format!("a table was expected, found {}", item.describe())));
    }
    let kind = item.get("kind").ok_or_else(|| match misspelt(item, "kind") {
        Some(entry) => {
            let shown = doc_error::shorten(&entry.key);
            DocError::at(entry.line, format!("unknown key \"{shown}\"; did you mean \"kind\"?"))
        }
        None => DocError::at(item.line, format!("key \"kind\" is missing; give one of: {}", kinds.join(", "))),
    })?;
    let Value::Text(name) = &kind.value else {
        return Err(DocError::at(kind.line, format!("kind: a text was expected, found {}", kind.describe())));
    };
    read(name, &item.without("kind"))?.ok_or_else(|| {
        let shown = doc_error::shorten(name);
        DocError::at(kind.line, format!("\"{shown}\" is not a kind that exists here; {}", suggestion(name, kinds)))
    })
}

fn layer(kind: &str, node: &Node) -> Result<Option<LayerDoc>, DocError> {
    Ok(Some(match kind {
        "terrain" => LayerDoc::Terrain(de::from_node(node)?),
        "line" => LayerDoc::Line(de::from_node(node)?),
        "area" => LayerDoc::Area(de::from_node(node)?),
        "point" => LayerDoc::Point(de::from_node(node)?),
        "boxes" => LayerDoc::Boxes(de::from_node(node)?),
        "mesh" => LayerDoc::Mesh(de::from_node(node)?),
        "city" => LayerDoc::City(de::from_node(node)?),
        "molecule" => LayerDoc::Molecule(de::from_node(node)?),
        "volume" => LayerDoc::Volume(de::from_node(node)?),
        _ => return Ok(None),
    }))
}

fn stage(kind: &str, node: &Node) -> Result<Option<StageDoc>, DocError> {
    Ok(Some(match kind {
        "terrain_disocclusion" => StageDoc::TerrainDisocclusion(de::from_node(node)?),
        "ground_moves" => StageDoc::GroundMoves(de::from_node(node)?),
        "strip" => StageDoc::Strip(de::from_node(node)?),
        "tube" => StageDoc::Tube(de::from_node(node)?),
        "unroll" => StageDoc::Unroll(de::from_node(node)?),
        "relief" => StageDoc::Relief(de::from_node(node)?),
        "spline_bend" => StageDoc::SplineBend(de::from_node(node)?),
        "curved_rays" => StageDoc::CurvedRays(de::from_node(node)?),
        _ => return Ok(None),
    }))
}
