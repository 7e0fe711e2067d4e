//! `schema`: JSON Schemas of scene files and of the answers of verbs.

use belvedere::answers::{Answer, Warned};
use belvedere::output;
use belvedere::request::WITH_REQUEST;
use belvedere::verbs::schemas;
use belvedere_bench::{BenchReport, CollectionReport};
use clap::builder::PossibleValuesParser;

/// The schema of scene files.
const SCENE: &str = "scene";
/// The same as a page for readers.
const KEYS: &str = "keys";
/// The verb whose report is not the library's.
const BENCH: &str = "bench";

/// What has a schema.
pub(crate) fn names() -> PossibleValuesParser {
    PossibleValuesParser::new([SCENE, KEYS, BENCH].into_iter().chain(schemas::VERBS))
}

/// The schema of scene files, or of the answers or the request of a verb.
pub(crate) fn text(of: &str, request: bool) -> anyhow::Result<String> {
    if request {
        return belvedere::request::schema(of).ok_or_else(|| {
            anyhow::anyhow!("--request: the request of {of} has no schema; possible: {}", WITH_REQUEST.join(", "))
        });
    }
    if of == BENCH {
        return Ok(schemas::schema_of(
            BENCH,
            &[schemas::shape::<Answer<Warned<BenchReport>>>(), schemas::shape::<Answer<Warned<CollectionReport>>>()],
        )?);
    }
    if of == KEYS {
        return crate::scene_keys::page(&output::schema_json()?);
    }
    match schemas::schema(of) {
        Some(text) => Ok(text?),
        None => Ok(output::schema_json()?),
    }
}
