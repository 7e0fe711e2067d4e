//! `reveal`: its request, and the files and lines of the answer.

use crate::args::RevealArgs;
use crate::goal::Goal;
use crate::inputs::as_text;
use crate::outputs::{self, png_named};
use crate::picture_names;
use crate::report::{Context, is_stdout};
use belvedere::picture::{self, PictureOptions};
use belvedere::scene_file::LightDoc;
use belvedere::verbs::reveal::{self, RevealAnswer, RevealFiles, Setting, Technique};
use belvedere::{Needs, request::Reveal};
use std::path::{Path, PathBuf};

/// Draws a picture in which features, a target in models, or one in a city is visible.
pub(crate) fn reveal(mut args: RevealArgs, context: &Context) -> anyhow::Result<Goal> {
    let request = &mut args.asked;
    for name in [&mut request.data].into_iter().chain(&mut request.features).chain(&mut request.rivers) {
        *name = as_text(&context.stdin.data(Path::new(name.as_str()))?);
    }
    anyhow::ensure!(
        args.scene.is_none() || !context.stdin.was_read(),
        "--scene: a scene file names its data, and standard input has no name; give a file instead of -"
    );
    let files = RevealFiles {
        out: if is_stdout(&args.out) { PathBuf::new() } else { args.out.clone() },
        before: args.before.clone(),
        report: args.report.clone(),
        scene: args.scene.clone(),
    };
    ready(&args, &files, context)?;
    let (sheet, size) = reveal::sheet(&args.asked)?;
    let transparent = args.asked.appearance.air.sky.as_deref() == Some(LightDoc::TRANSPARENT);
    picture::check_format(&args.out, size.map(|side| side as usize), transparent)?;
    let vectors = picture_names::vectors(&args.out, args.vectors_only);
    let picture = context.running(PictureOptions { vectors, ..Default::default() });
    let setting = Setting {
        open: context.options(Needs::Everything, None),
        picture,
        to_file: (!is_stdout(&args.out)).then(|| args.out.clone()),
    };
    if let Some(count) = args.drafts {
        anyhow::ensure!(
            sheet.is_none() && args.asked.paper == Default::default() && !args.vectors_only,
            "--drafts draws small pictures; leave out --paper, --dpi, --margin-mm and --vectors-only"
        );
        return crate::drafts::sheet(&reveal::drafts(&args.asked, count, &setting)?, &files.out, context);
    }
    deliver(&reveal::reveal(&args.asked, &setting)?, &args.out, &files, context)
}

/// Refuses bad outputs before the work starts.
fn ready(args: &RevealArgs, files: &RevealFiles, context: &Context) -> anyhow::Result<()> {
    match args.drafts {
        Some(_) => png_named(&args.out)?,
        None => picture_names::check_name(&args.out, args.vectors_only)?,
    }
    files.before.as_deref().map_or(Ok(()), png_named)?;
    let to_stdout = is_stdout(&args.out);
    let technique = args.asked.technique.unwrap_or_default();
    let moves_ground = !matches!(technique, Technique::Spline | Technique::CurvedRays) && args.asked.see.is_none();
    let delta = (moves_ground && !to_stdout).then(|| picture::delta_path(&args.out));
    if to_stdout {
        outputs::check_stdout(context)?;
        anyhow::ensure!(args.drafts.is_none(), "-o -: --drafts prints commands on standard output; name a file");
    }
    let outputs: Vec<PathBuf> = files.all().into_iter().chain(delta).collect();
    outputs::check(&outputs, &inputs(&args.asked), context)
}

/// Everything that may be a file to read.
fn inputs(asked: &Reveal) -> Vec<PathBuf> {
    let lists = [&asked.features, &asked.rivers, &asked.drape].into_iter().flatten();
    let named = [&asked.see, &asked.palette, &asked.transfer].into_iter().flatten();
    lists.chain([&asked.data]).chain(named).map(PathBuf::from).collect()
}

/// Writes the files and says what was found.
fn deliver(answer: &RevealAnswer, out: &Path, files: &RevealFiles, context: &Context) -> anyhow::Result<Goal> {
    let written = answer.write(files, context.common.overwrite)?;
    context.timings.note_picture(answer.picture.record());
    if let Some(scene) = &files.scene {
        context.remember(scene, &answer.session);
    }
    if is_stdout(out) {
        let mut alone = answer.picture.clone();
        alone.straight = None;
        outputs::write_stdout(&alone.to_png()?)?;
    }
    if context.common.json {
        context.print("reveal", &written, &answer.document())?;
    } else if !context.common.quiet {
        context.finish();
        context.say(&format!("{}\n", answer.summary()), out)?;
    }
    context.warn(&answer.warnings());
    context.warn(&answer.missed());
    Ok(if answer.missed().is_empty() { Goal::Reached } else { Goal::Missed })
}
