//! Arguments.

use crate::bench_args::BenchArgs;
use crate::city::GeneraliseArgs;
use crate::common_args::Common;
use crate::draw_args::DrawArgs;
use crate::export::ExportArgs;
use crate::info_args::InfoArgs;
use crate::kinds::RendererKind;
use crate::pack::PackArgs;
use crate::parse::{
    Outside, parse_drafts, parse_highlight, parse_outside, parse_part, parse_position, parse_scale, parse_sweep,
};
use crate::point_args::{DisplaceArgs, PICK_HELP, PickArgs, ProjectArgs, RaysArgs};
use crate::preset::PresetArgs;
use crate::print_args::PrintArgs;
use crate::shell_args::{CompletionsArgs, ManArgs};
use crate::trust::TrustArgs;
use belvedere::RendererChoice;
use belvedere::places::Place;
use belvedere::request::parse::{number, size, spacing, with_height};
use belvedere::request::{Air, Molecules, OfData, Reveal, Stated, one_of};
use belvedere::scene_file::{HighlightMark, SurfaceDoc};
use belvedere::verbs::animate;
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
    Disocclude(DisoccludeArgs),
    /// Merge buildings into blocks between streets: two levels of abstraction, a map, plan drawings
    Generalise(GeneraliseArgs),
    /// List, make, change, check and plot presets of spline bends
    Preset(PresetArgs),
    /// Draw a scene, or data as they are: one picture and its record
    Render(RenderArgs),
    /// Draw a film or numbered frames: along a route, through viewing angles, or once around
    Animate(AnimateArgs),
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
    Check(SceneArgs),
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

/// A scene.
#[derive(Debug, Args)]
pub(crate) struct SceneArgs {
    /// Scene file, TOML or JSON; - = standard input
    pub(crate) scene: PathBuf,
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

/// Terrain, features and an eye.
#[derive(Debug, Args)]
pub(crate) struct DisoccludeArgs {
    /// Elevation model: GeoTIFF, .hgt, ESRI ASCII
    pub(crate) dem: PathBuf,
    /// Routes, areas or points: GPX, GeoJSON, shapefiles, GeoPackages where they are built in; - = standard input
    #[arg(required = true)]
    pub(crate) features: Vec<PathBuf>,
    /// Rivers that do not run uphill on the displaced ground: a file of lines, GPX, GeoJSON, shapefile; may be given several times
    #[arg(long, value_name = "FILE")]
    pub(crate) rivers: Vec<PathBuf>,
    /// Eye: x,y in the system of the elevation model, lon,lat in degrees, or 46.5N,11.3E; and height in metres over its datum, or +20
    /// for 20 m above the ground
    #[arg(long, value_name = "X,Y,Z", allow_hyphen_values = true, value_parser = with_height)]
    pub(crate) eye: Place,
    /// Point to look at, written as the eye, without a height
    #[arg(long, value_name = "X,Y", allow_hyphen_values = true, value_parser = parse_position)]
    pub(crate) look: Place,
    /// Full horizontal field of view, degrees
    #[arg(long, value_name = "DEG", default_value = "70", allow_negative_numbers = true, value_parser = number)]
    pub(crate) fov: f64,
    /// Passes of the solver: paper as published; qp guarantees visibility by a quadratic program; paper+qp both
    #[arg(long, value_name = "MODE", value_parser = ["paper", "paper+qp", "qp"])]
    pub(crate) mode: Option<String>,
    /// Lift the limits of plausible ground: no lower than a fifth of the relief below the lowest point, no steeper than twice the 99.9th
    /// percentile of the terrain's slopes
    #[arg(long)]
    pub(crate) no_limits: bool,
    /// Any other key of a terrain_disocclusion stage, such as w=0.6; may be given several times
    #[arg(long, value_name = "KEY=VALUE")]
    pub(crate) set: Vec<String>,
    /// Displaced elevation model: cloud-optimised GeoTIFF, 32-bit floats in metres, on the grid and in the system of the input
    #[arg(short, long, value_name = "OUT.tif")]
    pub(crate) out: PathBuf,
    /// Grid of the written heights: the input's, or the scene's in metres, on which the ground is solved and the guarantee holds exactly
    #[arg(long, value_name = "GRID", value_parser = ["input", "scene"], default_value = "input")]
    pub(crate) grid: String,
    /// Write figures, parameters, and the parts that stay hidden with their reasons to this file
    #[arg(long, value_name = "OUT.json")]
    pub(crate) report: Option<PathBuf>,
    /// Write the displacement, on the same grid, to this file
    #[arg(long, value_name = "D.tif")]
    pub(crate) displacement: Option<PathBuf>,
    /// Write the features on the displaced ground, their true positions as properties, to this file: GeoJSON, or .gpkg
    #[arg(long, value_name = "OUT.geojson")]
    pub(crate) features_out: Option<PathBuf>,
    /// Draw the ground before and after from the eye, side by side, with its record
    #[arg(long, value_name = "OUT.png")]
    pub(crate) picture: Option<PathBuf>,
    /// Fill holes of the elevation model, also in the written heights, instead of leaving them open
    #[arg(long)]
    pub(crate) fill_voids: bool,
    /// Style of areas in the picture, instead of the one that their properties and names give
    #[arg(long, value_parser = one_of::<SurfaceDoc>(), value_name = "STYLE")]
    pub(crate) area_style: Option<SurfaceDoc>,
    /// Lower the ground with the distance, as on a sphere, with refraction
    #[arg(long)]
    pub(crate) curved_earth: bool,
    /// Coordinate system to solve in: auto, EPSG:n or local
    #[arg(long, value_name = "CRS")]
    pub(crate) crs: Option<String>,
    #[command(flatten)]
    pub(crate) ground: Stated,
}

/// A scene to measure.
#[derive(Debug, Args)]
pub(crate) struct MeasureArgs {
    /// Scene file, TOML or JSON; - = standard input
    pub(crate) scene: PathBuf,
    /// Output; standard output if left out
    #[arg(short, long, value_name = "OUT.json")]
    pub(crate) out: Option<PathBuf>,
    /// Renderer of the depth buffers
    #[arg(long, value_enum, default_value = "auto")]
    pub(crate) renderer: RendererKind,
}

impl From<RendererKind> for RendererChoice {
    fn from(kind: RendererKind) -> Self {
        match kind {
            RendererKind::Auto | RendererKind::Cpu => Self::Cpu,
            RendererKind::Exact => Self::Exact,
        }
    }
}

/// A picture.
#[derive(Debug, Args)]
pub(crate) struct RenderArgs {
    /// Scene file, TOML or JSON; or data of which all is shown from the south: an elevation model, a folder of its tiles, a city, a mesh, a
    /// molecule or a volume; - = standard input
    pub(crate) scene: PathBuf,
    /// Output: PNG, TIFF, JPEG, WebP, SVG or PDF, as its name ends, and OUT.png.json, its record; - = a PNG on standard output alone
    #[arg(short, long, value_name = "OUT.png")]
    pub(crate) out: PathBuf,
    #[command(flatten)]
    pub(crate) draw: DrawArgs,
    #[command(flatten)]
    pub(crate) print: PrintArgs,
    /// Draw and write a PNG or TIFF N rows at a time, rounded up to a multiple of 16, in less memory; 0 draws it in one piece. By default
    /// pictures of more than 33 million pixels are drawn so, and those for which there is too little memory. The bytes are the same
    #[arg(long, value_name = "N", allow_negative_numbers = true, value_parser = clap::value_parser!(u32).range(0..=65_535))]
    pub(crate) band_rows: Option<u32>,
    /// Buffers to write beside the picture
    #[arg(long, value_enum, value_delimiter = ',', value_name = "LIST")]
    pub(crate) aux: Vec<AuxKind>,
    /// Format of the buffers: one NPY each (OUT.NAME.npy), or one OpenEXR (OUT.exr)
    #[arg(long, value_enum, default_value = "npy")]
    pub(crate) aux_format: AuxFormatKind,
    /// Draw lines of the coordinate system on the ground, every M metres; by default at a round spacing
    #[arg(long, value_name = "M", num_args = 0..=1, require_equals = true, value_parser = spacing)]
    pub(crate) grid: Option<Option<f64>>,
    /// Colour the picture by how far the bend moves what it shows
    #[arg(long, conflicts_with = "straight")]
    pub(crate) heatmap: bool,
    /// Draw the ridges and routes of the straight picture faintly over the bent one
    #[arg(long, conflicts_with = "straight")]
    pub(crate) ghost: bool,
    /// Show what the bend did: shift = colours by how far points move in the picture, stages = a colour for each stage and turn where it
    /// moves most, revealed = the outline of what the straight picture hides, ghost-box = a box where a required feature would be in
    /// the straight picture, and a leader to it; without a list shift, revealed and ghost-box
    #[arg(long, value_delimiter = ',', value_name = "LIST", num_args = 0..=1, require_equals = true, default_missing_value = "shift,revealed,ghost-box", conflicts_with = "straight", value_parser = parse_highlight)]
    pub(crate) highlight: Vec<HighlightMark>,
    /// Leave out the mark in the corner that says that the view is bent, and by how much
    #[arg(long)]
    pub(crate) no_mark: bool,
    /// Draw the camera itself from above: rays, planes, viewpoints, curve
    #[arg(long, conflicts_with_all = CAMERA_CONFLICTS)]
    pub(crate) overhead: bool,
    /// Draw the camera itself from another eye: eye and point to look at, in scene coordinates or lon,lat, or auto
    #[arg(long, value_name = "X,Y,Z,X,Y,Z", allow_hyphen_values = true, conflicts_with_all = CAMERA_CONFLICTS, conflicts_with = "overhead", value_parser = parse_outside)]
    pub(crate) outside: Option<Outside>,
    /// Tint of the terrain instead of the scene's: a name, as of `reveal`, or a file of colours by height (GDAL text, GMT .cpt)
    #[arg(long, value_name = "NAME|FILE")]
    pub(crate) palette: Option<String>,
    #[command(flatten)]
    pub(crate) air: Air,
    #[command(flatten)]
    pub(crate) molecules: Molecules,
    /// Draw the sea as ordinary ground
    #[arg(long)]
    pub(crate) no_sea: bool,
    /// Style of the areas of all layers, instead of the scene's; auto = the one that properties and names give
    #[arg(long, value_parser = one_of::<SurfaceDoc>(), value_name = "STYLE")]
    pub(crate) area_style: Option<SurfaceDoc>,
    #[command(flatten, next_help_heading = "Data without a scene file")]
    pub(crate) data: OfData,
}

/// What makes no sense for pictures of the camera.
const CAMERA_CONFLICTS: [&str; 7] = ["straight", "compare", "aux", "grid", "heatmap", "ghost", "highlight"];

/// Format of buffers.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub(crate) enum AuxFormatKind {
    /// NumPy arrays
    Npy,
    /// OpenEXR; 32-bit, world positions relative to the attribute worldOrigin
    Exr,
}

/// A moving camera.
#[derive(Debug, Args)]
pub(crate) struct AnimateArgs {
    /// Scene file, TOML or JSON, or data as `render` takes them; - = standard input
    pub(crate) scene: PathBuf,
    /// Film, made by the ffmpeg program, with its frames in the folder OUT.frames; or a folder for the frames alone
    #[arg(short, long, value_name = "OUT.mp4|DIR")]
    pub(crate) out: PathBuf,
    /// Number of frames; by default the scene's, else 250 or as many as the path needs. Without --speed the speed follows
    #[arg(long, value_name = "N", allow_negative_numbers = true, value_parser = clap::value_parser!(u32).range(1..=100_000))]
    pub(crate) frames: Option<u32>,
    /// Frames per second; by default the scene's, else 25
    #[arg(long, value_name = "F", allow_negative_numbers = true, value_parser = number)]
    pub(crate) fps: Option<f64>,
    /// Follow the route of this line layer, behind and above a walker; the eye stays above the drawn ground
    #[arg(long, value_name = "LAYER", group = "way")]
    pub(crate) along: Option<String>,
    /// Ground speed along the route, metres per second of film; by default the whole route in all frames
    #[arg(long, value_name = "M", allow_negative_numbers = true, value_parser = number)]
    pub(crate) speed: Option<f64>,
    /// Tilt through the viewing angles of the spline's presets: phi, or phi=FIRST:LAST[:STEP] in degrees
    #[arg(long, value_name = "phi[=A:B]", group = "way", value_parser = parse_sweep)]
    pub(crate) sweep: Option<[f64; 3]>,
    /// Turn once around the point looked at, or as the scene says
    #[arg(long, group = "way")]
    pub(crate) turntable: bool,
    /// Mark the walker, along a route; he is seen through ground that hides him
    #[arg(long)]
    pub(crate) marker: bool,
    /// Write the time at the walker, along a route, where a GPX file gives times
    #[arg(long)]
    pub(crate) clock: bool,
    /// Draw a strip with the heights of the route and the walker's place
    #[arg(long)]
    pub(crate) profile: bool,
    /// Keep the frames that exist and draw the rest
    #[arg(long)]
    pub(crate) resume: bool,
    /// Draw these frames alone, counted from 0, both included: for one of several processes or machines that draw a film into one folder. --resume without it collects the parts and makes the film
    #[arg(long, value_name = "FIRST:LAST", value_parser = parse_part)]
    pub(crate) part: Option<animate::Part>,
    #[command(flatten)]
    pub(crate) draw: DrawArgs,
    #[command(flatten, next_help_heading = "Data without a scene file")]
    pub(crate) data: OfData,
}

/// Buffers beside a picture.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub(crate) enum AuxKind {
    /// Forward distance, f32
    Depth,
    /// 1 + index of the layer, u32
    Id,
    /// World position, 3 x f64
    World,
    /// Displaced minus world position, 3 x f64
    Displacement,
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
    /// The schema of what the verb is asked, its options as JSON, instead of that of its answers: reveal
    #[arg(long)]
    pub(crate) request: bool,
    /// Output; standard output if left out
    #[arg(short, long, value_name = "OUT.json")]
    pub(crate) out: Option<PathBuf>,
}
