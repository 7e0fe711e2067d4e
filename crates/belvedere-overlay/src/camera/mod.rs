//! Pictures of the camera in its scene: traced rays, viewpoints, transition planes, the deformation curve.

mod figure;
mod legend;
mod position;
mod rays;
mod spline;
mod subject;
mod turns;

pub use figure::figure;
pub use legend::draw as draw_legend;
pub use subject::CameraPicture;
