//! Ground as it is drawn, and lines of sight over it.

mod boxes;
mod clip;
mod ground;
mod line;
mod mesh_tree;
mod obstacles;
mod pyramid;

pub use boxes::{BoxTree, UprightBox};
pub use clip::clip_segment;
pub use ground::{Ground, Lift};
pub use line::GridLine;
pub use mesh_tree::MeshTree;
pub use obstacles::{Obstacles, SightOptions};
pub use pyramid::Pyramid;
