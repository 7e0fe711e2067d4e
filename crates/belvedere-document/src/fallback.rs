//! Rules of what happens to layers that hide a target where no bend shows it.

use schemars::JsonSchema;
use serde::Serialize;

/// How something gives the view free.
#[derive(Debug, Clone, Copy, PartialEq, Eq, JsonSchema, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum FallbackKind {
    /// Drawn so that what lies behind shows through.
    Transparency,
    /// Left out within the cone of rays to the target, with its edge drawn.
    Cutaway,
    /// Moved aside, part by part, just as far as needed, with leaders from where it was.
    Explosion,
}

/// One rule: what happens to a layer.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Fallback {
    /// Id of the layer; `None` = every layer that hides the target and has no rule of its own.
    pub layer: Option<String>,
    /// What happens to what of it hides the target.
    pub kind: FallbackKind,
}

impl std::str::FromStr for Fallback {
    type Err = String;

    /// Reads `KIND` or `LAYER:KIND`.
    fn from_str(text: &str) -> Result<Self, String> {
        let (layer, kind) = text.rsplit_once(':').map_or((None, text), |(layer, kind)| (Some(layer), kind));
        let kind = match kind.trim() {
            "transparency" => FallbackKind::Transparency,
            "cutaway" => FallbackKind::Cutaway,
            "explosion" => FallbackKind::Explosion,
            other => {
                return Err(format!(
                    "\"{other}\" is no fallback; possible are transparency, cutaway, explosion, each alone or after the id of a layer, as towers:cutaway"
                ));
            }
        };
        Ok(Self { layer: layer.map(|l| l.trim().to_owned()), kind })
    }
}
