//! Checks of the workspace itself: who imports whom, that documents name what exists, that files stay small.

mod circles;
mod dependencies;
mod layering;
mod papers;
mod sources;
