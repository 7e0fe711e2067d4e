//! The camera of data of which no scene says how to look at them, and how their ground ends.

use crate::BelvedereError;
use crate::scene_file::camera::set_camera;
use crate::scene_file::{Document, LayerDoc, LightDoc};
use belvedere_construct::views::{core_of_town, outline, over_land};
use belvedere_core::quantile::{Rank, quantile};
use belvedere_core::{Aabb, DVec2, DVec3, Navigation, Pinhole, Projection, Warning, WarningKind};
use belvedere_scene::{Edge, Layer, Light, Scene};

/// Ground of which nothing says how it ends: alone it is a block, under lines, areas and points it fades where its data end.
pub(crate) fn end_ground(layers: &mut [LayerDoc]) {
    let mut others = layers.iter().filter(|layer| !matches!(layer, LayerDoc::Terrain(_))).peekable();
    let edge = if others.peek().is_none() { Edge::Block } else { Edge::Soft };
    if !others.all(is_flat) {
        return;
    }
    for layer in layers {
        if let LayerDoc::Terrain(terrain) = layer
            && terrain.style.edge == Edge::Plain
        {
            terrain.style.edge = edge;
        }
    }
}

/// Whether a layer lies on the ground, wherever it is.
fn is_flat(layer: &LayerDoc) -> bool {
    matches!(layer, LayerDoc::Line(_) | LayerDoc::Area(_) | LayerDoc::Point(_))
}

/// What the camera that was found for a document shows.
pub(crate) enum Shown {
    /// All, but for a number of buildings that stand far apart from their town.
    All(usize),
    /// Ground that fills the picture.
    Land,
    /// The features on ground.
    Features,
}

impl Shown {
    pub(crate) fn said(&self) -> Warning {
        let shown = match self {
            Self::All(0) => "all of it is shown, from the south".to_owned(),
            Self::All(1) => {
                "it is shown as far as its town reaches, without a building far apart, from the south".to_owned()
            }
            Self::All(apart) => {
                format!("it is shown as far as its town reaches, without {apart} buildings far apart, from the south")
            }
            Self::Land => "the ground fills the picture, seen from the south".to_owned(),
            Self::Features => "its features are shown, from the south".to_owned(),
        };
        let text =
            format!("no scene says how to look at this: {shown}; `belvedere show` with -o writes a scene to change");
        Warning::new(WarningKind::Assumed, text)
    }
}

/// Heading and fall of the camera that shows models and towns, degrees.
const ALL_SEEN_FROM: [f64; 2] = [20.0, 30.0];
/// Share of the width or height of the picture that they fill.
const FILLED: f64 = 0.92;
/// Triangles of a layer by which it is framed, at most about.
const OUTLINE: usize = 50_000;
/// Ground around features that is shown with them, as a share of their longer side; and how much longer than that side the ground is where
/// they are shown alone.
const AROUND: f64 = 0.15;
const MUCH_LONGER: f64 = 2.0;
/// Areas or points of which some may stand far apart, at least, and the share of them that lies beyond either side of the others.
const MANY: usize = 50;
const APART: f64 = 0.05;

/// Sets the camera of a document so that ground fills its picture, or the whole scene is in it, and tells what is shown.
pub(crate) fn show_all(document: &mut Document, scene: &Scene) -> Result<Shown, BelvedereError> {
    let (camera, shown) = match over_ground(document, scene) {
        Some(found) => found,
        None => around_all(document, scene)?,
    };
    document.camera.near = camera.pinhole.near;
    set_camera(document, &camera);
    if scene.terrain().is_some() && document.light.as_ref().is_none_or(|light| !light.states_sun()) {
        let light = Light::azimuth_at_upper_left(&camera.pinhole).map(LightDoc::from_azimuth);
        document.light =
            light.map(|light| document.light.take().unwrap_or_default().over(light)).or(document.light.take());
    }
    Ok(shown)
}

/// The camera over one ground on which nothing stands but lines, areas and points; `None` for other scenes.
fn over_ground(document: &Document, scene: &Scene) -> Option<(Navigation, Shown)> {
    let is_ground = |layer: &LayerDoc| matches!(layer, LayerDoc::Terrain(_)) || is_flat(layer);
    let ground = scene.terrain().filter(|_| document.layer.iter().all(is_ground))?;
    let features: Vec<&str> = document.layer.iter().filter(|layer| is_flat(layer)).map(LayerDoc::id).collect();
    let features = scene.layers.iter().filter(|layer| features.contains(&layer.id.as_str()));
    let part = features.filter_map(core).next().and_then(|[a, b]| {
        let side = (b - a).max_element();
        let ground = (ground.bounds().max - ground.bounds().min).truncate().max_element();
        let around = (AROUND * side).max(4.0 * AROUND * ground / 100.0);
        (side * MUCH_LONGER < ground).then(|| [a - around, b + around])
    });
    let view = over_land(ground, part, document.camera.image)?;
    let shown = if part.is_some() { Shown::Features } else { Shown::Land };
    Some((Navigation { pinhole: view.pinhole, target: view.target }, shown))
}

/// The box on the map that holds the features of a layer, without the few that stand far apart where there are many; `None` without any.
fn core(layer: &Layer) -> Option<[DVec2; 2]> {
    let kind = &layer.kind;
    let areas = kind.areas().into_iter().flat_map(|l| &l.features).filter_map(|f| f.rings.first()?.first().copied());
    let points = kind.points().into_iter().flat_map(|l| &l.features).map(|f| f.position.truncate());
    let places: Vec<DVec2> = areas.chain(points).collect();
    if places.len() >= MANY {
        let at = |axis: usize, share: f64| {
            quantile(&mut places.iter().map(|p| p[axis]).collect::<Vec<_>>(), share, Rank::Nearest)
        };
        return Some([APART, 1.0 - APART].map(|share| DVec2::new(at(0, share), at(1, share))));
    }
    let bounds = layer.bounds();
    (!bounds.is_empty()).then(|| [bounds.min.truncate(), bounds.max.truncate()])
}

/// The camera that shows the whole scene, but for buildings far apart from their town.
fn around_all(document: &Document, scene: &Scene) -> Result<(Navigation, Shown), BelvedereError> {
    let [heading, fall] = ALL_SEEN_FROM;
    let is_city = |layer: &&LayerDoc| matches!(layer, LayerDoc::City(_));
    let cities: Vec<&str> = document.layer.iter().filter(is_city).map(LayerDoc::id).collect();
    let towns = scene.layers.iter().filter(|layer| cities.contains(&layer.id.as_str()));
    let apart = towns.filter_map(|layer| core_of_town(&layer.kind.mesh()?.mesh)).map(|(_, apart)| apart).sum();
    let mut points = outline(scene, OUTLINE, &cities);
    if points.is_empty() {
        points = outline(scene, OUTLINE, &[]);
    }
    let camera = framed(&scene.bounds(), heading, fall, document.camera.image)
        .and_then(|camera| camera.holding(&points, FILLED).ok())
        .ok_or_else(|| BelvedereError::Target("there is nothing to see in these files".into()))?;
    Ok((camera, Shown::All(apart)))
}

/// A camera that shows a box from the south, `pitch_deg` over the horizon and turned by `heading_deg` clockwise from north; `None` for an
/// empty box.
fn framed(bounds: &Aabb, heading_deg: f64, pitch_deg: f64, image: [u32; 2]) -> Option<Navigation> {
    let (heading, pitch) = (heading_deg.to_radians(), pitch_deg.to_radians());
    let ahead = DVec3::new(heading.sin() * pitch.cos(), heading.cos() * pitch.cos(), -pitch.sin());
    let lens = Projection::Perspective { fov_y: 45f64.to_radians() };
    let size = (bounds.max - bounds.min).length();
    let near = (1e-4 * size).clamp(1e-6, 1.0);
    let pinhole = Pinhole::look_at(-ahead, DVec3::ZERO, DVec3::Z, lens, image, near, None).ok()?;
    Navigation { pinhole, target: DVec3::ZERO }.framing(bounds).ok().filter(|_| !bounds.is_empty())
}
