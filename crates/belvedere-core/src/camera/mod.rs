//! The pinhole: its geometry, how one is built, and how it is moved.

mod builder;
mod image_box;
mod navigate;
mod pinhole;

pub use builder::PinholeBuilder;
pub use image_box::ImageBox;
pub use navigate::Navigation;
pub use pinhole::{Pinhole, PinholeError, Projection};
