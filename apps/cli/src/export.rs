//! `export`: the displaced scene and its camera as GLB.

use crate::goal::Goal;
use crate::outputs;
use crate::report::{Context, is_stdout};
use belvedere::export::{self, ExportOptions};
use belvedere::io::atomic;
use belvedere::request::Export;
use belvedere::{Needs, OpenOptions};
use clap::Args;
use std::path::PathBuf;

/// A scene and where it goes.
#[derive(Debug, Args)]
pub(crate) struct ExportArgs {
    /// Scene file, TOML or JSON, or data as `render` takes them; - = standard input
    scene: PathBuf,
    /// Output, glTF 2.0 in one binary file; - = standard output
    #[arg(short, long, value_name = "OUT.glb")]
    out: PathBuf,
    #[command(flatten)]
    asked: Export,
}

pub(crate) fn export_scene(args: &ExportArgs, context: &Context) -> anyhow::Result<Goal> {
    outputs::named(&args.out, &["glb"], "scenes are exported as binary glTF")?;
    let files: Vec<PathBuf> = outputs::file(Some(&args.out)).cloned().into_iter().collect();
    if is_stdout(&args.out) {
        outputs::check_stdout(context)?;
    }
    outputs::check(&files, std::slice::from_ref(&args.scene), context)?;
    let options = OpenOptions { unsolved: args.asked.straight, ..context.options(Needs::Everything, args.asked.size) };
    let session = context.open_drawable(&args.scene, &args.asked.data, &options)?;
    outputs::check(&files, &session.input_paths(), context)?;
    let options = ExportOptions { progress: context.progress.clone(), ..ExportOptions::of(&args.asked) };
    let made = export::export(&session, &options)?;
    context.finish();
    match &files[..] {
        [file] => atomic::write_atomic(file, context.common.overwrite, |out| out.write_all(&made.glb))
            .map_err(belvedere::BelvedereError::from)?,
        _ => outputs::write_stdout(&made.glb)?,
    }
    if context.common.json {
        context.print("export", &files, &made.report)?;
    } else if !context.common.quiet {
        let (report, [x, y, z]) = (&made.report, made.report.origin);
        let text = format!("{} triangles around {x},{y},{z} ({})\n", report.triangles, report.crs);
        context.say(&text, &args.out)?;
    }
    context.warn(&made.report.warnings);
    Ok(Goal::Reached)
}
