//! The smooth pass: equations (11)-(16) of Deng et al. 2013 in displacements.
//!
//! With u = f' - f the system is `(L^2 + (w^2 + g^2) I + W^T W) u = w^2 u0 + g^2 u_prev + W^T h`. L is the five-point
//! Laplacian with mirrored borders, so without W it is diagonal under the even cosine transform.

mod dct;
mod green;
mod hierarchy;
mod line;
mod smoother;

pub use dct::Dct;
pub use green::Green;
pub use hierarchy::Hierarchy;
pub use line::Real;
pub use smoother::{SmoothError, Smoother, grid_weight, laplacian};
