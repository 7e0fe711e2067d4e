//! Motions of layers: rows of a CSV file.

use crate::BelvedereError;
use belvedere_core::DVec3;
use belvedere_document::paths::Roots;
use belvedere_document::{DocError, SourceDocument};
use belvedere_io::InputFile;
use belvedere_scene::{Layer, LayerKind, Motion, Placement, Scene};
use std::sync::Arc;

/// The moving layers of a scene, and the scene with each of them at its own origin.
#[derive(Debug, Clone)]
pub struct Motions {
    rest: Arc<Scene>,
    /// Index and motion of each layer.
    layers: Vec<(usize, Motion)>,
    /// Layers whose atoms have models of a film, by index, and the end of each, seconds.
    films: Vec<(usize, f64)>,
}

impl Motions {
    /// Reads the motions that a document names; `None` if there are none.
    pub fn read(
        source: &SourceDocument,
        roots: &Roots,
        scene: &Arc<Scene>,
        inputs: &mut Vec<InputFile>,
    ) -> Result<Option<Self>, BelvedereError> {
        let mut layers = Vec::new();
        for (i, layer) in source.document.layer.iter().enumerate() {
            // A layer that is not loaded has no motion.
            let Some(index) = scene.layers.iter().position(|l| l.id == layer.id()) else { continue };
            let Some(name) = layer.motion() else { continue };
            let about = format!("layer \"{}\": ", layer.id());
            let path = roots
                .resolve(name)
                .map_err(|e| source.origin.refusal(&["layer", &i.to_string(), "motion"], &about, e))?;
            let (text, file) = belvedere_document::read_text(&path)?;
            layers.push((index, parse(&text).map_err(|e| e.in_file(&path))?));
            inputs.push(file);
        }
        let film = |(index, layer): (usize, &Layer)| match &layer.kind {
            LayerKind::Molecule(molecule) => Some((index, molecule.film.as_ref()?.end())),
            _ => None,
        };
        let films: Vec<(usize, f64)> = scene.layers.iter().enumerate().filter_map(film).collect();
        let any = !layers.is_empty() || !films.is_empty();
        Ok(any.then(|| Self { rest: Arc::clone(scene), layers, films }))
    }

    /// The scene at a time, seconds.
    pub fn at(&self, t: f64) -> Scene {
        let mut scene = (*self.rest).clone();
        for (index, _) in &self.films {
            // A model that cannot be drawn leaves the first.
            if let LayerKind::Molecule(molecule) = &self.rest.layers[*index].kind
                && let Some(Ok(made)) = molecule.at(t)
            {
                scene.layers[*index].kind = LayerKind::Molecule(Box::new(made));
            }
        }
        for (index, motion) in &self.layers {
            if let Some(kind) = scene.layers[*index].kind.placed(&motion.at(t)) {
                scene.layers[*index].kind = kind;
            }
        }
        scene
    }

    /// The middle of a layer at a time, seconds, scene coordinates: of a molecule that of the atoms that must be seen, or else of all.
    /// `None` without a layer of that id, or if it holds nothing.
    pub fn middle(&self, id: &str, t: f64) -> Option<DVec3> {
        let index = self.rest.layers.iter().position(|layer| layer.id == id)?;
        let layer = &self.rest.layers[index];
        let bounds = layer.bounds();
        let resting = match &layer.kind {
            LayerKind::Molecule(molecule) => molecule.middle(t)?,
            _ if bounds.is_empty() => return None,
            _ => bounds.center(),
        };
        let motion = self.layers.iter().find(|(moved, _)| *moved == index);
        Some(motion.map_or(resting, |(_, motion)| motion.at(t).apply(resting)))
    }

    /// Ids of the layers that move.
    pub fn moving(&self) -> Vec<&str> {
        let indices = self.layers.iter().map(|(index, _)| *index).chain(self.films.iter().map(|(index, _)| *index));
        indices.map(|index| self.rest.layers[index].id.as_str()).collect()
    }

    /// Time at which the last layer comes to rest, seconds.
    pub fn end(&self) -> f64 {
        let films = self.films.iter().map(|(_, end)| *end);
        self.layers.iter().map(|(_, motion)| motion.end()).chain(films).fold(0.0, f64::max)
    }
}

/// `t,x,y,z[,yaw_deg]`; a first line of names and lines that begin with # are skipped.
pub(super) fn parse(text: &str) -> Result<Motion, DocError> {
    let (mut keys, mut lines) = (Vec::new(), Vec::new());
    for (i, row) in text.lines().enumerate() {
        let cells: Vec<&str> = row.split([',', ';', '\t']).map(str::trim).collect();
        let is_head = keys.is_empty() && cells[0].parse::<f64>().is_err();
        if row.trim().is_empty() || row.starts_with('#') || (is_head && i == 0) {
            continue;
        }
        let number = |k: usize| cells.get(k).and_then(|c| c.parse::<f64>().ok()).filter(|v| v.is_finite());
        let yaw = if cells.get(4).is_none_or(|c| c.is_empty()) { Some(0.0) } else { number(4) };
        let (Some(t), Some(x), Some(y), Some(z), Some(yaw), true) =
            (number(0), number(1), number(2), number(3), yaw, cells.len() <= 5)
        else {
            return Err(DocError::at(i + 1, "t,x,y,z[,yaw_deg] was expected; give finite numbers"));
        };
        keys.push((t, Placement { translate: DVec3::new(x, y, z), yaw: yaw.to_radians() }));
        lines.push(i + 1);
    }
    Motion::new(keys).map_err(|e| {
        let row = match &e {
            belvedere_scene::MotionError::Order { row, .. } => *row,
            _ => 1,
        };
        DocError::at(lines.get(row - 1).copied().unwrap_or(1), e.to_string())
    })
}
