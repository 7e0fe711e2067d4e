//! Films: along a route the mover, the bends that follow it, and the ground as a frame draws it; what a camera follows that moves.

mod bends;
mod follow;
pub(crate) mod followed;
mod ground;
mod route;

pub(crate) use bends::FollowingBends;
pub(crate) use follow::{Adjustment, Following};
pub(crate) use ground::DrawnGround;
pub(crate) use route::RouteLine;
