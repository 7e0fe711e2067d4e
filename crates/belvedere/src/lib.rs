//! The whole of Belvedere behind one door: scene files, sessions and the verbs of the command line.
//!
//! ```no_run
//! use belvedere::{OpenOptions, Session};
//! let session = Session::open("scenes/massif.toml".as_ref(), &OpenOptions::default())?;
//! let answer = belvedere::verbs::points::project(session.view(), &[[377_000.0, 4_700_500.0, 1_200.0]]);
//! println!("{:?}", answer.points[0].pixel);
//! # Ok::<(), belvedere::BelvedereError>(())
//! ```

mod error;
mod overlays;
pub mod provenance;
mod resolve;
pub mod scene_file;
mod session;
pub mod verbs;

pub use belvedere_builtin as builtin;
pub use belvedere_construct as construct;
pub use belvedere_core as core;
pub use belvedere_cpu as cpu;
pub use belvedere_disocclusion as disocclusion;
pub use belvedere_io as io;
pub use belvedere_scene as scene;
pub use error::BelvedereError;
pub use overlays::camera::CameraPicture;
pub use session::{Needs, OpenOptions, Session};

/// Version of the program.
pub const VERSION: &str = env!("CARGO_PKG_VERSION");
