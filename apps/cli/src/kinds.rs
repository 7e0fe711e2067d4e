//! Choices among named kinds.

use clap::ValueEnum;

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
