//! `reveal`: what the arguments ask for, and the files and lines of the answer.

use crate::args::RevealArgs;
use crate::goal::Goal;
use crate::inputs::as_text;
use crate::kinds::TechniqueKind;
use crate::outputs::{self, png_named};
use crate::report::{Context, is_stdout};
use belvedere::picture::{self, Picture, PictureOptions};
use belvedere::places::Place;
use belvedere::print::Sheet;
use belvedere::scene_file::{LightDoc, PaletteDoc};
use belvedere::verbs::hold_a_city;
use belvedere::verbs::reveal::{self, IMAGE, RevealFiles, RevealRequest};
use belvedere::verbs::reveal_target::{TargetRequest, reveal_target};
use belvedere::{DataFiles, Needs, OpenOptions, Session};
use std::path::{Path, PathBuf};

/// Draws a picture in which features, a target in models, or one in a city is visible.
pub(crate) fn reveal(mut args: RevealArgs, context: &Context) -> anyhow::Result<Goal> {
    for name in [&mut args.dem].into_iter().chain(&mut args.features) {
        *name = as_text(&context.stdin.data(Path::new(name.as_str()))?);
    }
    for path in &mut args.rivers {
        *path = context.stdin.data(path)?;
    }
    anyhow::ensure!(
        args.scene.is_none() || !context.stdin.was_read(),
        "--scene: a scene file names its data, and standard input has no name; give a file instead of -"
    );
    let files: Vec<PathBuf> = [&args.dem].into_iter().chain(&args.features).map(PathBuf::from).collect();
    let models = args.see.is_some() || hold_a_city(&files);
    if models {
        crate::for_models::check(&args)?;
    }
    let to_file = if is_stdout(&args.out) { PathBuf::new() } else { args.out.clone() };
    let out = RevealFiles {
        out: to_file,
        before: args.before.clone(),
        report: args.report.clone(),
        scene: args.scene.clone(),
    };
    ready(&args, &out, context)?;
    let places = places(&args)?;
    match models {
        true => reveal_target_in(args, (files, places), &out, context),
        false => reveal_features(args, places, &out, context),
    }
}

fn technique(args: &RevealArgs) -> TechniqueKind {
    args.technique.unwrap_or(TechniqueKind::Spline)
}

/// Refuses bad outputs and contradictory options before the work starts.
fn ready(args: &RevealArgs, out: &RevealFiles, context: &Context) -> anyhow::Result<()> {
    let inputs = args.features.iter().chain([&args.dem]).map(PathBuf::from);
    let named = [&args.see, &args.palette, &args.transfer].into_iter().flatten().map(PathBuf::from);
    let inputs = inputs.chain(args.rivers.iter().chain(&args.drape).cloned()).chain(named);
    let inputs: Vec<PathBuf> = inputs.collect();
    match args.drafts {
        Some(_) => {
            png_named(&args.out)?;
            let print = &args.print;
            anyhow::ensure!(
                print.paper.is_none() && print.dpi.is_none() && print.margin_mm.is_none() && !print.vectors_only,
                "--drafts draws small pictures; leave out --paper, --dpi, --margin-mm and --vectors-only"
            );
        }
        None => args.print.check_name(&args.out)?,
    }
    out.before.as_deref().map_or(Ok(()), png_named)?;
    let moves_ground = !matches!(technique(args), TechniqueKind::Spline | TechniqueKind::CurvedRays);
    anyhow::ensure!(
        args.rivers.is_empty() || moves_ground,
        "--rivers needs --technique terrain, both or auto: rivers are kept from running uphill where the ground moves"
    );
    let to_stdout = is_stdout(&args.out);
    let delta = (moves_ground && args.see.is_none() && !to_stdout).then(|| picture::delta_path(&args.out));
    if to_stdout {
        outputs::check_stdout(context)?;
        anyhow::ensure!(args.drafts.is_none(), "-o -: --drafts prints commands on standard output; name a file");
    }
    outputs::check(&out.all().into_iter().chain(delta).collect::<Vec<_>>(), &inputs, context)
}

/// Paper of the picture.
fn sheet(args: &RevealArgs) -> anyhow::Result<Option<Sheet>> {
    let shape = args.size.or_else(|| size_of_scene(Path::new(&args.dem))).unwrap_or(IMAGE);
    let sheet = args.print.sheet(None, args.size, shape)?;
    let size = sheet.map(|sheet| sheet.pixels()).unwrap_or(shape);
    let transparent = args.look_args.air.sky.as_deref() == Some(LightDoc::TRANSPARENT);
    picture::check_format(&args.out, size.map(|side| side as usize), transparent)?;
    Ok(sheet)
}

/// Size of the picture of a scene file; `None` for other data.
fn size_of_scene(data: &Path) -> Option<[u32; 2]> {
    let is_scene = data.extension().is_some_and(|ending| ending.eq_ignore_ascii_case("toml"));
    let text = is_scene.then(|| std::fs::read_to_string(data).ok())??;
    belvedere::scene_file::parse(data, &text).ok().map(|source| source.document.camera.image)
}

fn places(args: &RevealArgs) -> anyhow::Result<Option<[Place; 2]>> {
    match (args.eye, args.look) {
        (None, None) => Ok(None),
        (Some(eye), Some(look)) => Ok(Some([eye, look])),
        (Some(_), None) => anyhow::bail!("--eye is given without --look; give both, or neither"),
        (None, Some(_)) => anyhow::bail!("--look is given without --eye; give both, or neither"),
    }
}

fn quality(picture: &mut PictureOptions, context: &Context) {
    picture.quality.threads = context.common.threads;
    picture.quality.max_bytes = belvedere::io::budget::bytes();
}

/// Finds what one target in models or in a city needs to be visible, and writes the files that were asked for.
fn reveal_target_in(
    args: RevealArgs,
    (files, places): (Vec<PathBuf>, Option<[Place; 2]>),
    out: &RevealFiles,
    context: &Context,
) -> anyhow::Result<Goal> {
    let picture = args.out.clone();
    if !matches!(args.technique, None | Some(TechniqueKind::Auto | TechniqueKind::CurvedRays | TechniqueKind::Spline)) {
        anyhow::bail!(
            "--see bends rays, or in a city the ground by a spline; give --technique curved_rays or spline, or leave it out"
        );
    }
    let (print, sheet) = (args.print.clone(), sheet(&args)?);
    let molecule = args.look_args.molecules.options();
    let options = OpenOptions { molecule, ..context.options(Needs::Everything, None) };
    let options = args.look_args.air.apply(options);
    let see = args.see.unwrap_or_default();
    let mut request = TargetRequest {
        files,
        see,
        fallback: args.fallback,
        transfer: args.transfer,
        places,
        appearance: args.look_args.appearance(),
        fov_y_deg: args.fov,
        up: args.up.map(belvedere::core::DVec3::from_array),
        image: sheet.map(|sheet| sheet.pixels()).or(args.size),
        technique: args.technique.filter(|kind| *kind != TechniqueKind::Auto).map(Into::into),
        ..TargetRequest::default()
    };
    request.picture = print.apply(request.picture, &picture, sheet);
    quality(&mut request.picture, context);
    if let Some(count) = args.drafts {
        return crate::drafts::of_target((&request, &options), count, &out.out, context);
    }
    let answer = reveal_target(&request, &options)?;
    let written = answer.write(out, context.common.overwrite)?;
    delivered((&answer.picture, &answer.session), &picture, out, context)?;
    if context.common.json {
        context.print("reveal", &written, &answer.document())?;
    } else if !context.common.quiet {
        context.finish();
        context.say(&format!("{}\n", answer.summary()), &picture)?;
    }
    context.warn(&answer.warnings());
    context.warn(&answer.missed());
    Ok(if answer.missed().is_empty() { Goal::Reached } else { Goal::Missed })
}

/// Finds a view and a bend that show features on terrain, and writes the files that were asked for.
fn reveal_features(
    args: RevealArgs,
    places: Option<[Place; 2]>,
    out: &RevealFiles,
    context: &Context,
) -> anyhow::Result<Goal> {
    let (picture, technique) = (args.out.clone(), technique(&args));
    let (print, sheet) = (args.print.clone(), sheet(&args)?);
    let molecule = args.look_args.molecules.options();
    let options = OpenOptions { molecule, ..context.options(Needs::Everything, None) };
    let options = args.look_args.air.apply(options);
    let mut request = RevealRequest {
        data: DataFiles {
            dem: args.dem,
            features: args.features,
            rivers: args.rivers.iter().map(|path| as_text(path)).collect(),
            crs: args.crs,
            keep_voids: args.keep_voids,
            fill_all_voids: args.look_args.fill_voids,
            hidden: args.look_args.hidden.map(Into::into),
            drape: args.drape.iter().map(|path| as_text(path)).collect(),
            labels: args.labels,
            palette: PaletteDoc::of(args.palette.as_deref().unwrap_or("auto")),
            no_sea: args.no_sea,
            area_style: args.area_style,
            source_crs: args.ground.source_crs,
            nodata: args.ground.nodata,
            vertical_unit: args.ground.vertical_unit.map(Into::into),
            name_field: args.ground.name_field,
        },
        places,
        appearance: args.look_args.appearance(),
        fov_y_deg: args.fov,
        image: sheet.map(|sheet| sheet.pixels()).or(args.size),
        curved_earth: args.curved_earth,
        technique: technique.into(),
        no_limits: args.no_limits,
        to_file: (!is_stdout(&args.out)).then(|| args.out.clone()),
        ..RevealRequest::default()
    };
    request.picture = print.apply(request.picture, &picture, sheet);
    quality(&mut request.picture, context);
    if let Some(count) = args.drafts {
        return crate::drafts::drafts((&request, &options), count, &out.out, context);
    }
    let answer = reveal::reveal(&request, &options)?;
    let written = answer.write(out, context.common.overwrite)?;
    delivered((&answer.picture, &answer.session), &picture, out, context)?;
    if context.common.json {
        context.print("reveal", &written, &answer.document())?;
    } else if !context.common.quiet {
        context.finish();
        context.say(&format!("{}\n", answer.summary()), &picture)?;
    }
    context.warn(&answer.session.warnings());
    context.warn(&answer.picture.sidecar.of_picture);
    context.warn(answer.missed());
    Ok(if answer.missed().is_empty() { Goal::Reached } else { Goal::Missed })
}

/// After the files of a revealed picture: the picture on standard output if it goes there, its times, and consent for the scene.
fn delivered(
    (picture, session): (&Picture, &Session),
    out: &Path,
    files: &RevealFiles,
    context: &Context,
) -> anyhow::Result<()> {
    context.timings.note_picture(picture.record());
    if let Some(scene) = &files.scene {
        context.remember(scene, session);
    }
    if is_stdout(out) {
        let mut alone = picture.clone();
        alone.straight = None;
        outputs::write_stdout(&alone.to_png()?)?;
    }
    Ok(())
}
