//! Contents of layers by kind.

use crate::{
    AreaLayer, BoxLayer, LayerKind, LineLayer, MeshLayer, MoleculeLayer, OwnLayer, PointLayer, TerrainLayer,
    VolumeLayer,
};

/// The content of one kind, to be read and to be changed; and a layer of it.
macro_rules! kinds {
    ($($kind:ident($content:ty) = $read:ident, $change:ident;)+) => {
        impl LayerKind {
            $(
                /// The content if the layer is of this kind.
                pub fn $read(&self) -> Option<&$content> {
                    if let Self::$kind(content) = self { Some(content) } else { None }
                }

                /// The same, to be changed.
                pub fn $change(&mut self) -> Option<&mut $content> {
                    if let Self::$kind(content) = self { Some(content) } else { None }
                }
            )+
        }
    };
}

kinds! {
    Terrain(TerrainLayer) = terrain, terrain_mut;
    Boxes(BoxLayer) = boxes, boxes_mut;
    Molecule(MoleculeLayer) = molecule, molecule_mut;
    Volume(VolumeLayer) = volume, volume_mut;
    Line(LineLayer) = lines, lines_mut;
    Area(AreaLayer) = areas, areas_mut;
    Point(PointLayer) = points, points_mut;
}

impl LayerKind {
    /// The triangles of a mesh, or of a kind of one's own.
    pub fn mesh(&self) -> Option<&MeshLayer> {
        match self {
            Self::Mesh(mesh) | Self::Own(OwnLayer { surface: mesh, .. }) => Some(mesh),
            _ => None,
        }
    }

    /// The same, to be changed.
    pub fn mesh_mut(&mut self) -> Option<&mut MeshLayer> {
        match self {
            Self::Mesh(mesh) | Self::Own(OwnLayer { surface: mesh, .. }) => Some(mesh),
            _ => None,
        }
    }

    /// The word for the kind, as scene files and records have it.
    pub fn name(&self) -> &'static str {
        match self {
            Self::Terrain(_) => "terrain",
            Self::Boxes(_) => "boxes",
            Self::Mesh(_) => "mesh",
            Self::Molecule(_) => "molecule",
            Self::Volume(_) => "volume",
            Self::Line(_) => "line",
            Self::Area(_) => "area",
            Self::Point(_) => "point",
            Self::Own(own) => own.content.kind(),
        }
    }

    /// How many things the layer holds: nodes, boxes, triangles, atoms, samples or features.
    pub fn count(&self) -> usize {
        match self {
            Self::Terrain(terrain) => terrain.heightfield.heights().len(),
            Self::Boxes(boxes) => boxes.boxes.len(),
            Self::Mesh(mesh) => mesh.mesh.triangles().len(),
            Self::Molecule(molecule) => molecule.atoms,
            Self::Volume(volume) => volume.volume.values().len(),
            Self::Line(lines) => lines.features.len(),
            Self::Area(areas) => areas.features.len(),
            Self::Point(points) => points.features.len(),
            Self::Own(own) => own.content.count().unwrap_or(own.surface.mesh.triangles().len()),
        }
    }
}

macro_rules! into_kind {
    ($($kind:ident($content:ty);)+) => {
        $(
            impl From<$content> for LayerKind {
                fn from(content: $content) -> Self {
                    Self::$kind(content.into())
                }
            }
        )+
    };
}

into_kind! {
    Terrain(TerrainLayer);
    Boxes(BoxLayer);
    Mesh(MeshLayer);
    Molecule(MoleculeLayer);
    Volume(VolumeLayer);
    Line(LineLayer);
    Area(AreaLayer);
    Point(PointLayer);
    Own(OwnLayer);
}
