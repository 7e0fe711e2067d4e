//! Belvedere draws pictures in which what matters is not hidden.
//!
//! Heights and lines made in memory, a view, a picture:
//!
//! ```
//! use belvedere::core::{DVec2, DVec3, Pinhole, View};
//! use belvedere::scene::{Heightfield, Scene};
//! use belvedere::{PictureOptions, Session};
//!
//! let heights = (0..100 * 100).map(|i| 80.0 * ((i % 100) as f32 / 9.0).sin()).collect();
//! let ground = Heightfield::measured(DVec2::new(0.0, 2970.0), DVec2::splat(30.0), 100, 100, heights)?;
//! let path = [DVec2::new(200.0, 300.0), DVec2::new(2700.0, 2500.0)];
//! let scene = Scene::default().with_terrain("ground", ground).with_line("path", &path);
//! let (eye, target) = (DVec3::new(1500.0, -1500.0, 900.0), DVec3::new(1500.0, 1200.0, 0.0));
//! let camera = Pinhole::looking(eye, target).image([320, 180]).build()?;
//! let session = Session::from_parts(scene, View::straight(camera));
//! let picture = session.render(&PictureOptions::default())?;
//! # let folder = tempfile::tempdir()?;
//! # let out = folder.path().join("hills.png");
//! picture.write(&out, false)?; // and its record beside it, hills.png.json
//! # assert!(picture.frame.id.contains(&1) && picture.frame.id.contains(&2) && out.exists());
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! A scene file describes the same and more, and is opened by [`Session::open`]. Terrain and routes straight from files become a
//! bent picture by [`verbs::reveal`], or moved ground by [`verbs::disocclude`]. Everything that a call takes or gives has its name
//! in this crate: [`core`] (views and stages), [`scene`] (layers, frames), [`io`] (loaders), [`construct`], [`disocclusion`],
//! [`cpu`] (renderers), [`builtin`] (generated scenes).

mod advice;
pub mod answers;
mod bodies;
mod camera_path;
mod city_blocks;
mod city_ground;
pub mod city_map;
mod data;
mod error;
pub mod export;
pub mod fallback;
mod film;
mod guard;
mod kept;
pub mod live;
mod names;
mod open;
mod options;
pub mod output;
mod overlays;
pub mod pick;
pub mod picture;
pub mod placed;
pub mod places;
pub mod print;
pub mod record;
pub mod renderers;
mod resolve;
mod session;
pub mod targets;
pub mod threads;
pub mod trust;
pub mod vectors;
pub mod verbs;

pub use advice::Advice;
pub use belvedere_builtin as builtin;
pub use belvedere_composite as composite;
pub use belvedere_construct as construct;
pub use belvedere_core as core;
pub use belvedere_core::{Warning, WarningKind};
pub use belvedere_cpu as cpu;
pub use belvedere_disocclusion as disocclusion;
pub use belvedere_document as scene_file;
pub use belvedere_document::DocumentError;
pub use belvedere_document::{request, sun};
pub use belvedere_io as io;
pub use belvedere_scene as scene;
pub use belvedere_sight as sight;
pub use data::{DataFiles, LARGEST_HOLE};
pub use error::BelvedereError;
pub use options::{Needs, OpenOptions};
pub use overlays::camera::CameraPicture;
pub use overlays::furniture::{CompassRecord, FurnitureRecord, ScaleRecord};
pub use overlays::highlight::{GhostRecord, HighlightRecord, PartRecord};
pub use picture::{DisplacementReport, Picture, PictureOptions, Sidecar};
pub use renderers::SharedRenderer;
pub use request::RendererName;
pub use resolve::by_property;
pub use session::Session;
pub use trust::Trust;

/// Version of the program.
pub const VERSION: &str = env!("CARGO_PKG_VERSION");
