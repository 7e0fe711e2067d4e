//! What molecules are shown as.

#[cfg(feature = "clap")]
use super::args::one_of;
use crate::ModelsDoc;
use belvedere_scene::molecule::Representation;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// What all molecules of a scene are shown as; what is left out stays as the scene has it.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[cfg_attr(feature = "clap", derive(clap::Args))]
#[serde(default)]
pub struct Molecules {
    /// What molecules are shown as, instead of what the scene says; without a scene auto
    #[cfg_attr(feature = "clap", arg(long, value_parser = one_of::<Representation>(), value_name = "KIND"))]
    pub representation: Option<Representation>,
    /// Colours of molecules: auto (by element; ribbons and surfaces by chain), element, chain, residue, structure, or one colour #rrggbb
    #[cfg_attr(feature = "clap", arg(long, value_name = "SOURCE|COLOUR"))]
    pub color_by: Option<String>,
    /// Biological assembly of molecules, such as 1: draws the copies that the file describes (`info` lists them); asymmetric = the atoms of
    /// the file alone
    #[cfg_attr(feature = "clap", arg(long, value_name = "NAME"))]
    pub assembly: Option<String>,
    /// Model of a file of molecules that holds several, from 1, or all
    #[cfg_attr(feature = "clap", arg(long, value_name = "N|all"))]
    pub model: Option<ModelsDoc>,
}

impl Molecules {
    /// Names of the options.
    pub const OPTIONS: [&'static str; 4] = ["representation", "color_by", "assembly", "model"];
}
