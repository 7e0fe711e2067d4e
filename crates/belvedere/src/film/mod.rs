//! Films along a route: the mover, the bends that follow it, and the ground as a frame draws it.

mod bends;
mod follow;
mod ground;
mod route;

pub(crate) use bends::FollowingBends;
pub(crate) use follow::{Adjustment, Following};
pub(crate) use ground::DrawnGround;
pub(crate) use route::RouteLine;
