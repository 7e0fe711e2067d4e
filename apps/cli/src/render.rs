//! `render`: a picture of a scene, or of data as they are.

use crate::goal::Goal;
use crate::outputs;
use crate::picture_names::{check_name, is_vectors, vectors};
use crate::report::{Context, is_stdout};
use belvedere::Needs;
use belvedere::core::{Warning, WarningKind};
use belvedere::picture::{self, Picture, PictureOptions};
use belvedere::request::Render;
use belvedere::scene::Sky;
use belvedere::verbs::asked;
use belvedere::verbs::schemas::Rendered;
use clap::Args;
use std::path::{Path, PathBuf};

/// A picture.
#[derive(Debug, Args)]
pub(crate) struct RenderArgs {
    /// Scene file, TOML or JSON; or data, seen from the south, ground as large as the picture and others whole: elevation models or folders of their tiles in any order, routes,
    /// areas and points on them, cities, meshes, molecules, volumes; - = standard input
    #[arg(required = true, value_name = "SCENE|DATA")]
    scene: Vec<PathBuf>,
    /// Output: PNG, TIFF, JPEG, WebP, SVG or PDF, as its name ends, and OUT.png.json, its record; - = a PNG on standard output alone
    #[arg(short, long, value_name = "OUT.png")]
    out: PathBuf,
    #[command(flatten)]
    asked: Render,
    /// Leave the raster of the surfaces out of an SVG or PDF
    #[arg(long)]
    vectors_only: bool,
}

pub(crate) fn render(args: &RenderArgs, context: &Context) -> anyhow::Result<Goal> {
    let (asked, out) = (&args.asked, &args.out);
    check_name(out, args.vectors_only)?;
    let source = context.stdin.drawable(&args.scene, &asked.data)?;
    let mut files = picture::outputs(out, &asked::foreseen(asked)?, source.document.solves_terrain());
    ready(args, context)?;
    if is_stdout(out) {
        files.clear();
    }
    outputs::check(&files, &args.scene, context)?;
    let (session, request, said) = asked::opened(source, asked, context.options(Needs::Everything, None))?;
    outputs::check(&files, &session.input_paths(), context)?;
    let request = PictureOptions { vectors: vectors(out, args.vectors_only), ..context.running(request) };
    let transparent = session.light().sky == Sky::Transparent;
    picture::check_format(out, session.view().pinhole().image.map(|side| side as usize), transparent)?;
    let (picture, written) = match is_stdout(out) {
        true => {
            let picture = session.render(&request)?;
            outputs::write_stdout(&picture.to_png()?)?;
            (picture, Vec::new())
        }
        false => session.render_to(&request, out, context.common.overwrite)?,
    };
    deliver(&picture, (&written, [session.warnings(), said].concat()), out, context)
}

/// Refuses bad outputs before the work starts.
fn ready(args: &RenderArgs, context: &Context) -> anyhow::Result<()> {
    let out = &args.out;
    anyhow::ensure!(
        !(is_vectors(out) && args.asked.drawing.compare),
        "{}: --compare draws two pictures of pixels; name the output .png",
        out.display()
    );
    if is_stdout(out) {
        outputs::check_stdout(context)?;
        anyhow::ensure!(
            args.asked.aux.is_empty(),
            "-o -: --aux writes several files, which standard output cannot hold; name a file"
        );
    }
    Ok(())
}

/// Says what was drawn.
fn deliver(
    picture: &Picture,
    (written, mut warnings): (&[PathBuf], Vec<Warning>),
    out: &Path,
    context: &Context,
) -> anyhow::Result<Goal> {
    let record = &picture.sidecar;
    context.timings.note_picture(record);
    warnings.extend(record.of_picture.iter().cloned());
    if context.common.json {
        let (displacement, render_ms) = (record.displacement, record.render_ms);
        let content =
            Rendered { displacement, render_ms, fallback: record.fallback.clone(), warnings: warnings.clone() };
        context.print("render", written, &content)?;
    } else if let Some(fallback) = record.fallback.as_ref().filter(|_| !context.common.quiet) {
        context.finish();
        context.say(&format!("{fallback}\n"), out)?;
    }
    context.warn(&warnings);
    // A picture of nothing is a missed goal.
    let shows_nothing = |w: &Warning| w.kind() == WarningKind::Suspect && w.subject() == Some("camera");
    Ok(if record.of_picture.iter().any(shows_nothing) { Goal::Missed } else { Goal::Reached })
}
