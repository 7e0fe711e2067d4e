//! Pictures of the camera itself, on its scene: rays as they really run, viewpoints, transition planes, the deformation curve.

mod figure;
mod legend;
mod position;
mod rays;
mod spline;
mod subject;
mod turns;

pub(crate) use figure::figure;
pub(crate) use legend::draw as draw_legend;
pub use subject::CameraPicture;
