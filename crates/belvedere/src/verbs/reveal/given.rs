//! Data that a request names, each asked once what it is.

use belvedere_io::formats::Reader;
use belvedere_io::{Arrays, Known};
use belvedere_resolve::vectors::{FeatureKind, kinds_of};
use std::path::PathBuf;
use std::sync::Arc;

/// Data that a request names.
#[derive(Clone)]
pub(super) enum Given {
    /// Built-in data.
    Builtin(PathBuf),
    /// A file, folder or array.
    Known(Arc<Known>),
    /// What cannot be read; it is asked again for the error.
    Unknown(PathBuf),
}

impl Given {
    pub(super) fn of(name: PathBuf, arrays: &Arrays) -> Self {
        if name.to_str().is_some_and(|name| name.starts_with("builtin:")) {
            return Self::Builtin(name);
        }
        match Known::of(&name, arrays) {
            Ok(known) => Self::Known(Arc::new(known)),
            Err(_) => Self::Unknown(name),
        }
    }

    fn reader(&self) -> Option<Reader> {
        match self {
            Self::Builtin(name) => name.to_str()?.starts_with("builtin:town").then_some(Reader::City),
            Self::Known(known) => known.reader,
            Self::Unknown(_) => None,
        }
    }

    pub(super) fn is_same(&self, other: &Self) -> bool {
        matches!((self, other), (Self::Known(a), Self::Known(b)) if a.path == b.path)
    }
}

/// Whether data are those of a city, or footprints and features, beside which features and elevation models may be given.
pub(super) fn hold_a_city(given: &[Given]) -> bool {
    let has_areas = |known: &Known| known.features().is_ok_and(|v| kinds_of(v).contains(&FeatureKind::Areas));
    if let [Given::Known(first), _, ..] = given
        && first.reader == Some(Reader::Features)
        && has_areas(first)
    {
        // Footprints, unless an elevation model follows.
        return given.iter().all(|given| given.reader() == Some(Reader::Features));
    }
    given.iter().any(|given| given.reader() == Some(Reader::City))
}
