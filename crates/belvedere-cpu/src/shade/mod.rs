//! Colour of what a sample sees.

pub(crate) mod area;
pub(crate) mod color;
mod drape;
mod mesh;
mod palette;
mod pyramid;
mod relief;
mod seen;
mod sky;

use crate::blocks::{BOX_TRIANGLES, Block, Blocks, Found, SIDE};
use crate::grid::CELL_TRIANGLES;
use crate::lens::{Lens, SUB};
use crate::polish::Polish;
use crate::raster::SKY;
use area::AreaMap;
use belvedere_core::{DVec2, DVec3, Stage};
use belvedere_scene::{BoxLayer, BoxShape, Heightfield, LayerKind, RenderJob, Shading, TerrainLayer};
use color::{Rgb, linear, smoothstep};
use drape::DrapeMap;
use glam::Vec3A;
use palette::Tint;
use pyramid::Pyramid;
use relief::ReliefLight;
use sky::Sky;
use std::sync::Arc;

/// Everything that colours need, made once per frame.
pub(crate) struct Shader<'a> {
    pub(crate) sky: Sky,
    lens: &'a Lens,
    blocks: &'a Blocks,
    layers: Vec<LayerShade<'a>>,
    areas: Vec<AreaMap>,
}

enum LayerShade<'a> {
    Terrain(Box<TerrainShade<'a>>),
    Boxes(&'a BoxLayer, ReliefLight),
    Mesh(mesh::MeshShade<'a>),
    Other,
}

struct TerrainShade<'a> {
    hf: &'a Heightfield,
    pyramid: Arc<Pyramid>,
    tint: Tint,
    light: ReliefLight,
    exaggeration: f32,
    drapes: Vec<DrapeMap>,
}

/// Colour and identity of a sample.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Shaded {
    pub(crate) color: Rgb,
    /// 0 = sky, else 1 + layer.
    pub(crate) id: u32,
    /// True position, scene coordinates; NaN in the sky.
    pub(crate) world: DVec3,
}

impl<'a> Shader<'a> {
    pub(crate) fn new(job: &RenderJob<'a>, lens: &'a Lens, blocks: &'a Blocks) -> Self {
        let layers = job
            .scene
            .layers
            .iter()
            .map(|l| match &l.kind {
                LayerKind::Terrain(t) => LayerShade::Terrain(Box::new(TerrainShade::new(t, job))),
                LayerKind::Boxes(b) => LayerShade::Boxes(b, ReliefLight::new(belvedere_scene::Relief::Sun, job.light)),
                LayerKind::Mesh(m) => LayerShade::Mesh(mesh::MeshShade::new(m, job.light)),
                _ => LayerShade::Other,
            })
            .collect();
        let areas = job
            .scene
            .layers
            .iter()
            .enumerate()
            .filter_map(|(i, l)| match &l.kind {
                LayerKind::Area(a) => AreaMap::new(i as u32, a),
                _ => None,
            })
            .collect();
        Self { sky: Sky::new(&job.scene.bounds(), job.view.pinhole()), lens, blocks, layers, areas }
    }

    /// Whether both primitives (not sky) belong to one terrain layer, whose colours change smoothly.
    pub(crate) fn is_terrain(&self, a: u32, b: u32) -> bool {
        let layer = self.blocks.layer_of(a);
        layer == self.blocks.layer_of(b)
            && layer.is_some_and(|l| matches!(self.layers[l as usize], LayerShade::Terrain(_)))
    }

    /// Place and depth of the surface at a pixel's centre by the true map, see [`Polish::place`].
    pub(crate) fn exact_place(
        &self,
        polish: &Polish<'_>,
        prim: u32,
        near: DVec3,
        x: i32,
        y: i32,
    ) -> Option<(DVec3, f32)> {
        let found = if prim == SKY { None } else { self.blocks.find(prim) };
        polish.place(&found?, near, DVec2::new(f64::from(x) + 0.5, f64::from(y) + 0.5))
    }

    /// What the sample at fixed-point position (`xs`, `ys`) sees.
    pub(crate) fn shade(&self, prim: u32, q: f32, xs: i32, ys: i32) -> Shaded {
        let pixel = DVec2::new(f64::from(xs), f64::from(ys)) / f64::from(SUB);
        let found = if prim == SKY { None } else { self.blocks.find(prim) };
        let Some(found) = found else {
            return Shaded { color: self.sky.at(self.lens, pixel), id: 0, world: DVec3::NAN };
        };
        let depth = self.lens.depth_of(q);
        let hit = Hit::new(&found, self.lens, xs, ys);
        let layer = found.block.layer;
        match &self.layers[layer as usize] {
            LayerShade::Terrain(t) => {
                let fp = self.lens.footprint(f64::from(depth));
                let (color, id, world) = t.shade(self, &found, &hit, fp, pixel);
                Shaded { color: self.sky.through_air(color, depth), id: id.unwrap_or(layer) + 1, world }
            }
            LayerShade::Boxes(b, light) => {
                let (color, world) = shade_box(b, light, &found, &hit, self.lens.footprint(f64::from(depth)));
                Shaded { color: self.sky.through_air(color, depth), id: layer + 1, world }
            }
            LayerShade::Mesh(m) => {
                let (color, world) = m.shade(&found, hit.weights);
                Shaded { color: self.sky.through_air(color, depth), id: layer + 1, world }
            }
            LayerShade::Other => Shaded { color: Rgb::ZERO, id: layer + 1, world: DVec3::NAN },
        }
    }
}

/// Place of a sample inside the parent triangle.
struct Hit {
    /// Weights of the parent's vertices.
    weights: [f64; 3],
    /// Share of the parent triangle that one pixel covers.
    parent_per_px: f64,
}

impl Hit {
    fn new(found: &Found<'_>, lens: &Lens, xs: i32, ys: i32) -> Self {
        let s = found.v.map(|v| [f64::from(v.screen.x), f64::from(v.screen.y)]);
        let p = [f64::from(xs), f64::from(ys)];
        let cross =
            |a: [f64; 2], b: [f64; 2], c: [f64; 2]| (b[0] - a[0]) * (c[1] - a[1]) - (c[0] - a[0]) * (b[1] - a[1]);
        let area = cross(s[0], s[1], s[2]);
        let inverse = 1.0 / area;
        let mut w = [cross(p, s[1], s[2]), cross(s[0], p, s[2]), cross(s[0], s[1], p)].map(|e| (e * inverse).max(0.0));
        if !lens.ortho {
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
        let part = (b1[0] - b0[0]) * (b2[1] - b0[1]) - (b2[0] - b0[0]) * (b1[1] - b0[1]);
        Self { weights: b, parent_per_px: (part * inverse).abs() * (2.0 * f64::from(SUB * SUB)) }
    }
}

impl<'a> TerrainShade<'a> {
    fn new(layer: &'a TerrainLayer, job: &RenderJob<'_>) -> Self {
        let hf = &layer.heightfield;
        let stages = job.view.stages();
        let ground = stages.iter().position(|s| matches!(s, Stage::TerrainDisocclusion(_)));
        // Light stays fixed to the map unless the ground itself was changed, else a lowered ridge keeps its old shadow.
        let deformed = match layer.shading {
            Some(Shading::Map) => None,
            Some(Shading::Deformed) => Some(stages),
            None => ground.map(|i| &stages[..=i]),
        };
        let move_point = |p: DVec3| {
            deformed.unwrap_or(&[]).iter().try_fold(p, |p, s| s.as_map().apply(p)).ok().filter(|p| p.is_finite())
        };
        let map: Option<&(dyn Fn(DVec3) -> Option<DVec3> + Sync)> = deformed.is_some().then_some(&move_point);
        Self {
            hf,
            // The map's own slopes stay the same from frame to frame.
            pyramid: match map {
                Some(_) => Arc::new(Pyramid::new(hf, map)),
                None => hf.derived(|| Pyramid::new(hf, None)),
            },
            tint: Tint::new(layer.palette, hf.z_range()),
            light: ReliefLight::new(layer.relief, job.light),
            exaggeration: layer.exaggeration as f32,
            drapes: layer.drapes.iter().filter_map(DrapeMap::new).collect(),
        }
    }

    fn shade(
        &self,
        shader: &Shader<'_>,
        found: &Found<'_>,
        hit: &Hit,
        footprint: f64,
        pixel: DVec2,
    ) -> (Rgb, Option<u32>, DVec3) {
        let cell = (found.parent >> 1) as usize;
        let Block { origin, step, .. } = *found.block;
        let [c, r] = [origin[0] + step * (cell % SIDE), origin[1] + step * (cell / SIDE)];
        let nodes = CELL_TRIANGLES[(found.parent & 1) as usize];
        let (mut u, mut v, mut z) = (0.0, 0.0, 0.0);
        for (n, w) in nodes.into_iter().zip(hit.weights) {
            u += w * (step * (n & 1)) as f64;
            v += w * (step * (n >> 1)) as f64;
            z += w * f64::from(self.hf.heights()[(r + step * (n >> 1)) * self.hf.cols() + c + step * (n & 1)]);
        }
        let (col, row) = (c as f64 + u, r as f64 + v);
        let spacing = self.hf.spacing();
        let xy = self.hf.north_west() + DVec2::new(col * spacing.x, -row * spacing.y);
        // Side of the square on the ground that the pixel covers; the triangle tells slant and bend, the depth keeps it sane.
        let pitch = (spacing.x * spacing.y).sqrt();
        let fp = (0.5 * hit.parent_per_px).sqrt() * pitch * step as f64;
        let fp = fp.clamp(footprint, 6.0 * footprint);
        let (color, id) = self.shade_at(shader, xy, fp, pixel);
        (color, id, xy.extend(z))
    }

    /// Colour of the ground at a place of which a pixel covers a square of side `fp`, and the area it lies in.
    fn shade_at(&self, shader: &Shader<'_>, xy: DVec2, fp: f64, pixel: DVec2) -> (Rgb, Option<u32>) {
        let (spacing, g) = (self.hf.spacing(), self.hf.grid_from_scene(xy));
        let node = self.pyramid.sample(g.x as f32, g.y as f32, (fp / (spacing.x * spacing.y).sqrt()) as f32);
        self.color(shader, xy, node, fp, pixel)
    }

    fn color(&self, shader: &Shader<'_>, xy: DVec2, node: glam::Vec4, fp: f64, pixel: DVec2) -> (Rgb, Option<u32>) {
        let steep = (node.x * node.x + node.y * node.y).sqrt();
        let mut albedo = self.tint.at(node.z);
        albedo =
            albedo.lerp(self.tint.rock, 0.85 * smoothstep(self.tint.rock_slope[0], self.tint.rock_slope[1], steep));
        let snow = smoothstep(self.tint.snow_m[0], self.tint.snow_m[1], node.z) * (1.0 - smoothstep(0.7, 1.3, steep));
        albedo = albedo.lerp(self.tint.snow, snow);
        let mut draped = 0.0f32;
        for d in &self.drapes {
            let (c, a) = d.at(xy.x, xy.y, fp);
            albedo = albedo.lerp(c, a);
            draped = draped.max(a);
        }
        let n = Vec3A::new(-node.x * self.exaggeration, -node.y * self.exaggeration, 1.0).normalize();
        let relief = self.light.at(n, node.w);
        // A photograph has its own light: model it only half.
        let mut light = relief.lerp(Rgb::splat(0.95), 0.5 * draped);
        let (mut id, mut water) = (None, 0.0f32);
        for a in &shader.areas {
            let inside = a.depth_inside(xy) / fp;
            let cover = (0.5 + inside).clamp(0.0, 1.0) as f32;
            if cover <= 0.0 {
                continue;
            }
            if inside >= 0.0 {
                id = Some(a.layer);
            }
            let share = cover * a.alpha;
            let mut fill = a.fill;
            if a.water && !a.has_outline {
                // Shore line: darker over the first pixel and a half.
                fill *= 1.0 - 0.45 * (1.0 - smoothstep(0.6, 2.2, inside as f32));
            }
            albedo = albedo.lerp(fill, share);
            water = if a.water { water + share * (1.0 - water) } else { water * (1.0 - share) };
        }
        if water > 0.0 {
            let down = -shader.lens.direction(pixel).z as f32;
            let mirror = 0.03 + 0.55 * (1.0 - down.clamp(0.0, 1.0)).powi(5);
            let reflected = shader.sky.towards(0.15 + 0.5 * down.clamp(0.0, 1.0));
            light = light.lerp(Rgb::ONE, water);
            return ((albedo * light).lerp(reflected, water * mirror), id);
        }
        (albedo * light, id)
    }
}

fn shade_box(layer: &BoxLayer, light: &ReliefLight, found: &Found<'_>, hit: &Hit, footprint: f64) -> (Rgb, DVec3) {
    let shape = &layer.boxes[found.block.origin[0] + (found.parent / 12) as usize];
    let corners = shape.corners();
    let p = BOX_TRIANGLES[(found.parent % 12) as usize].map(|k| corners[k]);
    let centre = shape.base + DVec3::Z * 0.5 * shape.size.z;
    let n = (p[1] - p[0]).cross(p[2] - p[0]);
    let n = if n.dot(p[0] - centre) < 0.0 { -n } else { n }.normalize_or(DVec3::Z);
    let world = p[0] * hit.weights[0] + p[1] * hit.weights[1] + p[2] * hit.weights[2];
    (box_color(shape, light, n, world, footprint), world)
}

/// Boxes look like an architect's model: matt, darker towards the foot, with drawn edges.
/// * `n`: outward unit normal of the face; `footprint`: size of a pixel at the box, scene units.
fn box_color(shape: &BoxShape, light: &ReliefLight, n: DVec3, world: DVec3, footprint: f64) -> Rgb {
    let centre = shape.base + DVec3::Z * 0.5 * shape.size.z;
    let up = (((world.z - shape.base.z) / shape.size.z.max(1e-9)) as f32).clamp(0.0, 1.0);
    let open = 0.60 + 0.40 * smoothstep(-0.1, 0.6, up);
    let n = Vec3A::new(n.x as f32, n.y as f32, n.z as f32);
    let c = shape.color;
    let ink = 1.0 - 0.42 * edge_share(shape, world - centre, footprint);
    // Streets return light that open ground does not.
    let lit = light.at(n, open) * 0.82 + Rgb::new(0.19, 0.18, 0.18) * open;
    linear([c.r, c.g, c.b]) * lit * ((0.76 + 0.24 * open) * ink)
}

/// How much of a pixel the edge of a box covers, at a place on its surface relative to its centre.
fn edge_share(shape: &BoxShape, from_centre: DVec3, footprint: f64) -> f32 {
    let local = DVec2::from_angle(-shape.yaw).rotate(from_centre.truncate()).extend(from_centre.z);
    let mut inside = (0.5 * shape.size - local.abs()).to_array();
    inside.sort_by(f64::total_cmp);
    // The smallest is the face itself, the next the way to the nearest edge.
    let line = 1.0 - smoothstep(0.5, 1.6, (inside[1] / footprint) as f32);
    // Small boxes would be nothing but edges.
    line * smoothstep(5.0, 24.0, (shape.size.min_element() / footprint) as f32)
}
