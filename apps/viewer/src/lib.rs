//! The application: each technique by hand. A thin shell over the facade's editor: panels edit one document, a painter draws it.

#[cfg(target_family = "wasm")]
mod browser;
mod builtin;
mod export;
mod files;
mod keys;
mod menu;
mod model;
mod notices;
mod panels;
mod picture;
mod pointer;
mod times;
mod viewer;
mod widgets;
#[cfg(not(target_family = "wasm"))]
mod window;

#[cfg(target_family = "wasm")]
pub use browser::Application;
pub use builtin::BUILTIN;
pub use viewer::{Opening, Viewer};
#[cfg(not(target_family = "wasm"))]
pub use window::{WindowError, run};
