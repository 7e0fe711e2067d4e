//! Ground as it is drawn, lines of sight over it, passes over a view ([`pass`]), and the exact tracer of curved rays through surfaces
//! ([`trace`]) and volumes ([`volume`]): what is seen where, asked by everything that draws, measures or picks.

mod beam;
mod boxes;
mod carried;
mod clip;
mod crossings;
mod displaced;
mod fast;
mod field;
mod ground;
mod light_buffer;
mod line;
mod mesh_tree;
mod obstacles;
mod openness;
pub mod pass;
mod pyramid;
mod rigid;
pub mod screen;
pub mod sections;
mod shadow;
mod solids;
mod summits;
pub mod trace;
pub mod volume;
mod voxels;

pub use boxes::{BoxTree, UprightBox};
pub use carried::{Carried, CarriedLayer};
pub use clip::clip_segment;
pub use crossings::{AT_NODE, SightLine, SightSample, guard_tau, sight_samples};
pub use displaced::{DisplacedGround, Excess, SightVertex};
pub use fast::Fast;
pub use field::{Field, FieldError};
pub use ground::{Ground, Lift};
pub use light_buffer::{Blocker, Found, LightBuffer};
pub use line::{Edge, EdgeFamily, GridLine, floor};
pub use mesh_tree::{MeshTree, TreeMemory};
pub use obstacles::{Obstacles, SightOptions};
pub use openness::{GroundHeight, Occluded, OpennessSettings, with_ambient_occlusion};
pub use pyramid::Pyramid;
pub use rigid::{RigidLayers, refusal};
pub use shadow::Bundle;
pub use solids::{LayerPart, Solids};
pub use summits::{Standing, most_prominent, standings};
pub use voxels::Voxels;
