//! Choices among named kinds.

use belvedere::scene_file::SurfaceDoc;
use belvedere::verbs::reveal::Technique;
use clap::ValueEnum;

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

/// What areas are drawn as.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub(crate) enum AreaStyleKind {
    /// The style that properties and names give, else outline
    Auto,
    /// A line and a light, transparent fill
    Outline,
    /// A grey fill
    Plain,
    /// Water: flat, with a shore line
    Water,
    /// Forest
    Forest,
    /// Ice
    Glacier,
    /// A line and a light green, transparent fill
    Park,
}

impl From<AreaStyleKind> for SurfaceDoc {
    fn from(kind: AreaStyleKind) -> Self {
        match kind {
            AreaStyleKind::Auto => Self::Auto,
            AreaStyleKind::Outline => Self::Outline,
            AreaStyleKind::Plain => Self::Plain,
            AreaStyleKind::Water => Self::Water,
            AreaStyleKind::Forest => Self::Forest,
            AreaStyleKind::Glacier => Self::Glacier,
            AreaStyleKind::Park => Self::Park,
        }
    }
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
