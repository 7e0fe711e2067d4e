//! `check`: contents of a scene.

use crate::scene_file::StageDoc;
use crate::{BelvedereError, Session};
use belvedere_core::Warning;
use belvedere_scene::Bodies;
use schemars::JsonSchema;
use serde::Serialize;

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
