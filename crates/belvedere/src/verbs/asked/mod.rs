//! Verbs as requests of [`crate::request`] ask for them: every door of the program (command line, Python, window) goes through here.

mod drawing;
mod reveal;

pub use drawing::{film, foreseen, opened, paper, picture, picture_of};
pub use reveal::{Revealed, RevealedDocument, Setting, drafts, is_of_models, reveal, sheet};
