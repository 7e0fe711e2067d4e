//! Arguments that say of files what they do not say themselves, and those of `info`.

use belvedere::scene_file::VerticalUnit;
use clap::{Args, ValueEnum};

/// What files do not say.
#[derive(Debug, Clone, Default, Args)]
pub(crate) struct GroundArgs {
    /// Coordinate system of the terrain's file, instead of the stated one
    #[arg(long, value_name = "EPSG:n")]
    pub(crate) source_crs: Option<String>,
    /// Stored value of the terrain that means "no data", instead of the stated one
    #[arg(long, value_name = "VALUE", allow_negative_numbers = true)]
    pub(crate) nodata: Option<f64>,
    /// Unit of the terrain's heights, instead of the stated one
    #[arg(long, value_enum, value_name = "UNIT")]
    pub(crate) vertical_unit: Option<UnitKind>,
    /// Property that holds the names of features, instead of the one that looks most like a name
    #[arg(long, value_name = "PROPERTY")]
    pub(crate) name_field: Option<String>,
}

/// Units of heights.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub(crate) enum UnitKind {
    /// Metres.
    M,
    /// Feet of 0.3048 m.
    Ft,
    /// US survey feet.
    UsFt,
}

impl From<UnitKind> for VerticalUnit {
    fn from(kind: UnitKind) -> Self {
        match kind {
            UnitKind::M => Self::Metre,
            UnitKind::Ft => Self::Foot,
            UnitKind::UsFt => Self::UsFoot,
        }
    }
}

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
    pub(crate) ground: GroundArgs,
}
