//! Styles that follow a property of the features.

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
