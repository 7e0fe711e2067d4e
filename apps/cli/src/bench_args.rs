//! Arguments of `bench`.

use belvedere::request::parse::size;
use clap::Args;
use std::path::PathBuf;

/// A measurement.
#[derive(Debug, Args)]
pub(crate) struct BenchArgs {
    /// Times that every case is drawn
    #[arg(long, default_value_t = 7, value_name = "N", allow_negative_numbers = true)]
    pub(crate) rounds: usize,
    /// Nodes along a side of the ground
    #[arg(long, default_value_t = 1025, value_name = "N", allow_negative_numbers = true)]
    pub(crate) nodes: usize,
    /// Size of the picture
    #[arg(long, value_name = "WxH", default_value = "1280x720", value_parser = size)]
    pub(crate) size: [u32; 2],
    /// Measure twelve scenes of the data collection in this folder instead: straight, bent, moving
    #[arg(long, value_name = "FOLDER", conflicts_with = "nodes")]
    pub(crate) collection: Option<PathBuf>,
    /// Of the collection, scenes with this in their name alone
    #[arg(long, value_name = "TEXT", requires = "collection")]
    pub(crate) only: Option<String>,
    /// A Python that has the package vtk: it draws the straight scenes of the collection, too
    #[arg(long, value_name = "PYTHON", requires = "collection")]
    pub(crate) vtk: Option<PathBuf>,
    /// An earlier report of the collection: tells which ratios are more than 1.15 times those (a missed goal under --strict)
    #[arg(long, value_name = "FILE.json", requires = "collection")]
    pub(crate) against: Option<PathBuf>,
    /// Output of the report as JSON
    #[arg(short, long, value_name = "OUT.json")]
    pub(crate) out: Option<PathBuf>,
}
