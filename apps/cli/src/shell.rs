//! What a system wants to know of the arguments: completions for shells, and manual pages.

use crate::args::Cli;
use crate::goal::Goal;
use crate::outputs;
use crate::report::{Context, is_stdout, print};
use crate::shell_args::{CompletionsArgs, ManArgs};
use anyhow::Context as _;
use belvedere::answers::Written;
use belvedere::io::atomic;
use belvedere::output;
use clap::CommandFactory;
use clap_complete::Shell;
use std::path::PathBuf;

/// Writes what a shell needs to complete the command line.
pub(crate) fn completions(args: &CompletionsArgs, context: &Context) -> anyhow::Result<Goal> {
    let file = outputs::file(args.out.as_ref()).cloned();
    outputs::check(file.as_slice(), &[], context)?;
    let mut text = Vec::new();
    clap_complete::generate(Shell::from(args.shell), &mut Cli::command(), "belvedere", &mut text);
    let text = String::from_utf8(text)?;
    context.deliver("completions", args.out.as_deref(), &text, &[])?;
    Ok(Goal::Reached)
}

/// Writes one manual page for the program and one for each verb.
pub(crate) fn man(args: &ManArgs, context: &Context) -> anyhow::Result<Goal> {
    anyhow::ensure!(!is_stdout(&args.dir), "-: there is a page for every verb; name a folder");
    outputs::check_folder(&args.dir, context)?;
    let mut command = Cli::command().disable_help_subcommand(true);
    command.build();
    let mut pages = Vec::new();
    collect(&command, &mut pages)?;
    let files: Vec<PathBuf> = pages.iter().map(|(name, _)| args.dir.join(name)).collect();
    std::fs::create_dir_all(&args.dir).with_context(|| args.dir.display().to_string())?;
    outputs::check(&files, &[], context)?;
    atomic::together(|| {
        for (path, (_, text)) in files.iter().zip(&pages) {
            output::write_text(path, text, context.common.overwrite)?;
        }
        Ok::<(), belvedere::BelvedereError>(())
    })?;
    if context.common.json {
        context.print("man", &files, &Written::default())?;
    } else if !context.common.quiet {
        print(&format!("{} pages in {}\n", files.len(), args.dir.display()))?;
    }
    Ok(Goal::Reached)
}

/// The page of a command and those of its verbs: file names and texts.
fn collect(command: &clap::Command, pages: &mut Vec<(String, String)>) -> anyhow::Result<()> {
    let mut page = Vec::new();
    let man = clap_mangen::Man::new(command.clone());
    man.render(&mut page)?;
    pages.push((man.get_filename(), String::from_utf8(page)?));
    command.get_subcommands().filter(|verb| !verb.is_hide_set()).try_for_each(|verb| collect(verb, pages))
}
