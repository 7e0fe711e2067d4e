//! The scene: a flat list of layers in one coordinate system.

use crate::{Heightfield, Layer, LayerKind};
use belvedere_core::Aabb;

/// Unit of all lengths of a scene.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
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

/// What is looked at. Plain data, independent of any view.
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
}

impl Scene {
    /// The first terrain layer's heightfield.
    pub fn terrain(&self) -> Option<&Heightfield> {
        self.layers.iter().find_map(|l| match &l.kind {
            LayerKind::Terrain(t) => Some(&*t.heightfield),
            _ => None,
        })
    }

    /// Layers that must be seen, with their indices.
    pub fn must_see(&self) -> impl Iterator<Item = (usize, &Layer)> {
        self.layers.iter().enumerate().filter(|(_, l)| l.must_see)
    }

    /// Smallest box around everything; [`Aabb::EMPTY`] for an empty scene.
    pub fn bounds(&self) -> Aabb {
        self.layers.iter().fold(Aabb::EMPTY, |b, l| b.union(l.bounds()))
    }
}
