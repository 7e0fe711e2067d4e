//! The smooth pass: equations (11)-(16) of Deng et al. 2013 in displacements.
//!
//! With u = f' - f the system is `(L^2 + (w^2 + g^2) I + W^T W) u = w^2 u0 + g^2 u_prev + W^T h`. L is the five-point
//! Laplacian with mirrored borders, so without W it is diagonal under the even cosine transform.

#[cfg(feature = "sparse")]
mod cholesky;
mod conjugate;
mod cosine;
mod elevation;
mod green;
mod hierarchy;
mod pass;
mod smoother;
mod temporal;

#[cfg(feature = "sparse")]
pub use cholesky::Cholesky;
pub use conjugate::{ConjugateGradients, Convergence};
pub use elevation::{ElevationRows, row_weight};
pub use green::{Between, Green};
pub use hierarchy::Hierarchy;
pub use pass::{SmoothPass, Smoothed};
pub use smoother::{SmoothError, Smoother, grid_weight, laplacian};
pub use temporal::temporal_weight;
