//! `trust`: lets a scene read files outside its folder, and says which scenes may.

use crate::goal::Goal;
use crate::report::{Context, print};
use anyhow::ensure;
use belvedere::trust;
use belvedere::verbs::schemas::TrustAnswer;
use clap::Args;
use std::fmt::Write;
use std::path::PathBuf;

/// A scene.
#[derive(Debug, Args)]
pub(crate) struct TrustArgs {
    /// Scene file whose files outside its folder may be read from now on: those that it names today, no others
    #[arg(required_unless_present_any = ["list", "forget"])]
    pub(crate) scene: Option<PathBuf>,
    /// Print the scenes and the files that they may read
    #[arg(long, conflicts_with_all = ["scene", "forget"])]
    pub(crate) list: bool,
    /// Forget the scene, or all scenes if none is named
    #[arg(long)]
    pub(crate) forget: bool,
}

pub(crate) fn trust(args: &TrustArgs, context: &Context) -> anyhow::Result<Goal> {
    let Some(record) = context.trust.record() else {
        anyhow::bail!(
            "nothing is remembered: --no-remember or {} is given, or there is no folder for settings",
            trust::OFF
        );
    };
    let mut text = String::new();
    let mut result = TrustAnswer { record: record.to_owned(), files: None, forgotten: None, scenes: None };
    match &args.scene {
        Some(scene) if !args.forget => {
            let found = trust::outside(scene, &context.common.allow_root)?;
            if let [name, ..] = &found.missing[..] {
                anyhow::bail!(
                    "{}: \"{name}\" is not there; check the name, or give its folder with --allow-root DIR",
                    scene.display()
                );
            }
            context.trust.remember(scene, &found.files)?;
            for file in &found.files {
                writeln!(text, "may be read: {}", file.display())?;
            }
            if found.files.is_empty() {
                writeln!(text, "{} names no file outside its folder", scene.display())?;
            }
            result.files = Some(found.files);
        }
        scene if args.forget => {
            let count = context.trust.forget(scene.as_deref())?;
            ensure!(
                count > 0 || scene.is_none(),
                "{}: it is not remembered",
                scene.iter().map(|s| s.display().to_string()).collect::<String>()
            );
            writeln!(text, "forgotten: {count} {}", if count == 1 { "scene" } else { "scenes" })?;
            result.forgotten = Some(count);
        }
        _ => {
            let list = context.trust.list();
            for entry in &list {
                writeln!(text, "{}", entry.scene.display())?;
                entry.files.iter().try_for_each(|file| writeln!(text, "  {}", file.display()))?;
            }
            result.scenes = Some(list);
        }
    }
    if context.common.json {
        context.print("trust", &[], &result)?;
    } else if !context.common.quiet || args.list {
        print(&text)?;
    }
    Ok(Goal::Reached)
}
