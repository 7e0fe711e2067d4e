//! `export`: the displaced scene and its camera as GLB.

use crate::goal::Goal;
use crate::outputs;
use crate::report::{Context, is_stdout};
use belvedere::export::{self, ExportOptions, GROUND_NODES};
use belvedere::io::atomic;
use belvedere::request::OfData;
use belvedere::request::parse::size;
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
    /// Size of the picture that the camera is for, instead of the scene's
    #[arg(long, value_name = "WxH", allow_hyphen_values = true, value_parser = size)]
    size: Option<[u32; 2]>,
    /// The scene without its bends
    #[arg(long)]
    straight: bool,
    /// Most nodes of the ground, 4 to 4,000,000; of finer ground every second, third ... node is taken
    #[arg(long, value_name = "N", default_value_t = GROUND_NODES as u32, allow_negative_numbers = true, value_parser = clap::value_parser!(u32).range(4..=4_000_000))]
    nodes: u32,
    #[command(flatten)]
    data: OfData,
}

pub(crate) fn export_scene(args: &ExportArgs, context: &Context) -> anyhow::Result<Goal> {
    outputs::named(&args.out, &["glb"], "scenes are exported as binary glTF")?;
    let files: Vec<PathBuf> = outputs::file(Some(&args.out)).cloned().into_iter().collect();
    if is_stdout(&args.out) {
        outputs::check_stdout(context)?;
    }
    outputs::check(&files, std::slice::from_ref(&args.scene), context)?;
    let options = OpenOptions { unsolved: args.straight, ..context.options(Needs::Everything, args.size) };
    let session = context.open_drawable(&args.scene, &args.data, &options)?;
    outputs::check(&files, &session.input_paths(), context)?;
    let options = ExportOptions {
        ground_nodes: args.nodes as usize,
        straight: args.straight,
        progress: context.progress.clone(),
    };
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
