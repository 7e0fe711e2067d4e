//! Choices among named kinds.

use belvedere::scene_file::{SurfaceDoc, choices};
use belvedere::verbs::reveal::Technique;
use clap::ValueEnum;
use clap::builder::{PossibleValue, PossibleValuesParser, TypedValueParser};

/// What bends a picture.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub(crate) enum TechniqueKind {
    /// The technique that shows most; tries a spline, both, and terrain disocclusion, 120 s of solving each (or --time-limit)
    Auto,
    /// A spline over the mean ground
    Spline,
    /// Terrain disocclusion
    Terrain,
    /// Spline and terrain
    Both,
    /// Rays that bend once, around what hides most; the technique for models (--see)
    #[value(name = "curved_rays")]
    CurvedRays,
}

impl From<TechniqueKind> for Technique {
    fn from(kind: TechniqueKind) -> Self {
        match kind {
            TechniqueKind::Auto => Self::Auto,
            TechniqueKind::Spline => Self::Spline,
            TechniqueKind::Terrain => Self::Terrain,
            TechniqueKind::Both => Self::Both,
            TechniqueKind::CurvedRays => Self::CurvedRays,
        }
    }
}

/// Parser of the surface of areas: names and help texts are those of the schema.
pub(crate) fn surface() -> impl TypedValueParser<Value = SurfaceDoc> {
    let value = |(name, says): (String, String)| PossibleValue::new(name).help(says.trim_end_matches('.').to_owned());
    PossibleValuesParser::new(choices::<SurfaceDoc>().into_iter().map(value))
        .try_map(|name| serde_json::from_value(name.into()))
}

/// Renderers of this version.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub(crate) enum RendererKind {
    /// The fastest that is available: today cpu
    Auto,
    /// The rasteriser on the processor; needs no GPU
    Cpu,
    /// The tracer along the curved ray of every sample: slow, without subdivision error, the reference
    Exact,
}
