//! Paths of previews: a line layer, the motion of a layer, or a file.

use super::motion;
use crate::BelvedereError;
use belvedere_core::DVec3;
use belvedere_document::paths::Roots;
use belvedere_document::{DocError, DocumentError, SourceDocument};
use belvedere_io::InputFile;
use belvedere_scene::Scene;
use serde::Deserialize;
use std::path::Path;

/// The points of the path that a constructor or a tube names, and the file of the path, if any.
///
/// * `fail`: the error at its key.
pub(super) fn read(
    source: &SourceDocument,
    roots: &Roots,
    scene: &Scene,
    name: &str,
    fail: &dyn Fn(String) -> DocumentError,
) -> Result<(Vec<DVec3>, Option<InputFile>), BelvedereError> {
    if let Some(layer) = scene.layers.iter().find(|l| l.id == name) {
        if let Some(line) = layer.kind.lines() {
            let gap = scene.terrain().map_or(1.0, |t| 20.0 * t.spacing().max_element());
            return Ok((line.longest_chain(gap), None));
        }
        let moves = source.document.layer.iter().find(|l| l.id() == name).and_then(|l| l.motion());
        if let Some(file) = moves {
            let path = roots.resolve(file).map_err(|e| fail(e.to_string()))?;
            let (text, _) = belvedere_document::read_text(&path)?;
            return Ok((motion::parse(&text).map_err(|e| e.in_file(&path))?.path(), None));
        }
        let reason =
            format!("layer \"{name}\" is no line and does not move; name a line layer, a layer with motion, or a file");
        return Err(fail(reason).into());
    }
    let path = roots.resolve(name).map_err(|e| {
        let ids: Vec<&str> = scene.layers.iter().map(|l| l.id.as_str()).collect();
        let hint =
            if ids.is_empty() { String::new() } else { format!("; {}", belvedere_document::suggestion(name, &ids)) };
        fail(format!("\"{name}\" is no layer of the scene, and as a file: {e}{hint}"))
    })?;
    let (text, file) = belvedere_document::read_text(&path)?;
    let points = parse(&path, &text).map_err(|e| e.in_file(&path))?;
    Ok((points, Some(file)))
}

fn parse(path: &Path, text: &str) -> Result<Vec<DVec3>, DocError> {
    let ending = path.extension().and_then(|e| e.to_str()).unwrap_or_default().to_ascii_lowercase();
    let points = match ending.as_str() {
        "json" => cameras(text)?,
        "obj" => rows(text, |line| line.strip_prefix("v ").map(|rest| rest.split_whitespace().collect()))?,
        _ => rows(text, |line| Some(line.split([',', ';', '\t']).map(str::trim).collect()))?,
    };
    if points.len() < 2 {
        return Err(DocError::whole(format!("{} points make no path; give at least 2", points.len())));
    }
    Ok(points)
}

/// The first three numbers of every line for which `cells` returns values; a first line of names is skipped.
fn rows<'t>(text: &'t str, cells: impl Fn(&'t str) -> Option<Vec<&'t str>>) -> Result<Vec<DVec3>, DocError> {
    let mut points = Vec::new();
    for (i, line) in text.lines().enumerate() {
        let line = line.trim();
        let Some(cells) = cells(line).filter(|_| !line.is_empty() && !line.starts_with('#')) else { continue };
        let number = |k: usize| cells.get(k).and_then(|c| c.parse::<f64>().ok()).filter(|v| v.is_finite());
        match (number(0), number(1), number(2)) {
            (Some(x), Some(y), Some(z)) => points.push(DVec3::new(x, y, z)),
            _ if i == 0 => {}
            _ => return Err(DocError::at(i + 1, "x, y, z were expected; give finite numbers")),
        }
    }
    Ok(points)
}

/// A saved camera, whose eye lies on the path.
#[derive(Deserialize)]
struct Saved {
    eye: [f64; 3],
}

fn cameras(text: &str) -> Result<Vec<DVec3>, DocError> {
    let tree = belvedere_document::json_points(text)?;
    let saved: Vec<Saved> = belvedere_document::decode(&tree)?;
    Ok(saved.iter().map(|c| DVec3::from_array(c.eye)).collect())
}
