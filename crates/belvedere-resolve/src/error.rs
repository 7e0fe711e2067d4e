//! Errors of the library. Texts name the given value and the possible ones in the words of the library; an application
//! adds the names of its own options.

use crate::advice::Advice;
use belvedere_document::DocumentError;
use belvedere_io::LiftedBy;
use std::path::PathBuf;

/// Anything that ends a call without a result.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum BelvedereError {
    /// A mistake in a scene or preset document, or a file that it may not use.
    #[error(transparent)]
    Document(DocumentError),
    /// Points or pixels that cannot be read.
    #[error("{}: {reason}", path.display())]
    Points {
        /// The file.
        path: PathBuf,
        /// Number of the element, what is wrong, and what to do.
        reason: String,
    },
    /// An output that would destroy something, or cannot be written.
    #[error("{}: {reason}", path.display())]
    Output {
        /// The output.
        path: PathBuf,
        /// Why it is refused, and what to do.
        reason: String,
    },
    /// A picture that is too large for one piece, with parts that are drawn in one piece alone.
    #[error(
        "a picture of {} x {} pixels with {what} is drawn in one piece alone, which needs about {needed_mib} MiB, and {limit_mib} MiB are allowed; leave that out to draw it in bands, or use a smaller picture or more memory",
        size[0], size[1]
    )]
    OnePiece {
        /// What needs one piece.
        what: &'static str,
        /// Width and height, pixels.
        size: [u64; 2],
        /// Memory needed, MiB.
        needed_mib: u64,
        /// Memory allowed, MiB.
        limit_mib: u64,
    },
    /// A field of view outside (0, 180) degrees.
    #[error("the field of view is {deg} degrees, it must lie strictly between 0 and 180")]
    FieldOfView {
        /// The angle given, degrees.
        deg: f64,
    },
    /// A field of view through which no view could be chosen.
    #[error(
        "through a field of view of {deg} degrees no eye around the features gives a usable picture; 10 to 90 degrees are usual"
    )]
    UnusualFieldOfView {
        /// The angle given, degrees.
        deg: f64,
    },
    /// The eye is the point that it looks at.
    #[error("the eye and the point to look at are the same; look somewhere else")]
    EyeIsTarget,
    /// A position that is not on the map.
    #[error("{what}: {reason}")]
    Position {
        /// `eye`, `target`, or another place that was given.
        what: &'static str,
        /// Why it is not, and what to do.
        reason: String,
    },
    /// The eye is under the ground.
    #[error(
        "the eye at height {eye_m:.1} m is {:.1} m under the ground, which is at {ground_m:.1} m; raise it above the ground", ground_m - eye_m
    )]
    UnderGround {
        /// Height of the eye, metres.
        eye_m: f64,
        /// Height of the ground there, metres.
        ground_m: f64,
    },
    /// No file of routes, areas or points was given.
    #[error("no features are given; name at least one file of routes, areas or points")]
    NoFeatures,
    /// An elevation model was given, and no file of routes, areas or points.
    #[error("no features are given; name at least one file of routes, areas or points beside {ground}")]
    GroundAlone {
        /// The elevation model.
        ground: String,
    },
    /// A target that does not exist.
    #[error("{0}")]
    Target(String),
    /// An argument of a call that is missing, or does not go with the others or with the scene.
    #[error("{0}")]
    Argument(Advice),
    /// A parameter of the terrain solver that does not exist or is out of range.
    #[error("{0}")]
    Setting(String),
    /// A light, stylisation or exaggeration that a picture cannot have.
    #[error("{reason}")]
    Appearance {
        /// What is asked for: `light-time`, `stylise`, `exaggeration`, `palette`.
        option: &'static str,
        /// The measured value, the limit, and what to do.
        reason: String,
    },
    /// A paper that a picture cannot have.
    #[error(transparent)]
    Paper(#[from] belvedere_overlay::sheet::PaperError),
    /// A renderer that does not exist.
    #[error("there is no renderer \"{name}\"; {advice}")]
    NoRenderer {
        /// Its name.
        name: String,
        /// What to do.
        advice: String,
    },
    /// A picture that cannot be written as vectors.
    #[error("{0} cannot be written as vectors; write a PNG")]
    NoVectors(&'static str),
    /// A scene without anything that vectors draw.
    #[error(
        "nothing in this scene is drawn as vectors: {layers}; draw the vectors over the raster of the surfaces, write a PNG, or add lines, \
         areas, points or names"
    )]
    NothingAsVectors {
        /// Its layers and their kinds.
        layers: String,
    },
    /// Highlights that cannot be drawn together.
    #[error("{0}")]
    Highlight(&'static str),
    /// A built-in scene that does not exist.
    #[error("{0}")]
    Builtin(String),
    /// Rays that end before they begin.
    #[error("rays end at depth {far}, it must be finite and beyond near = {near}")]
    RayEnd {
        /// Depth of the last sample, scene units.
        far: f64,
        /// Nearest depth of the camera, scene units.
        near: f64,
    },
    /// Neither the call nor the camera nor the scene gives an end of rays.
    #[error("nothing says where rays end: the scene has no layer in front of the camera")]
    NoRayEnd,
    /// Too few or too many samples of rays.
    #[error("{samples} samples of {rays} rays were asked for; at least 1 and together at most {most} are needed")]
    RaySamples {
        /// Samples of each ray.
        samples: usize,
        /// Rays.
        rays: usize,
        /// Most samples of all rays together.
        most: usize,
    },
    /// The scene has no `[animation]`, and none was given.
    #[error("nothing says how the camera moves; add [animation] to the scene")]
    NoAnimation,
    /// A sweep of the viewing angle without a range.
    #[error("a sweep of the viewing angle needs a range, or a spline_bend stage, whose presets say one")]
    NoSweepRange,
    /// An animation that cannot be made.
    #[error("{0}")]
    Animation(String),
    /// A folder that holds frames already.
    #[error("{}: {reason}", folder.display())]
    FramesThere {
        /// The folder.
        folder: PathBuf,
        /// What it holds.
        reason: String,
        /// Whether the animation can be resumed from them.
        resumable: bool,
    },
    /// An animation was cancelled between frames or in one.
    #[error("interrupted after {done} of {frames} frames in {}", folder.display())]
    Interrupted {
        /// Frames that are finished.
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
    /// A report or document that has no text form, which no type of this library gives.
    #[error("{what} cannot be written as text: {reason}")]
    Text {
        /// Name of the text that was to be written.
        what: &'static str,
        /// Reason given by the writer.
        reason: String,
    },
    /// An invalid camera.
    #[error(transparent)]
    Camera(#[from] belvedere_core::PinholeError),
    /// Stages that do not go together.
    #[error(transparent)]
    View(#[from] belvedere_core::ViewError),
    /// A coordinate system that cannot be used.
    #[error(transparent)]
    Crs(#[from] belvedere_io::crs::CrsError),
    /// A preset document that describes no usable deformation.
    #[error(transparent)]
    Preset(#[from] belvedere_core::presets::PresetError),
    /// An operation on a preset document that cannot be carried out.
    #[error(transparent)]
    PresetEdit(#[from] belvedere_core::presets::edit::EditError),
    /// A loader or writer failed.
    #[error(transparent)]
    Io(#[from] belvedere_io::IoError),
    /// A renderer failed.
    #[error(transparent)]
    Render(#[from] belvedere_scene::RenderError),
    /// A constructor or measure failed.
    #[error(transparent)]
    Construct(#[from] belvedere_construct::ConstructError),
    /// A city could not be generalised.
    #[error(transparent)]
    Generalise(#[from] belvedere_construct::generalise::GeneraliseError),
    /// Terrain could not be solved.
    #[error(transparent)]
    Disocclusion(#[from] belvedere_disocclusion::DisocclusionError),
    /// A library failed in a way that it does not report.
    #[error("internal error ({what}); please report this with the command line and the files")]
    Internal {
        /// First line of its message.
        what: String,
    },
    /// Work that needs more memory than the budget has left, see [`belvedere_io::budget`].
    #[error("{0}")]
    Memory(belvedere_io::budget::Refusal),
    /// Cancelled.
    #[error(transparent)]
    Cancelled(#[from] belvedere_scene::Cancelled),
}

impl BelvedereError {
    /// The error of a name that is no UTF-8.
    pub fn not_utf8(name: &str) -> Self {
        DocumentError::not_utf8(name).into()
    }

    /// What lifts it, where a file or the memory is at fault.
    pub fn lifted_by(&self) -> LiftedBy {
        match self {
            Self::Memory(_) => LiftedBy::Memory,
            Self::Io(error) => error.lifted_by(),
            Self::Document(error) => error.lifted_by(),
            Self::Frame { source, .. } => source.lifted_by(),
            _ => LiftedBy::default(),
        }
    }

    /// Whether the work was cancelled rather than failed.
    pub fn is_cancelled(&self) -> bool {
        matches!(
            self,
            Self::Cancelled(_)
                | Self::Generalise(belvedere_construct::generalise::GeneraliseError::Cancelled(_))
                | Self::Construct(belvedere_construct::ConstructError::Cancelled(_))
                | Self::Disocclusion(belvedere_disocclusion::DisocclusionError::Cancelled(_))
                | Self::Io(belvedere_io::IoError::Cancelled(_))
                | Self::Render(belvedere_scene::RenderError::Cancelled(_))
        )
    }
}

impl From<DocumentError> for BelvedereError {
    fn from(error: DocumentError) -> Self {
        match error {
            DocumentError::Io(error) => Self::Io(error),
            DocumentError::Palette(reason) => Self::Appearance { option: "palette", reason },
            error => Self::Document(error),
        }
    }
}
