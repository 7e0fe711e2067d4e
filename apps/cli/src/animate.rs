//! `animate`: a film of a moving camera.

use crate::goal::Goal;
use crate::outputs;
use crate::report::Context;
use belvedere::request::Animate;
use belvedere::verbs::animate::{self as verb, Film};
use belvedere::verbs::asked;
use belvedere::verbs::schemas::Animated;
use belvedere::{Needs, OpenOptions, Session, output};
use clap::Args;
use std::path::PathBuf;

/// A moving camera.
#[derive(Debug, Args)]
pub(crate) struct AnimateArgs {
    /// Scene file, TOML or JSON, or data as `render` takes them; - = standard input
    scene: PathBuf,
    /// Film, made by the ffmpeg program, with its frames in the folder OUT.frames; or a folder for the frames alone
    #[arg(short, long, value_name = "OUT.mp4|DIR")]
    out: PathBuf,
    #[command(flatten)]
    asked: Animate,
}

pub(crate) fn animate(args: &AnimateArgs, context: &Context) -> anyhow::Result<Goal> {
    let (asked, overwrite) = (&args.asked, context.common.overwrite);
    let (folder, film) = verb::outputs(&args.out)?;
    outputs::check_folder(&folder, context)?;
    if let (Some(film), None) = (&film, &asked.part) {
        output::check(film, std::slice::from_ref(&args.scene), overwrite || asked.resume)?;
    }
    let source = context.stdin.drawable(std::slice::from_ref(&args.scene), &asked.data)?;
    let (sheet, size) = asked::paper((&asked.paper, asked.drawing.size), &source.document)?;
    let mut request = asked::film(asked, sheet, args.out.clone(), overwrite)?;
    request.picture = context.running(request.picture);
    // The ground is solved for every frame, not on opening.
    let furniture = Some(asked.furnishing.wish());
    let trajectory = asked.trajectory.clone();
    let options = OpenOptions { unsolved: true, furniture, trajectory, ..context.options(Needs::Everything, size) };
    let session = Session::from_document(source, &options)?;
    let made = verb::animate(&session, &request, &context.progress)?;
    context.finish();
    let warnings = [session.warnings(), made.warnings.clone()].concat();
    let mut outputs = vec![made.folder.clone()];
    let missing = match &made.film {
        Film::Made(path) => {
            outputs.insert(0, path.clone());
            None
        }
        Film::Missing { reason, command } => {
            Some(format!("{reason}; install ffmpeg and go on with --resume, or run: {command}"))
        }
        Film::Unwanted => None,
    };
    if context.common.json {
        let (frames, fps) = (made.manifest.frames.len(), made.manifest.settings.fps);
        let content = Animated { frames, drawn: made.drawn, fps, warnings: warnings.clone() };
        context.print("animate", &outputs, &content)?;
    }
    context.warn(&warnings);
    context.warn(missing.as_slice());
    Ok(if missing.is_some() { Goal::Missed } else { Goal::Reached })
}
