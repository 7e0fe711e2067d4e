//! `demo`: the built-in scenes, straight and bent side by side, with a page that shows them.

use super::output;
use super::render::{self, RenderRequest};
use crate::{BelvedereError, OpenOptions, Session};
use std::path::{Path, PathBuf};

/// Name and text of every scene of the demo; they need no files.
pub const SCENES: &[(&str, &str)] = &[
    ("massif", include_str!("../../../../scenes/massif.toml")),
    ("massif_curved_rays", include_str!("../../../../scenes/massif_curved_rays.toml")),
    ("street", include_str!("../../../../scenes/street.toml")),
];

/// Draws every scene of [`SCENES`] into `folder`, which is made if need be: `NAME.png` (straight beside bent) with its
/// record, `NAME.toml`, and `index.html`. Returns the files.
///
/// # Errors
/// [`BelvedereError::Io`] if a file exists and `overwrite` is false, else as [`render::render`].
pub fn demo(
    folder: &Path,
    options: &OpenOptions,
    request: &RenderRequest,
    overwrite: bool,
) -> Result<Vec<PathBuf>, BelvedereError> {
    std::fs::create_dir_all(folder).map_err(|e| belvedere_io::IoError::os(folder, e))?;
    let index = folder.join("index.html");
    let request = RenderRequest { compare: true, straight: false, ..request.clone() };
    let picture_of = |name: &str| folder.join(format!("{name}.png"));
    let scene_of = |name: &str| folder.join(format!("{name}.toml"));
    output::check(&index, &[], overwrite)?;
    for (name, _) in SCENES {
        output::check(&scene_of(name), &[], overwrite)?;
        for path in render::outputs(&picture_of(name), &request) {
            output::check(&path, &[], overwrite)?;
        }
    }
    let (mut written, mut rows) = (Vec::new(), String::new());
    for (name, text) in SCENES {
        output::write_text(&scene_of(name), text, overwrite)?;
        let mut session = Session::from_text(&scene_of(name), text, options)?;
        session.inputs = vec![scene_of(name)];
        let picture = render::render(&session, &request, &options.progress)?;
        written.extend(picture.write(&picture_of(name), overwrite)?);
        written.push(scene_of(name));
        let sidecar = &picture.sidecar;
        rows += &format!(
            "<h2>{title}</h2>\n<p>{stages}. {note}. <a href=\"{name}.toml\">Scene</a>, <a href=\"{name}.png.json\">record</a>.</p>\n<img src=\"{name}.png\" alt=\"straight and bent\">\n",
            title = escape(&sidecar.scene.title),
            stages = escape(&sidecar.stages.join(", ")),
            note = escape(sidecar.note.as_deref().unwrap_or("straight view")),
        );
    }
    output::write_text(&index, &page(&rows), overwrite)?;
    written.push(index);
    Ok(written)
}

fn page(rows: &str) -> String {
    format!(
        "<!doctype html>\n<html lang=\"en\">\n<meta charset=\"utf-8\">\n<title>Belvedere</title>\n\
         <style>body{{font:16px sans-serif;max-width:84rem;margin:2rem auto;padding:0 1rem}}img{{width:100%}}</style>\n\
         <h1>Belvedere {}</h1>\n<p>Left: an ordinary picture. Right: the same camera, with what matters no longer hidden.</p>\n{rows}</html>\n",
        crate::VERSION
    )
}

fn escape(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;")
}
