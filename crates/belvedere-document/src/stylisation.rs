//! Stylisation of the scene document.

use belvedere_scene::Stylisation;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Strengths that `true` stands for.
const EDGES: f64 = 0.7;
const UNSHARP: f64 = 4.0;

/// What is done to the surfaces of the picture, before lines and names are drawn over them.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct StylisationDoc {
    /// Dark edges where depth breaks, and between the faces of solids: a strength in 0..=1; `true` is 0.7.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub edges: Option<SwitchOrStrength>,
    /// Shade behind what stands out (depth unsharp masking): a strength in 0..=10; `true` is 4.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub unsharp: Option<SwitchOrStrength>,
}

/// On or off, or a strength.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(untagged, expecting = "true, false or a strength was expected")]
pub enum SwitchOrStrength {
    /// On or off.
    Switch(bool),
    /// A strength.
    Strength(f64),
}

impl SwitchOrStrength {
    fn strength(self, on: f64) -> f64 {
        match self {
            Self::Switch(true) => on,
            Self::Switch(false) => 0.0,
            Self::Strength(strength) => strength,
        }
    }
}

impl StylisationDoc {
    /// What `true` for both stands for.
    pub fn usual() -> Self {
        let on = Some(SwitchOrStrength::Switch(true));
        Self { edges: on, unsharp: on }
    }

    /// The strengths.
    ///
    /// # Errors
    /// The key that is out of range, and why.
    pub fn strengths(&self) -> Result<Stylisation, (&'static str, String)> {
        let of = |key: &'static str, value: Option<SwitchOrStrength>, on: f64, most: f64| {
            let value = value.map_or(0.0, |v| v.strength(on));
            let fits = (0.0..=most).contains(&value);
            fits.then_some(value as f32).ok_or_else(|| (key, format!("{key} is {value}, it must be in 0..={most}")))
        };
        Ok(Stylisation {
            edges: of("edges", self.edges, EDGES, 1.0)?,
            unsharp: of("unsharp", self.unsharp, UNSHARP, 10.0)?,
        })
    }
}
