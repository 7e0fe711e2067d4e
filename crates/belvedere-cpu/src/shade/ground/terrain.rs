//! Terrain: its light, and the drapes and areas over it.

use crate::cache::GroundCache;
use crate::shade::Shader;
use crate::shade::footprint::{Footprint, LONGEST};
use crate::shade::ground::broad::Broad;
use crate::shade::ground::displaced::{self, DisplacedLight};
use crate::shade::ground::edge::Border;
use crate::shade::ground::lit::{Lit, LitGround, LitKey};
use crate::shade::ground::patch::{GroundShape, LightingInputs};
use crate::shade::ground::shadow::{Shadows, Softness};
use crate::shade::ground::surface::{MipPyramid, Surface};
use crate::shade::ground::texture::stipple;
use crate::shade::ground::tiles::CELL;
use crate::shade::overlay::area::{AreaCache, AreaMap};
use crate::shade::overlay::drape::DrapeMap;
use crate::shade::relief::ReliefLight;
use belvedere_composite::color::{Rgb, linear, smoothstep};
use belvedere_composite::tint::GroundTint;
use belvedere_core::{DVec2, DVec3};
use belvedere_scene::{AreaSurface, Haze, Heightfield, Light, Relief, RenderJob, Shading, Sky, TerrainLayer};
use belvedere_sight::sections::Sections;
use std::sync::Arc;

/// A terrain layer ready for shading.
pub(crate) struct TerrainShade<'a> {
    /// Index of the layer in the scene.
    layer: usize,
    pub(crate) hf: &'a Heightfield,
    pub(crate) lit: Arc<LitGround>,
    pub(crate) light: ReliefLight,
    /// Side of a cell, scene units.
    pub(crate) pitch: f64,
    means: Arc<MipPyramid>,
    surface: Surface<'a>,
    /// The undisplaced ground and its averages, where light falls on a displaced one.
    map: Option<(Surface<'a>, Arc<MipPyramid>)>,
    shadows: Option<Arc<Shadows>>,
    tint: GroundTint,
    broad: Option<Arc<Broad>>,
    exaggeration: f32,
    drapes: Arc<Vec<DrapeMap>>,
    /// Where the ground fades, if its edge is soft.
    pub(super) border: Option<Border>,
}

/// The drapes with their averages, from the cache if they were made from the same pictures.
fn drapes(layer: &TerrainLayer, cache: &LightCache) -> Arc<Vec<DrapeMap>> {
    if layer.drapes.is_empty() {
        return Arc::default();
    }
    let make = || Arc::new(layer.drapes.iter().filter_map(DrapeMap::new).collect::<Vec<_>>());
    let known = cache.drapes.get(&layer.heightfield, (), make);
    let same =
        known.len() == layer.drapes.len() && known.iter().zip(&layer.drapes).all(|(map, drape)| map.is_of(drape));
    if same {
        return known;
    }
    let made = make();
    cache.drapes.put(&layer.heightfield, (), made.clone());
    made
}

/// Caches of the light on grounds, and of what is draped over them, kept between frames.
#[derive(Debug, Default)]
pub(crate) struct LightCache {
    means: GroundCache<(), Arc<MipPyramid>>,
    broad: GroundCache<(), Arc<Broad>>,
    shadows: GroundCache<(Light, Relief), Option<Arc<Shadows>>>,
    lit: GroundCache<LitKey, Arc<LitGround>>,
    displaced: GroundCache<LitKey, DisplacedLight>,
    drapes: GroundCache<(), Arc<Vec<DrapeMap>>>,
    pub(crate) areas: AreaCache,
}

/// Spacing of nodes that made detail reaches, metres; most levels of it, and most nodes of the finest one along a side.
const FINEST_M: f64 = 2.0;
const MOST_FINER: u32 = 6;
const MOST_SIDE: usize = 1 << 17;

/// Altitudes of the light whose shadows are painted, radians.
const LOWEST: f64 = 0.55;
const HIGHEST: f64 = 0.8;

/// The shadows of a ground: those of the sun if they are wanted, else painted ones in a Swiss relief.
fn shadows(surface: &Surface<'_>, means: &MipPyramid, relief: Relief, light: Light) -> Option<Arc<Shadows>> {
    if light.shadows {
        return Some(Arc::new(Shadows::new(surface, means, &light, Softness::SUN)));
    }
    let light = Light { altitude: light.altitude.clamp(LOWEST, HIGHEST), ..light };
    (relief == Relief::Swiss).then(|| Arc::new(Shadows::new(surface, means, &light, Softness::PAINTED)))
}

/// Levels of made detail below the nodes of a ground.
pub(crate) fn finer_levels(hf: &Heightfield) -> u32 {
    let wanted = (hf.spacing().min_element() / FINEST_M).log2().ceil().clamp(0.0, f64::from(MOST_FINER)) as u32;
    let side = hf.cols().max(hf.rows());
    (0..=wanted).rev().find(|finer| side << finer <= MOST_SIDE).unwrap_or(0)
}

impl<'a> TerrainShade<'a> {
    /// * `layer`: with its index in the scene.
    pub(crate) fn new((index, layer): (usize, &'a TerrainLayer), job: &RenderJob<'a>, cache: &LightCache) -> Self {
        let hf = &layer.heightfield;
        let surface = lit_surface(layer, job);
        // Caches are of the sun alone.
        let light = Light { sky: Sky::Auto, haze: Haze::Auto, clouds: 0.0, ..*job.light };
        let (relief, palette) = (layer.relief, layer.palette.clone());
        let key = LitKey { relief, light, palette, exaggeration: layer.exaggeration };
        let tint = GroundTint::new(&layer.palette, hf.z_range());
        let finer = if tint.is_made() { finer_levels(hf) } else { 0 };
        let unlit = |means: &MipPyramid| Arc::new(LitGround::new(hf.cols(), hf.rows(), means.top(), finer));
        let averages = || Arc::new(MipPyramid::new(&surface));
        let map = (!surface.is_map()).then(|| {
            let map = Surface::of_map(hf);
            let means = cache.means.get(hf, (), || Arc::new(MipPyramid::new(&map)));
            (map, means)
        });
        let cast = |means: &MipPyramid| shadows(&surface, means, relief, light);
        let (means, shadows, lit) = if surface.is_map() {
            // The undisplaced ground has the same light in all frames.
            let means = cache.means.get(hf, (), averages);
            let shadows = cache.shadows.get(hf, (light, relief), || cast(&means));
            let lit = cache.lit.take(hf, &key).filter(|lit| !lit.is_full()).unwrap_or_else(|| unlit(&means));
            cache.lit.put(hf, key, lit.clone());
            (means, shadows, lit)
        } else if let Some(heights) = surface.moved() {
            let DisplacedLight { means, shadows, lit, .. } =
                displaced::light(&cache.displaced, hf, &surface, heights, (key, finer), &cast);
            (means, shadows, lit)
        } else {
            let means = averages();
            (means.clone(), cast(&means), unlit(&means))
        };
        let of_map = map.as_ref().map_or(&means, |(_, means)| means);
        let spacing = hf.spacing();
        let broad = tint.is_made().then(|| cache.broad.get(hf, (), || Arc::new(Broad::new(of_map, spacing))));
        let steeper = broad.as_ref().map_or(1.0, |broad| broad.steeper);
        Self {
            layer: index,
            hf,
            lit,
            light: ReliefLight::new(layer.relief, job.light),
            pitch: (spacing.x * spacing.y).sqrt(),
            means,
            surface,
            map,
            shadows,
            tint,
            broad,
            exaggeration: steeper * layer.exaggeration as f32,
            drapes: drapes(layer, cache),
            border: Border::of(layer, job),
        }
    }

    /// Inputs of the tiles of lit ground.
    pub(crate) fn inputs(&self) -> LightingInputs<'_> {
        LightingInputs {
            surface: &self.surface,
            means: &self.means,
            map: self.map.as_ref().map(|(surface, means)| GroundShape { surface, means }),
            broad: self.broad.as_deref(),
            shadows: self.shadows.as_deref(),
            tint: &self.tint,
            light: &self.light,
            exaggeration: self.exaggeration,
        }
    }

    /// Whether a drape, an area or a cast shadow may lie over the ground.
    pub(crate) fn is_covered(&self, shader: &Shader<'_>) -> bool {
        !self.drapes.is_empty() || !shader.areas.is_empty() || shader.casters.is_some()
    }

    /// Colour of the ground at a point where a pixel covers a square of side `fp`, scene units, and the area it lies in.
    /// * `axes`: see [`Footprint::new`].
    pub(crate) fn shade_at(
        &self,
        shader: &Shader<'_>,
        xy: DVec2,
        fp: f64,
        axes: [DVec2; 2],
        depth: f64,
        pixel: DVec2,
    ) -> (Rgb, Option<u32>) {
        let g = self.hf.grid_from_scene(xy);
        let side = fp / self.pitch;
        let last = DVec2::new((self.hf.cols() - 1) as f64, (self.hf.rows() - 1) as f64);
        let at = (g.clamp(DVec2::ZERO, last) * f64::from(CELL)).as_ivec2().to_array();
        let longest = axes[0].length().max(axes[1].length()) / self.pitch;
        let lod = self.lod((side * side) as f32, longest as f32);
        let inputs = self.inputs();
        let print = || Footprint::new(axes, shader.screen.footprint(depth));
        let ground = || self.lit.sample(at, lod, &inputs);
        self.covered(shader, g, side, print, ground, pixel.as_vec2().to_array()).unwrap_or_else(|| {
            let root = Rgb::from_array(self.lit.color(at, lod, &inputs));
            (root * root, None)
        })
    }

    /// * `sun`: share of the sun's disc that boxes and meshes leave visible.
    fn light_of(&self, lit: &Lit, sun: f32) -> Rgb {
        let left = self.light.in_shadow + (1.0 - self.light.in_shadow) * sun;
        self.light.warm * (lit.direct * left) + self.light.cool * lit.sky
    }

    /// Share of an area that styling sections show on this ground.
    fn share_of(&self, shader: &Shader<'_>, area: &AreaMap, xy: DVec2) -> f32 {
        let of = |s: &Sections<'_>| s.share(area.layer as usize, self.layer, xy.extend(0.0)) as f32;
        shader.sections.as_ref().map_or(1.0, of)
    }

    /// Share of the sun's disc that boxes and meshes leave visible from a point with the footprint `print`.
    fn sun_on(&self, shader: &Shader<'_>, xy: DVec2, print: &Footprint) -> f32 {
        let Some(casters) = &shader.casters else { return 1.0 };
        let Some(z) = self.hf.surface_at(xy) else { return 1.0 };
        let (p, across) = (xy.extend(z), print.major.perp().normalize_or_zero() * print.minor);
        casters.on_ground(p, [print.major, across], &|other| shader.throws(other, self.layer, p))
    }

    /// Colour and area where a drape, an area or a shadow of models covers the ground; `None` elsewhere.
    /// * `g`: column and row;
    /// * `cells`: side of the square that the pixel covers, cells;
    /// * `print`: computes the footprint of the pixel;
    /// * `ground`: computes the light of the ground there.
    pub(crate) fn covered(
        &self,
        shader: &Shader<'_>,
        g: DVec2,
        cells: f64,
        print: impl FnOnce() -> Footprint,
        ground: impl FnOnce() -> Lit,
        pixel: [f32; 2],
    ) -> Option<(Rgb, Option<u32>)> {
        let spacing = self.hf.spacing();
        let (xy, fp) = (self.hf.north_west() + DVec2::new(g.x, -g.y) * spacing, cells * self.pitch);
        // An upper bound of the footprint's length selects the areas; the footprint itself then gives the distance to the border in pixels.
        let areas = shader.areas.iter().map(|a| (a, a.border(xy)));
        let areas: Vec<_> = areas.filter(|(_, border)| border.inside > -0.5 * LONGEST * fp).collect();
        if self.drapes.is_empty() && areas.is_empty() && shader.casters.is_none() {
            return None;
        }
        let print = print();
        let areas = areas.into_iter().filter_map(|(a, border)| {
            let inside = border.inside / print.along(border.across);
            let shown = if inside > -0.5 { self.share_of(shader, a, xy) } else { 0.0 };
            (shown > 0.0).then(|| (a, a.paint_of(border.feature), inside, shown))
        });
        let areas: Vec<_> = areas.collect();
        let drapes: Vec<_> = self.drapes.iter().map(|d| d.at(xy, &print)).filter(|(_, alpha)| *alpha > 0.0).collect();
        let sun = self.sun_on(shader, xy, &print);
        if drapes.is_empty() && areas.is_empty() && sun >= 1.0 {
            return None;
        }
        let lit = ground();
        let mut albedo = lit.albedo();
        let mut draped = 0.0f32;
        for (color, alpha) in drapes {
            albedo = albedo.lerp(color, alpha);
            draped = draped.max(alpha);
        }
        // A photograph contains light already, so only half of ours is applied.
        let mut light = self.light_of(&lit, sun).lerp(Rgb::splat(0.95 * (0.5 + 0.5 * sun)), 0.5 * draped);
        let (mut id, mut water) = (None, 0.0f32);
        for (a, (color, alpha), inside, shown) in areas {
            if inside >= 0.0 && shown >= 0.5 {
                id = Some(a.layer);
            }
            let share = (0.5 + inside).clamp(0.0, 1.0) as f32 * alpha * shown;
            albedo = albedo.lerp(fill(a, color, xy, inside as f32, &print), share);
            match a.surface {
                AreaSurface::Water | AreaSurface::Sea => water += share * (1.0 - water),
                AreaSurface::Glacier => {
                    // Snow lights its own shadows.
                    light = light.lerp(Rgb::splat(1.02), 0.35 * share);
                    water *= 1.0 - share;
                }
                _ => water *= 1.0 - share,
            }
        }
        let color = if water > 0.0 { mirrored(shader, pixel, (albedo, light), sun, water) } else { albedo * light };
        let root = Rgb::from_array(color.to_array().map(|c| self.light.film(c.max(0.0).sqrt())));
        Some((root * root, id))
    }
}

/// Colour of ground that mirrors the sky.
/// * `sun`: see [`TerrainShade::light_of`]; `water`: share of water on it.
#[inline]
fn mirrored(shader: &Shader<'_>, pixel: [f32; 2], (albedo, light): (Rgb, Rgb), sun: f32, water: f32) -> Rgb {
    let down = -shader.sky.sine(pixel);
    let mirror = 0.03 + 0.55 * (1.0 - down.clamp(0.0, 1.0)).powi(5);
    let reflected = shader.sky.towards(0.15 + 0.5 * down.clamp(0.0, 1.0));
    let light = light.lerp(Rgb::splat(0.6 + 0.4 * sun), water);
    (albedo * light).lerp(reflected, water * mirror)
}

/// Colour of an area at a point.
/// * `inside`: distance from the border inwards, pixels.
fn fill(area: &AreaMap, color: Rgb, xy: DVec2, inside: f32, print: &Footprint) -> Rgb {
    // The rim is about a pixel and a half wide.
    let rim = if area.has_outline { 0.0 } else { 1.0 - smoothstep(0.6, 2.2, inside) };
    match area.surface {
        AreaSurface::Plain | AreaSurface::Outline | AreaSurface::Park => color,
        // Shore line.
        AreaSurface::Water | AreaSurface::Sea => color * (1.0 - 0.45 * rim),
        AreaSurface::Forest => color * (1.0 + 0.22 * stipple(xy, print.length())),
        AreaSurface::Glacier => {
            let ice = color * (1.0 + 0.035 * stipple(xy, print.length()));
            ice.lerp(linear([96, 156, 205]), 0.7 * rim)
        }
    }
}

/// The ground that is lit; its tint is always that of the map. Light stays fixed to the map unless a stage moves the ground itself:
/// a lowered ridge must not keep its old shadow.
fn lit_surface<'a>(layer: &'a TerrainLayer, job: &RenderJob<'a>) -> Surface<'a> {
    let (hf, stages) = (&layer.heightfield, job.view.stages());
    let ground = stages.iter().rposition(|s| s.moves_ground());
    let deformed = match layer.shading {
        Some(Shading::Map) => return Surface::of_map(hf),
        Some(Shading::Deformed) => stages,
        None => match ground {
            Some(i) => &stages[..=i],
            None => return Surface::of_map(hf),
        },
    };
    if deformed.iter().all(|s| s.is_upright()) {
        return Surface::lifted(hf, Arc::new(displaced::heights(hf, deformed)));
    }
    let moved = move |p: DVec3| deformed.iter().try_fold(p, |p, s| s.apply(p)).ok().filter(|p| p.is_finite());
    Surface::bent(hf, Arc::new(moved))
}
