//! Laws of what follows the surfaces.

mod other_renderer;
