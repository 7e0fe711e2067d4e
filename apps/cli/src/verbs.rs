//! One function per verb: open, call the library, deliver.

use crate::args::{ProjectArgs, RaysArgs, SceneArgs, SchemaArgs, ShowArgs, Verb};
use crate::report::{Context, print};
use belvedere::verbs::{check, output, points};
use belvedere::{Needs, Session};
use std::path::{Path, PathBuf};

/// Whether a verb reached its stated goal.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Goal {
    /// It did, or has none.
    Reached,
}

impl Goal {
    /// Whether a stated goal was missed.
    pub(crate) fn is_missed(self) -> bool {
        self != Self::Reached
    }
}

/// Runs a verb.
pub(crate) fn run(verb: Verb, context: &Context) -> anyhow::Result<Goal> {
    match verb {
        Verb::Project(args) => project(&args, context),
        Verb::Rays(args) => rays(&args, context),
        Verb::Displace(args) => displace(&args, context),
        Verb::Check(args) => check_scene(&args, context),
        Verb::Show(args) => show(&args, context),
        Verb::Schema(args) => schema(&args, context),
    }
}

/// Refuses a bad output before the work starts.
fn ready(out: Option<&PathBuf>, inputs: &[&Path], context: &Context) -> anyhow::Result<()> {
    let inputs: Vec<PathBuf> = inputs.iter().map(|p| p.to_path_buf()).collect();
    out.map_or(Ok(()), |path| Ok(output::check(path, &inputs, context.common.overwrite)?))
}

fn answer(verb: &str, session: &Session, out: Option<&PathBuf>, text: &str, context: &Context) -> anyhow::Result<Goal> {
    ready(out, &session.inputs().iter().map(PathBuf::as_path).collect::<Vec<_>>(), context)?;
    context.deliver(verb, out.map(PathBuf::as_path), text, session.warnings())?;
    Ok(Goal::Reached)
}

fn project(args: &ProjectArgs, context: &Context) -> anyhow::Result<Goal> {
    ready(args.out.as_ref(), &[&args.scene, &args.points], context)?;
    let session = context.open(&args.scene, Needs::View, None)?;
    let points = points::read_points::<3>(&args.points)?;
    answer("project", &session, args.out.as_ref(), &output::json(&points::project(session.view(), &points))?, context)
}

fn displace(args: &ProjectArgs, context: &Context) -> anyhow::Result<Goal> {
    ready(args.out.as_ref(), &[&args.scene, &args.points], context)?;
    let session = context.open(&args.scene, Needs::View, None)?;
    let points = points::read_points::<3>(&args.points)?;
    answer("displace", &session, args.out.as_ref(), &output::json(&points::displace(session.view(), &points))?, context)
}

fn rays(args: &RaysArgs, context: &Context) -> anyhow::Result<Goal> {
    ready(args.out.as_ref(), &[&args.scene, &args.pixels], context)?;
    let mut session = context.open(&args.scene, Needs::View, None)?;
    let pixels = points::read_points::<2>(&args.pixels)?;
    if args.far.or(session.view().pinhole().far).is_none() {
        session = context.open(&args.scene, Needs::Everything, None)?;
    }
    let far = points::far_depth(&session, args.far)?;
    let report = points::rays(session.view(), &pixels, args.samples, far)?;
    answer("rays", &session, args.out.as_ref(), &output::json(&report)?, context)
}

fn check_scene(args: &SceneArgs, context: &Context) -> anyhow::Result<Goal> {
    let session = context.open(&args.scene, Needs::Everything, None)?;
    let report = check::check(&session)?;
    if context.common.json {
        print(&output::json(&report)?)?;
    } else if !context.common.quiet {
        print(&report.to_string())?;
    }
    context.warn(session.warnings());
    Ok(Goal::Reached)
}

fn show(args: &ShowArgs, context: &Context) -> anyhow::Result<Goal> {
    ready(args.out.as_ref(), &[&args.scene], context)?;
    let session = context.open(&args.scene, Needs::View, None)?;
    let named_json = args.out.as_ref().is_some_and(|p| p.extension().is_some_and(|e| e.eq_ignore_ascii_case("json")));
    let json = if args.out.is_some() { named_json } else { context.common.json };
    let text = if json { check::document_json(session.resolved())? } else { check::document_toml(session.resolved())? };
    context.deliver("show", args.out.as_deref(), &text, session.warnings())?;
    Ok(Goal::Reached)
}

fn schema(args: &SchemaArgs, context: &Context) -> anyhow::Result<Goal> {
    ready(args.out.as_ref(), &[], context)?;
    context.deliver("schema", args.out.as_deref(), &check::schema_json()?, &[])?;
    Ok(Goal::Reached)
}
