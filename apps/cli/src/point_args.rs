//! Arguments of verbs about single points and pixels: `project`, `displace`, `rays`, `pick`.

use belvedere::request::parse::number;
use clap::Args;
use std::path::PathBuf;

/// A scene and points.
#[derive(Debug, Args)]
pub(crate) struct ProjectArgs {
    /// Scene file, TOML or JSON; - = standard input
    pub(crate) scene: PathBuf,
    /// JSON file of points [[x,y,z],...]; texts such as "46.5N,11.3E,+20" may stand among them;
    /// - = standard input
    #[arg(long, value_name = "P.json")]
    pub(crate) points: PathBuf,
    /// Output; standard output if left out
    #[arg(short, long, value_name = "OUT.json")]
    pub(crate) out: Option<PathBuf>,
}

/// A scene, and points in it or its features.
#[derive(Debug, Args)]
pub(crate) struct DisplaceArgs {
    /// Scene file, TOML or JSON; - = standard input
    pub(crate) scene: PathBuf,
    /// JSON file of points [[x,y,z],...], as for project; if left out, the lines, areas and points of the scene are displaced
    #[arg(long, value_name = "P.json")]
    pub(crate) points: Option<PathBuf>,
    /// Output, standard output if left out; of features GeoJSON, or GeoPackage where the name ends in .gpkg
    #[arg(short, long, value_name = "OUT.json")]
    pub(crate) out: Option<PathBuf>,
}

/// A scene and pixels.
#[derive(Debug, Args)]
pub(crate) struct RaysArgs {
    /// Scene file, TOML or JSON; - = standard input
    pub(crate) scene: PathBuf,
    /// JSON file of pixels [[x,y],...]; - = standard input
    #[arg(long, value_name = "P.json")]
    pub(crate) pixels: PathBuf,
    /// Samples per ray, equidistant in depth
    #[arg(long, value_name = "N", allow_negative_numbers = true)]
    pub(crate) samples: usize,
    /// Depth of the last sample; by default the camera's far, else the scene's largest depth
    #[arg(long, value_name = "W", allow_negative_numbers = true, value_parser = number)]
    pub(crate) far: Option<f64>,
    /// Output; standard output if left out
    #[arg(short, long, value_name = "OUT.json")]
    pub(crate) out: Option<PathBuf>,
}

/// Shape of the answer of `pick`.
pub(crate) const PICK_HELP: &str = r#"Pixels: origin at the outer corner of the top-left pixel, centres at .5.
Answer, in input order, numbers round-trip exactly:
  {"pixels":[{"point":[x,y,z],"depth":w,"segment":k,"layer":"ID","feature":"NAME" or null}, null for sky, ...]}
point is the true place in scene coordinates, depth the forward distance at which it is seen; segment 2k = straight part of viewpoint k,
2j-1 = transition of turn j. Visible lines and points count before the ground (the last layer first), areas belong to the ground."#;

/// A scene and pixels to look through.
#[derive(Debug, Args)]
pub(crate) struct PickArgs {
    /// Scene file, TOML or JSON; - = standard input
    pub(crate) scene: PathBuf,
    /// JSON file of pixels [[x,y],...]; - = standard input
    #[arg(long, value_name = "P.json")]
    pub(crate) pixels: PathBuf,
    /// Output; standard output if left out
    #[arg(short, long, value_name = "OUT.json")]
    pub(crate) out: Option<PathBuf>,
}
