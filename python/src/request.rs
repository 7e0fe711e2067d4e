//! Options that Python gives as JSON.

use crate::errors::{raised, wrong};
use belvedere::io::Arrays;
use belvedere::picture::PictureOptions;
use belvedere::print::Sheet;
use belvedere::request::{self, OfData, Render, Request};
use belvedere::scene::Progress;
use belvedere::verbs::asked;
use belvedere::{OpenOptions, Session};
use pyo3::PyResult;
use serde::Deserialize;
use serde::de::DeserializeOwned;
use std::path::PathBuf;

/// The request of a verb from its JSON text.
pub(crate) fn request<T: Request>(verb: &str, text: &str) -> PyResult<T> {
    request::read(text).map_err(|reason| wrong(&format!("{verb}: {reason}")))
}

/// Options from their JSON text.
pub(crate) fn read<T: DeserializeOwned>(what: &str, text: &str) -> PyResult<T> {
    serde_json::from_str(text).map_err(|e| {
        let said = e.to_string();
        // Python gave no text, so that it has no lines.
        let words = said.rsplit_once(" at line ").map_or(said.as_str(), |(words, _)| words);
        wrong(&format!("{what}: {words}"))
    })
}

/// How a scene is opened.
#[derive(Debug, Clone, Default, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub(crate) struct Opening {
    allow_roots: Vec<PathBuf>,
    size: Option<[u32; 2]>,
    seed: Option<u64>,
    fonts: Vec<PathBuf>,
    /// What data without a scene file do not say.
    pub(crate) data: OfData,
    unsolved: bool,
    /// A trajectory of the molecule.
    trajectory: Option<String>,
    /// What is shown otherwise than the scene says.
    shows: Option<Render>,
}

impl Opening {
    /// The options of the facade.
    pub(crate) fn options(self, arrays: Arrays, progress: Progress) -> OpenOptions {
        let options = OpenOptions {
            allow_roots: self.allow_roots,
            image: self.size,
            seed: self.seed,
            fonts: self.fonts,
            arrays,
            unsolved: self.unsolved,
            trajectory: self.trajectory,
            max_bytes: Some(belvedere::io::budget::bytes()),
            progress,
            ..OpenOptions::default()
        };
        match self.shows {
            Some(asked) => OpenOptions { unsolved: self.unsolved, ..options.showing(&asked) },
            None => options,
        }
    }
}

/// A picture that Python asks for, with its furniture, and its paper wholly stated.
pub(crate) fn picture(asked: &Render, session: &Session, progress: Progress) -> PyResult<PictureOptions> {
    // With paper and pixels per inch no size is left open.
    let sheet = Sheet::of(&asked.paper.document(), None, [1, 1]).map_err(|e| raised(&e.into()))?;
    let (options, _) = asked::picture(asked, session).map_err(|e| raised(&e))?;
    let options = PictureOptions { progress, ..options };
    Ok(sheet.map_or(options.clone(), |sheet| options.on(sheet)))
}
