//! Colours of samples.

mod cast;
pub(crate) mod footprint;
pub(crate) mod ground;
pub(crate) mod key_light;
mod mesh;
mod mix;
mod molecule;
pub(crate) mod overlay;
mod paint;
mod painted;
pub(crate) mod pixel_center;
pub(crate) mod relief;
mod sky;
mod traced;

use crate::geometry::block::{Block, DrawnTriangle};
use crate::geometry::blocks::Blocks;
use crate::geometry::grid::CELL_TRIANGLES;
use crate::geometry::lod::DecimatedHeights;
use crate::raster::band::SKY;
use crate::raster::cells::SIDE;
use crate::screen::{SUB, Screen};
use crate::shade::pixel_center::PixelCenters;
use crate::simd::nearest;
use belvedere_composite::color::{Rgb, linear, smoothstep};
use belvedere_composite::stylise::Face;
use belvedere_core::{DVec2, DVec3};
use belvedere_scene::{AreaSurface, BoxLayer, BoxShape, Heightfield, LayerKind, OwnLayer, Relief, RenderJob};
use belvedere_sight::sections::Sections;
use cast::Casters;
use glam::Vec3A;
pub(crate) use ground::terrain::LightCache;
use ground::terrain::{TerrainShade, finer_levels};
use ground::{broad, surface, tiles};
use key_light::KeyShadows;
use overlay::area::AreaMap;
pub(crate) use painted::{Painted, Samples};
use relief::ReliefLight;
use sky::Sky;
use std::sync::Arc;

/// Data for colouring, prepared once per frame.
pub(crate) struct Shader<'a> {
    pub(crate) sky: Sky,
    screen: &'a Screen,
    blocks: &'a Blocks,
    layers: Vec<LayerShade<'a>>,
    areas: Vec<AreaMap>,
    casters: Option<Casters<'a>>,
    sections: Option<Sections<'a>>,
    /// The only layer with surfaces, if that is terrain.
    only_terrain: bool,
}

enum LayerShade<'a> {
    Terrain(Box<TerrainShade<'a>>),
    Boxes(&'a BoxLayer, ReliefLight),
    Mesh(mesh::MeshShade<'a>),
    Molecule(molecule::MoleculeShade<'a>),
    Other,
}

/// A sample of the picture: primitive, nearness, and fixed-point position on the image.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Sample {
    pub(crate) prim: u32,
    pub(crate) at: [i32; 2],
}

/// Colour, id and world point of a sample.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Shaded {
    pub(crate) color: Rgb,
    /// 0 = sky, else 1 + layer.
    pub(crate) id: u32,
    /// True position, scene coordinates; NaN in the sky.
    pub(crate) world: DVec3,
}

/// Bytes for colouring a ground, beside its heights: averages, decimated heights, lifted heights of this and the last frame, shadows,
/// and both pictures of the lit ground.
pub(crate) fn ground_bytes(job: &RenderJob<'_>, hf: &Heightfield) -> u64 {
    let nodes = hf.heights().len() as u64;
    let lifted = job.view.stages().iter().any(|s| s.moves_ground());
    let shadows = nodes * 4 / 3;
    let pixels = job.view.pinhole().image.map(u64::from).iter().product();
    let lit = 2 * tiles::most_bytes([hf.cols(), hf.rows()], finer_levels(hf), pixels);
    let means = surface::means_bytes(nodes) + broad::bytes(nodes);
    // Lifted ground takes its tint from the averages of the map.
    means + DecimatedHeights::bytes(nodes) + shadows + lit + if lifted { 8 * nodes + means } else { 0 }
}

impl<'a> Shader<'a> {
    pub(crate) fn new(job: &RenderJob<'a>, screen: &'a Screen, blocks: &'a Blocks, cache: &LightCache) -> Self {
        let key_shadows = KeyShadows::of(job).map(Arc::new);
        let layers: Vec<_> = job
            .scene
            .layers
            .iter()
            .enumerate()
            .map(|(i, l)| match &l.kind {
                LayerKind::Terrain(t) => LayerShade::Terrain(Box::new(TerrainShade::new((i, t), job, cache))),
                LayerKind::Boxes(b) => LayerShade::Boxes(b, ReliefLight::new(Relief::Sun, job.light)),
                LayerKind::Mesh(m) | LayerKind::Own(OwnLayer { surface: m, .. }) => {
                    LayerShade::Mesh(mesh::MeshShade::new(m, job.light))
                }
                LayerKind::Molecule(m) => {
                    LayerShade::Molecule(molecule::MoleculeShade::new(&m.surface, job.view, key_shadows.clone()))
                }
                _ => LayerShade::Other,
            })
            .collect();
        let areas = job
            .scene
            .layers
            .iter()
            .enumerate()
            .filter_map(|(i, l)| l.kind.areas().and_then(|a| AreaMap::new(i as u32, a, &cache.areas)));
        // The sea is drawn below all other areas.
        let mut areas: Vec<AreaMap> = areas.collect();
        areas.sort_by_key(|a| a.surface != AreaSurface::Sea);
        let mut surfaces = layers.iter().filter(|l| !matches!(l, LayerShade::Other));
        let only_terrain = matches!((surfaces.next(), surfaces.next()), (Some(LayerShade::Terrain(_)), None));
        let sections = Sections::new(job);
        let casts = |layer: usize| sections.as_ref().is_none_or(|s| s.casts(layer));
        Self {
            sky: Sky::of(job.scene, job.light, job.view.pinhole()),
            screen,
            blocks,
            areas,
            casters: Casters::new(job.scene, job.light, &casts, screen.width as usize * screen.height as usize),
            sections,
            layers,
            only_terrain,
        }
    }

    /// Whether the only layer with surfaces is terrain.
    #[inline(always)]
    pub(crate) fn only_terrain(&self) -> bool {
        self.only_terrain
    }

    /// Whether both primitives (not sky) belong to one terrain layer, whose colours change smoothly.
    #[inline]
    pub(crate) fn is_terrain(&self, a: u32, b: u32) -> bool {
        self.only_terrain || {
            let layer = self.blocks.layer_of(a);
            layer == self.blocks.layer_of(b)
                && layer.is_some_and(|l| matches!(self.layers[l as usize], LayerShade::Terrain(_)))
        }
    }

    /// Point and depth of the surface at a pixel's centre by the true map, see [`PixelCenters::exact`].
    pub(crate) fn exact_point(
        &self,
        centers: &PixelCenters<'_>,
        prim: u32,
        near: DVec3,
        x: i32,
        y: i32,
    ) -> Option<(DVec3, f32)> {
        let found = if prim == SKY { None } else { self.blocks.find(prim) };
        centers.exact(&found?, near, DVec2::new(f64::from(x) + 0.5, f64::from(y) + 0.5))
    }

    /// World point that a sample sees, scene coordinates; NaN in the sky.
    pub(crate) fn world(&self, sample: Sample) -> DVec3 {
        let found = if sample.prim == SKY { None } else { self.blocks.find(sample.prim) };
        let Some(found) = found else { return DVec3::NAN };
        let hit = SurfacePoint::new(&found, self.screen, sample.at);
        match &self.layers[found.block.layer as usize] {
            LayerShade::Terrain(t) => hit.on_ground(&found, t.hf),
            LayerShade::Boxes(b, _) => hit.on_box(&found, b).1,
            LayerShade::Mesh(m) => m.place(&found, hit.weights),
            LayerShade::Molecule(m) => m.place(&found, hit.weights),
            LayerShade::Other => DVec3::NAN,
        }
    }
}

impl Shader<'_> {
    /// Face of a primitive of a solid, with its normal towards the eye; the default for others.
    pub(crate) fn face(&self, prim: u32) -> Face {
        let found = if prim == SKY { None } else { self.blocks.find(prim) };
        let Some(found) = found else { return Face::default() };
        let parent = found.parent as usize;
        let normal = match &self.layers[found.block.layer as usize] {
            LayerShade::Boxes(b, _) => {
                b.boxes.get(found.block.origin[0] + parent / 12).map(|s| s.normal_of(parent % 12))
            }
            LayerShade::Mesh(m) => Some(m.face_normal(found.block.origin[0] + parent)),
            _ => None,
        };
        let front = mesh::is_front(&found);
        normal.map_or_else(Face::default, |n| Face::solid(if front { n } else { -n }))
    }

    /// Share of the sun's disc visible from a surface, 1 without cast shadows.
    /// * `layer`: layer of the surface; `n`: unit normal to the visible side; `footprint`: size of a pixel there, scene units.
    fn sun_on(&self, layer: usize, p: DVec3, n: DVec3, footprint: f64) -> f32 {
        self.casters.as_ref().map_or(1.0, |c| c.on_surface(p, n, footprint, &|other| self.throws(other, layer, p)))
    }

    /// Whether a layer casts shadows on another at a point.
    fn throws(&self, layer: usize, onto: usize, p: DVec3) -> bool {
        self.sections.as_ref().is_none_or(|s| s.throws(layer, onto, p))
    }

    /// Colour of boxes, like an architect's model: matt, darker towards the foot, with drawn edges.
    /// * `n`: outward unit normal of the face; `footprint`: size of a pixel at the box, scene units.
    fn box_color(
        &self,
        layer: usize,
        shape: &BoxShape,
        light: &ReliefLight,
        n: DVec3,
        world: DVec3,
        footprint: f64,
    ) -> Rgb {
        let centre = shape.base + DVec3::Z * 0.5 * shape.size.z;
        let up = (((world.z - shape.base.z) / shape.size.z.max(1e-9)) as f32).clamp(0.0, 1.0);
        let open = 0.60 + 0.40 * smoothstep(-0.1, 0.6, up);
        let sun = self.sun_on(layer, world, n, footprint);
        let n = Vec3A::new(n.x as f32, n.y as f32, n.z as f32);
        let c = shape.color;
        let ink = 1.0 - 0.42 * edge_share(shape, world - centre, footprint);
        let lit = light.at(n, open, sun) * 0.82 + around(n, open);
        linear([c.r, c.g, c.b]) * lit * ((0.76 + 0.24 * open) * ink)
    }
}

/// How much more light from around upright faces get: walls away from the sun are shades, not black.
const WALLS: f32 = 1.3;

/// Light that streets and walls return, which open ground does not.
/// * `n`: unit normal; `open`: share of the surroundings that is not blocked.
fn around(n: Vec3A, open: f32) -> Rgb {
    Rgb::new(0.19, 0.18, 0.18) * (open * (1.0 + WALLS * (1.0 - n.z.abs())))
}

/// Pixel of a fixed-point position.
fn pixel_of([x, y]: [i32; 2]) -> [f32; 2] {
    [x as f32 / SUB as f32, y as f32 / SUB as f32]
}

/// Level of averages for a pixel that covers `cells` cells: 128 log2(cells), 256 steps to a level, 0 up to one cell.
#[inline(always)]
fn lod(cells: f32) -> u32 {
    let bits = cells.max(1.0).to_bits();
    let (exponent, mantissa) = ((bits >> 23) as f32 - 127.0, f32::from_bits((bits & 0x7f_ffff) | 0x3f80_0000));
    // The parabola through log2 at 1, the root of 2, and 2: within 0.009.
    let log2 = exponent + (mantissa - 1.0) * (1.707_103 - 0.353_551_5 * mantissa);
    nearest(128.0 * log2) as u32
}

/// Position of a sample inside the parent triangle.
struct SurfacePoint {
    /// Weights of the parent's vertices.
    weights: [f64; 3],
}

impl SurfacePoint {
    fn new(found: &DrawnTriangle<'_>, screen: &Screen, [xs, ys]: [i32; 2]) -> Self {
        let s = found.v.map(|v| [f64::from(v.screen.x), f64::from(v.screen.y)]);
        let p = [f64::from(xs), f64::from(ys)];
        let cross =
            |a: [f64; 2], b: [f64; 2], c: [f64; 2]| (b[0] - a[0]) * (c[1] - a[1]) - (c[0] - a[0]) * (b[1] - a[1]);
        let area = cross(s[0], s[1], s[2]);
        let inverse = 1.0 / area;
        let mut w = [cross(p, s[1], s[2]), cross(s[0], p, s[2]), cross(s[0], s[1], p)].map(|e| (e * inverse).max(0.0));
        if !screen.ortho {
            // Weights are linear on the image only after multiplication by nearness.
            w = std::array::from_fn(|i| w[i] * f64::from(found.v[i].screen.q));
        }
        let scale = 1.0 / w.iter().sum::<f64>();
        let mut b = [0.0; 3];
        let [b0, b1, b2] = found.v.map(|v| v.weights.map(f64::from));
        for k in 0..2 {
            b[k + 1] = (w[0] * b0[k] + w[1] * b1[k] + w[2] * b2[k]) * scale;
        }
        b[0] = 1.0 - b[1] - b[2];
        Self { weights: b }
    }

    /// Position on the ground.
    fn on_ground(&self, found: &DrawnTriangle<'_>, hf: &Heightfield) -> DVec3 {
        let cell = (found.parent >> 1) as usize;
        let Block { origin, step, .. } = *found.block;
        let [c, r] = [origin[0] + step * (cell % SIDE), origin[1] + step * (cell / SIDE)];
        let nodes = CELL_TRIANGLES[(found.parent & 1) as usize];
        let (mut u, mut v, mut z) = (0.0, 0.0, 0.0);
        for (n, w) in nodes.into_iter().zip(self.weights) {
            u += w * (step * (n & 1)) as f64;
            v += w * (step * (n >> 1)) as f64;
            z += w * f64::from(hf.heights()[(r + step * (n >> 1)) * hf.cols() + c + step * (n & 1)]);
        }
        let xy = hf.north_west() + DVec2::new(c as f64 + u, -(r as f64 + v)) * hf.spacing();
        xy.extend(z)
    }

    /// The box, the position on it, and the outward normal of its face.
    fn on_box<'b>(&self, found: &DrawnTriangle<'_>, layer: &'b BoxLayer) -> (&'b BoxShape, DVec3, DVec3) {
        let shape = &layer.boxes[found.block.origin[0] + (found.parent / 12) as usize];
        let corners = shape.corners();
        let p = BoxShape::TRIANGLES[(found.parent % 12) as usize].map(|k| corners[k]);
        let n = shape.normal_of((found.parent % 12) as usize);
        (shape, p[0] * self.weights[0] + p[1] * self.weights[1] + p[2] * self.weights[2], n)
    }
}

/// Coverage of a pixel by the drawn edges of a box, at a point on its surface relative to its centre.
fn edge_share(shape: &BoxShape, from_centre: DVec3, footprint: f64) -> f32 {
    let local = DVec2::from_angle(-shape.yaw).rotate(from_centre.truncate()).extend(from_centre.z);
    let mut inside = (0.5 * shape.size - local.abs()).to_array();
    inside.sort_by(f64::total_cmp);
    // The smallest distance is that to the face itself, the next that to the nearest edge.
    let line = 1.0 - smoothstep(0.5, 1.6, (inside[1] / footprint) as f32);
    // Edges fade on small boxes, which they would fill.
    line * smoothstep(5.0, 24.0, (shape.size.min_element() / footprint) as f32)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn levels_are_logarithms() {
        for i in 0..4000 {
            let cells = 0.5 * 1.004f32.powi(i);
            let want = (128.0 * cells.max(1.0).log2()) as f64;
            assert!((f64::from(lod(cells)) - want).abs() < 2.5, "{cells}: {} {want}", lod(cells));
        }
        assert_eq!((lod(0.0), lod(1.0), lod(4.0), lod(f32::NAN)), (0, 0, 256, 0));
    }
}
