//! The scene: a flat list of layers in one coordinate system.

use crate::{
    Color, Drawing, FontFile, Heightfield, Layer, LayerKind, LineFeature, LineLayer, Representation, TerrainLayer,
    drape_polyline,
};
use belvedere_core::{Aabb, DVec2};
use serde::{Deserialize, Serialize};
use std::sync::Arc;

/// Unit of all lengths of a scene.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "snake_case")]
pub enum Unit {
    /// Metres.
    #[default]
    Metre,
    /// Angstrom, for molecules.
    Angstrom,
    /// Voxel edges, for volumes.
    Voxel,
}

/// Coordinate reference system of a scene.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Crs {
    /// No georeference.
    #[default]
    Local,
    /// A projected system in metres by its EPSG code.
    Epsg(u32),
}

impl std::fmt::Display for Crs {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::Local => write!(f, "local"),
            Self::Epsg(code) => write!(f, "EPSG:{code}"),
        }
    }
}

/// A scene: plain data, independent of any view.
#[derive(Debug, Clone, Default)]
pub struct Scene {
    /// Title for pictures and reports.
    pub title: String,
    /// Coordinate system of every coordinate in the scene.
    pub crs: Crs,
    /// Unit of length.
    pub unit: Unit,
    /// Layers, in file order. The id buffer of a [`crate::Frame`] holds `1 + index` into this list.
    pub layers: Vec<Layer>,
    /// Alternative sets of layers, of which styling sections choose; empty = every layer is shown everywhere.
    pub representations: Vec<Representation>,
    /// Fonts of names whose letters the embedded font lacks, in the order in which letters are looked for.
    pub fonts: Vec<FontFile>,
    /// Symbols of its own, by the number of [`crate::Symbol::Own`].
    pub drawings: Vec<Arc<Drawing>>,
}

impl Scene {
    /// This scene with another layer, whose features are not required.
    pub fn with_layer(mut self, id: impl Into<String>, kind: impl Into<LayerKind>) -> Self {
        self.layers.push(Layer { id: id.into(), must_see: false, kind: kind.into() });
        self
    }

    /// This scene with ground in the usual style.
    pub fn with_terrain(self, id: impl Into<String>, heightfield: impl Into<Arc<Heightfield>>) -> Self {
        self.with_layer(id, TerrainLayer::new(heightfield))
    }

    /// This scene with a line that must be seen, in the usual style: laid on the terrain, or at height 0 in a scene without
    /// terrain.
    pub fn with_line(mut self, id: impl Into<String>, line: &[DVec2]) -> Self {
        let parts = match self.terrain() {
            Some(terrain) => drape_polyline(terrain, line).parts,
            None => vec![line.iter().map(|p| p.extend(0.0)).collect()],
        };
        let features =
            parts.into_iter().map(|points| LineFeature { style: None, name: String::new(), points }).collect();
        let kind = LayerKind::Line(LineLayer::new(features, Color::rgb(215, 48, 31)));
        self.layers.push(Layer { id: id.into(), must_see: true, kind });
        self
    }

    /// Whether something shines through any layer, see [`LayerKind::is_see_through`].
    pub fn has_see_through(&self) -> bool {
        self.layers.iter().any(|layer| layer.kind.is_see_through())
    }

    /// Whether something is painted on ground that was drawn: lines of equal height.
    pub fn paints_over_ground(&self) -> bool {
        self.layers.iter().any(|layer| layer.kind.terrain().is_some_and(|t| t.contours.is_some()))
    }

    /// The first terrain layer's heightfield.
    pub fn terrain(&self) -> Option<&Heightfield> {
        self.layers.iter().find_map(|l| l.kind.terrain().map(|t| &*t.heightfield))
    }

    /// Layers that must be seen, with their indices.
    pub fn must_see(&self) -> impl Iterator<Item = (usize, &Layer)> {
        self.layers.iter().enumerate().filter(|(_, l)| l.must_see)
    }

    /// Smallest box around everything; [`Aabb::EMPTY`] for an empty scene.
    pub fn bounds(&self) -> Aabb {
        self.layers.iter().fold(Aabb::EMPTY, |b, l| b.union(l.bounds()))
    }

    /// For each layer the numbers, in `ids`, of the representations that show it, as bits; all bits for layers of no representation.
    ///
    /// An id that is no representation of the scene stands for the first one, so that presets without sections of their own show one
    /// representation and not all on top of each other.
    pub fn shown_by(&self, ids: &[&str]) -> Vec<u32> {
        let known = |id: &str| self.representations.iter().find(|r| r.id == id).or(self.representations.first());
        let layers = self.layers.iter().map(|layer| {
            let holds = |r: &Representation| r.layers.contains(&layer.id);
            if !self.representations.iter().any(holds) {
                return u32::MAX;
            }
            let bit = |(i, id): (usize, &&str)| known(id).is_some_and(holds).then_some(1 << i);
            ids.iter().enumerate().take(u32::BITS as usize).filter_map(bit).fold(0, |all, bit: u32| all | bit)
        });
        layers.collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::BoxLayer;

    #[test]
    fn layers_are_shown_by_their_representations_and_common_ones_by_all() {
        let of = |id: &str, layers: &[&str]| Representation {
            id: id.into(),
            layers: layers.iter().map(|l| (*l).to_owned()).collect(),
        };
        let layer = |scene: Scene, id: &str| scene.with_layer(id, BoxLayer::default());
        let scene = ["ground", "houses", "blocks", "church"].into_iter().fold(Scene::default(), layer);
        let representations = vec![of("loa0", &["houses", "church"]), of("loa1", &["blocks", "church"])];
        let scene = Scene { representations, ..scene };
        assert_eq!(scene.shown_by(&["loa1", "loa0"]), [u32::MAX, 0b10, 0b01, 0b11]);
        // An id that the scene does not know stands for the first representation.
        assert_eq!(scene.shown_by(&["all"]), [u32::MAX, 0b1, 0b0, 0b1]);
        assert_eq!(Scene { representations: vec![], ..scene }.shown_by(&["all"]), [u32::MAX; 4]);
    }
}
