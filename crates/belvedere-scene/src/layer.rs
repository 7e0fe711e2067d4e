//! Layers and their styles.

use crate::{
    BoxLayer, BoxShape, Climate, Color, CoverMap, DistanceMarkers, FeatureStyle, Heightfield, Hidden, MeshLayer,
    MoleculeLayer, OwnLayer, PointStyle, Ramp, VolumeLayer,
};
use belvedere_core::{Aabb, DVec2, DVec3, Pinhole};
use serde::{Deserialize, Serialize};
use std::sync::Arc;

/// Relief shading of terrain.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "snake_case")]
pub enum Relief {
    /// Several light directions blended as in Swiss relief maps.
    #[default]
    Swiss,
    /// The scene's single light.
    Sun,
    /// No shading.
    None,
}

/// Normals used to shade terrain.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "snake_case")]
pub enum Shading {
    /// Undisplaced normals: light stays fixed to the map.
    #[default]
    Map,
    /// Normals of the deformed ground.
    Deformed,
}

/// Built-in tints.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "snake_case")]
pub enum PaletteName {
    /// Summer by the climate of the place, or by the range of heights where the place is not known.
    #[default]
    Auto,
    /// Meadows, forest, rock and snow by the climate of the place, in summer.
    Swiss,
    /// The same in winter, with snow down to the valleys.
    Winter,
    /// The same in autumn.
    Autumn,
    /// Green valleys, brown slopes, white summits.
    Alpine,
    /// Sand and rust.
    Desert,
    /// Rock and ice.
    Glacial,
    /// Blue to yellow in even steps of lightness: the one that is read most safely.
    Clear,
    /// One light grey.
    Plain,
    /// By height over the sea alone, as in an atlas.
    Atlas,
    /// Dark blue.
    Night,
}

impl PaletteName {
    /// All of them, as files write them.
    pub const ALL: [(&'static str, Self); 11] = [
        ("auto", Self::Auto),
        ("swiss", Self::Swiss),
        ("winter", Self::Winter),
        ("autumn", Self::Autumn),
        ("alpine", Self::Alpine),
        ("desert", Self::Desert),
        ("glacial", Self::Glacial),
        ("clear", Self::Clear),
        ("plain", Self::Plain),
        ("atlas", Self::Atlas),
        ("night", Self::Night),
    ];
}

/// Hypsometric tint.
#[derive(Debug, Clone, PartialEq)]
pub enum Palette {
    /// A built-in one.
    Named(PaletteName),
    /// A built-in one at a place on the earth, whose climate is known, and whose land cover may be.
    Placed(PaletteName, Climate, Option<Arc<CoverMap>>),
    /// A colour ramp given by the user.
    Ramp(Arc<Ramp>),
}

impl Default for Palette {
    fn default() -> Self {
        PaletteName::default().into()
    }
}

impl From<PaletteName> for Palette {
    fn from(name: PaletteName) -> Self {
        Self::Named(name)
    }
}

/// A georeferenced picture draped over terrain.
#[derive(Debug, Clone)]
pub struct Drape {
    /// Pixels, row-major, row 0 first, sRGB with straight alpha; alpha 0 = no picture there.
    pub pixels: Vec<[u8; 4]>,
    /// Columns.
    pub width: usize,
    /// Rows.
    pub height: usize,
    /// Column and row (in pixels, pixel centres at .5) of a scene point: `col = a[0] x + a[1] y + a[2]`, `row = a[3] x + a[4] y + a[5]`.
    pub pixel_from_scene: [f64; 6],
}

/// Lines of equal height on the ground.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Contours {
    /// Heights between two lines, scene units, > 0; `None` = by the scale of the picture, see [`Contours::interval_in`].
    pub interval: Option<f64>,
    /// Colour.
    pub color: Color,
}

impl Contours {
    /// Every so many lines one is thick.
    pub const INDEX: u32 = 5;
    /// Wanted distance of lines on the picture, pixels, and the flattest view that counts, as the sine of its angle.
    const WANTED_PX: f64 = 5.0;
    const FLATTEST: f64 = 0.3;

    /// Lines of an interval, scene units, or of an automatic one, in brown; light on dark tints.
    pub fn new(interval: Option<f64>, palette: &Palette) -> Self {
        let dark = matches!(palette, Palette::Named(PaletteName::Night));
        let color = if dark { Color::rgb(196, 208, 230) } else { Color::rgb(104, 66, 34) };
        Self { interval, color: color.with_alpha(190) }
    }

    /// The interval in a picture: the stated one, or the round one at which lines on ground of usual slope stand about 5 points of a screen
    /// apart in the middle of the ground.
    ///
    /// * `density`: pixels of the picture per point of a screen.
    pub fn interval_in(&self, ground: &Heightfield, pinhole: &Pinhole, density: f64) -> f64 {
        if let Some(stated) = self.interval {
            return stated;
        }
        let middle = ground.bounds().center();
        let away = pinhole.eye - middle;
        let per_px = if pinhole.is_orthographic() { 1.0 } else { away.length() } / pinhole.scale_px();
        let flat = (-pinhole.forward.z).max(Self::FLATTEST);
        let wanted = Self::WANTED_PX * density * per_px * ground.usual_slope().max(0.02) / flat;
        let power = 10f64.powf(wanted.max(1e-9).log10().floor());
        [1.0, 2.0, 5.0].map(|k| k * power).into_iter().find(|v| *v >= wanted).unwrap_or(10.0 * power)
    }
}

/// How the ground ends where its data end.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "snake_case")]
pub enum Edge {
    /// It ends.
    #[default]
    Plain,
    /// It fades into what stands behind, over a few per cent of its width.
    Soft,
    /// It stands on a plain surface that goes on.
    Mat,
    /// It is cut as a block, with sides down to a flat base.
    Block,
}

impl Edge {
    /// All of them, as files write them.
    pub const ALL: [(&'static str, Self); 4] =
        [("plain", Self::Plain), ("soft", Self::Soft), ("mat", Self::Mat), ("block", Self::Block)];
    /// Id of the layer of sides and mats, where no other layer has it.
    pub const LAYER: &'static str = "edge";
}

/// A terrain layer.
#[derive(Debug, Clone)]
pub struct TerrainLayer {
    /// Heights. Shared: copies of a scene and caches per ground identify the ground by this pointer.
    pub heightfield: Arc<Heightfield>,
    /// Pictures draped over it, later ones on top.
    pub drapes: Vec<Drape>,
    /// Relief shading.
    pub relief: Relief,
    /// Shading normals; `None` = deformed under terrain disocclusion, else map.
    pub shading: Option<Shading>,
    /// Vertical exaggeration of the shading only, > 0.
    pub exaggeration: f64,
    /// Hypsometric tint.
    pub palette: Palette,
    /// Lines of equal height; `None` = none.
    pub contours: Option<Contours>,
    /// Whether the ground fades where its data end ([`Edge::Soft`]); sides and mats are layers of their own.
    pub edge: Edge,
}

impl TerrainLayer {
    /// Ground in the usual style: Swiss relief, tinted by its range of heights.
    pub fn new(heightfield: impl Into<Arc<Heightfield>>) -> Self {
        Self {
            heightfield: heightfield.into(),
            drapes: Vec::new(),
            relief: Relief::default(),
            shading: None,
            exaggeration: 1.0,
            palette: Palette::default(),
            contours: None,
            edge: Edge::Plain,
        }
    }
}

/// One polyline of a line layer.
#[derive(Debug, Clone, Default)]
pub struct LineFeature {
    /// Name, possibly empty.
    pub name: String,
    /// Style of its own; `None` = that of its layer.
    pub style: Option<FeatureStyle>,
    /// Vertices, scene coordinates, draped on the terrain (z = ground) and densified to its spacing; at least 2.
    pub points: Vec<DVec3>,
}

/// A layer of lines.
#[derive(Debug, Clone)]
pub struct LineLayer {
    /// Polylines.
    pub features: Vec<LineFeature>,
    /// Colour.
    pub color: Color,
    /// Width on screen, pixels.
    pub width_px: f64,
    /// Casing colour; `None` = no casing.
    pub casing: Option<Color>,
    /// Style of hidden parts.
    pub hidden: Hidden,
    /// Height above ground at which the line is drawn and judged visible, metres.
    pub lift_m: f64,
    /// Marks along each line at equal distances; `None` = none.
    pub markers: Option<DistanceMarkers>,
    /// Height of the letters at those marks, pixels; usually [`crate::SMALL_LETTERS_PX`].
    pub marker_px: f64,
    /// Height of the letters of names, pixels; `None` = no names. Each name is written once, at the middle of the longest stretch that
    /// is seen; names that would overlap earlier ones are left out.
    pub label_px: Option<f64>,
    /// Length that lies beyond the ground or over its holes and was cut off, scene units; it counts as not visible.
    pub beyond: f64,
}

impl LineLayer {
    /// Lines in the usual style: 3 pixels wide, dashed where hidden, 1 m above ground, without casing, marks or names.
    pub fn new(features: Vec<LineFeature>, color: Color) -> Self {
        Self {
            features,
            color,
            width_px: 3.0,
            casing: None,
            hidden: Hidden::Dash,
            lift_m: 1.0,
            markers: None,
            marker_px: crate::SMALL_LETTERS_PX,
            label_px: None,
            beyond: 0.0,
        }
    }
}

/// One polygon of an area layer.
#[derive(Debug, Clone, Default)]
pub struct AreaFeature {
    /// Name, possibly empty.
    pub name: String,
    /// Style of its own; `None` = that of its layer.
    pub style: Option<FeatureStyle>,
    /// Rings, outer first, then holes; x and y in scene coordinates, closed implicitly.
    pub rings: Vec<Vec<DVec2>>,
}

/// Surface of an area.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum AreaSurface {
    /// Unknown: an outline, and a light fill that everything shows through.
    #[default]
    Outline,
    /// Nothing but its colour; the relief shows through.
    Plain,
    /// Water: flat, without relief shading, with a shore line.
    Water,
    /// The sea: as water, under all other areas, with a coast line.
    Sea,
    /// Forest: the relief with a quiet stipple.
    Forest,
    /// Ice: bright, the relief softened, with a blue rim.
    Glacier,
    /// A park or reserve: an outline, and a light green fill that everything shows through.
    Park,
}

impl AreaSurface {
    /// Fill where none is given.
    pub fn color(self) -> Color {
        match self {
            Self::Outline => Color::rgb(250, 244, 226).with_alpha(52),
            Self::Plain => Color::rgb(205, 205, 202).with_alpha(128),
            Self::Water => Color::rgb(74, 144, 200),
            Self::Sea => Color::rgb(64, 128, 180),
            Self::Forest => Color::rgb(78, 112, 78).with_alpha(150),
            Self::Glacier => Color::rgb(226, 238, 247).with_alpha(225),
            Self::Park => Color::rgb(88, 166, 84).with_alpha(64),
        }
    }

    /// Outline where none is given; `None` = no line but the shore or rim that the surface itself has.
    pub fn outline(self) -> Option<Color> {
        match self {
            Self::Outline => Some(Color::rgb(110, 68, 128)),
            Self::Park => Some(Color::rgb(38, 106, 52)),
            _ => None,
        }
    }

    /// Its name in scene files and records.
    pub fn name(self) -> &'static str {
        match self {
            Self::Outline => "outline",
            Self::Plain => "plain",
            Self::Water => "water",
            Self::Sea => "sea",
            Self::Forest => "forest",
            Self::Glacier => "glacier",
            Self::Park => "park",
        }
    }
}

/// A layer of areas painted on the terrain.
#[derive(Debug, Clone)]
pub struct AreaLayer {
    /// Polygons.
    pub features: Vec<AreaFeature>,
    /// Fill colour; alpha blends over the ground.
    pub fill: Color,
    /// Outline colour; `None` = none.
    pub outline: Option<Color>,
    /// Outline width on screen, pixels.
    pub width_px: f64,
    /// Surface of the areas.
    pub surface: AreaSurface,
    /// Style of hidden parts of the outline.
    pub hidden: Hidden,
    /// Height above ground for visibility, metres.
    pub lift_m: f64,
    /// Height of the letters of names, pixels; `None` = no names. Each name is written once, in the largest of the areas that bear it, where
    /// the point farthest from its border is seen; names that would overlap earlier ones are left out.
    pub label_px: Option<f64>,
    /// Area in plan of what lies beyond the ground and was left out, scene units squared; it counts as not visible.
    pub beyond: f64,
}

/// One point.
#[derive(Debug, Clone, Default)]
pub struct PointFeature {
    /// Name, possibly empty.
    pub name: String,
    /// Style of its own; `None` = that of its layer.
    pub style: Option<FeatureStyle>,
    /// Position, scene coordinates, z = ground.
    pub position: DVec3,
}

/// A layer of points.
#[derive(Debug, Clone)]
pub struct PointLayer {
    /// Points.
    pub features: Vec<PointFeature>,
    /// Colour.
    pub color: Color,
    /// Diameter on screen, pixels.
    pub size_px: f64,
    /// Symbol, casing and names.
    pub style: PointStyle,
    /// Style of hidden points.
    pub hidden: Hidden,
    /// Height above ground, metres.
    pub lift_m: f64,
    /// Number of points that lie beyond the ground or over its holes and were left out; they count as not visible.
    pub beyond: f64,
}

/// Content of a layer.
#[derive(Debug, Clone)]
pub enum LayerKind {
    /// Ground.
    Terrain(TerrainLayer),
    /// Upright boxes.
    Boxes(BoxLayer),
    /// Triangles.
    Mesh(MeshLayer),
    /// Atoms.
    Molecule(Box<MoleculeLayer>),
    /// Voxels.
    Volume(VolumeLayer),
    /// Polylines on the ground.
    Line(LineLayer),
    /// Polygons on the ground.
    Area(AreaLayer),
    /// Points on the ground.
    Point(PointLayer),
    /// A kind that a program brings along.
    Own(OwnLayer),
}

/// One layer of a scene.
#[derive(Debug, Clone)]
pub struct Layer {
    /// Unique id within the scene.
    pub id: String,
    /// Whether its features are required: constructors and measures work to make them visible.
    pub must_see: bool,
    /// Content.
    pub kind: LayerKind,
}

impl Layer {
    /// Smallest box around the layer; areas contribute nothing (they lie on the terrain).
    pub fn bounds(&self) -> Aabb {
        match &self.kind {
            LayerKind::Terrain(t) => t.heightfield.bounds(),
            LayerKind::Boxes(b) => Aabb::of(b.boxes.iter().flat_map(BoxShape::corners)),
            LayerKind::Mesh(_) | LayerKind::Molecule(_) | LayerKind::Own(_) => {
                self.kind.triangles().map_or(Aabb::EMPTY, |m| m.mesh.bounds())
            }
            LayerKind::Volume(v) => v.volume.bounds(),
            LayerKind::Line(l) => Aabb::of(l.features.iter().flat_map(|f| f.points.iter().copied())),
            LayerKind::Area(_) => Aabb::EMPTY,
            LayerKind::Point(p) => Aabb::of(p.features.iter().map(|f| f.position)),
        }
    }
}

impl LayerKind {
    /// What of the source of lines, areas or points lies beyond the ground: length, area or number, scene units.
    pub fn beyond(&self) -> f64 {
        match self {
            Self::Line(lines) => lines.beyond,
            Self::Area(areas) => areas.beyond,
            Self::Point(points) => points.beyond,
            _ => 0.0,
        }
    }

    /// Name of a line, area or point by its index; `None` if there is no such feature or it has no name.
    pub fn feature_name(&self, index: usize) -> Option<&str> {
        let name = match self {
            Self::Line(l) => &l.features.get(index)?.name,
            Self::Area(a) => &a.features.get(index)?.name,
            Self::Point(p) => &p.features.get(index)?.name,
            _ => return None,
        };
        Some(name.as_str()).filter(|name| !name.is_empty())
    }

    /// The name that all lines, areas or points have in common.
    pub fn only_name(&self) -> Option<&str> {
        let count = match self {
            Self::Line(l) => l.features.len(),
            Self::Area(a) => a.features.len(),
            Self::Point(p) => p.features.len(),
            _ => 0,
        };
        let first = self.feature_name(0);
        first.filter(|_| (1..count).all(|i| self.feature_name(i) == first))
    }

    /// Whether both are known to be one surface and differ at most in colour: terrain on the same heights, meshes of the same triangles
    /// that move alike and are as opaque.
    pub fn is_surface_of(&self, other: &Self) -> bool {
        match (self, other) {
            (Self::Terrain(a), Self::Terrain(b)) => Arc::ptr_eq(&a.heightfield, &b.heightfield),
            (Self::Mesh(a), Self::Mesh(b)) => {
                a.mesh.is_surface_of(&b.mesh)
                    && a.rigid == b.rigid
                    && (a.opacity, a.has_plate) == (b.opacity, b.has_plate)
            }
            _ => false,
        }
    }

    /// Shares the surface of another layer if it is equal, so that memory and computations per surface are spent once.
    pub fn share_surface(&mut self, other: &Self) {
        match (self, other) {
            (Self::Terrain(a), Self::Terrain(b)) if a.heightfield == b.heightfield => {
                a.heightfield = Arc::clone(&b.heightfield);
            }
            (Self::Mesh(a), Self::Mesh(b)) => a.mesh.share(&b.mesh),
            _ => {}
        }
    }

    /// Opacity of a solid (boxes, mesh, molecule), 0..=1: 1 hides what is behind, at 0 the layer is not drawn. Of each layer the nearest
    /// surface of a line of sight counts alone, so no inner side shows. 1 for everything else.
    pub fn opacity(&self) -> f32 {
        match self {
            Self::Boxes(boxes) => boxes.opacity,
            kind => kind.triangles().map_or(1.0, |mesh| mesh.opacity),
        }
    }

    /// Whether what is behind the layer shines through it: it then hides nothing, but for its plate
    /// ([`MeshLayer::has_plate`]).
    pub fn is_see_through(&self) -> bool {
        self.opacity() < 1.0
    }

    /// Sets the opacity of a solid, 0..=1; other layers stay as they are.
    pub fn set_opacity(&mut self, opacity: f32) {
        match self {
            Self::Boxes(boxes) => boxes.opacity = opacity,
            Self::Mesh(mesh) | Self::Own(OwnLayer { surface: mesh, .. }) => mesh.opacity = opacity,
            Self::Molecule(molecule) => molecule.surface.opacity = opacity,
            _ => {}
        }
    }

    /// The triangles of a mesh, of a kind of one's own, or of the surface of a molecule; `None` for everything else.
    pub fn triangles(&self) -> Option<&MeshLayer> {
        match self {
            Self::Molecule(molecule) => Some(&molecule.surface),
            other => other.mesh(),
        }
    }
}
