//! Method (b): draw the picture and compare each sample's depth with the depth buffer.

use super::image::{BodyViews, DepthTest, SampleImage};
use super::{pinpoint, surface};
use crate::ConstructError;
use crate::sample::{Sample, SampledFeature};
use belvedere_core::{CurvedRays, DVec2, DVec3, Pinhole, SplitRays, Stage, View};
use belvedere_scene::{
    Aux, CellTriangle, Frame, Heightfield, Layer, LayerKind, Light, Progress, RenderJob, RenderOptions, Renderer, Scene,
};

pub(super) struct Job<'a> {
    pub(super) scene: &'a Scene,
    pub(super) renderer: &'a dyn Renderer,
    pub(super) light: &'a Light,
    pub(super) scale: Option<u32>,
    pub(super) progress: &'a Progress,
}

/// How a plane through a sample shows up in the depth buffer: `depth(pixel) = depth + gradient . (pixel - at)`.
struct Footprint {
    at: DVec2,
    depth: f64,
    gradient: DVec2,
    /// Steepest change of depth per pixel towards the ground one cell around.
    roughness: f64,
}

impl Job<'_> {
    /// The same view on a finer image.
    fn enlarged(&self, view: &View, images: &[Vec<SampleImage>]) -> Result<View, ConstructError> {
        let pinhole = view.pinhole();
        let mut depths: Vec<f64> = images.iter().flatten().filter(|j| j.in_frame).map(|j| j.depth).collect();
        depths.sort_by(f64::total_cmp);
        let scale = self.scale.unwrap_or_else(|| {
            let cell = self.scene.terrain().map_or(f64::INFINITY, |hf| hf.spacing().min_element());
            let depth =
                if pinhole.is_orthographic() { 1.0 } else { depths.get(depths.len() / 2).copied().unwrap_or(0.0) };
            // Balls and rods of molecules are a few pixels wide.
            let cell = if cell.is_finite() { cell } else { depths.last().copied().unwrap_or(1.0) / pinhole.scale_px() };
            let wanted = (4.0 * depth / (pinhole.scale_px() * cell)).ceil().clamp(1.0, 3.0);
            let pixels = f64::from(pinhole.image[0]) * f64::from(pinhole.image[1]);
            wanted.min((8e6 / pixels).sqrt().floor().max(1.0)) as u32
        });
        let scale = scale.clamp(1, 8).min(65_535 / pinhole.image[0].max(pinhole.image[1])).max(1);
        let larger = Pinhole { image: pinhole.image.map(|n| n * scale), ..pinhole.clone() };
        let rebuilt = |stage: &Stage| match stage {
            Stage::CurvedRays(rays) => {
                CurvedRays::new(&larger, rays.model(), rays.spec()).map(Stage::CurvedRays).map_err(|_| ())
            }
            Stage::SplitRays(rays) => {
                SplitRays::new(&larger, rays.model(), rays.spec()).map(Stage::SplitRays).map_err(|_| ())
            }
            other => Ok(other.clone()),
        };
        // Curved rays belong to the pixels of their image; should the finer ones not bend, the given image has to do.
        match view.stages().iter().map(rebuilt).collect::<Result<Vec<_>, _>>() {
            Ok(stages) => Ok(View::new(larger, stages)?),
            Err(_) => Ok(view.clone()),
        }
    }

    /// Fills in [`SampleImage::in_buffer`].
    pub(super) fn test(
        &self,
        view: &View,
        features: &[SampledFeature],
        images: &mut [Vec<SampleImage>],
    ) -> Result<(), ConstructError> {
        let original = view.pinhole().image[0];
        let enlarged = self.enlarged(view, images)?;
        let view = &enlarged;
        let aux = Aux { exact: true, ..Aux::default() };
        let options =
            RenderOptions { samples: 1, lod_px: 0.0, tolerance_px: STRAIGHT_PX, aux, ..RenderOptions::default() };
        let judged = judged(self.scene);
        let scene = judged.as_ref().unwrap_or(self.scene);
        let job = RenderJob { scene, view, light: self.light, options: &options, progress: self.progress };
        let frame = self.renderer.render(&job)?;
        let expected = frame.width * frame.height;
        let [width, height] = view.pinhole().image.map(|n| n as usize);
        if frame.depth.len() != expected || (frame.width, frame.height) != (width, height) {
            return Err(ConstructError::FrameSize {
                renderer: self.renderer.name(),
                got: frame.depth.len(),
                expected: width * height,
            });
        }
        let terrain = self.scene.terrain();
        let pinpoint = Pinpoint::new(self.scene, (view, original), features, images, &frame);
        let bodies = BodyViews::new(self.scene, view);
        let finer = width as f64 / f64::from(original);
        let mut pinpointed = 0..;
        for (feature, row) in features.iter().zip(images) {
            for (sample, j) in feature.samples.iter().zip(row.iter_mut()).filter(|(_, j)| j.in_frame) {
                let finer = SampleImage { pixel: finer * j.pixel, ..*j };
                j.in_buffer = Some(match sample.surface {
                    Some(normal) => {
                        let seen = bodies.of(view, feature.layer, sample).is_some_and(|view| {
                            surface::in_buffer(&view, (sample.p_world, normal), feature.layer, &finer, &frame)
                        });
                        DepthTest { seen, missed: false }
                    }
                    None => {
                        let coarse = in_buffer(view, terrain, sample, &finer, &frame);
                        let exact = pinpointed.next().and_then(|index| pinpoint.seen(index, &finer, &frame));
                        DepthTest { seen: exact.unwrap_or(coarse.seen), ..coarse }
                    }
                });
            }
        }
        Ok(())
    }
}

/// The scene as it hides: without solids that something shines through, but for those that must be seen, which are drawn whole; `None` if
/// the scene is that already.
fn judged(scene: &Scene) -> Option<Scene> {
    if !scene.has_see_through() {
        return None;
    }
    let mut judged = scene.clone();
    for layer in judged.layers.iter_mut().filter(|layer| layer.kind.is_see_through()) {
        layer.kind.set_opacity(f32::from(u8::from(layer.must_see)));
    }
    Some(judged)
}

/// Tolerance within which the picture for the depth test draws bent edges straight, pixels: half a pixel, as in usual pictures, is
/// metres of ground, which hide points that neither the displaced ground nor its facets hide.
const STRAIGHT_PX: f64 = 0.05;
/// Depths for one sample: at its own pixel position, then at the four pixel centres around it.
const PLACES: usize = 5;
/// Largest relative difference between a drawn and a pinpointed depth; beyond it the pixel shows another surface, or is wrong.
const AGREES: f64 = 1e-3;
/// Share by which a drawn depth may lie outside the depths around its sample: where ground is seen slantwise or breaks off, renderers
/// may draw ground a part of a pixel beside.
const BESIDE: f64 = 0.01;
/// Share of the pixel centres at which a picture must show the pinpointed depth, to be trusted with that tolerance.
const TRUSTED: f64 = 0.5;
/// Relative tolerance of the depth of a sample on the ground: rounding.
const TOUCH: f64 = 1e-7;

/// Depths of the terrain at the pixel positions of all samples in the frame that stand for no surface in space.
struct Pinpoint {
    depths: Vec<f64>,
    /// The same over flat triangles between displaced nodes, if ground is displaced upwards alone; the sample's own pixel position is
    /// then the one on these triangles. The second list holds the samples' own depths there.
    flat: Option<(Vec<f64>, Vec<f64>)>,
    /// Whether the picture shows the terrain at the pinpointed depths.
    trusted: bool,
    /// Whether a layer, by its index, can hide the terrain.
    solid: Vec<bool>,
}

impl Pinpoint {
    fn new(
        scene: &Scene,
        (view, original): (&View, u32),
        features: &[SampledFeature],
        images: &[Vec<SampleImage>],
        frame: &Frame,
    ) -> Self {
        let is_solid = |l: &Layer| {
            use LayerKind::{Area, Line, Point, Terrain};
            !matches!(l.kind, Terrain(_) | Line(_) | Area(_) | Point(_))
        };
        let solid = scene.layers.iter().map(is_solid).collect();
        if scene.terrain().is_none() {
            return Self { depths: Vec::new(), flat: None, trusted: false, solid };
        }
        let finer = f64::from(view.pinhole().image[0]) / f64::from(original);
        let mut places = Vec::new();
        for (feature, row) in features.iter().zip(images) {
            let framed = feature.samples.iter().zip(row).filter(|(s, j)| j.in_frame && s.surface.is_none());
            for (_, j) in framed {
                let at = finer * j.pixel;
                places.push(at);
                places.extend(around(at));
            }
        }
        let depths = pinpoint::depths(scene, view, &places, false);
        let centres = || {
            places.chunks_exact(PLACES).zip(depths.chunks_exact(PLACES)).flat_map(|(p, d)| p[1..].iter().zip(&d[1..]))
        };
        let all = centres().filter(|(p, _)| pixel(**p, frame).is_some()).count();
        let same = centres().filter(|(p, d)| pixel(**p, frame).is_some_and(|k| is_same(frame, k, **d))).count();
        let trusted = same as f64 >= TRUSTED * all as f64;
        let upright = view.is_bent() && view.stages().iter().all(|s| s.is_upright());
        let flat = upright.then(|| {
            let mut own = Vec::new();
            for (feature, row) in features.iter().zip(images) {
                let framed = feature.samples.iter().zip(row).filter(|(s, j)| j.in_frame && s.surface.is_none());
                own.extend(framed.map(|(s, j)| flat_image(scene, view, s).unwrap_or((finer * j.pixel, j.depth))));
            }
            for (place, (pixel, _)) in places.chunks_exact_mut(PLACES).zip(&own) {
                place[0] = *pixel;
            }
            (pinpoint::depths(scene, view, &places, true), own.into_iter().map(|(_, depth)| depth).collect())
        });
        Self { trusted, depths, flat, solid }
    }

    /// Whether the terrain does not hide a sample, between the pixels too; `None` where the picture shows something other than the terrain.
    /// * `index`: of the sample among those that stand for no surface.
    fn seen(&self, index: usize, j: &SampleImage, frame: &Frame) -> Option<bool> {
        let at = index * PLACES..(index + 1) * PLACES;
        let depths = self.depths.get(at.clone())?;
        let (flat, own) = self.flat.as_ref().map_or((depths, j.depth), |(flat, own)| (&flat[at], own[index]));
        let [nearest, farthest] =
            depths.iter().chain(flat).fold([f64::INFINITY, 0.0], |[lo, hi], d| [d.min(lo), d.max(hi)]);
        let mut explained = 0;
        for (centre, (&depth, &flat)) in around(j.pixel).into_iter().zip(depths[1..].iter().zip(&flat[1..])) {
            let Some(k) = pixel(centre, frame) else {
                explained += 1;
                continue;
            };
            let drawn = f64::from(frame.depth[k]);
            let covered = (frame.id[k] as usize).checked_sub(1).is_some_and(|layer| self.solid[layer]);
            let near = drawn >= (1.0 - BESIDE) * nearest && drawn <= (1.0 + BESIDE) * farthest;
            explained += usize::from(
                !covered && (is_same(frame, k, depth) || is_same(frame, k, flat) || (self.trusted && near)),
            );
        }
        // One pixel may show another ridge.
        (explained >= 3).then(|| depths[0] >= j.depth * (1.0 - TOUCH) && flat[0] >= own * (1.0 - TOUCH))
    }
}

/// Pixel and depth of a sample on the flat triangle between displaced nodes; `None` beside the terrain.
fn flat_image(scene: &Scene, view: &View, sample: &Sample) -> Option<(DVec2, f64)> {
    let hf = scene.terrain()?;
    let g = hf.grid_from_scene(sample.p_world.truncate());
    let corner = g.floor().min(DVec2::new(hf.cols() as f64 - 2.0, hf.rows() as f64 - 2.0));
    if corner.min_element() < 0.0 {
        return None;
    }
    let [col, row] = [corner.x as usize, corner.y as usize];
    let mut heights = [0.0; 4];
    for (k, (x, y)) in [(0, 0), (1, 0), (0, 1), (1, 1)].into_iter().enumerate() {
        heights[k] = view.displace(hf.node(col + x, row + y).filter(|p| p.is_finite())?).ok()?.point.z;
    }
    let ground = CellTriangle::at(g - corner).height(heights, g - corner);
    view.pinhole().project(sample.p_world.truncate().extend(ground + sample.lift)).ok()
}

/// The four pixel centres around a pixel position.
fn around(at: DVec2) -> [DVec2; 4] {
    let corner = (at - 0.5).floor() + 0.5;
    [(0.0, 0.0), (1.0, 0.0), (0.0, 1.0), (1.0, 1.0)].map(|(dx, dy)| corner + DVec2::new(dx, dy))
}

/// Index of the pixel at a pixel position; `None` beside the picture.
fn pixel(at: DVec2, frame: &Frame) -> Option<usize> {
    let inside = at.x >= 0.0 && at.y >= 0.0 && at.x < frame.width as f64 && at.y < frame.height as f64;
    inside.then(|| at.y as usize * frame.width + at.x as usize)
}

fn is_same(frame: &Frame, k: usize, depth: f64) -> bool {
    let drawn = f64::from(frame.depth[k]);
    drawn == depth || (drawn - depth).abs() <= AGREES * depth.min(drawn)
}

/// Whether the depths around the sample's pixel belong to the ground the sample stands on, or to something behind it.
///
/// The four nearest pixel centres vote, each with its bilinear weight and with its own expected depth.
fn in_buffer(view: &View, terrain: Option<&Heightfield>, sample: &Sample, j: &SampleImage, frame: &Frame) -> DepthTest {
    let plane = terrain.and_then(|hf| footprint(view, hf, sample)).unwrap_or(Footprint {
        at: j.pixel,
        depth: j.depth,
        gradient: DVec2::ZERO,
        roughness: 0.0,
    });
    // The plane stands for the ground about one cell around; beyond that its slope says nothing.
    let reach = 1.5 * terrain.map_or(0.0, |hf| hf.spacing().max_element());
    // A pixel centre is up to 0.7 px away, perhaps on a neighbouring slope; and the buffer holds f32.
    let tolerance = (0.7 * plane.roughness).min(reach) + 1e-6 * j.depth;
    let corner = (j.pixel - 0.5).floor();
    let part = j.pixel - 0.5 - corner;
    let (mut seen, mut missed) = (0.0, true);
    for (dx, dy) in [(0.0, 0.0), (1.0, 0.0), (0.0, 1.0), (1.0, 1.0)] {
        let at = corner + DVec2::new(dx, dy);
        let column = (at.x.max(0.0) as usize).min(frame.width - 1);
        let row = (at.y.max(0.0) as usize).min(frame.height - 1);
        let centre = DVec2::new(column as f64 + 0.5, row as f64 + 0.5);
        let weight = (1.0 - (part.x - dx).abs()) * (1.0 - (part.y - dy).abs());
        // Sky is infinitely far away: nothing was drawn in front.
        let drawn = f64::from(frame.depth[row * frame.width + column]);
        let expected = plane.depth + plane.gradient.dot(centre - plane.at).clamp(-reach, reach);
        if drawn >= expected - tolerance {
            seen += weight;
        }
        missed &= drawn > expected + tolerance + 1e-3 * j.depth;
    }
    DepthTest { seen: seen >= 0.5, missed: missed && terrain.is_some() }
}

/// Image of the tangent plane of the drawn ground under `sample`, by differences over a tenth of a cell.
fn footprint(view: &View, hf: &Heightfield, sample: &Sample) -> Option<Footprint> {
    let ground = sample.p_world - DVec3::Z * sample.lift;
    let cell = hf.grid_from_scene(ground.truncate()).floor();
    let step = 0.1 * hf.spacing();
    // Differences must stay in one triangle: lean towards its middle.
    let inside = hf.grid_from_scene(ground.truncate()) - cell;
    let middle = if inside.x >= inside.y { DVec2::new(2.0 / 3.0, 1.0 / 3.0) } else { DVec2::new(1.0 / 3.0, 2.0 / 3.0) };
    let base = inside.lerp(middle, 0.5);
    let (col, row) = (cell.x as usize, cell.y as usize);
    if cell.min_element() < 0.0 || col + 1 >= hf.cols() || row + 1 >= hf.rows() {
        return None;
    }
    let height = |f: DVec2| hf.surface_in_cell(col, row, f.x, f.y);
    let (delta, h0) = (0.02, height(base)?);
    let slope_x = (height(base + DVec2::new(delta, 0.0))? - h0) / (delta * hf.spacing().x);
    let slope_y = -(height(base + DVec2::new(0.0, delta))? - h0) / (delta * hf.spacing().y);
    let image = |p: DVec3| view.project(p).ok();
    let (i0, ix, iy) = (
        image(ground)?,
        image(ground + step.x * DVec3::new(1.0, 0.0, slope_x))?,
        image(ground + step.y * DVec3::new(0.0, 1.0, slope_y))?,
    );
    let (px, py) = (ix.pixel - i0.pixel, iy.pixel - i0.pixel);
    let (wx, wy) = (ix.depth - i0.depth, iy.depth - i0.depth);
    let area = px.x * py.y - px.y * py.x;
    // East then north turns clockwise on an image whose y points down: negative area = seen from above.
    let facing = area < -1e-12;
    let gradient = if facing { DVec2::new(wx * py.y - wy * px.y, wy * px.x - wx * py.x) / area } else { DVec2::ZERO };
    let around = (0..8).filter_map(|k| {
        let (sin, cos) = (f64::from(k) * std::f64::consts::FRAC_PI_4).sin_cos();
        let xy = ground.truncate() + hf.spacing() * DVec2::new(cos, sin);
        let there = image(xy.extend(hf.surface_at(xy)?))?;
        Some((there.depth - i0.depth).abs() / (there.pixel - i0.pixel).length().max(1.0))
    });
    let roughness = around.fold(gradient.length(), f64::max);
    Some(Footprint { at: i0.pixel, depth: i0.depth, gradient, roughness })
}
