//! One function per verb: open, call the library, deliver.

use crate::args::{CheckArgs, DemoArgs, FigureKind, FiguresArgs, MeasureArgs, SchemaArgs, ShowArgs, Verb};
use crate::goal::Goal;
use crate::info_args::InfoArgs;
use crate::inputs::as_text;
use crate::outputs::{self, named};
use crate::point_args::{DisplaceArgs, PickArgs, ProjectArgs, RaysArgs};
use crate::report::{Context, is_stdout, print};
use anyhow::Context as _;
use belvedere::answers::{self, Content, Warned, Written};
use belvedere::pick;
use belvedere::picture::PictureOptions;
use belvedere::verbs::moved::MovedFeatures;
use belvedere::verbs::schemas::{FailedFile, FileAnswer, Informed};
use belvedere::verbs::{check, info, measure, points};
use belvedere::{Needs, OpenOptions, Session, output};
use std::path::{Path, PathBuf};

/// Runs a verb.
pub(crate) fn run(verb: Verb, context: &Context) -> anyhow::Result<Goal> {
    match verb {
        Verb::Render(args) => crate::render::render(&args, context),
        Verb::Disocclude(args) => crate::disocclude::disocclude(*args, context),
        Verb::Generalise(args) => crate::city::generalise_city(args, context),
        Verb::Preset(args) => crate::preset::preset(args, context),
        Verb::Animate(args) => crate::animate::animate(&args, context),
        Verb::Export(args) => crate::export::export_scene(&args, context),
        Verb::Project(args) => project(&args, context),
        Verb::Rays(args) => rays(&args, context),
        Verb::Displace(args) => displace(&args, context),
        Verb::Reveal(args) => crate::reveal::reveal(*args, context),
        Verb::Pick(args) => pick_pixels(&args, context),
        Verb::Measure(args) => measure_scene(&args, context),
        Verb::Demo(args) => demonstrate(&args, context),
        Verb::Info(args) => describe(&args, context),
        Verb::Check(args) => check_scene(&args, context),
        Verb::Show(args) => show(&args, context),
        Verb::Schema(args) => schema(&args, context),
        Verb::Bench(args) => crate::bench::bench(&args, context),
        Verb::Figures(args) => draw_figures(&args, context),
        Verb::View(args) => crate::view::view(&args, context),
        Verb::Pack(args) => crate::pack::pack_scene(args, context),
        Verb::Trust(args) => crate::trust::trust(&args, context),
        Verb::Completions(args) => crate::shell::completions(&args, context),
        Verb::Man(args) => crate::shell::man(&args, context),
    }
}

/// Refuses a bad output before the work starts.
fn ready(out: Option<&PathBuf>, inputs: &[&Path], context: &Context) -> anyhow::Result<()> {
    let from_stdin = inputs.iter().filter(|path| is_stdout(path)).count();
    anyhow::ensure!(from_stdin < 2, "-: only one input can be standard input; give a file for the other");
    let inputs: Vec<PathBuf> = inputs.iter().map(|p| p.to_path_buf()).collect();
    outputs::check(&outputs::file(out).cloned().into_iter().collect::<Vec<_>>(), &inputs, context)
}

fn answer(
    verb: &'static str,
    session: &Session,
    out: Option<&PathBuf>,
    content: &impl Content,
    context: &Context,
) -> anyhow::Result<Goal> {
    ready(out, &session.inputs().iter().map(|file| file.path.as_path()).collect::<Vec<_>>(), context)?;
    context.deliver_answer(verb, out.map(PathBuf::as_path), content, &session.warnings())?;
    Ok(Goal::Reached)
}

/// Content with the warnings of opening a scene.
fn warned<T>(content: T, session: &Session) -> Warned<T> {
    Warned { content, warnings: session.warnings() }
}

fn measure_scene(args: &MeasureArgs, context: &Context) -> anyhow::Result<Goal> {
    ready(args.out.as_ref(), &[&args.scene], context)?;
    let session = context.open(&args.scene, Needs::Everything, args.asked.size)?;
    let report = measure::measure(&session, &args.asked, &context.progress)?;
    answer("measure", &session, args.out.as_ref(), &report, context)
}

fn draw_figures(args: &FiguresArgs, context: &Context) -> anyhow::Result<Goal> {
    outputs::check_folder(&args.out, context)?;
    let (options, overwrite) = (context.options(Needs::Everything, None), context.common.overwrite);
    let mut written = Vec::new();
    if args.what.0.contains(&FigureKind::Algorithms) {
        written.extend(belvedere_gallery::algorithm_figures(&args.out, &options, overwrite)?);
    }
    if args.what.0.contains(&FigureKind::Guide) {
        written.extend(belvedere_gallery::guide_figures(&args.out, &options, overwrite)?);
    }
    if args.what.0.contains(&FigureKind::Curved) {
        written.extend(belvedere_gallery::curved_figures(&args.out, &options, args.scale, overwrite)?);
    }
    if args.what.0.contains(&FigureKind::Spline) {
        written.extend(belvedere_gallery::spline_figures(&args.out, &options, args.scale, overwrite)?);
    }
    if args.what.0.contains(&FigureKind::Compare) {
        written.extend(belvedere_gallery::compare_figures(&args.out, &options, args.scale, overwrite)?);
    }
    if args.what.0.contains(&FigureKind::Terrain) {
        written.extend(belvedere_gallery::terrain_figures(&args.out, &args.scenes, &options, overwrite)?);
    }
    context.finish();
    if context.common.json {
        context.print("figures", &written, &Written::default())?;
    } else if let Some(last) = written.last().filter(|_| !context.common.quiet) {
        print(&format!("open {}\n", last.display()))?;
    }
    Ok(Goal::Reached)
}

fn demonstrate(args: &DemoArgs, context: &Context) -> anyhow::Result<Goal> {
    outputs::check_folder(&args.out, context)?;
    let mut request = PictureOptions::default();
    request.quality.threads = context.common.threads;
    let options = context.options(Needs::Everything, args.size);
    let written = belvedere_gallery::demo(&args.out, &options, &request, context.common.overwrite)?;
    context.finish();
    if context.common.json {
        context.print("demo", &written, &Written::default())?;
    } else if !context.common.quiet {
        print(&format!("open {}\n", args.out.join("index.html").display()))?;
    }
    Ok(Goal::Reached)
}

fn describe(args: &InfoArgs, context: &Context) -> anyhow::Result<Goal> {
    ready(None, &[], context)?;
    let machine = args.adapters.then(info::machine);
    let request = info::InfoRequest {
        source_crs: args.ground.raster.source_crs.clone(),
        nodata: args.ground.raster.nodata,
        vertical_unit: args.ground.raster.vertical_unit,
        name_field: args.ground.name_field.clone(),
        max_bytes: context.common.budget(),
    };
    let (mut files, mut bad) = (Vec::new(), Vec::new());
    for file in &args.files {
        let file = &as_text(&context.stdin.data(Path::new(file))?);
        match info::describe_as(file, &request, &context.progress) {
            Ok(found) => files.push(FileAnswer::Described(Box::new(found))),
            Err(e) if e.is_cancelled() || args.files.len() == 1 => return Err(e.into()),
            Err(e) => {
                let reason = e.to_string();
                files.push(FileAnswer::Failed(FailedFile::new(Path::new(file), reason.clone())));
                bad.push(reason);
            }
        }
    }
    context.finish();
    let text = answers::line("info", &[], &Informed { machine, files })?;
    if context.common.json {
        print(&text)?;
    } else {
        print(&check::plain(&serde_json::from_str(&text)?))?;
    }
    match bad.as_slice() {
        [] => Ok(Goal::Reached),
        [first, ..] => Err(anyhow::anyhow!("{} of {} files cannot be described: {first}", bad.len(), args.files.len())),
    }
}

/// A scene and points in its coordinates; the ground is read if a point is written as a place.
fn with_points(scene: &Path, points: &Path, context: &Context) -> anyhow::Result<(Session, Vec<[f64; 3]>)> {
    let written = points::read_written_points(&context.stdin.json(points)?)?;
    let is_place = |point: &points::WrittenPoint| matches!(point, points::WrittenPoint::Place(_));
    let needs = if written.iter().any(is_place) { Needs::Ground } else { Needs::View };
    let session = context.open(scene, needs, None)?;
    let (found, said) = session.find_points(&written)?;
    context.warn(&said);
    Ok((session, found))
}

fn project(args: &ProjectArgs, context: &Context) -> anyhow::Result<Goal> {
    ready(args.out.as_ref(), &[&args.scene, &args.points], context)?;
    let (session, points) = with_points(&args.scene, &args.points, context)?;
    let report = warned(points::project(session.view(), &points), &session);
    answer("project", &session, args.out.as_ref(), &report, context)
}

fn displace(args: &DisplaceArgs, context: &Context) -> anyhow::Result<Goal> {
    let Some(points) = &args.points else { return displace_features(args, context) };
    ready(args.out.as_ref(), &[&args.scene, points], context)?;
    let (session, points) = with_points(&args.scene, points, context)?;
    let report = warned(points::displace(session.view(), &points), &session);
    answer("displace", &session, args.out.as_ref(), &report, context)
}

fn displace_features(args: &DisplaceArgs, context: &Context) -> anyhow::Result<Goal> {
    ready(args.out.as_ref(), &[&args.scene], context)?;
    let out = outputs::file(args.out.as_ref());
    if let Some(out) = out {
        named(out, &["geojson", "json", "gpkg"], "moved features are written as GeoJSON and GeoPackage")?;
    }
    let session = context.open(&args.scene, Needs::Everything, None)?;
    ready(out, &session.inputs().iter().map(|file| file.path.as_path()).collect::<Vec<_>>(), context)?;
    let moved = MovedFeatures::of_session(&session)?;
    let mut warnings = session.warnings();
    warnings.extend(moved.warnings());
    match out {
        None => print(&output::json(&moved.geojson()?)?)?,
        Some(path) => {
            moved.write(path, context.common.overwrite)?;
            if context.common.json {
                context.print("displace", std::slice::from_ref(path), &Written { warnings: warnings.clone() })?;
            }
        }
    }
    context.warn(&warnings);
    Ok(Goal::Reached)
}

fn rays(args: &RaysArgs, context: &Context) -> anyhow::Result<Goal> {
    ready(args.out.as_ref(), &[&args.scene, &args.pixels], context)?;
    let source = context.stdin.scene(&args.scene)?;
    // Without a far limit from the arguments or the scene, the layers' extent limits the rays, so they are loaded.
    let needs = if args.far.or(source.document.camera.far).is_some() { Needs::View } else { Needs::Everything };
    let session = Session::from_document(source, &context.options(needs, None))?;
    let pixels = points::read_points::<2>(&context.stdin.json(&args.pixels)?)?;
    let far = session.ray_end(args.far)?;
    let report = points::rays(session.view(), &pixels, args.samples, far)?;
    answer("rays", &session, args.out.as_ref(), &warned(report, &session), context)
}

fn pick_pixels(args: &PickArgs, context: &Context) -> anyhow::Result<Goal> {
    ready(args.out.as_ref(), &[&args.scene, &args.pixels], context)?;
    let pixels = points::read_points::<2>(&context.stdin.json(&args.pixels)?)?;
    let session = context.open(&args.scene, Needs::Everything, None)?;
    let report = pick::pick(&session, &pixels, &context.progress)?;
    answer("pick", &session, args.out.as_ref(), &warned(report, &session), context)
}

fn check_scene(args: &CheckArgs, context: &Context) -> anyhow::Result<Goal> {
    ready(args.mend.as_ref(), &[&args.scene], context)?;
    let options = OpenOptions { unsolved: true, undrawn: true, ..context.options(Needs::Everything, None) };
    let (session, outputs) = match &args.mend {
        None => (context.open_with(&args.scene, &options)?, Vec::new()),
        Some(out) => {
            let made = check::mend(context.stdin.scene(&args.scene)?, &options, out)?;
            output::write_text(out, &made.text, context.common.overwrite)?;
            let said = made.wrong.iter().map(|wrong| format!("mended: {wrong}\n")).collect::<String>();
            let said = if said.is_empty() { "nothing to mend\n".to_owned() } else { said };
            if !context.common.quiet && !context.common.json {
                print(&said)?;
            }
            (made.session, vec![out.clone()])
        }
    };
    let report = check::check(&session)?;
    if context.common.json {
        context.print("check", &outputs, &report)?;
    } else if !context.common.quiet {
        print(&report.to_string())?;
    }
    context.warn(&session.warnings());
    Ok(Goal::Reached)
}

fn show(args: &ShowArgs, context: &Context) -> anyhow::Result<Goal> {
    ready(args.out.as_ref(), &[&args.scene], context)?;
    let options = OpenOptions { unsolved: true, ..context.options(Needs::Ground, None) };
    let session = context.open_drawable(&args.scene, &args.data, &options)?;
    let out = outputs::file(args.out.as_ref());
    let named_json = out.is_some_and(|p| p.extension().is_some_and(|e| e.eq_ignore_ascii_case("json")));
    let json = if out.is_some() { named_json } else { context.common.json };
    let document = match (out, session.path()) {
        (Some(path), _) => session.resolved_for(path),
        (None, Some(_)) => session.resolved().cloned(),
        // Data alone: a scene of the current folder, where a shell's redirection puts it.
        (None, None) => session.resolved_for(Path::new("scene.toml")),
    };
    let document = document.context("the scene has no document")?;
    let text = if json { output::document_json(&document)? } else { output::document_toml(&document)? };
    context.deliver("show", args.out.as_deref(), &text, &session.warnings())?;
    if let Some(path) = out {
        context.remember(path, &session);
    }
    Ok(Goal::Reached)
}

fn schema(args: &SchemaArgs, context: &Context) -> anyhow::Result<Goal> {
    ready(args.out.as_ref(), &[], context)?;
    context.deliver("schema", args.out.as_deref(), &crate::schemas::text(&args.of, args.request)?, &[])?;
    Ok(Goal::Reached)
}
