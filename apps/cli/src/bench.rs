//! `bench`: what pictures cost on this machine.

use crate::bench_args::BenchArgs;
use crate::goal::Goal;
use crate::outputs;
use crate::report::{Context, is_stdout, print};
use anyhow::Context as _;
use belvedere::answers::{Content, Warned};
use belvedere_bench::{BenchRequest, CollectionReport, CollectionRequest, bench_collection};
use std::path::Path;

/// Measures generated ground, or the collection.
pub(crate) fn bench(args: &BenchArgs, context: &Context) -> anyhow::Result<Goal> {
    let inputs: Vec<_> = args.against.iter().cloned().collect();
    outputs::check(&outputs::file(args.out.as_ref()).cloned().into_iter().collect::<Vec<_>>(), &inputs, context)?;
    match &args.collection {
        Some(folder) => collection(folder, args, context),
        None => {
            let threads = context.common.threads;
            let request = BenchRequest { rounds: args.rounds, nodes: args.nodes, image: args.size, threads };
            let report = belvedere_bench::bench(&request, &context.progress)?;
            let text = report.to_string();
            deliver(report, &text, args, context)?;
            Ok(Goal::Reached)
        }
    }
}

fn collection(folder: &Path, args: &BenchArgs, context: &Context) -> anyhow::Result<Goal> {
    let earlier = args.against.as_deref().map(read).transpose()?;
    let request = CollectionRequest {
        data: folder.to_owned(),
        rounds: args.rounds,
        image: args.size,
        threads: context.common.threads,
        only: args.only.clone(),
        vtk: args.vtk.clone(),
    };
    let mut report = bench_collection(&request, &context.progress)?;
    report.slower = earlier.map_or_else(Vec::new, |earlier| report.slower_than(&earlier));
    let (text, missed) = (report.to_string(), !report.slower.is_empty());
    deliver(report, &text, args, context)?;
    Ok(if missed { Goal::Missed } else { Goal::Reached })
}

/// An earlier report.
fn read(path: &Path) -> anyhow::Result<CollectionReport> {
    let about = || format!("{}: this is no report of `bench --collection`", path.display());
    serde_json::from_slice(&belvedere::io::fs::read(path).with_context(about)?).with_context(about)
}

fn deliver(report: impl Content, text: &str, args: &BenchArgs, context: &Context) -> anyhow::Result<()> {
    context.finish();
    let report = Warned { content: report, warnings: Vec::new() };
    let to_stdout = args.out.as_deref().is_some_and(is_stdout);
    if args.out.is_some() || context.common.json {
        context.deliver_answer("bench", args.out.as_deref(), &report, &[])?;
    }
    if !to_stdout && !context.common.json && !context.common.quiet {
        print(text)?;
    }
    Ok(())
}
