//! The scene: terrain, lines, areas, points, boxes, meshes, molecules and cities as plain data, independent of any view;
//! and the interface between renderers and their callers ([`Renderer`], [`RenderJob`], [`Frame`]).

pub mod bodies;
mod boxes;
pub mod cell;
mod chain;
pub mod city;
pub mod climate;
pub mod color;
pub mod drape;
mod font_file;
pub mod frame;
pub mod heightfield;
mod kinds;
pub mod land_cover;
pub mod layer;
pub mod light;
mod line_class;
pub mod mark;
mod materials;
pub mod mesh;
pub mod molecule;
pub mod motion;
pub mod overlay;
pub mod own;
pub mod placed_name;
pub mod placement;
pub mod progress;
pub mod ramp;
pub mod representation;
pub mod rigid_parts;
pub mod scene;
pub mod sea;
pub mod texture;
pub mod volume;

pub use bodies::Bodies;
pub use boxes::{BoxLayer, BoxShape};
pub use cell::CellTriangle;
pub use city::{
    Building, City, CityArea, CityFace, FacePicture, HeightSource, LandCover, Polygon, Structure, StructureKind,
    Surface, Way, WayClass,
};
pub use climate::Climate;
pub use color::Color;
pub use drape::{Draped, drape_polyline};
pub use font_file::FontFile;
pub use frame::{
    Aux, Compositing, Frame, FrameStats, PictureRows, PixelGrid, ROWS, RenderError, RenderJob, RenderOptions, Renderer,
    Stylisation,
};
pub use heightfield::{Heightfield, HeightfieldError, NodeState, States};
pub use land_cover::{Cover, CoverMap};
pub use layer::{
    AreaFeature, AreaLayer, AreaSurface, Contours, Drape, Edge, Layer, LayerKind, LineFeature, LineLayer, Palette,
    PaletteName, PointFeature, PointLayer, Relief, Shading, TerrainLayer,
};
pub use light::{Haze, Light, Sky};
pub use line_class::{LineClass, LineLook};
pub use mark::{DistanceMarkers, Drawing, FeatureStyle, Hidden, PlaceKind, PointStyle, Symbol, WrittenHeight};
pub use mesh::{Mesh, MeshColors, MeshError, MeshLayer, triangle_lattice};
pub use molecule::{Molecule, MoleculeLayer, MoleculeStyle};
pub use motion::{Motion, MotionError};
pub use overlay::{Overlay, OverlayFace, OverlayLine, OverlayPoint, SMALL_LETTERS_PX};
pub use own::{LayerContent, OwnLayer};
pub use placed_name::{NameAnchor, NameId, NamePlace, NameSide, PlacedName};
pub use placement::Placement;
pub use progress::{Cancelled, Progress};
pub use ramp::{Ramp, RampHeight, RampStop};
pub use representation::Representation;
pub use rigid_parts::RigidParts;
pub use scene::{Crs, Scene, Unit};
pub use sea::Sea;
pub use texture::{Texture, Texturing, Wrap};
pub use volume::{
    Bricks, TransferError, TransferFunction, TransferPoint, Volume, VolumeError, VolumeLayer, VolumeModel, VoxelValues,
};
pub use web_time::Instant;
