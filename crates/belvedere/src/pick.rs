//! `pick`: the object and point at a pixel.

use crate::{BelvedereError, Session};
use belvedere_core::{DVec2, DVec3, View, polygon};
use belvedere_scene::{AreaLayer, Heightfield, Layer, LayerKind, LineLayer, PointLayer, Progress, Scene};
use belvedere_sight::trace::{RayHit, Tracer};
use belvedere_sight::volume::VolumeTracer;
use rayon::prelude::*;
use schemars::JsonSchema;
use serde::Serialize;
use std::sync::atomic::{AtomicUsize, Ordering};

/// Answer of [`pick`].
#[derive(Debug, Clone, PartialEq, JsonSchema, Serialize)]
pub struct PickReport {
    /// One per input pixel, in input order; null where only sky is seen.
    pub pixels: Vec<Option<Picked>>,
}

/// The object and point at one pixel.
#[derive(Debug, Clone, PartialEq, JsonSchema, Serialize)]
pub struct Picked {
    /// Undisplaced world point: of the surface, of the line at its point nearest to the pixel, or of the point feature; scene coordinates.
    pub point: [f64; 3],
    /// Depth at which it is seen, scene units.
    pub depth: f64,
    /// Segment of the curved ray: `2k` straight part of viewpoint `k`, `2j-1` transition of turn `j`.
    pub segment: u32,
    /// Id of the layer.
    pub layer: String,
    /// Name of the feature of a line, area or point layer, of the part of a mesh, or of the atom of a molecule; null for other surfaces
    /// and for features without a name.
    pub feature: Option<String>,
}

/// Objects at pixels (origin at the outer corner of the top-left pixel, centres at .5), by the exact tracer.
///
/// A visible line or point within half its width of the pixel takes precedence over the surface, and of several the one in the last
/// layer. Areas belong to the ground on which they are painted. A volume is reported where it has absorbed half of the light. Pixels
/// outside the image have results as far as the camera has rays there.
///
/// # Errors
/// [`BelvedereError::UnderGround`], [`BelvedereError::Cancelled`].
pub fn pick(session: &Session, pixels: &[[f64; 2]], progress: &Progress) -> Result<PickReport, BelvedereError> {
    session.check_drawable()?;
    let (scene, view) = (session.scene(), session.view());
    progress.tick("prepare", 0.0)?;
    let tracer = Tracer::new(scene, view);
    let volumes = VolumeTracer::new(scene, view);
    let marks = Marks::new(scene, view);
    let solid = |at: DVec2| {
        let hit = tracer.first_hit(at);
        volumes.first_hit(at, hit.map_or(f64::INFINITY, |h| h.depth)).or(hit)
    };
    let done = AtomicUsize::new(0);
    let one = |pixel: &[f64; 2]| -> Result<Option<Picked>, BelvedereError> {
        let at = DVec2::from_array(*pixel);
        let picked = marks.at(&tracer, at).or_else(|| solid(at).and_then(|seen| surface(scene, &seen)));
        let done = done.fetch_add(1, Ordering::Relaxed) + 1;
        progress.tick("pick", done as f64 / pixels.len() as f64)?;
        Ok(picked)
    };
    Ok(PickReport { pixels: pixels.par_iter().map(one).collect::<Result<_, _>>()? })
}

impl Session {
    /// [`pick`] without progress.
    ///
    /// # Errors
    /// Those of [`pick`].
    pub fn pick(&self, pixels: &[[f64; 2]]) -> Result<Vec<Option<Picked>>, BelvedereError> {
        Ok(pick(self, pixels, &Progress::silent())?.pixels)
    }
}

fn named(name: &str) -> Option<String> {
    (!name.is_empty()).then(|| name.to_owned())
}

/// The surface, or the last area painted on it.
fn surface(scene: &Scene, seen: &RayHit) -> Option<Picked> {
    let layer = scene.layers.get(seen.layer)?;
    let (mut id, mut feature) = (&layer.id, None);
    if let Some(m) = layer.kind.mesh() {
        feature = seen.triangle().and_then(|t| m.name_of(t)).map(str::to_owned);
    }
    if let Some(m) = layer.kind.molecule() {
        feature = seen.triangle().and_then(|t| m.name_of(t));
    }
    if layer.kind.terrain().is_some() {
        for (other, area) in scene.layers.iter().filter_map(area_of) {
            let hit = area.features.iter().find(|f| polygon::is_inside(&f.rings, seen.point.truncate()));
            if let Some(hit) = hit {
                (id, feature) = (&other.id, named(&hit.name));
            }
        }
    }
    Some(Picked { point: seen.point.to_array(), depth: seen.depth, segment: seen.segment, layer: id.clone(), feature })
}

fn area_of(layer: &Layer) -> Option<(&Layer, &AreaLayer)> {
    layer.kind.areas().map(|a| (layer, a))
}

/// Images of lines and points, in the order of the layers.
struct Marks<'a> {
    view: &'a View,
    layers: Vec<(&'a Layer, f64, Vec<Path<'a>>)>,
}

/// Distance from the drawn ground below which a vertex counts as lying on it, scene units.
const ON_GROUND: f64 = 0.01;
/// Largest relative depth of a visible line or point behind the first surface: on the ground only rounding, elsewhere
/// less than the lift of a line seen across its own ground.
const NO_DEEPER: [f64; 2] = [1e-6, 5e-4];

/// A feature: its name and the images of its vertices, lifted.
struct Path<'a> {
    name: &'a str,
    /// The ground and the height over it, if all vertices lie on the ground.
    laid: Option<(&'a Heightfield, f64)>,
    vertices: Vec<(DVec3, Option<(DVec2, f64)>)>,
}

impl<'a> Marks<'a> {
    fn new(scene: &'a Scene, view: &'a View) -> Self {
        let terrain = scene.terrain();
        let is_on_ground = |p: &DVec3| {
            let ground = terrain.and_then(|hf| hf.surface_at(p.truncate()));
            ground.is_some_and(|ground| (ground - p.z).abs() <= ON_GROUND)
        };
        let path = |name: &'a str, points: &[DVec3], lift: f64| {
            let laid = terrain.filter(|_| points.iter().all(is_on_ground)).map(|hf| (hf, lift));
            let image = |p: DVec3| view.project(p).ok().map(|i| (i.pixel, i.depth));
            let vertices = points.iter().map(|p| *p + lift * DVec3::Z).map(|p| (p, image(p))).collect();
            Path { name, laid, vertices }
        };
        let lines = |l: &'a LineLayer| l.features.iter().map(|f| path(&f.name, &f.points, l.lift_m)).collect();
        let points = |l: &'a PointLayer| l.features.iter().map(|f| path(&f.name, &[f.position], l.lift_m)).collect();
        let layers = scene.layers.iter().filter_map(|layer| match &layer.kind {
            LayerKind::Line(l) => Some((layer, 0.5 * l.width_px, lines(l))),
            LayerKind::Point(l) => Some((layer, 0.5 * l.size_px, points(l))),
            _ => None,
        });
        Self { view, layers: layers.collect() }
    }

    /// The topmost visible line or point at a pixel.
    fn at(&self, tracer: &Tracer<'_>, pixel: DVec2) -> Option<Picked> {
        self.layers.iter().rev().find_map(|(layer, half_px, paths)| {
            let near = paths.iter().filter_map(|path| Some((path, path.nearest(pixel, *half_px)?)));
            let mut near: Vec<_> = near.collect();
            near.sort_by(|a, b| a.1.1.total_cmp(&b.1.1));
            near.into_iter().find_map(|(path, (p, _))| {
                let ground = path.laid.and_then(|(hf, lift)| Some(hf.surface_at(p.truncate())? + lift));
                let (p, no_deeper) = ground.map_or((p, NO_DEEPER[1]), |z| (p.with_z(z), NO_DEEPER[0]));
                let image = self.view.project(p).ok()?;
                let first = tracer.first_hit(image.pixel);
                if first.is_some_and(|seen| seen.depth < image.depth * (1.0 - no_deeper)) {
                    return None;
                }
                Some(Picked {
                    point: p.to_array(),
                    depth: image.depth,
                    segment: image.segment,
                    layer: layer.id.clone(),
                    feature: named(path.name),
                })
            })
        })
    }
}

impl Path<'_> {
    /// World point of the path nearest to a pixel on the image, and its distance there; `None` if farther than `reach` pixels.
    fn nearest(&self, pixel: DVec2, reach: f64) -> Option<(DVec3, f64)> {
        let mut best: Option<(DVec3, f64)> = None;
        let mut take = |p: DVec3, distance: f64| {
            if distance <= reach && best.is_none_or(|b| distance < b.1) {
                best = Some((p, distance));
            }
        };
        if let [(p, Some((at, _)))] = self.vertices.as_slice() {
            take(*p, at.distance(pixel));
        }
        for pair in self.vertices.windows(2) {
            let [(p, Some((a, near))), (q, Some((b, far)))] = [pair[0], pair[1]] else { continue };
            let along = b - a;
            let length = along.length_squared();
            let t = if length > 0.0 { ((pixel - a).dot(along) / length).clamp(0.0, 1.0) } else { 0.0 };
            // Converts a share on the image to a share in space by the depths.
            let share = t * near / (t * near + (1.0 - t) * far);
            take(p.lerp(q, share), (a + t * along).distance(pixel));
        }
        best
    }
}
