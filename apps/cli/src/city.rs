//! `generalise`: its arguments, and what it says.

use crate::goal::Goal;
use crate::outputs;
use crate::report::{Context, print};
use belvedere::output;
use belvedere::request::Generalise;
use belvedere::verbs::generalise;
use clap::Args;
use std::path::PathBuf;

/// Buildings and streets.
#[derive(Debug, Args)]
pub(crate) struct GeneraliseArgs {
    #[command(flatten)]
    asked: Generalise,
    /// Folder for the levels, the map, the plan drawings and the report
    #[arg(short, long, value_name = "DIR")]
    out: PathBuf,
}

pub(crate) fn generalise_city(args: GeneraliseArgs, context: &Context) -> anyhow::Result<Goal> {
    outputs::check_folder(&args.out, context)?;
    let inputs: Vec<PathBuf> = args.asked.roads.iter().chain([&args.asked.city]).map(PathBuf::from).collect();
    if args.out.exists() {
        for path in [None, Some(0)].iter().flat_map(|epsg| generalise::files(&args.out, *epsg)) {
            output::check(&path, &inputs, context.common.overwrite)?;
        }
    }
    let found = generalise::generalise(&args.asked, &context.progress)?;
    let written = found.write(&args.out, context.common.overwrite, &context.progress)?;
    context.finish();
    if context.common.json {
        context.print("generalise", &written, &found.document())?;
    } else if !context.common.quiet {
        print(&format!("{}\nopen {}\n", found.summary(), args.out.join("overview.png").display()))?;
    }
    context.warn(&found.warnings);
    context.warn(&found.generalised.report.notes);
    context.warn(&found.missed());
    context.warn(&found.failing());
    Ok(if found.missed().is_empty() { Goal::Reached } else { Goal::Missed })
}
