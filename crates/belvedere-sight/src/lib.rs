//! Ground as it is drawn, and lines of sight over it.

mod ground;
mod mesh_tree;
mod obstacles;

pub use ground::{Ground, Lift};
pub use mesh_tree::MeshTree;
pub use obstacles::{Obstacles, SightOptions};
