//! Styles that follow a property of the features.

use belvedere_scene::Color;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;

/// Colour by a property of the file's features: texts become categories, numbers become classes or a ramp.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct ColorByDoc {
    /// Property whose value gives the colour; `info` lists those of a file.
    pub property: String,
    /// Colours of single values, `#rrggbb` or `#rrggbbaa`. Without it the seven most frequent texts get colours that the
    /// colour-blind can tell apart; if every value is a number, there are classes of numbers.
    #[serde(default, skip_serializing_if = "BTreeMap::is_empty")]
    pub values: BTreeMap<String, String>,
    /// Colour of all other features, and of those without the property; by default that of the layer.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub others: Option<String>,
    /// Colours of numbers, from the lowest to the highest; `viridis` by default.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub scale: Option<ScaleName>,
    /// How numbers become colours; `quantiles` by default.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub steps: Option<StepsDoc>,
    /// Number of classes of numbers, 3 to 7; 5 by default. There are fewer where the numbers have fewer values.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub classes: Option<u8>,
    /// Limits between classes of numbers, ascending, 1 to 11 of them, in place of `steps` and `classes`; a number at a limit
    /// belongs to the class above.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub breaks: Option<Vec<f64>>,
}

impl ColorByDoc {
    /// Colours by a property with everything else by default.
    pub fn of(property: &str) -> Self {
        Self { property: property.to_owned(), ..Self::default() }
    }
}

/// How numbers become colours.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum StepsDoc {
    /// Classes of about as many features each.
    #[default]
    Quantiles,
    /// Classes of equal width.
    Equal,
    /// No classes: the colour runs from the lowest number to the highest.
    Smooth,
}

/// A scale of colours for numbers.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum ScaleName {
    /// From dark violet over green to yellow, evenly; safe for the colour-blind.
    #[default]
    Viridis,
    /// From dark blue over grey to yellow, evenly; safe for the colour-blind.
    Cividis,
    /// From light to dark blue.
    Blues,
    /// From light to dark green.
    Greens,
    /// From light to dark orange.
    Oranges,
    /// From blue over white to red, for numbers on both sides of a middle.
    BlueRed,
}

impl ScaleName {
    /// The colour at a share of the scale, clamped to 0..=1. Sources: viridis and cividis (Smith, van der Walt; Nuñez, Anderton, Renslow)
    /// at five places, the others after ColorBrewer (Brewer); between the places linear in sRGB.
    pub fn color_at(self, share: f64) -> Color {
        let stops: [u32; 5] = match self {
            Self::Viridis => [0x440154, 0x3b528b, 0x21918c, 0x5ec962, 0xfde725],
            Self::Cividis => [0x00224e, 0x434e6c, 0x7d7c78, 0xbcaf6f, 0xfee838],
            Self::Blues => [0xeff3ff, 0xbdd7e7, 0x6baed6, 0x3182bd, 0x08519c],
            Self::Greens => [0xedf8e9, 0xbae4b3, 0x74c476, 0x31a354, 0x006d2c],
            Self::Oranges => [0xfeedde, 0xfdbe85, 0xfd8d3c, 0xe6550d, 0xa63603],
            Self::BlueRed => [0x2166ac, 0x67a9cf, 0xf7f7f7, 0xef8a62, 0xb2182b],
        };
        let share = if share.is_finite() { share.clamp(0.0, 1.0) } else { 0.0 };
        let at = share * (stops.len() - 1) as f64;
        let i = (at as usize).min(stops.len() - 2);
        let part = |shift: u32| {
            let [a, b] = [stops[i], stops[i + 1]].map(|stop| f64::from(stop >> shift & 255));
            (a + (at - i as f64) * (b - a)).round() as u8
        };
        Color::rgb(part(16), part(8), part(0))
    }
}

/// Width of lines, or diameter of points, by a property of the file's features that is a number.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct SizeByDoc {
    /// Property that holds the number; features without it have the width or size of the layer.
    pub property: String,
    /// Pixels of the lowest and of the highest number, in (0, 100]; between them the size is linear.
    #[serde(default = "usual_px")]
    pub px: [f64; 2],
    /// Lowest and highest number; by default those of the features. What lies beyond has the size of the nearer end.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub range: Option<[f64; 2]>,
}

fn usual_px() -> [f64; 2] {
    [1.0, 8.0]
}

impl SizeByDoc {
    /// Sizes by a property with everything else by default.
    pub fn of(property: &str) -> Self {
        Self { property: property.to_owned(), px: usual_px(), range: None }
    }
}
