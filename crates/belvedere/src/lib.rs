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
mod figures;
pub mod provenance;
mod resolve;
pub mod scene_file;
mod session;
pub mod verbs;

pub use belvedere_core as core;
pub use belvedere_scene as scene;
pub use error::BelvedereError;
pub use figures::camera::CameraPicture;
pub use session::{Needs, OpenOptions, Session};

/// Version of the program.
pub const VERSION: &str = env!("CARGO_PKG_VERSION");
