//! The application: each technique by hand. A thin shell over `belvedere_studio`: panels edit one document, a painter draws it.

mod address;
#[cfg(target_family = "wasm")]
mod browser;
mod builtin;
mod consent;
mod export;
mod files;
mod find;
mod flight;
mod flying;
mod handles;
mod keys;
mod language;
mod look;
mod measure;
mod menu;
#[cfg(any(target_family = "wasm", test))]
mod mirror;
mod model;
mod notices;
mod panels;
mod picture;
mod pointer;
mod points;
mod settings;
mod theme;
mod times;
mod viewer;
mod wake;
mod widgets;
#[cfg(not(target_family = "wasm"))]
mod window;
mod words;

#[cfg(target_family = "wasm")]
pub use browser::Application;
pub use builtin::BUILTIN;
pub use viewer::{Opening, Viewer};
#[cfg(all(target_family = "wasm", target_feature = "atomics"))]
pub use wasm_bindgen_rayon::init_thread_pool;
#[cfg(not(target_family = "wasm"))]
pub use window::{WindowError, run};
