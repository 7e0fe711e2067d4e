//! Errors of the facade as exceptions of `belvedere.errors`.

use belvedere::scene::RenderError;
use belvedere::{BelvedereError, DocumentError};
use pyo3::prelude::*;

/// The exception of an error.
pub(crate) fn raised(error: &BelvedereError) -> PyErr {
    exception(class_of(error), &one_line(error))
}

/// An exception of a class of `belvedere.errors`.
pub(crate) fn exception(class: &str, text: &str) -> PyErr {
    Python::attach(|py| {
        let made = py.import("belvedere.errors").and_then(|module| module.getattr(class)?.call1((text,)));
        made.map_or_else(|error| error, PyErr::from_value)
    })
}

/// The exception of a wrong argument.
pub(crate) fn wrong(text: &str) -> PyErr {
    exception("InputError", text)
}

fn class_of(error: &BelvedereError) -> &'static str {
    match error {
        _ if error.is_cancelled() => "Cancelled",
        BelvedereError::Interrupted { .. } => "Cancelled",
        BelvedereError::Frame { source, .. } => class_of(source),
        BelvedereError::Memory(_) | BelvedereError::Render(RenderError::TooLarge { .. }) => "MemoryLimitError",
        BelvedereError::Internal { .. } => "InternalError",
        BelvedereError::Io(_)
        | BelvedereError::Document(DocumentError::Path { .. })
        | BelvedereError::Output { .. }
        | BelvedereError::FramesThere { .. } => "FileError",
        _ => "InputError",
    }
}

/// The name of an argument in Python.
fn argument(name: &'static str) -> &'static str {
    match name {
        "look" => "look_at",
        "fov" => "fov_y_deg",
        "no_sea" => "sea",
        "no_mark" => "mark",
        "keep_voids" => "fill_voids",
        "crs" => "scene_crs",
        name => name,
    }
}

/// An error with its causes as one line.
fn one_line(error: &BelvedereError) -> String {
    let mut text = match error {
        BelvedereError::Argument(advice) => advice.naming(|name| format!("`{}`", argument(name))),
        _ => error.to_string(),
    };
    let mut cause = std::error::Error::source(error);
    while let Some(next) = cause {
        let words = next.to_string();
        if !text.contains(&words) {
            text = format!("{text}: {words}");
        }
        cause = next.source();
    }
    text.split('\n').map(str::trim).filter(|line| !line.is_empty()).collect::<Vec<_>>().join("; ")
}
