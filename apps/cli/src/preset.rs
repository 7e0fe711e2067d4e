//! `preset`: its arguments, and what it says.

use crate::goal::Goal;
use crate::outputs;
use crate::report::{Context, is_stdout, print};
use belvedere::answers::Written;
use belvedere::core::presets::PresetDocument;
use belvedere::core::presets::edit::{PresetChange, PresetOperation};
use belvedere::io::png;
use belvedere::verbs::preset::{self, Shape, Verdict};
use belvedere::verbs::schemas::Presets;
use belvedere::{Needs, Session, Warning, output};
use clap::{Args, Subcommand};
use std::fmt::Write;
use std::path::{Path, PathBuf};

/// What is done with presets.
#[derive(Debug, Args)]
pub(crate) struct PresetArgs {
    #[command(subcommand)]
    pub(crate) work: PresetWork,
}

/// One kind of work on presets.
#[derive(Debug, Subcommand)]
pub(crate) enum PresetWork {
    /// List the built-in documents: names, effects, angles
    List,
    /// Print a document as TOML or JSON
    Show {
        /// Built-in name or file
        preset: String,
        /// File to write; standard output if left out
        #[arg(short, long, value_name = "FILE")]
        out: Option<PathBuf>,
    },
    /// Make a document of your own from a built-in one
    New {
        /// File to write, .toml or .json
        #[arg(short, long, value_name = "FILE")]
        out: PathBuf,
        /// Built-in name or file to start from
        #[arg(long, default_value = "demo", value_name = "PRESET")]
        from: String,
    },
    /// Change a document: PRESET.KEY[.N]=VALUE, all or nothing
    #[command(after_help = SET_HELP)]
    Set {
        /// File of the document
        file: PathBuf,
        /// Operations, in this order
        #[arg(value_name = "OPERATION")]
        operations: Vec<PresetOperation>,
        /// Fit a preset to the viewing angle of a scene's camera
        #[arg(long, value_name = "PRESET=SCENE")]
        capture: Vec<String>,
        /// File to write instead
        #[arg(short, long, value_name = "FILE")]
        out: Option<PathBuf>,
    },
    /// Check a document: valid or not, the viewing angles at which it is usable, facing, sections
    Check {
        /// Built-in name or file
        preset: String,
    },
    /// Draw the curves with eye, wedge of view and tag points
    Plot {
        /// Built-in name or file
        preset: String,
        /// PNG
        #[arg(short, long, value_name = "OUT.png")]
        out: PathBuf,
        /// Draw the preset that is interpolated for this viewing angle, degrees
        #[arg(long, value_name = "DEG", allow_hyphen_values = true, value_parser = belvedere::request::parse::number)]
        phi: Option<f64>,
    },
}

const SET_HELP: &str = "Presets by name, or by position from 1; points, tags and sections by position from 1.
  PRESET.point.N=U,V      drags a control point          PRESET.phi=DEG     viewing angle
  PRESET.add-point=T      one more, same curve           PRESET.tau=DEG     half width of its range
  PRESET.remove-point=N   one less                       PRESET.range=S,E   depths of u = 0 and u = 1
  PRESET.corner=N         doubles a point, or undoes it  PRESET.fade=A,B    where representations fade
  PRESET.soften=SHARE     spreads doubled points         PRESET.fov=DEG     field of view, or none
  PRESET.angles=COUNT     the curve as angles of view    PRESET.angle.N=DEG one of them
  PRESET.tag.N=T or U,V   moves a border                 PRESET.mirror      near and far change places
  PRESET.width.N=DELTA    half width of its transition   PRESET.name=NAME
  PRESET.section.N=ID     representation of a section    PRESET.duplicate=NAME,DEG
  PRESET.split=N  PRESET.merge=N                         PRESET.remove
  add=BUILT-IN,NAME,DEG  frame=camera|plane  units=absolute|distance  ease=linear|smoothstep  pin=true|false  follow=true|false";

pub(crate) fn preset(args: PresetArgs, context: &Context) -> anyhow::Result<Goal> {
    match args.work {
        PresetWork::List => list(context),
        PresetWork::Show { preset, out } => {
            out.as_deref().map_or(Ok(()), document_named)?;
            let file = outputs::file(out.as_ref()).cloned();
            outputs::check(file.as_slice(), &[], context)?;
            // Only the ending of the name counts.
            let printed = PathBuf::from(if context.common.json { "-.json" } else { "-.toml" });
            let text = preset::text(&preset::load(&preset)?, &file.unwrap_or(printed))?;
            context.deliver("preset", out.as_deref(), &text, &[])?;
            Ok(Goal::Reached)
        }
        PresetWork::New { out, from } => {
            document_named(&out)?;
            let file = outputs::file(Some(&out)).cloned();
            outputs::check(file.as_slice(), &[], context)?;
            let text = preset::text(&preset::load(&from)?, &file.unwrap_or_default())?;
            context.deliver("preset", Some(&out), &text, &[])?;
            Ok(Goal::Reached)
        }
        PresetWork::Set { file, operations, capture, out } => set(&file, operations, &capture, out, context),
        PresetWork::Check { preset } => check(&preset, context),
        PresetWork::Plot { preset, out, phi } => {
            let document = preset::load(&preset)?;
            outputs::png_named(&out)?;
            let file = outputs::file(Some(&out));
            file.map_or_else(|| outputs::check_stdout(context), |_| Ok(()))?;
            outputs::check(&file.cloned().into_iter().collect::<Vec<_>>(), &[], context)?;
            let plot = preset::plot(&document, phi);
            let height = plot.pixels.len() / plot.width;
            let pixels = plot.pixels.as_flattened();
            if file.is_none() {
                let mut bytes = Vec::new();
                png::encode(&mut bytes, plot.width, height, png::Channels::Rgb, pixels, &[])?;
                outputs::write_stdout(&bytes)?;
                return Ok(Goal::Reached);
            }
            png::write(&out, context.common.overwrite, plot.width, height, png::Channels::Rgb, pixels, &[])?;
            written(&[out], &[], context)
        }
    }
}

/// Refuses names with the ending of another format than those of documents.
fn document_named(path: &Path) -> anyhow::Result<()> {
    outputs::named(path, &["toml", "json"], "presets are written as TOML or JSON")
}

fn written(files: &[PathBuf], warnings: &[Warning], context: &Context) -> anyhow::Result<Goal> {
    if context.common.json {
        context.print("preset", files, &Written { warnings: warnings.to_vec() })?;
    }
    context.warn(warnings);
    Ok(Goal::Reached)
}

fn list(context: &Context) -> anyhow::Result<Goal> {
    let listed = preset::list()?;
    if context.common.json {
        context.print("preset", &[], &Presets { presets: listed })?;
        return Ok(Goal::Reached);
    }
    let mut text = String::new();
    for l in listed {
        let also = if l.aliases.is_empty() { String::new() } else { format!(" (also {})", l.aliases.join(", ")) };
        writeln!(text, "{}{also}: {}", l.name, l.effect)?;
        for shape in &l.presets {
            writeln!(text, "  {}", line(shape))?;
        }
    }
    print(&text)?;
    Ok(Goal::Reached)
}

fn line(shape: &Shape) -> String {
    let [near, pivot, far] = shape.slopes_deg;
    format!(
        "{:12} phi {:>3.0}, slopes {near:.0} / {pivot:.0} / {far:.0}, length {:.3}, facing {:.3}",
        shape.name, shape.phi, shape.length, shape.facing
    )
}

fn check(source: &str, context: &Context) -> anyhow::Result<Goal> {
    let found = preset::check(&preset::load(source)?);
    if context.common.json {
        context.print("preset", &[], &found)?;
    } else {
        let lines = found.presets.iter().map(line).chain(found.still_words()).chain([found.words()]);
        print(&format!("{}\n", lines.collect::<Vec<_>>().join("\n")))?;
        context.warn(&found.warnings);
    }
    let good = found.verdict == Verdict::Valid && found.warnings.is_empty();
    Ok(if good { Goal::Reached } else { Goal::Missed })
}

fn set(
    file: &Path,
    mut operations: Vec<PresetOperation>,
    capture: &[String],
    out: Option<PathBuf>,
    context: &Context,
) -> anyhow::Result<Goal> {
    // What is changed in place is meant to be replaced.
    let replaces = out.is_none() || context.common.overwrite;
    let to = out.unwrap_or_else(|| file.to_owned());
    if !is_stdout(&to) {
        output::check(&to, &[], replaces)?;
    }
    outputs::check(&[], &[], context)?;
    for text in capture {
        let (preset, scene) =
            text.split_once('=').ok_or_else(|| anyhow::anyhow!("--capture {text}: write PRESET=SCENE.toml"))?;
        let session = Session::open(Path::new(scene), &context.options(Needs::View, None))?;
        let change =
            PresetChange::Phi(preset::viewing_angle(&session).map_err(|e| anyhow::anyhow!("--capture {text}: {e}"))?);
        operations.push(PresetOperation::Preset { preset: preset.to_owned(), change });
    }
    anyhow::ensure!(!operations.is_empty(), "nothing to do; give operations such as low.phi=25, or --capture");
    let source = file.to_string_lossy();
    anyhow::ensure!(
        file.exists(),
        "{source}: there is no such file; make one with belvedere preset new -o {source} --from demo"
    );
    let (document, clamped) = preset::set(&load_file(&source)?, &operations)?;
    document_named(&to)?;
    let text = preset::text(&document, outputs::file(Some(&to)).map_or(Path::new(""), PathBuf::as_path))?;
    if is_stdout(&to) {
        print(&text)?;
    } else {
        output::write_text(&to, &text, replaces)?;
    }
    let clamped = clamped.iter().map(Warning::from);
    let warnings: Vec<Warning> = clamped.chain(preset::check(&document).warnings).collect();
    if is_stdout(&to) {
        context.warn(&warnings);
        return Ok(Goal::Reached);
    }
    written(&[to], &warnings, context)
}

/// The document of a file, which may be called like a built-in one.
fn load_file(source: &str) -> anyhow::Result<PresetDocument> {
    let here = Path::new(".").join(source);
    Ok(preset::load(if Path::new(source).is_absolute() { source } else { here.to_str().unwrap_or(source) })?)
}
