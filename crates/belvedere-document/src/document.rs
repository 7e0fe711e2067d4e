//! The scene document, key by key. Defaults are those of the format; `None` means the key was not given.

use super::layers::LayerDoc;
use super::stages::StageDoc;
use belvedere_core::{DVec3, Pinhole, Projection};
use belvedere_scene::Unit;
use schemars::JsonSchema;
use serde::de::value::{MapAccessDeserializer, SeqAccessDeserializer};
use serde::de::{Deserializer, MapAccess, SeqAccess, Visitor};
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;

/// A whole scene file, version 1.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
#[schemars(deny_unknown_fields)]
pub struct Document {
    /// Version of the format; 1.
    #[schemars(default = "one")]
    pub format: u32,
    /// Title for pictures and reports.
    #[schemars(default)]
    pub title: String,
    /// `auto`, `EPSG:n` or `local`: the system of every coordinate that is read or written.
    #[schemars(default = "auto")]
    pub crs: String,
    /// Unit of all lengths.
    #[schemars(default)]
    pub unit: Unit,
    /// `flat`, or `curved` for the drop of the ground with distance (refraction 0.13).
    #[schemars(default)]
    pub earth: EarthDoc,
    /// The camera.
    pub camera: CameraDoc,
    /// The sun.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub light: Option<LightDoc>,
    /// Marks over the picture.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub overlay: Option<super::overlay::OverlayDoc>,
    /// Title, legend, attribution, compass and scale.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub furniture: Option<super::furniture::FurnitureDoc>,
    /// What is done to the surfaces of the picture.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub stylisation: Option<super::stylisation::StylisationDoc>,
    /// Renderer of the pictures: `cpu`, `exact`, or one that the program registers; by default the fastest that there is.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub renderer: Option<super::renderer::RendererName>,
    /// Paper of the pictures that `render` writes.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub print: Option<super::print::PrintDoc>,
    /// Letters of names.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub text: Option<super::text::TextDoc>,
    /// Layers, a flat list; terrain first in drawing order.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub layer: Vec<LayerDoc>,
    /// Ways to show the same, by name: the ids of their layers. Styling sections of presets choose of them; layers of no representation
    /// are shown everywhere. A section may also name a layer.
    #[serde(default, skip_serializing_if = "BTreeMap::is_empty")]
    pub representations: BTreeMap<String, Vec<String>>,
    /// Ids of layers that are not drawn and hide nothing. What a stage or a constructor follows stays known to it.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub hidden: Vec<String>,
    /// Stages in order of application: terrain_disocclusion, ground_moves, strip, relief, spline_bend, curved_rays.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub stage: Vec<StageDoc>,
    /// Builds stages from an intent.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub constructor: Option<super::intent::ConstructorDoc>,
    /// A fly-through.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub animation: Option<super::intent::AnimationDoc>,
}

impl Document {
    /// An empty scene in a system of its own, in metres.
    pub fn seen_by(camera: CameraDoc) -> Self {
        Self {
            format: one(),
            title: String::new(),
            crs: auto(),
            unit: Unit::default(),
            earth: EarthDoc::default(),
            camera,
            light: None,
            overlay: None,
            furniture: None,
            stylisation: None,
            renderer: None,
            print: None,
            text: None,
            layer: Vec::new(),
            representations: BTreeMap::new(),
            hidden: Vec::new(),
            stage: Vec::new(),
            constructor: None,
            animation: None,
        }
    }

    /// Whether terrain disocclusion has to be solved before anything can be drawn: the scene names what must be seen, not how far the ground moves.
    pub fn solves_terrain(&self) -> bool {
        self.stage.iter().any(StageDoc::is_terrain_intent)
    }
}

/// The keys of a [`Document`] as they stand in a file; layers and stages are read by kind.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct Head {
    #[serde(default = "one")]
    pub(super) format: u32,
    #[serde(default)]
    pub(super) title: String,
    #[serde(default = "auto")]
    pub(super) crs: String,
    #[serde(default)]
    pub(super) unit: Unit,
    #[serde(default)]
    pub(super) earth: EarthDoc,
    pub(super) camera: CameraDoc,
    pub(super) light: Option<LightDoc>,
    pub(super) overlay: Option<super::overlay::OverlayDoc>,
    pub(super) furniture: Option<super::furniture::FurnitureDoc>,
    pub(super) stylisation: Option<super::stylisation::StylisationDoc>,
    pub(super) renderer: Option<super::renderer::RendererName>,
    pub(super) print: Option<super::print::PrintDoc>,
    pub(super) text: Option<super::text::TextDoc>,
    #[serde(default)]
    pub(super) representations: BTreeMap<String, Vec<String>>,
    #[serde(default)]
    pub(super) hidden: Vec<String>,
    #[serde(default)]
    #[serde(rename = "layer")]
    pub(super) _layer: serde::de::IgnoredAny,
    #[serde(default)]
    #[serde(rename = "stage")]
    pub(super) _stage: serde::de::IgnoredAny,
    pub(super) constructor: Option<super::intent::ConstructorDoc>,
    pub(super) animation: Option<super::intent::AnimationDoc>,
}

fn one() -> u32 {
    1
}

fn auto() -> String {
    "auto".into()
}

/// Shape of the earth.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum EarthDoc {
    /// A plane.
    #[default]
    Flat,
    /// A sphere of the ellipsoid's radius at the eye, refraction 0.13.
    Curved,
}

/// Perspective or parallel rays.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum ProjectionDoc {
    /// A pinhole.
    #[default]
    Perspective,
    /// Parallel rays; needs `ortho_height_m`.
    Orthographic,
}

/// The camera.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct CameraDoc {
    /// Eye.
    pub eye: PointDoc,
    /// Point that the optical axis meets; or give `heading_deg` and `pitch_deg`.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub look_at: Option<PointDoc>,
    /// Direction of view, degrees clockwise from north.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub heading_deg: Option<f64>,
    /// Direction of view, degrees below the horizon.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub pitch_deg: Option<f64>,
    /// Upright direction.
    #[serde(default = "up")]
    pub up: [f64; 3],
    /// Perspective or orthographic.
    #[serde(default)]
    pub projection: ProjectionDoc,
    /// Full vertical field of view, degrees, in (0, 180).
    #[serde(default = "fov")]
    pub fov_y_deg: f64,
    /// Scene units that fill an orthographic picture from top to bottom.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub ortho_height_m: Option<f64>,
    /// Width and height in pixels.
    #[serde(default = "image")]
    pub image: [u32; 2],
    /// Nearest drawn depth, scene units, > 0.
    #[serde(default = "near")]
    pub near: f64,
    /// Farthest drawn depth, scene units.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub far: Option<f64>,
}

impl CameraDoc {
    /// The camera of a pinhole whose optical axis meets `look_at`, upright.
    pub fn of(pinhole: &Pinhole, look_at: DVec3) -> Self {
        let (projection, fov_y_deg, ortho_height_m) = match pinhole.projection {
            Projection::Perspective { fov_y } => (ProjectionDoc::Perspective, fov_y.to_degrees(), None),
            Projection::Orthographic { height } => (ProjectionDoc::Orthographic, fov(), Some(height)),
        };
        Self {
            eye: PointDoc::Scene(pinhole.eye.to_array()),
            look_at: Some(PointDoc::Scene(look_at.to_array())),
            heading_deg: None,
            pitch_deg: None,
            up: up(),
            projection,
            fov_y_deg,
            ortho_height_m,
            image: pinhole.image,
            near: pinhole.near,
            far: pinhole.far,
        }
    }
}

fn up() -> [f64; 3] {
    [0.0, 0.0, 1.0]
}

fn fov() -> f64 {
    45.0
}

fn image() -> [u32; 2] {
    [1280, 720]
}

fn near() -> f64 {
    1.0
}

/// A position: `[x, y, z]` in the scene's system, or a table with two horizontal and one vertical key.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, JsonSchema)]
#[serde(untagged)]
pub enum PointDoc {
    /// Scene coordinates.
    Scene([f64; 3]),
    /// On the map.
    Map(MapPointDoc),
}

/// A position on the map: `lon` and `lat` (WGS84 degrees) with `height_m` or `above_ground_m`, or `x` and `y` with `above_ground_m`.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct MapPointDoc {
    /// Longitude, WGS84 degrees.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub lon: Option<f64>,
    /// Latitude, WGS84 degrees.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub lat: Option<f64>,
    /// Scene x.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub x: Option<f64>,
    /// Scene y.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub y: Option<f64>,
    /// Height above the data's datum.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub height_m: Option<f64>,
    /// Height above the undeformed terrain.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub above_ground_m: Option<f64>,
}

impl<'de> Deserialize<'de> for PointDoc {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct PointVisitor;
        impl<'de> Visitor<'de> for PointVisitor {
            type Value = PointDoc;

            fn expecting(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
                f.write_str("[x, y, z] or { lon, lat, height_m | above_ground_m } or { x, y, above_ground_m }")
            }

            fn visit_seq<A: SeqAccess<'de>>(self, seq: A) -> Result<PointDoc, A::Error> {
                <[f64; 3]>::deserialize(SeqAccessDeserializer::new(seq)).map(PointDoc::Scene)
            }

            fn visit_map<A: MapAccess<'de>>(self, map: A) -> Result<PointDoc, A::Error> {
                MapPointDoc::deserialize(MapAccessDeserializer::new(map)).map(PointDoc::Map)
            }
        }
        deserializer.deserialize_any(PointVisitor)
    }
}

/// The sun: a direction, or a time; the sky and the haze.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct LightDoc {
    /// Direction the light comes from, degrees clockwise from north; 315 by default.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub azimuth_deg: Option<f64>,
    /// Height of the light over the horizon, degrees in (0, 90]; 45 by default.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub altitude_deg: Option<f64>,
    /// The sun at this time (RFC 3339, e.g. `2026-07-01T15:00:00Z`) over the eye.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub time: Option<String>,
    /// Whether cast shadows are wanted: by the sun, and on molecules by the light over the viewer's left shoulder.
    #[serde(default)]
    pub shadows: bool,
    /// What stands behind everything: `auto` (by the height of the sun), `day`, `dusk`, `night`, `white`, a colour `#rrggbb`, or
    /// `transparent` (PNG and SVG).
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub sky: Option<String>,
    /// Haze: `true` dims the farther part of the view, `false` nothing; a number is the visibility of air near the ground in kilometres (thousands of scene units).
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub haze: Option<SwitchOrVisibility>,
    /// Share of the sky that quiet clouds cover, about, 0..=1; none by default.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub clouds: Option<f64>,
}

impl LightDoc {
    /// Names of skies.
    pub const SKIES: [&'static str; 5] = ["auto", "day", "dusk", "night", "white"];

    /// Light from a direction, radians clockwise from north.
    pub fn from_azimuth(azimuth: f64) -> Self {
        Self { azimuth_deg: Some(azimuth.to_degrees().round()), ..Self::default() }
    }

    /// Whether a direction or a time is stated.
    pub fn states_sun(&self) -> bool {
        self.azimuth_deg.is_some() || self.altitude_deg.is_some() || self.time.is_some()
    }

    /// This light where it states something, `below` elsewhere: a direction takes the place of a time, and the other way round.
    pub fn over(self, below: Self) -> Self {
        let sun = if self.states_sun() { &self } else { &below };
        Self {
            azimuth_deg: sun.azimuth_deg,
            altitude_deg: sun.altitude_deg,
            time: sun.time.clone(),
            shadows: self.shadows || below.shadows,
            sky: self.sky.clone().or(below.sky.clone()),
            haze: self.haze.or(below.haze),
            clouds: self.clouds.or(below.clouds),
        }
    }

    /// Name of the sky that lets through what is laid behind the picture.
    pub const TRANSPARENT: &'static str = "transparent";
}

/// On or off, or the visibility.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(untagged, expecting = "true, false or the visibility in kilometres was expected")]
pub enum SwitchOrVisibility {
    /// On or off.
    Switch(bool),
    /// Distance at which a black thing is seen in 2 % contrast, kilometres.
    Kilometres(f64),
}
