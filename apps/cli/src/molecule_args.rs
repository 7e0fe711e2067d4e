//! Arguments that say what molecules are shown as.

use belvedere::MoleculeOptions;
use belvedere::scene::molecule::Representation;
use clap::{Args, ValueEnum};

/// Molecules of the picture.
#[derive(Debug, Clone, Default, Args)]
pub(crate) struct MoleculeArgs {
    /// What molecules are shown as, instead of what the scene says; without a scene auto
    #[arg(long, value_enum, value_name = "KIND")]
    pub(crate) representation: Option<RepresentationKind>,
    /// Colours of molecules: auto (by element; ribbons and surfaces by chain), element, chain, residue, structure, or one colour #rrggbb
    #[arg(long, value_name = "SOURCE|COLOUR")]
    pub(crate) color_by: Option<String>,
    /// Biological assembly of molecules, such as 1: draws the copies that the file describes (`info` lists them); asymmetric = the atoms of
    /// the file alone
    #[arg(long, value_name = "NAME")]
    pub(crate) assembly: Option<String>,
    /// Model of a file of molecules that holds several, from 1
    #[arg(long, value_name = "N")]
    pub(crate) model: Option<usize>,
}

/// What molecules are shown as.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub(crate) enum RepresentationKind {
    /// Small balls joined by rods
    BallAndStick,
    /// Balls of van der Waals radius
    #[value(alias = "space-filling")]
    Spheres,
    /// Rods alone
    Sticks,
    /// Bands along chains, the rest as balls and rods
    #[value(alias = "cartoon")]
    Ribbon,
    /// The smooth surface around all atoms
    Surface,
    /// Ribbons from 100 residues on, else small balls joined by rods
    Auto,
}

impl From<RepresentationKind> for Representation {
    fn from(kind: RepresentationKind) -> Self {
        match kind {
            RepresentationKind::BallAndStick => Self::BallAndStick,
            RepresentationKind::Spheres => Self::SpaceFilling,
            RepresentationKind::Sticks => Self::Sticks,
            RepresentationKind::Ribbon => Self::Ribbon,
            RepresentationKind::Surface => Self::Surface,
            RepresentationKind::Auto => Self::Auto,
        }
    }
}

impl MoleculeArgs {
    pub(crate) fn options(&self) -> MoleculeOptions {
        MoleculeOptions {
            representation: self.representation.map(Into::into),
            color: self.color_by.clone(),
            assembly: self.assembly.clone(),
            model: self.model,
        }
    }
}
