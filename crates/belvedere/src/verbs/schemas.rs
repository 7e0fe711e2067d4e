//! Contents of the answers of verbs, and a JSON Schema for each verb, made from the types.

use super::check::CheckReport;
use super::disocclude::DisoccludeDocument;
use super::generalise::GeneraliseDocument;
use super::info::{FileInfo, MachineInfo};
use super::measure::MeasureReport;
use super::pack::Packed;
use super::points::{DisplaceReport, ProjectReport, RaysReport};
use super::preset::{Listed, PresetCheck};
use super::reveal::Draft;
use super::reveal::answer::{RevealDocument, TargetDocument};

use crate::answers::{Answer, Warned, Written};
use crate::export::ExportReport;
use crate::fallback::FallbackRecord;
use crate::pick::PickReport;
use crate::picture::DisplacementReport;
use crate::scene_file::Document;
use crate::trust::Trusted;
use crate::{BelvedereError, output};
use belvedere_core::Warning;
use belvedere_core::presets::PresetDocument;
use schemars::generate::SchemaSettings;
use schemars::{JsonSchema, Schema, SchemaGenerator};
use serde::Serialize;
use serde_json::{Value, json};
use std::collections::BTreeSet;
use std::path::{Path, PathBuf};

/// Content of `render`.
#[derive(Debug, Clone, JsonSchema, Serialize)]
pub struct Rendered {
    /// Displacement of the points in the picture; null for a straight picture.
    pub displacement: Option<DisplacementReport>,
    /// Wall time of drawing, milliseconds.
    pub render_ms: f64,
    /// Report of the fallback; null if none was asked for.
    pub fallback: Option<FallbackRecord>,
    /// Warnings.
    pub warnings: Vec<Warning>,
}

/// Content of `animate`.
#[derive(Debug, Clone, JsonSchema, Serialize)]
pub struct Animated {
    /// Number of frames.
    pub frames: usize,
    /// Number of frames that were drawn by this run.
    pub drawn: usize,
    /// Frames per second.
    pub fps: f64,
    /// Warnings.
    pub warnings: Vec<Warning>,
}

/// Content of `reveal --drafts`.
#[derive(Debug, Clone, JsonSchema, Serialize)]
pub struct Drafts {
    /// The drafts, that of `reveal` first.
    pub drafts: Vec<DraftWithCommand>,
    /// Warnings.
    pub warnings: Vec<Warning>,
}

/// A draft and how it is drawn.
#[derive(Debug, Clone, JsonSchema, Serialize)]
pub struct DraftWithCommand {
    /// The draft.
    #[serde(flatten)]
    pub draft: Draft,
    /// The command that draws it.
    pub command: String,
}

/// Content of `info`.
#[derive(Debug, Clone, JsonSchema, Serialize)]
pub struct Informed {
    /// This machine, with `--adapters`.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub machine: Option<MachineInfo>,
    /// The files, in the order in which they were named.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub files: Vec<FileAnswer>,
}

/// Description of a file, or why there is none.
#[derive(Debug, Clone, JsonSchema, Serialize)]
#[serde(untagged)]
pub enum FileAnswer {
    /// The description.
    Described(Box<FileInfo>),
    /// The reason.
    Failed(FailedFile),
}

/// A file that cannot be described.
#[derive(Debug, Clone, JsonSchema, Serialize)]
pub struct FailedFile {
    /// Always `error`.
    kind: Failure,
    /// The file.
    pub path: String,
    /// The reason, one sentence.
    pub error: String,
}

/// Kind of a file that cannot be described.
#[derive(Debug, Clone, Copy, JsonSchema, Serialize)]
#[serde(rename_all = "snake_case")]
enum Failure {
    /// It cannot be described.
    Error,
}

impl FailedFile {
    /// The answer about a file.
    pub fn new(path: &Path, error: String) -> Self {
        Self { kind: Failure::Error, path: path.display().to_string(), error }
    }
}

/// Content of `preset list`.
#[derive(Debug, Clone, JsonSchema, Serialize)]
pub struct Presets {
    /// The built-in documents.
    pub presets: Vec<Listed>,
}

/// Content of `trust`.
#[derive(Debug, Clone, JsonSchema, Serialize)]
pub struct TrustAnswer {
    /// File of the record.
    pub record: PathBuf,
    /// Files that the scene may read from now on.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub files: Option<Vec<PathBuf>>,
    /// Number of scenes that were forgotten.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub forgotten: Option<usize>,
    /// The scenes and their files, with `--list`.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub scenes: Option<Vec<Trusted>>,
}

/// One of the shapes that an answer may have.
pub type Shape = fn(&mut SchemaGenerator) -> Schema;

/// The shape of a type.
pub fn shape<T: JsonSchema>() -> Shape {
    |generator| generator.subschema_for::<T>()
}

/// Verbs of the library that answer in JSON, in alphabetical order.
pub const VERBS: [&str; 21] = [
    "animate",
    "check",
    "completions",
    "demo",
    "disocclude",
    "displace",
    "export",
    "figures",
    "generalise",
    "info",
    "man",
    "measure",
    "pack",
    "pick",
    "preset",
    "project",
    "rays",
    "render",
    "reveal",
    "show",
    "trust",
];

/// The shapes of the answers of a verb; `None` for one that does not answer in JSON.
fn shapes(verb: &str) -> Option<Vec<Shape>> {
    Some(match verb {
        "animate" => vec![shape::<Answer<Animated>>()],
        "check" => vec![shape::<Answer<CheckReport>>()],
        "completions" | "demo" | "figures" | "man" => vec![shape::<Answer<Written>>()],
        "disocclude" => vec![shape::<Answer<DisoccludeDocument<'static>>>()],
        "displace" => vec![shape::<Answer<Warned<DisplaceReport>>>()],
        "export" => vec![shape::<Answer<ExportReport>>()],
        "generalise" => vec![shape::<Answer<GeneraliseDocument<'static>>>()],
        "info" => vec![shape::<Answer<Informed>>()],
        "measure" => vec![shape::<Answer<MeasureReport>>()],
        "pack" => vec![shape::<Answer<Warned<Packed>>>()],
        "pick" => vec![shape::<Answer<Warned<PickReport>>>()],
        "preset" => vec![
            shape::<Answer<Presets>>(),
            shape::<Answer<PresetCheck>>(),
            shape::<Answer<Written>>(),
            shape::<PresetDocument>(),
        ],
        "project" => vec![shape::<Answer<Warned<ProjectReport>>>()],
        "rays" => vec![shape::<Answer<Warned<RaysReport>>>()],
        "render" => vec![shape::<Answer<Rendered>>()],
        "reveal" => vec![
            shape::<Answer<RevealDocument<'static>>>(),
            shape::<Answer<TargetDocument<'static>>>(),
            shape::<Answer<Drafts>>(),
        ],
        "show" => vec![shape::<Answer<Written>>(), shape::<Document>()],
        "trust" => vec![shape::<Answer<TrustAnswer>>()],
        _ => return None,
    })
}

/// The JSON Schema of the answers of a verb; `None` for one that does not answer in JSON.
///
/// # Errors
/// [`BelvedereError::Text`], which does not occur.
pub fn schema(verb: &str) -> Option<Result<String, BelvedereError>> {
    shapes(verb).map(|shapes| schema_of(verb, &shapes))
}

/// The JSON Schema of answers that have one of `shapes`.
///
/// # Errors
/// [`BelvedereError::Text`], which does not occur.
pub fn schema_of(verb: &str, shapes: &[Shape]) -> Result<String, BelvedereError> {
    let mut generator = SchemaSettings::draft2020_12().for_serialize().into_generator();
    let shapes: Vec<Schema> = shapes.iter().map(|shape| shape(&mut generator)).collect();
    let mut definitions = generator.take_definitions(true);
    for (name, definition) in &mut definitions {
        // A key that two flattened types name stands there twice, which the meta-schema forbids.
        if let Some(required) = definition.get_mut("required").and_then(Value::as_array_mut) {
            let mut known = BTreeSet::new();
            required.retain(|key| known.insert(key.to_string()));
        }
        if name.starts_with("Answer")
            && let Some(property) = definition.pointer_mut("/properties/verb").and_then(Value::as_object_mut)
        {
            property.insert("const".into(), verb.into());
        }
    }
    output::pretty(&json!({
        "$schema": "https://json-schema.org/draft/2020-12/schema",
        "title": format!("belvedere {verb} --json"),
        "anyOf": shapes,
        "$defs": definitions,
    }))
}
