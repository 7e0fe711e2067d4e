//! How marks look: hidden parts, symbols, rims, distances.

use crate::{Color, LineClass};
use belvedere_core::DVec2;
use serde::{Deserialize, Serialize};

/// What happens to the parts of a line, area outline or point that the terrain hides.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "snake_case")]
pub enum Hidden {
    /// Drawn as if nothing were in front.
    Show,
    /// Drawn faintly.
    Fade,
    /// Drawn dashed and thinner.
    #[default]
    Dash,
    /// Not drawn.
    Cut,
}

/// Shape of a point marker.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "snake_case")]
pub enum Symbol {
    /// A disc.
    #[default]
    Dot,
    /// A triangle with its tip up: a summit.
    #[serde(alias = "peak")]
    Triangle,
    /// An upright square.
    Square,
    /// A drop whose tip stands on the point.
    Pin,
    /// A diagonal cross.
    Cross,
    /// A house: a mountain hut.
    Hut,
    /// Two brackets back to back: a mountain pass.
    Pass,
    /// A cabin under its cable: a station of a lift.
    Lift,
    /// A fan of rays: a viewpoint.
    Viewpoint,
    /// A square with a P: a car park.
    #[serde(alias = "car_park")]
    Parking,
    /// A ring: a village.
    #[serde(alias = "village")]
    Ring,
    /// A ring around a dot: a town.
    #[serde(alias = "town", alias = "city")]
    Target,
    /// A drawing of the scene's own, see [`crate::Scene::drawings`], by its number.
    #[serde(skip)]
    Own(u16),
}

impl Symbol {
    /// Every symbol that has a name, with its name.
    pub const NAMED: [(&str, Self); 12] = [
        ("dot", Self::Dot),
        ("triangle", Self::Triangle),
        ("square", Self::Square),
        ("pin", Self::Pin),
        ("cross", Self::Cross),
        ("hut", Self::Hut),
        ("pass", Self::Pass),
        ("lift", Self::Lift),
        ("viewpoint", Self::Viewpoint),
        ("parking", Self::Parking),
        ("ring", Self::Ring),
        ("target", Self::Target),
    ];

    /// The symbol of that name, or of one of its other names: `peak`, `car_park`, `village`, `town`, `city`.
    pub fn named(name: &str) -> Option<Self> {
        let other = match name {
            "peak" => "triangle",
            "car_park" => "parking",
            "village" => "ring",
            "town" | "city" => "target",
            name => name,
        };
        Self::NAMED.iter().find(|(known, _)| *known == other).map(|(_, symbol)| *symbol)
    }
}

/// What a point of a map is.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum PlaceKind {
    /// A summit.
    Peak,
    /// A mountain pass.
    Pass,
    /// A mountain hut or shelter.
    Hut,
    /// A station of a lift.
    Lift,
    /// A viewpoint.
    Viewpoint,
    /// A car park.
    Parking,
    /// A city.
    City,
    /// A town.
    Town,
    /// A village.
    Village,
    /// A hamlet or farm.
    Hamlet,
    /// Another place with a name.
    Locality,
}

impl PlaceKind {
    /// Its usual symbol.
    pub fn symbol(self) -> Symbol {
        match self {
            Self::Peak => Symbol::Triangle,
            Self::Pass => Symbol::Pass,
            Self::Hut => Symbol::Hut,
            Self::Lift => Symbol::Lift,
            Self::Viewpoint => Symbol::Viewpoint,
            Self::Parking => Symbol::Parking,
            Self::City | Self::Town => Symbol::Target,
            Self::Village => Symbol::Ring,
            Self::Hamlet | Self::Locality => Symbol::Dot,
        }
    }

    /// Its usual colour.
    pub fn color(self) -> Color {
        match self {
            Self::Peak | Self::Pass => Color::rgb(0x5a, 0x3a, 0x1c),
            Self::Hut => Color::rgb(0x9c, 0x25, 0x22),
            Self::Lift => Color::rgb(0x3a, 0x3f, 0x52),
            Self::Viewpoint => Color::rgb(0x1c, 0x68, 0x5c),
            Self::Parking => Color::rgb(0x1f, 0x5a, 0xa6),
            Self::City | Self::Town | Self::Village | Self::Hamlet | Self::Locality => Color::rgb(0x2f, 0x33, 0x38),
        }
    }
}

/// A drawing of polygons around its point: a symbol of one's own.
#[derive(Debug, Clone, PartialEq)]
pub struct Drawing {
    /// Polygons from below: their rings in half sizes of the symbol, y down, holes oriented against their outer ring; and their colour,
    /// `None` = that of the layer.
    pub shapes: Vec<(Vec<Vec<DVec2>>, Option<Color>)>,
}

/// A height that is written below a name.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct WrittenHeight {
    /// In metres.
    pub metres: f64,
    /// Whether it is written in feet.
    pub in_feet: bool,
}

impl std::fmt::Display for WrittenHeight {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self.in_feet {
            false => write!(f, "{:.0} m", self.metres),
            true => write!(f, "{:.0} ft", self.metres / 0.3048),
        }
    }
}

/// Style of the points of a layer, besides colour and size.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PointStyle {
    /// Shape.
    pub symbol: Symbol,
    /// Colour of the rim; `None` = no rim.
    pub casing: Option<Color>,
    /// Height of the letters of names, pixels; `None` = no names. Names that would overlap earlier ones are left out.
    pub label_px: Option<f64>,
}

impl Default for PointStyle {
    fn default() -> Self {
        Self { symbol: Symbol::Dot, casing: Some(Color::rgb(255, 255, 255)), label_px: None }
    }
}

/// Style of one feature, where it differs from that of its layer.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FeatureStyle {
    /// Colour, or fill of an area; `None` = that of the layer.
    pub color: Option<Color>,
    /// Colour of the casing of a line; `None` = as the layer has it.
    pub casing: Option<Color>,
    /// Width of a line or diameter of a point in those of its layer, > 0; areas ignore it.
    pub scale: f64,
    /// What a point is, if it is known.
    pub kind: Option<PlaceKind>,
    /// What a line is, if it is known.
    pub class: Option<LineClass>,
    /// Symbol of a point; `None` = that of the layer.
    pub symbol: Option<Symbol>,
    /// Importance of the name: names of larger ones are placed first; `None`: after all that have one, in the order of the layer.
    pub rank: Option<f64>,
    /// Height written below the name.
    pub height: Option<WrittenHeight>,
}

impl Default for FeatureStyle {
    fn default() -> Self {
        Self { color: None, casing: None, scale: 1.0, kind: None, class: None, symbol: None, rank: None, height: None }
    }
}

/// Distance between marks along a line.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub enum DistanceMarkers {
    /// A round distance that gives about ten marks on the longest line of the layer.
    #[default]
    Auto,
    /// Distance along the ground, scene units, > 0.
    Every(f64),
}
