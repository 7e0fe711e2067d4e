//! Outputs: checked before the work, all of them together; `-o -` is standard output.

use crate::report::{Context, is_stdout};
use anyhow::ensure;
use belvedere::output;
use std::io::{IsTerminal, Write};
use std::path::{Path, PathBuf};

/// Endings of formats; an output is not named after one that it does not have.
const KNOWN: [&str; 32] = [
    "jpg", "jpeg", "png", "tif", "tiff", "webp", "gif", "bmp", "svg", "pdf", "json", "toml", "geojson", "xml", "yaml",
    "yml", "txt", "csv", "asc", "hgt", "gpx", "obj", "ply", "stl", "gltf", "glb", "mp4", "avi", "exr", "npy", "gpkg",
    "shp",
];

/// Refuses names with the ending of another format than those that are written.
///
/// * `endings`: of what is written, the best one first.
/// * `what`: a sentence that says what is written.
pub(crate) fn named(path: &Path, endings: &[&str], what: &str) -> anyhow::Result<()> {
    match KNOWN.contains(&ending(path).as_str()) {
        true => only(path, endings, what),
        false => Ok(()),
    }
}

/// Refuses names with any other ending; one that begins with no letter is none, such as that of `v1.2`.
pub(crate) fn only(path: &Path, endings: &[&str], what: &str) -> anyhow::Result<()> {
    let ending = ending(path);
    let is_other = ending.starts_with(|c: char| c.is_alphabetic()) && !endings.contains(&ending.as_str());
    let best = endings.first().copied().unwrap_or_default();
    anyhow::ensure!(!is_other, "{}: {what}, not .{ending}; name the output .{best}", path.display());
    Ok(())
}

fn ending(path: &Path) -> String {
    path.extension().and_then(|e| e.to_str()).unwrap_or_default().to_ascii_lowercase()
}

/// The same for pictures.
pub(crate) fn png_named(path: &Path) -> anyhow::Result<()> {
    named(path, &["png"], "pictures are written as PNG")
}

/// The file of an output; `None` if it is left out or standard output.
pub(crate) fn file(out: Option<&PathBuf>) -> Option<&PathBuf> {
    out.filter(|path| !is_stdout(path))
}

/// Refuses outputs that cannot be written, that exist, that are inputs, or that are named twice.
pub(crate) fn check(paths: &[PathBuf], inputs: &[PathBuf], context: &Context) -> anyhow::Result<()> {
    let paths: Vec<PathBuf> = paths.iter().chain(&context.common.timings).cloned().collect();
    ensure!(!paths.iter().any(|path| is_stdout(path)), "-: only -o takes standard output; name a file");
    Ok(output::check_all(&paths, inputs, context.common.overwrite)?)
}

/// Refuses a folder that cannot be written or made, and standard output.
pub(crate) fn check_folder(folder: &Path, context: &Context) -> anyhow::Result<()> {
    ensure!(
        !is_stdout(folder),
        "-o -: this command writes several files, which standard output cannot hold; name a folder"
    );
    check(&[], &[], context)?;
    Ok(output::check_folder(folder)?)
}

/// Refuses to write a picture on standard output where it is a terminal, or where the result of `--json` goes.
pub(crate) fn check_stdout(context: &Context) -> anyhow::Result<()> {
    ensure!(!context.common.json, "-o -: --json prints on standard output, too; name a file, or leave --json out");
    ensure!(
        !std::io::stdout().is_terminal(),
        "-o -: standard output is a terminal; send it to a file or a program, or name a file"
    );
    Ok(())
}

/// Writes bytes on standard output; a closed pipe is not an error.
pub(crate) fn write_stdout(bytes: &[u8]) -> anyhow::Result<()> {
    crate::interrupt::note_stdout();
    let mut out = std::io::stdout().lock();
    match out.write_all(bytes).and_then(|()| out.flush()) {
        Err(e) if e.kind() != std::io::ErrorKind::BrokenPipe => Err(anyhow::anyhow!("standard output: {e}")),
        _ => Ok(()),
    }
}
