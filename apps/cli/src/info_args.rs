//! Arguments of `info`.

use belvedere::request::Stated;
use clap::Args;

/// Files to describe.
#[derive(Debug, Args)]
pub(crate) struct InfoArgs {
    /// Rasters, features, models, archives of one of them (or archive.zip/entry), or builtin:NAME
    #[arg(required_unless_present = "adapters")]
    pub(crate) files: Vec<String>,
    /// Describe what this machine can draw with
    #[arg(long)]
    pub(crate) adapters: bool,
    #[command(flatten)]
    pub(crate) ground: Stated,
}
