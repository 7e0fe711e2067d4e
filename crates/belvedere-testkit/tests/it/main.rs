//! Checks of the workspace itself: which crate imports which, that documents name existing items, that files stay small.

mod circles;
mod dependencies;
mod layering;
mod links;
mod papers;
mod prose;
mod publishing;
mod sources;
