//! Arguments.

use crate::animate::AnimateArgs;
use crate::bench_args::BenchArgs;
use crate::city::GeneraliseArgs;
use crate::common_args::Common;
use crate::disocclude::DisoccludeArgs;
use crate::export::ExportArgs;
use crate::info_args::InfoArgs;
use crate::pack::PackArgs;
use crate::parse::{parse_drafts, parse_scale};
use crate::point_args::{DisplaceArgs, PICK_HELP, PickArgs, ProjectArgs, RaysArgs};
use crate::preset::PresetArgs;
use crate::render::RenderArgs;
use crate::shell_args::{CompletionsArgs, ManArgs};
use crate::trust::TrustArgs;
use belvedere::request::parse::size;
use belvedere::request::{Measure, OfData, Reveal};
use clap::{Args, Parser, Subcommand, ValueEnum};
use std::path::PathBuf;

/// Pictures in which what matters is not hidden: bent projections of terrain and routes
#[derive(Debug, Parser)]
#[command(name = "belvedere", version, max_term_width = 120)]
pub(crate) struct Cli {
    #[command(flatten)]
    pub(crate) common: Common,
    #[command(subcommand)]
    pub(crate) verb: Verb,
}

impl Verb {
    /// Its name on the command line.
    pub(crate) fn name(&self) -> &'static str {
        match self {
            Self::Demo(_) => "demo",
            Self::Reveal(_) => "reveal",
            Self::Disocclude(_) => "disocclude",
            Self::Generalise(_) => "generalise",
            Self::Preset(_) => "preset",
            Self::Render(_) => "render",
            Self::Animate(_) => "animate",
            Self::Export(_) => "export",
            Self::Project(_) => "project",
            Self::Rays(_) => "rays",
            Self::Displace(_) => "displace",
            Self::Pick(_) => "pick",
            Self::Measure(_) => "measure",
            Self::Check(_) => "check",
            Self::Info(_) => "info",
            Self::Show(_) => "show",
            Self::Schema(_) => "schema",
            Self::Bench(_) => "bench",
            Self::Figures(_) => "figures",
            Self::View(_) => "view",
            Self::Pack(_) => "pack",
            Self::Trust(_) => "trust",
            Self::Completions(_) => "completions",
            Self::Man(_) => "man",
        }
    }

    /// Whether it makes many pictures, each of which may take as long as the limit of time says.
    pub(crate) fn makes_many_pictures(&self) -> bool {
        matches!(self, Self::Animate(_) | Self::Bench(_) | Self::Demo(_) | Self::Figures(_) | Self::View(_))
    }
}

/// What to do.
#[derive(Debug, Subcommand)]
pub(crate) enum Verb {
    /// Draw the built-in scenes, straight and bent side by side, with an index.html; needs no files
    Demo(DemoArgs),
    /// Draw terrain and routes so that the routes are visible; or, with --see, a part of a model
    Reveal(Box<RevealArgs>),
    /// Write an elevation model on which the features are visible from an eye
    Disocclude(Box<DisoccludeArgs>),
    /// Merge buildings into blocks between streets: two levels of abstraction, a map, plan drawings
    Generalise(GeneraliseArgs),
    /// List, make, change, check and plot presets of spline bends
    Preset(PresetArgs),
    /// Draw a scene, or data as they are: one picture and its record
    Render(Box<RenderArgs>),
    /// Draw a film or numbered frames: along a route, through viewing angles, or once around
    Animate(Box<AnimateArgs>),
    /// Write the displaced scene and its camera as a GLB file, for Blender and other programs
    Export(ExportArgs),
    /// Give the pixel and depth of points: [[x,y,z],...] in scene coordinates
    Project(ProjectArgs),
    /// Sample the curved rays of pixels: [[x,y],...]
    Rays(RaysArgs),
    /// Give points, or the lines, areas and points of the scene, as the stages displace them, before the pinhole
    Displace(DisplaceArgs),
    /// Tell what pixels [[x,y],...] show: world point, depth, ray segment, layer, feature; null for sky
    #[command(after_help = PICK_HELP)]
    Pick(PickArgs),
    /// Measure the visible share of required features, straight and bent, by two methods
    Measure(MeasureArgs),
    /// Validate a scene
    Check(CheckArgs),
    /// Describe data: size, system, range, voids, features
    Info(InfoArgs),
    /// Print a scene with every default filled in and every rule replaced by its value
    Show(ShowArgs),
    /// Print the JSON Schema of scene files, or of the answers of a verb
    Schema(SchemaArgs),
    /// Measure what bends, anti-aliasing and level of detail cost on this machine
    Bench(BenchArgs),
    /// Draw the figures and tables of the papers on open data, with an index.html; needs no files
    Figures(FiguresArgs),
    /// Open the application with a scene, data or the built-in scenes
    View(ViewArgs),
    /// Write the application with a scene, data or the built-in scenes as a web page: a folder for any web server
    Pack(PackArgs),
    /// Let a scene read the files outside its folder that it names, from now on; list and forget such scenes
    Trust(TrustArgs),
    /// Print what a shell needs to complete the command line
    Completions(CompletionsArgs),
    /// Write manual pages: one for the program and one for each verb
    Man(ManArgs),
}

/// The application.
#[derive(Debug, Args)]
pub(crate) struct ViewArgs {
    /// A scene file, models, or an elevation model, alone or with routes, areas or points
    pub(crate) files: Vec<PathBuf>,
}

/// The figures.
#[derive(Debug, Args)]
pub(crate) struct FiguresArgs {
    /// Which figures, separated by commas: terrain, curved, spline, compare, algorithms, guide
    #[arg(value_parser = parse_figures)]
    pub(crate) what: FigureKinds,
    /// Scene files with a camera and features that must be seen, in place of the built-in areas (and of the two real ranges
    /// that are drawn where BELVEDERE_DATA names the folder of their files)
    pub(crate) scenes: Vec<PathBuf>,
    /// Folder for the pictures
    #[arg(short, long, value_name = "DIR", default_value = "belvedere-figures")]
    pub(crate) out: PathBuf,
    /// Factor of the width and height of the pictures of curved, spline and compare, in 0.1..=1: smaller drafts are drawn sooner
    #[arg(long, default_value = "1", allow_negative_numbers = true, value_parser = parse_scale)]
    pub(crate) scale: f64,
}

/// Figures of one paper.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub(crate) enum FigureKind {
    /// Terrain disocclusion: Deng et al. 2013
    Terrain,
    /// Curved ray camera: Cui et al. 2010
    Curved,
    /// Multi-perspective views: Pasewaldt et al. 2011
    Spline,
    /// One hidden target by transparency, cutaway, explosion and bent rays
    Compare,
    /// Charts of docs/algorithms
    Algorithms,
    /// Pictures of docs/guide
    Guide,
}

/// Figures of one paper or several.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) struct FigureKinds(pub(crate) Vec<FigureKind>);

fn parse_figures(text: &str) -> Result<FigureKinds, String> {
    let kind = |name: &str| {
        FigureKind::from_str(name.trim(), false).map_err(|_| {
            format!("\"{name}\" is unknown; possible: terrain, curved, spline, compare, algorithms, guide")
        })
    };
    Ok(FigureKinds(text.split(',').map(kind).collect::<Result<_, _>>()?))
}

/// The check of a scene.
#[derive(Debug, Args)]
pub(crate) struct CheckArgs {
    /// Scene file, TOML or JSON; - = standard input
    pub(crate) scene: PathBuf,

    /// Write the scene with valid curved rays in place of those that are not: the nearest valid values are set
    #[arg(long, value_name = "OUT.toml")]
    pub(crate) mend: Option<PathBuf>,
}

/// The demo.
#[derive(Debug, Args)]
pub(crate) struct DemoArgs {
    /// Folder for the pictures
    #[arg(short, long, value_name = "DIR", default_value = "belvedere-demo")]
    pub(crate) out: PathBuf,
    /// Size of each picture instead of the scenes' own
    #[arg(long, value_name = "WxH", allow_hyphen_values = true, value_parser = size)]
    pub(crate) size: Option<[u32; 2]>,
}

/// What must be seen, and the files of the answer.
#[derive(Debug, Args)]
pub(crate) struct RevealArgs {
    /// Picture to write: PNG, TIFF, JPEG, WebP, SVG or PDF, as its name ends; its record goes to OUT.png.json, and if it is bent, the straight beside the bent picture to OUT.pair.png (not of SVG and PDF, nor with a transparent sky); - =
    /// standard output, and the picture alone
    #[arg(short, long, value_name = "OUT.png")]
    pub(crate) out: PathBuf,
    #[command(flatten)]
    pub(crate) asked: Reveal,
    /// Leave the raster of the surfaces out of an SVG or PDF
    #[arg(long)]
    pub(crate) vectors_only: bool,
    /// Write a sheet of up to N pictures from different sides to OUT.png instead of one, with the shares of each and the command that
    /// makes it
    #[arg(long, value_name = "N", conflicts_with_all = ["eye", "look"], allow_negative_numbers = true, value_parser = parse_drafts)]
    pub(crate) drafts: Option<usize>,
    /// Write the straight picture to this file
    #[arg(long, value_name = "OUT.png")]
    pub(crate) before: Option<PathBuf>,
    /// Write the figures to this file
    #[arg(long, value_name = "OUT.json")]
    pub(crate) report: Option<PathBuf>,
    /// Write a scene file that draws the same picture
    #[arg(long, value_name = "OUT.toml")]
    pub(crate) scene: Option<PathBuf>,
}

/// A scene to measure.
#[derive(Debug, Args)]
pub(crate) struct MeasureArgs {
    /// Scene file, TOML or JSON; - = standard input
    pub(crate) scene: PathBuf,
    /// Output; standard output if left out
    #[arg(short, long, value_name = "OUT.json")]
    pub(crate) out: Option<PathBuf>,
    #[command(flatten)]
    pub(crate) asked: Measure,
}

/// A scene to show.
#[derive(Debug, Args)]
pub(crate) struct ShowArgs {
    /// Scene file, TOML or JSON, or data as `render` takes them; - = standard input
    pub(crate) scene: PathBuf,
    /// Output (TOML, or JSON if named so); standard output if left out
    #[arg(short, long, value_name = "OUT")]
    pub(crate) out: Option<PathBuf>,
    #[command(flatten, next_help_heading = "Data without a scene file")]
    pub(crate) data: OfData,
}

/// The schema.
#[derive(Debug, Args)]
pub(crate) struct SchemaArgs {
    /// Document: scene (a scene file), keys (its keys as a page in Markdown), or a verb, for what it prints with --json
    #[arg(value_name = "VERB", default_value = "scene", value_parser = crate::schemas::names())]
    pub(crate) of: String,
    /// The schema of what the verb is asked, its options as JSON, instead of that of its answers: animate, disocclude, export, generalise,
    /// measure, render, reveal
    #[arg(long)]
    pub(crate) request: bool,
    /// Output; standard output if left out
    #[arg(short, long, value_name = "OUT.json")]
    pub(crate) out: Option<PathBuf>,
}
