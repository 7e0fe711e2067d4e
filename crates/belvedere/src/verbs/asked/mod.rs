//! Verbs as requests of [`crate::request`] ask for them: every door of the program (command line, Python, window) goes through here.

mod drawing;
mod reveal;

pub use drawing::{film, is_as_opened, paper, picture, picture_of, unheard};
pub use reveal::{Revealed, RevealedDocument, Setting, drafts, is_of_models, reveal, sheet};
