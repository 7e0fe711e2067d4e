//! Lines, outlines and points, drawn over the surfaces.

use crate::lens::{Lens, Pass};
use crate::shade::color::Packed;
use belvedere_scene::RenderJob;

/// All marks of a frame.
pub(crate) struct Marks {}

impl Marks {
    pub(crate) fn new(_job: &RenderJob<'_>, _passes: &[Pass<'_>], _lens: &Lens, _tol: f64, _depth: &[f32]) -> Self {
        Self {}
    }

    pub(crate) fn draw(&self, _y0: i32, _width: i32, _color: &mut [Packed], _id: &mut [u32]) {}
}
