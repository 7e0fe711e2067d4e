//! `disocclude`: an elevation model on which features are visible.

use crate::goal::Goal;
use crate::inputs::as_text;
use crate::outputs::{self, named, png_named};
use crate::report::{Context, is_stdout, print};
use belvedere::Needs;
use belvedere::request::Disocclude;
use belvedere::verbs::disocclude::{self as verb, DisoccludeFiles};
use clap::Args;
use std::path::{Path, PathBuf};

/// Terrain, features and an eye.
#[derive(Debug, Args)]
pub(crate) struct DisoccludeArgs {
    #[command(flatten)]
    asked: Disocclude,
    /// Displaced elevation model: cloud-optimised GeoTIFF, 32-bit floats in metres, on the grid and in the system of the input
    #[arg(short, long, value_name = "OUT.tif")]
    out: PathBuf,
    /// Write figures, parameters, and the parts that stay hidden with their reasons to this file
    #[arg(long, value_name = "OUT.json")]
    report: Option<PathBuf>,
    /// Write the displacement, on the same grid, to this file
    #[arg(long, value_name = "D.tif")]
    displacement: Option<PathBuf>,
    /// Write the features on the displaced ground, their true positions as properties, to this file: GeoJSON, or .gpkg
    #[arg(long, value_name = "OUT.geojson")]
    features_out: Option<PathBuf>,
    /// Draw the ground before and after from the eye, side by side, with its record
    #[arg(long, value_name = "OUT.png")]
    picture: Option<PathBuf>,
    /// Write lines of sight to this file by which what is shown can be checked against the elevation model alone
    #[arg(long, value_name = "OUT.json")]
    certificate: Option<PathBuf>,
}

pub(crate) fn disocclude(args: DisoccludeArgs, context: &Context) -> anyhow::Result<Goal> {
    let mut asked = args.asked;
    let files = DisoccludeFiles {
        out: args.out,
        report: args.report,
        displacement: args.displacement,
        features: args.features_out,
        picture: args.picture,
        certificate: args.certificate,
    };
    ready(&files)?;
    let inputs: Vec<PathBuf> =
        asked.features.iter().chain(&asked.rivers).chain([&asked.data]).map(PathBuf::from).collect();
    outputs::check(&files.all(), &inputs, context)?;
    for name in asked.features.iter_mut().chain(&mut asked.rivers).chain([&mut asked.data]) {
        *name = as_text(&context.stdin.data(Path::new(name.as_str()))?);
    }
    let found = verb::disocclude(&asked, &context.options(Needs::Everything, None))?;
    let written = found.write(&files, context.common.overwrite, &context.progress)?;
    context.timings.note("disocclusion", serde_json::json!(found.report().times));
    context.finish();
    if context.common.json {
        context.print("disocclude", &written, &found.document())?;
    } else if !context.common.quiet {
        print(&format!("{}\n", found.summary()))?;
    }
    context.warn(&found.session.warnings());
    context.warn(&found.missed());
    Ok(if found.missed().is_empty() { Goal::Reached } else { Goal::Missed })
}

/// Refuses names of other formats.
fn ready(files: &DisoccludeFiles) -> anyhow::Result<()> {
    files.picture.as_deref().map_or(Ok(()), png_named)?;
    for path in [Some(&files.out), files.displacement.as_ref()].into_iter().flatten() {
        named(path, &["tif", "tiff"], "elevation models are written as GeoTIFF")?;
    }
    if let Some(path) = &files.features {
        named(path, &["geojson", "json", "gpkg"], "moved features are written as GeoJSON and GeoPackage")?;
    }
    anyhow::ensure!(!is_stdout(&files.out), "-o -: an elevation model is written to a file; name one");
    Ok(())
}
