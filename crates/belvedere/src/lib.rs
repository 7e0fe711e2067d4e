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
//! bent picture by [`verbs::reveal::reveal`], or moved ground by [`verbs::disocclude`]; what verbs are asked is plain data of [`request`].
//! Everything that a call takes or gives has its name in this crate: [`core`] (views and stages), [`scene`] (layers, frames), [`io`] (loaders),
//! [`construct`], [`disocclusion`], [`cpu`] (renderers), [`builtin`] (generated scenes).
//!
//! # A tour: from a formula to a picture
//!
//! A picture is a pinhole photograph of a displaced world. A *map* displaces points, and can undo it. This one raises what lies farther north:
//!
//! ```
//! use belvedere::core::map::StageMap;
//! use belvedere::core::{DMat3, DVec2, DVec3, Miss, Pinhole, SpaceMap, Stage, View};
//! use belvedere::scene::{Heightfield, Scene};
//! use belvedere::{PictureOptions, Session};
//!
//! #[derive(Debug)]
//! struct Ramp;
//!
//! impl SpaceMap for Ramp {
//!     fn apply(&self, p: DVec3) -> Result<DVec3, Miss> {
//!         Ok(p + p.y.max(0.0).powi(2) / 2000.0 * DVec3::Z)
//!     }
//!     fn invert(&self, p: DVec3) -> Result<DVec3, Miss> {
//!         Ok(p - p.y.max(0.0).powi(2) / 2000.0 * DVec3::Z)
//!     }
//!     fn jacobian(&self, p: DVec3) -> Result<DMat3, Miss> {
//!         Ok(DMat3::from_cols(DVec3::X, DVec3::new(0.0, 1.0, p.y.max(0.0) / 1000.0), DVec3::Z))
//!     }
//! }
//! impl StageMap for Ramp {}
//!
//! // A *view* is a pinhole and its stages: a point has a pixel, and a pixel has a ray, which is curved.
//! let camera = Pinhole::looking(DVec3::new(0.0, -100.0, 60.0), DVec3::new(0.0, 400.0, 0.0)).image([160, 90]).build()?;
//! let view = View::new(camera, vec![Stage::own(Ramp)])?;
//! let point = DVec3::new(20.0, 300.0, 0.0);
//! let image = view.project(point).map_err(|miss| format!("{miss:?}"))?;
//! let along = view.ray(image.pixel).at(image.depth).map_err(|miss| format!("{miss:?}"))?;
//! assert!(along.point.distance(point) < 1e-6);
//!
//! // Renderers, picks and measures go through the view: none of them knows the map.
//! let ground = Heightfield::measured(DVec2::new(-300.0, 600.0), DVec2::splat(10.0), 61, 61, vec![0.0; 61 * 61])?;
//! let session = Session::from_parts(Scene::default().with_terrain("ground", ground), view);
//! let picture = session.render(&PictureOptions::default())?;
//! assert_eq!(picture.sidecar.stages, ["own"]);
//! let seen = session.pick(&[image.pixel.to_array()])?;
//! assert!(seen[0].as_ref().is_some_and(|seen| (seen.point[1] - 300.0).abs() < 0.1));
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! A *layer* of your own kind says what its surface is ([`scene::LayerContent`]); it is then drawn, picked, measured and exported like a mesh:
//!
//! ```
//! use belvedere::core::{DVec3, Pinhole, View};
//! use belvedere::scene::{Color, LayerContent, Mesh, MeshColors, MeshLayer, OwnLayer, Scene};
//! use belvedere::{PictureOptions, Session};
//!
//! #[derive(Debug)]
//! struct Sail([DVec3; 3]);
//!
//! impl LayerContent for Sail {
//!     fn kind(&self) -> &'static str {
//!         "sail"
//!     }
//!     fn surface(&self) -> MeshLayer {
//!         let mesh = Mesh::new(&self.0, vec![[0, 1, 2]], MeshColors::Layer);
//!         MeshLayer::new(mesh.expect("three finite corners"), Color::rgb(250, 240, 220))
//!     }
//! }
//!
//! let sail = Sail([DVec3::new(-2.0, 20.0, 0.0), DVec3::new(2.0, 20.0, 0.0), DVec3::new(0.0, 20.0, 6.0)]);
//! let scene = Scene::default().with_layer("sail", OwnLayer::new(sail));
//! let camera = Pinhole::looking(DVec3::new(0.0, 0.0, 2.0), DVec3::new(0.0, 20.0, 2.0)).image([80, 60]).build()?;
//! let session = Session::from_parts(scene, View::straight(camera));
//! let frame = session.render(&PictureOptions::default())?.frame;
//! assert!(frame.id.iter().filter(|id| **id == 1).count() > 100);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! A *renderer* of your own is handed a job and gives a frame ([`scene::Renderer`]). Registered under a name ([`renderers::register`]) it is the
//! one of every verb that asks for it: in options of pictures, in the key `renderer` of scene files, on a command line. Its contract is
//! `renderer_laws!` of `belvedere-testkit`. This one follows the ray of each pixel by steps:
//!
//! ```
//! use belvedere::core::{DVec2, DVec3, Pinhole, View};
//! use belvedere::scene::{Frame, Heightfield, RenderError, RenderJob, Renderer, Scene};
//! use belvedere::{PictureOptions, Session, renderers};
//! use std::sync::Arc;
//!
//! struct Stepper;
//!
//! impl Renderer for Stepper {
//!     fn name(&self) -> &'static str {
//!         "stepper"
//!     }
//!     fn render(&self, job: &RenderJob<'_>) -> Result<Frame, RenderError> {
//!         let [width, height] = job.view.pinhole().image.map(|side| side as usize);
//!         let mut frame = Frame { width, height, ..Frame::default() };
//!         for i in 0..width * height {
//!             job.progress.tick("step", i as f64 / (width * height) as f64)?;
//!             let ray = job.view.ray(DVec2::new((i % width) as f64 + 0.5, (i / width) as f64 + 0.5));
//!             let is_below = |depth: &f64| {
//!                 let point = ray.at(*depth).ok().map(|at| at.point);
//!                 let ground = |p: DVec3| job.scene.terrain()?.surface_at(p.truncate());
//!                 point.is_some_and(|p| ground(p).is_some_and(|z| p.z < z))
//!             };
//!             let hit = (1..400).map(|step| 5.0 * f64::from(step)).find(is_below);
//!             frame.color.push(if hit.is_some() { [120, 140, 90] } else { [200, 220, 240] });
//!             frame.depth.push(hit.map_or(f32::INFINITY, |depth| depth as f32));
//!             frame.id.push(u32::from(hit.is_some()));
//!         }
//!         Ok(frame)
//!     }
//! }
//!
//! renderers::register("stepper", || Arc::new(Stepper));
//! let ground = Heightfield::measured(DVec2::new(-300.0, 600.0), DVec2::splat(10.0), 61, 61, vec![0.0; 61 * 61])?;
//! let camera = Pinhole::looking(DVec3::new(0.0, -100.0, 60.0), DVec3::new(0.0, 400.0, 0.0)).image([80, 45]).build()?;
//! let session = Session::from_parts(Scene::default().with_terrain("ground", ground), View::straight(camera));
//! let picture = session.render(&PictureOptions { renderer: "stepper".into(), ..PictureOptions::default() })?;
//! assert_eq!(picture.sidecar.renderer, "stepper");
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

pub mod answers;
mod camera_path;
mod circle;
pub mod city_map;
mod data;
pub mod export;
pub mod fallback;
mod film;
mod guard;
mod kept;
pub mod live;
mod names;
mod open;
pub mod output;
pub mod pick;
pub mod picture;
pub mod placed;
pub mod places;
pub mod record;
pub mod renderers;
mod session;
mod shown;
mod straightened;
pub mod threads;
mod user_files;
pub mod verbs;

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
pub use belvedere_overlay as overlay;
pub use belvedere_overlay::camera::CameraPicture;
pub use belvedere_overlay::furniture::{CompassRecord, FurnitureRecord, ScaleRecord};
pub use belvedere_overlay::highlight::{GhostRecord, HighlightRecord, PartRecord};
pub use belvedere_overlay::{sheet as print, vectors};
pub use belvedere_resolve::{Advice, BelvedereError, Needs, OpenOptions, Trust, by_property, targets, trust};
pub use belvedere_scene as scene;
pub use belvedere_sight as sight;
pub use data::{DataFiles, LARGEST_HOLE, without_terrain};
pub use picture::{DisplacementReport, Picture, PictureOptions, Sidecar};
pub use renderers::SharedRenderer;
pub use request::RendererName;
pub use session::Session;

/// Version of the program.
pub const VERSION: &str = env!("CARGO_PKG_VERSION");
