//! What a line of a map is, and how lines of each class are drawn.

use crate::Color;
use serde::{Deserialize, Serialize};

/// What a line of a map is.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "snake_case")]
pub enum LineClass {
    /// A route, whatever it follows: drawn as lines of no class are.
    Route,
    /// A motorway or another road between towns.
    MainRoad,
    /// Any other road.
    Road,
    /// A track of farms and forests.
    Track,
    /// A path.
    Path,
    /// A railway.
    Railway,
    /// A lift: straight cables between pylons, above the ground.
    Lift,
    /// A river or canal.
    River,
    /// A stream or ditch.
    Stream,
    /// A piste for beginners.
    PisteGreen,
    /// An easy piste.
    PisteBlue,
    /// A piste of medium difficulty.
    PisteRed,
    /// A difficult piste.
    PisteBlack,
    /// A piste without a grade.
    Piste,
    /// A border of countries, communes or reserves.
    Border,
}

/// How lines of a class are drawn.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LineLook {
    /// Colour of the line.
    pub color: Color,
    /// Width on screen, pixels.
    pub width_px: f64,
    /// Colour of the casing.
    pub casing: Color,
}

impl LineClass {
    /// Every class with its name in scene files and its words in legends.
    pub const NAMED: [(Self, &str, &str); 15] = [
        (Self::Route, "route", "Route"),
        (Self::MainRoad, "main_road", "Main road"),
        (Self::Road, "road", "Road"),
        (Self::Track, "track", "Track"),
        (Self::Path, "path", "Path"),
        (Self::Railway, "railway", "Railway"),
        (Self::Lift, "lift", "Lift"),
        (Self::River, "river", "River"),
        (Self::Stream, "stream", "Stream"),
        (Self::PisteGreen, "piste_green", "Green piste"),
        (Self::PisteBlue, "piste_blue", "Blue piste"),
        (Self::PisteRed, "piste_red", "Red piste"),
        (Self::PisteBlack, "piste_black", "Black piste"),
        (Self::Piste, "piste", "Piste"),
        (Self::Border, "border", "Border"),
    ];

    /// The class of a name as scene files write it, in the plural as well.
    pub fn named(name: &str) -> Option<Self> {
        let name = name.trim().to_lowercase().replace([' ', '-'], "_");
        let singular = name.strip_suffix('s').unwrap_or(&name);
        Self::NAMED.iter().find(|(_, known, _)| *known == name || *known == singular).map(|(class, ..)| *class)
    }

    /// Its words in legends.
    pub fn words(self) -> &'static str {
        Self::NAMED.iter().find(|(class, ..)| *class == self).map_or("", |(.., words)| words)
    }

    /// Whether routes follow it: such a line that must be seen is drawn as a route.
    pub fn is_way(self) -> bool {
        matches!(self, Self::Route | Self::MainRoad | Self::Road | Self::Track | Self::Path)
    }

    /// How its lines are drawn. Classes of one width and casing differ in lightness, so that every kind of colour vision tells them apart.
    pub fn look(self) -> LineLook {
        let (color, width_px, casing) = match self {
            Self::Route => (0xd7301f, 3.0, 0xffffff),
            Self::MainRoad => (0xf6b03c, 2.6, 0x54401f),
            Self::Road => (0xfdf8ea, 1.8, 0x6a625a),
            Self::Track => (0xb8741f, 1.5, 0xfff6e4),
            Self::Path => (0x4b2f1c, 1.2, 0xfff6e4),
            Self::Railway => (0xe4e4ea, 1.3, 0x17171c),
            Self::Lift => (0x14141a, 1.5, 0xffffff),
            Self::River => (0x1f78c8, 2.4, 0xd8ecfa),
            Self::Stream => (0x3f95dc, 1.2, 0xd8ecfa),
            Self::PisteGreen => (0x6cd05a, 4.2, 0xffffff),
            Self::PisteBlue => (0x2a52d8, 4.2, 0xffffff),
            Self::PisteRed => (0xc8143c, 4.2, 0xffffff),
            Self::PisteBlack => (0x121216, 4.2, 0xffffff),
            Self::Piste => (0xc48cf4, 4.2, 0x4a2470),
            Self::Border => (0x9a2a86, 1.8, 0xf4dcf0),
        };
        let [color, casing] = [color, casing].map(|v: u32| Color::rgb((v >> 16) as u8, (v >> 8) as u8, v as u8));
        LineLook { color, width_px, casing }
    }
}
