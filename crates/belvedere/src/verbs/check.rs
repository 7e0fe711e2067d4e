//! `check`: contents of a scene, and a valid one in place of one whose rays are not.

use crate::scene_file::{SourceDocument, StageDoc};
use crate::{BelvedereError, OpenOptions, Session, camera_path, output, scene_file};
use belvedere_core::Warning;
use belvedere_resolve::rays::mended;
use belvedere_scene::Bodies;
use schemars::JsonSchema;
use serde::Serialize;
use std::path::{Path, PathBuf};

/// Answer of [`check`].
#[derive(Debug, Clone, JsonSchema, Serialize)]
pub struct CheckReport {
    /// The scene file.
    pub scene: String,
    /// Coordinate system.
    pub crs: String,
    /// One line per layer.
    pub layers: Vec<CheckedLayer>,
    /// Stages in order of application.
    pub stages: Vec<&'static str>,
    /// Warnings.
    pub warnings: Vec<Warning>,
}

/// A scene whose camera was made valid.
#[derive(Debug, Clone)]
pub struct Mended {
    /// The scene, opened.
    pub session: Session,
    /// Its text.
    pub text: String,
    /// What was wrong, in words; empty for a scene that was valid.
    pub wrong: Vec<String>,
}

/// One checked layer.
#[derive(Debug, Clone, JsonSchema, Serialize)]
pub struct CheckedLayer {
    /// Id.
    pub id: String,
    /// Kind.
    pub kind: &'static str,
    /// Nodes of a terrain, triangles of a mesh, drawn atoms of a molecule, features of the others.
    pub count: usize,
    /// Whether it must be seen.
    pub must_see: bool,
    /// Whether bends carry its parts as rigid bodies.
    #[serde(skip_serializing_if = "std::ops::Not::not")]
    pub rigid: bool,
}

impl std::fmt::Display for CheckReport {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        writeln!(f, "{}: valid, {}, {} layers, {} stages", self.scene, self.crs, self.layers.len(), self.stages.len())?;
        for layer in &self.layers {
            let must = if layer.must_see { ", must be seen" } else { "" };
            let rigid = if layer.rigid { ", rigid" } else { "" };
            writeln!(f, "  {} ({}): {}{must}{rigid}", layer.id, layer.kind, layer.count)?;
        }
        self.stages.iter().try_for_each(|stage| writeln!(f, "  stage {stage}"))
    }
}

/// Contents of an opened scene; opening it is the check.
///
/// # Errors
/// [`BelvedereError`] if the scene can be opened but not drawn.
pub fn check(session: &Session) -> Result<CheckReport, BelvedereError> {
    session.check_drawable()?;
    camera_path::check(session)?;
    let layers = session.scene().layers.iter().map(|layer| {
        let (kind, count) = (layer.kind.name(), layer.kind.count());
        let rigid = Bodies::of(&layer.kind).is_some();
        CheckedLayer { id: layer.id.clone(), kind, count, must_see: layer.must_see, rigid }
    });
    Ok(CheckReport {
        scene: session.name(),
        crs: session.scene().crs.to_string(),
        layers: layers.collect(),
        stages: stages(session),
        warnings: session.warnings(),
    })
}

/// A scene whose curved rays are made valid where they are not: the nearest valid values that errors name are set. Everything else stays
/// as it is written, where `out` lies beside the scene file.
///
/// * `out`: the file that is to hold the text.
///
/// # Errors
/// Those of opening the scene that are no matter of its curved rays, and the first of these where no valid camera is found.
pub fn mend(source: SourceDocument, options: &OpenOptions, out: &Path) -> Result<Mended, BelvedereError> {
    let mut document = source.document.clone();
    let is_rays = |stage: &StageDoc| matches!(stage, StageDoc::CurvedRays(_));
    let mut wrong = Vec::new();
    if document.stage.iter().any(is_rays) {
        let mut straight = source.clone();
        straight.document.stage.retain(|stage| !is_rays(stage));
        let root = Session::from_document(straight, options)?.view().pinhole().clone();
        for stage in &mut document.stage {
            let StageDoc::CurvedRays(rays) = stage else { continue };
            let Some(made) = mended(&root, rays) else { continue };
            if !made.wrong.is_empty() {
                (*rays, document.camera.near) = (made.stage, made.near);
                wrong.extend(made.wrong);
            }
        }
    }
    let (path, written) = (source.path().map(Path::to_owned), source.document.clone());
    let session = Session::from_document(SourceDocument { document: document.clone(), ..source }, options)?;
    let is_beside = path.as_deref().is_some_and(|path| folder(path) == folder(out));
    let text = path.filter(|_| is_beside).and_then(|path| scene_file::read_text(&path).ok()).map(|(text, _)| text);
    let is_json = out.extension().is_some_and(|e| e.eq_ignore_ascii_case("json"));
    let kept = text.filter(|text| scene_file::is_json(text) == is_json).and_then(|text| match document == written {
        true => Some(text),
        false => scene_file::rewritten(&text, &document),
    });
    let text = match (kept, session.resolved_for(out)) {
        (Some(text), _) => text,
        (None, Some(made)) if is_json => output::document_json(&made)?,
        (None, Some(made)) => output::document_toml(&made)?,
        (None, None) => output::document_toml(&document)?,
    };
    Ok(Mended { session, text, wrong })
}

/// The folder of a file.
fn folder(path: &Path) -> Option<PathBuf> {
    let parent = path.parent().filter(|p| !p.as_os_str().is_empty()).unwrap_or(Path::new("."));
    belvedere_io::fs::canonicalize(parent).ok()
}

/// Names of the stages, including those that are not solved yet.
fn stages(session: &Session) -> Vec<&'static str> {
    let mut names = session.stage_names();
    let stages = session.resolved().map(|document| document.stage.as_slice()).unwrap_or_default();
    let intent = stages.iter().find(|s| s.is_terrain_intent()).map(StageDoc::kind);
    if let Some(kind) = intent.filter(|kind| !names.contains(kind)) {
        names.insert(usize::from(names.first() == Some(&"earth")), kind);
    }
    names
}

/// A report as indented `key: value` lines for people.
pub fn plain(value: &serde_json::Value) -> String {
    let mut text = String::new();
    plain_into(value, 0, &mut text);
    text
}

fn plain_into(value: &serde_json::Value, depth: usize, text: &mut String) {
    let indent = "  ".repeat(depth);
    let simple = |v: &serde_json::Value| match v {
        serde_json::Value::Object(_) => false,
        serde_json::Value::Array(items) => items.iter().all(|i| !i.is_object() && !i.is_array() && !i.is_string()),
        _ => true,
    };
    let word = |v: &serde_json::Value| v.as_str().map_or_else(|| v.to_string(), str::to_owned);
    match value {
        serde_json::Value::Object(entries) => {
            for (key, v) in entries.iter().filter(|(k, _)| !matches!(k.as_str(), "verb" | "outputs")) {
                if simple(v) {
                    *text += &format!("{indent}{key}: {}\n", word(v));
                } else {
                    *text += &format!("{indent}{key}:\n");
                    plain_into(v, depth + 1, text);
                }
            }
        }
        serde_json::Value::Array(items) => {
            for (i, item) in items.iter().enumerate() {
                if i > 0 && item.is_object() {
                    text.push('\n');
                }
                plain_into(item, depth, text);
            }
        }
        other => *text += &format!("{indent}{}\n", word(other)),
    }
}
