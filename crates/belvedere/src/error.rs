//! What can go wrong, in one sentence each.

use std::path::PathBuf;

/// Anything that ends a verb without a result.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum BelvedereError {
    /// A mistake in a scene, preset or other text document.
    #[error("{}{}: {reason}", path.display(), line.map(|l| format!(":{l}")).unwrap_or_default())]
    Scene {
        /// The document.
        path: PathBuf,
        /// Line of the mistake, 1-based.
        line: Option<usize>,
        /// What is wrong, measured value, limit, what to do.
        reason: String,
    },
    /// A file name that a scene may not use.
    #[error("path \"{name}\" {reason}")]
    Path {
        /// The name as given.
        name: String,
        /// Why it is refused and what to do.
        reason: String,
    },
    /// Points or pixels that cannot be read.
    #[error("{}: {reason}", path.display())]
    Points {
        /// The file.
        path: PathBuf,
        /// Which element, what is wrong, what to do.
        reason: String,
    },
    /// An output that would destroy something, or cannot be written.
    #[error("{}: {reason}", path.display())]
    Output {
        /// The output.
        path: PathBuf,
        /// Why not, and what to do.
        reason: String,
    },
    /// A request that makes no sense.
    #[error("{0}")]
    Usage(String),
    /// An animation was cancelled between frames or in one.
    #[error("cancelled after {done} of {frames} frames in {}; the same command with --resume goes on from there", folder.display())]
    Interrupted {
        /// Frames that are there.
        done: usize,
        /// Frames of the whole animation.
        frames: usize,
        /// Their folder.
        folder: PathBuf,
    },
    /// One frame of an animation cannot be drawn.
    #[error("frame {frame}: {source}")]
    Frame {
        /// Its number, from 0.
        frame: usize,
        /// Why not.
        source: Box<BelvedereError>,
    },
    /// A loader or writer failed.
    #[error(transparent)]
    Io(#[from] belvedere_io::IoError),
    /// A renderer failed.
    #[error(transparent)]
    Render(#[from] belvedere_scene::RenderError),
    /// A constructor or measure failed.
    #[error(transparent)]
    Construct(#[from] belvedere_construct::ConstructError),
    /// Terrain could not be solved.
    #[error(transparent)]
    Disocclusion(#[from] belvedere_disocclusion::DisocclusionError),
    /// Cancelled.
    #[error(transparent)]
    Cancelled(#[from] belvedere_scene::Cancelled),
}

impl BelvedereError {
    /// Whether the work was cancelled rather than failed.
    pub fn is_cancelled(&self) -> bool {
        matches!(
            self,
            Self::Cancelled(_)
                | Self::Construct(belvedere_construct::ConstructError::Cancelled(_))
                | Self::Disocclusion(belvedere_disocclusion::DisocclusionError::Cancelled(_))
                | Self::Io(belvedere_io::IoError::Cancelled(_))
                | Self::Render(belvedere_scene::RenderError::Cancelled(_))
        )
    }
}
