//! Choices among named kinds.

use belvedere::scene_file::SurfaceDoc;
use belvedere::verbs::reveal::Technique;
use clap::ValueEnum;

/// What bends a picture.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub(crate) enum TechniqueKind {
    /// What shows most of the techniques that are tried, 120 s of solving each (or --time-limit): a spline; both; terrain disocclusion
    Auto,
    /// A spline over the mean ground
    Spline,
    /// Terrain disocclusion
    Terrain,
    /// Spline and terrain
    Both,
    /// Rays that bend once, around what hides most; what bends models with --see
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
    /// What properties and names say, else outline
    Auto,
    /// A line, and a light fill that everything shows through
    Outline,
    /// A grey fill
    Plain,
    /// Water: flat, with a shore line
    Water,
    /// Forest
    Forest,
    /// Ice
    Glacier,
    /// A line, and a light green fill that everything shows through
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
    /// The best there is: today the cpu
    Auto,
    /// On the processor, without a GPU
    Cpu,
    /// Every sample along its own curved ray: slower, no subdivision error, the reference for the others
    Exact,
}
