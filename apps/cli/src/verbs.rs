//! One function per verb: open, call the library, deliver.

use crate::args::{
    AnimateArgs, AuxFormatKind, AuxKind, DemoArgs, DisoccludeArgs, FigureKind, FiguresArgs, MeasureArgs, RenderArgs,
    SceneArgs, SchemaArgs, ShowArgs, Verb,
};
use crate::draw_args::{CompositingKind, DrawArgs};
use crate::goal::Goal;
use crate::info_args::InfoArgs;
use crate::inputs::as_text;
use crate::outputs::{self, named, png_named};
use crate::point_args::{DisplaceArgs, PickArgs, ProjectArgs, RaysArgs};
use crate::print_args::{self, is_vectors};
use crate::report::{Context, is_stdout, print};
use anyhow::Context as _;
use belvedere::answers::{self, Content, Warned, Written};
use belvedere::core::{Warning, WarningKind};
use belvedere::pick;
use belvedere::picture::{self, AuxBuffer, AuxFormat, PictureOptions};
use belvedere::request::Air;
use belvedere::scene::{Compositing, Sky};
use belvedere::scene_file::{AnimationDoc, PaletteDoc, StylisationDoc, SweepDoc, TurntableDoc};
use belvedere::verbs::animate::{self, AnimateRequest, Film};
use belvedere::verbs::disocclude::{self, DisoccludeFiles, DisoccludeRequest, WrittenGrid};
use belvedere::verbs::moved::MovedFeatures;
use belvedere::verbs::schemas::{Animated, FailedFile, FileAnswer, Informed, Rendered};
use belvedere::verbs::{check, info, measure, points};
use belvedere::{CameraPicture, DataFiles, Needs, OpenOptions, Session, output};
use std::path::{Path, PathBuf};

/// Runs a verb.
pub(crate) fn run(verb: Verb, context: &Context) -> anyhow::Result<Goal> {
    match verb {
        Verb::Render(args) => render(&args, context),
        Verb::Disocclude(args) => disocclude_terrain(args, context),
        Verb::Generalise(args) => crate::city::generalise_city(args, context),
        Verb::Preset(args) => crate::preset::preset(args, context),
        Verb::Animate(args) => animate_scene(args, context),
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

/// Options common to all pictures and frames.
fn request(args: &DrawArgs, context: &Context) -> PictureOptions {
    let mut request = PictureOptions { straight: args.straight, compare: args.compare, ..PictureOptions::default() };
    request.renderer = args.renderer.into();
    request.quality.threads = context.common.threads;
    request.quality.samples = args.samples;
    request.quality.compositing = match args.compositing {
        CompositingKind::Single => Compositing::Single,
        CompositingKind::Dither => Compositing::Dither,
        CompositingKind::Layers => Compositing::Layers,
    };
    request.quality.exposures = args.thresholds.div_ceil(args.samples.max(1));
    request.quality.lod_px = args.lod;
    request.stylisation = args.stylise.then(|| StylisationDoc::usual().strengths().unwrap_or_default());
    request.progress = context.progress.clone();
    request.quality.max_bytes = belvedere::io::budget::bytes();
    request
}

fn render(args: &RenderArgs, context: &Context) -> anyhow::Result<Goal> {
    let mut request = request(&args.draw, context);
    request.aux = args
        .aux
        .iter()
        .map(|kind| match kind {
            AuxKind::Depth => AuxBuffer::Depth,
            AuxKind::Id => AuxBuffer::Id,
            AuxKind::World => AuxBuffer::World,
            AuxKind::Displacement => AuxBuffer::Displacement,
        })
        .collect();
    request.aux_format = match args.aux_format {
        AuxFormatKind::Npy => AuxFormat::Npy,
        AuxFormatKind::Exr => AuxFormat::Exr,
    };
    (request.grid, request.heatmap, request.ghost, request.no_mark) =
        (args.grid, args.heatmap, args.ghost, args.no_mark);
    request.highlight = args.highlight.clone();
    request.camera =
        args.overhead.then_some(CameraPicture::Overhead).or(args.outside.map(|_| CameraPicture::Outside(None)));
    print_args::check_name(&args.out, args.print.vectors_only)?;
    let source = context.stdin.drawable(&args.scene, &args.data)?;
    let document = &source.document;
    let sheet = args.print.sheet(document.print.as_ref(), args.draw.size, document.camera.image)?;
    let size = sheet.map(|sheet| sheet.pixels()).or(args.draw.size);
    let mut request = args.print.apply(request, &args.out, sheet);
    anyhow::ensure!(
        !(is_vectors(&args.out) && args.draw.compare),
        "{}: --compare draws two pictures of pixels; name the output .png",
        args.out.display()
    );
    let mut files = picture::outputs(&args.out, &request, source.document.solves_terrain());
    if is_stdout(&args.out) {
        outputs::check_stdout(context)?;
        anyhow::ensure!(
            args.aux.is_empty(),
            "-o -: --aux writes several files, which standard output cannot hold; name a file"
        );
        files.clear();
    }
    outputs::check(&files, std::slice::from_ref(&args.scene), context)?;
    let palette = args.palette.as_deref().map(PaletteDoc::of);
    // A straight picture does not need the ground solved.
    let unsolved = request.straight;
    let (area_style, sea) = (args.area_style, args.no_sea.then_some(false));
    let Air { sky, haze, furnishing, .. } = args.air.clone();
    let furniture = Some(furnishing.wish());
    let options = OpenOptions {
        palette,
        sky,
        haze,
        furniture,
        area_style,
        sea,
        unsolved,
        molecule: args.molecules.clone(),
        ..context.options(Needs::Everything, size)
    };
    let session = Session::from_document(source, &options.airy(&args.air))?;
    outputs::check(&files, &session.input_paths(), context)?;
    let mut warnings = session.warnings();
    if let Some(Some(places)) = &args.outside {
        let mut found = [[0.0; 3]; 2];
        for (to, place) in found.iter_mut().zip(places) {
            let (p, said) = session.find_place(place, "outside")?;
            *to = p.to_array();
            warnings.extend(said);
        }
        request.camera = Some(CameraPicture::Outside(Some(found)));
    }
    let transparent = session.light().sky == Sky::Transparent;
    picture::check_format(&args.out, session.view().pinhole().image.map(|side| side as usize), transparent)?;
    request.band_rows = args.band_rows.map(|rows| rows as usize);
    let (picture, written) = match is_stdout(&args.out) {
        true => {
            let picture = session.render(&request)?;
            outputs::write_stdout(&picture.to_png()?)?;
            (picture, Vec::new())
        }
        false => session.render_to(&request, &args.out, context.common.overwrite)?,
    };
    context.timings.note_picture(&picture.sidecar);
    warnings.extend(picture.sidecar.of_picture.iter().cloned());
    if context.common.json {
        let record = &picture.sidecar;
        let (displacement, render_ms) = (record.displacement, record.render_ms);
        let content =
            Rendered { displacement, render_ms, fallback: record.fallback.clone(), warnings: warnings.clone() };
        context.print("render", &written, &content)?;
    } else if let Some(fallback) = picture.sidecar.fallback.as_ref().filter(|_| !context.common.quiet) {
        context.finish();
        context.say(&format!("{fallback}\n"), &args.out)?;
    }
    context.warn(&warnings);
    // A picture of nothing is a missed goal.
    let shows_nothing = |w: &Warning| w.kind() == WarningKind::Suspect && w.subject() == Some("camera");
    Ok(if picture.sidecar.of_picture.iter().any(shows_nothing) { Goal::Missed } else { Goal::Reached })
}

fn disocclude_terrain(mut args: DisoccludeArgs, context: &Context) -> anyhow::Result<Goal> {
    let files = DisoccludeFiles {
        out: args.out,
        report: args.report,
        displacement: args.displacement,
        features: args.features_out,
        picture: args.picture,
    };
    files.picture.as_deref().map_or(Ok(()), png_named)?;
    for path in [Some(&files.out), files.displacement.as_ref()].into_iter().flatten() {
        named(path, &["tif", "tiff"], "elevation models are written as GeoTIFF")?;
    }
    if let Some(path) = &files.features {
        named(path, &["geojson", "json", "gpkg"], "moved features are written as GeoJSON and GeoPackage")?;
        MovedFeatures::check_name(path)?;
    }
    let inputs: Vec<PathBuf> = args.features.iter().chain(&args.rivers).chain([&args.dem]).cloned().collect();
    anyhow::ensure!(!is_stdout(&files.out), "-o -: an elevation model is written to a file; name one");
    outputs::check(&files.all(), &inputs, context)?;
    for path in args.features.iter_mut().chain(&mut args.rivers).chain([&mut args.dem]) {
        *path = context.stdin.data(path)?;
    }
    let mode = args.mode.map(|mode| format!("mode=\"{mode}\""));
    let limits = args.no_limits.then(|| "limits=false".to_owned());
    let set: Vec<String> = args.set.into_iter().chain(mode).chain(limits).collect();
    let request = DisoccludeRequest {
        data: DataFiles {
            dem: as_text(&args.dem),
            features: args.features.iter().map(|path| as_text(path)).collect(),
            rivers: args.rivers.iter().map(|path| as_text(path)).collect(),
            crs: args.crs,
            area_style: args.area_style,
            source_crs: args.ground.raster.source_crs,
            nodata: args.ground.raster.nodata,
            vertical_unit: args.ground.raster.vertical_unit,
            name_field: args.ground.name_field,
            ..DataFiles::default()
        },
        fill_voids: args.fill_voids,
        places: Some([args.eye, args.look]),
        fov_x_deg: args.fov,
        parameters: disocclude::parameters(&set)?,
        curved_earth: args.curved_earth,
        grid: if args.grid == "scene" { WrittenGrid::Scene } else { WrittenGrid::Input },
        ..DisoccludeRequest::default()
    };
    let found = disocclude::disocclude(&request, &context.options(Needs::Everything, None))?;
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

fn animate_scene(args: AnimateArgs, context: &Context) -> anyhow::Result<Goal> {
    let (folder, film) = animate::outputs(&args.out)?;
    outputs::check_folder(&folder, context)?;
    if let (Some(film), None) = (&film, &args.part) {
        let replaces = context.common.overwrite || args.resume;
        output::check(film, std::slice::from_ref(&args.scene), replaces)?;
    }
    let picture = request(&args.draw, context);
    let animation = AnimationDoc {
        along: args.along,
        sweep: args.sweep.map(|phi_deg| SweepDoc { phi_deg }),
        turntable: args.turntable.then_some(TurntableDoc { deg_per_s: 0.0 }),
        frames: args.frames,
        fps: args.fps,
        speed_mps: args.speed,
        marker: args.marker.then_some(true),
        clock: args.clock.then_some(true),
        profile: args.profile.then_some(true),
        ..AnimationDoc::default()
    };
    let (resume, overwrite) = (args.resume, context.common.overwrite);
    let request = AnimateRequest { animation, picture, out: args.out, resume, overwrite, part: args.part };
    // The ground is solved for every frame, not on opening.
    let options = OpenOptions { unsolved: true, ..context.options(Needs::Everything, args.draw.size) };
    let session = context.open_drawable(&args.scene, &args.data, &options)?;
    let made = animate::animate(&session, &request, &context.progress)?;
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

fn measure_scene(args: &MeasureArgs, context: &Context) -> anyhow::Result<Goal> {
    ready(args.out.as_ref(), &[&args.scene], context)?;
    let session = context.open(&args.scene, Needs::Everything, None)?;
    let report =
        measure::measure(&session, &measure::MeasureOptions::default(), args.renderer.into(), &context.progress)?;
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
        MovedFeatures::check_name(out)?;
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

fn check_scene(args: &SceneArgs, context: &Context) -> anyhow::Result<Goal> {
    ready(None, &[&args.scene], context)?;
    let options = OpenOptions { unsolved: true, undrawn: true, ..context.options(Needs::Everything, None) };
    let session = context.open_with(&args.scene, &options)?;
    let report = check::check(&session)?;
    if context.common.json {
        context.print("check", &[], &report)?;
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
