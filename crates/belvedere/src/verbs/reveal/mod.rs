//! `reveal`: a picture in which routes, other features, or a part of a model or city are visible.
//!
//! A request is read, and its subject opened; views and bends are tried until one shows enough; the best is drawn and told.

pub mod answer;
pub mod appearance;
mod drafts;
mod features;
mod files;
mod given;
mod judge;
mod opened;
mod request;
mod subject;
mod target;

pub use crate::scene_file::request::Technique;
pub use crate::verbs::found_view::IMAGE;
pub use answer::{FinalShares, Found, RevealAnswer, RevealedDocument, Tried};
pub use belvedere_construct::views::RefitRecord;
pub use drafts::{Draft, DraftsAnswer, MOST_DRAFTS, drafts};
pub use files::RevealFiles;
pub use request::{Setting, sheet};

use crate::BelvedereError;
use crate::guard::guarded;
use crate::request::Reveal;
use request::Request;

/// Chooses a view (unless given) and a bend, and draws both pictures. Where nothing is hidden, or no bend shows more, the straight one is the
/// answer.
///
/// # Errors
/// [`BelvedereError::Argument`] for options that do not go together, [`BelvedereError::FieldOfView`], [`BelvedereError::Position`],
/// [`BelvedereError::Target`] if there is no such target, [`BelvedereError::Construct`] if no view is possible, else as
/// [`crate::Session::open`] and [`crate::Session::render`].
pub fn reveal(asked: &Reveal, setting: &Setting) -> Result<RevealAnswer, BelvedereError> {
    guarded(|| revealed(&Request::of(asked, setting)?))
}

fn revealed(request: &Request<'_>) -> Result<RevealAnswer, BelvedereError> {
    if request.models { target::reveal(request) } else { features::reveal(request) }
}
