//! Renderers without a GPU: a threaded, deterministic rasteriser for bent views, and an exact one that follows the curved ray of every sample
//! ([`belvedere_sight::trace`]).
//!
//! A frame of the rasteriser, step by step:
//!
//! 1. `geometry`: surfaces are cut into blocks. Blocks that the image does not show are left out, by the bounds of their
//!    *displaced* boxes; distant ground takes less detail where the error stays below a fraction of a pixel.
//! 2. The vertices of the remaining blocks are displaced and projected once. Edges that the bend would visibly curve are split; triangles that
//!    leave the domain are clipped.
//! 3. `raster`: bands of image rows are drawn independently, the nearest primitive at every sample. No order of drawing and no
//!    number of threads changes a byte.
//! 4. `shade`: samples become colours. The light on the ground is fixed to the map and remembered (`cache`) from frame to frame.
//! 5. `see_through`: solids that something shines through are drawn into samples of their own, which become a veil over the picture.
//! 6. `volume`: light that rays gather in voxels, up to the surfaces, is laid over them.
//! 7. [`belvedere_composite`]: stylisation, then lines, outlines, points and names, then the veil, by lines of sight through the surfaces themselves
//!    ([`belvedere_composite::traced_marks`]).
//!
//! Where styling sections show layers in part, samples choose by thresholds, and exposures of a band are averaged. Where rays part,
//! every branch is drawn so and the pictures are put together along the seams.

mod cache;
mod exact;
mod frame;
mod geometry;
mod level_rows;
mod over_ground;
mod raster;
mod rasteriser;
mod resolve;
mod rows;
mod screen;
mod see_through;
mod shade;
mod simd;
mod surfaces;
mod traced_veil;
mod volume;

pub use exact::ExactRenderer;
pub use geometry::project::GroundImage;
pub use rasteriser::CpuRenderer;
