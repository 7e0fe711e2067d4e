//! Arguments of `reveal` that say how its picture looks.

use crate::molecule_args::MoleculeArgs;
use crate::parse::{parse_exaggeration, parse_haze, parse_light, parse_spacing, parse_stylise, parse_time};
use belvedere::OpenOptions;
use belvedere::scene::{Edge, Hidden, Relief};
use belvedere::scene_file::{
    FurnitureItem, FurnitureWish, LightDoc, StylisationDoc, SwitchOrLength, SwitchOrVisibility,
};
use belvedere::verbs::appearance::Appearance;
use clap::{Args, ValueEnum};

/// Sky, haze and furniture.
#[derive(Debug, Clone, Default, Args)]
pub(crate) struct AirArgs {
    /// Sky: auto (by the height of the sun), day, dusk, night, white, a colour #rrggbb, or transparent (PNG and SVG)
    #[arg(long, visible_alias = "background", value_name = "NAME|COLOUR")]
    pub(crate) sky: Option<String>,
    /// Haze: on (the default: dims the farther part of the view), off, or the visibility in kilometres
    #[arg(long, value_name = "on|off|KM", allow_negative_numbers = true, value_parser = parse_haze)]
    pub(crate) haze: Option<SwitchOrVisibility>,
    /// Draw lines of equal height on the ground, every M metres of true height; by default at an interval that fits the scale
    #[arg(long, value_name = "M", num_args = 0..=1, require_equals = true, value_parser = parse_spacing)]
    pub(crate) contours: Option<Option<f64>>,
    /// How the ground ends where its data end: soft (it fades), block (it is cut, with sides), mat (it stands on a plain surface), plain
    #[arg(long, value_name = "KIND", value_parser = parse_edge)]
    pub(crate) edge: Option<Edge>,
    #[command(flatten)]
    pub(crate) furniture: FurnitureArgs,
}

fn parse_edge(text: &str) -> Result<Edge, String> {
    Edge::ALL.iter().find(|(name, _)| *name == text).map(|(_, edge)| *edge).ok_or_else(|| {
        let shown: String = text.chars().take(40).collect();
        format!("\"{shown}\" is no edge; possible: {}", Edge::ALL.map(|(name, _)| name).join(", "))
    })
}

impl AirArgs {
    /// The options of opening with what is said of the ground.
    pub(crate) fn apply(&self, options: OpenOptions) -> OpenOptions {
        let contours = self.contours.map(|every| every.map_or(SwitchOrLength::Switch(true), SwitchOrLength::Length));
        OpenOptions { contours: contours.or(options.contours), edge: self.edge.or(options.edge), ..options }
    }
}

/// Title, legend, attribution, compass and scale.
#[derive(Debug, Clone, Default, Args)]
pub(crate) struct FurnitureArgs {
    /// Title in the picture
    #[arg(long, value_name = "TEXT")]
    pub(crate) title: Option<String>,
    /// What stands over the picture so that it can be read as a map: any of title, legend, attribution, source, date, compass, scale,
    /// distances; all, or none
    #[arg(long, value_name = "LIST", value_parser = parse_furniture)]
    pub(crate) furniture: Option<FurnitureItems>,
}

/// Pieces of furniture.
#[derive(Debug, Clone)]
pub(crate) struct FurnitureItems(Vec<FurnitureItem>);

fn parse_furniture(text: &str) -> Result<FurnitureItems, String> {
    FurnitureItem::listed(text.split(',')).map(FurnitureItems)
}

impl FurnitureArgs {
    pub(crate) fn wish(&self) -> FurnitureWish {
        FurnitureWish { items: self.furniture.as_ref().map(|items| items.0.clone()), title: self.title.clone() }
    }
}

/// Look of the picture; all of it is written into the scene file too.
#[derive(Debug, Clone, Default, Args)]
pub(crate) struct LookArgs {
    /// Light the scene as the sun does over the eye at this time, such as 2026-07-01T15:00:00Z or 2026-07-01T17:00+02:00: shading by
    /// the sun alone while it is up (unless --relief says otherwise), with cast shadows
    #[arg(long, value_name = "TIME", value_parser = parse_time)]
    pub(crate) light_time: Option<String>,
    /// Light from a direction: degrees clockwise from north, and over the horizon; 315,45 by default
    #[arg(long, value_name = "AZIMUTH,ALTITUDE", allow_hyphen_values = true, conflicts_with = "light_time", value_parser = parse_light)]
    pub(crate) light: Option<[f64; 2]>,
    #[command(flatten)]
    pub(crate) air: AirArgs,
    /// Draw cast shadows
    #[arg(long)]
    pub(crate) shadows: bool,
    /// Draw no shadows on molecules, which have them without --shadows
    #[arg(long, conflicts_with_all = ["shadows", "light_time"])]
    pub(crate) no_shadows: bool,
    /// Shading of the terrain; swiss by default, sun with --light-time
    #[arg(long, value_enum, value_name = "SHADING")]
    pub(crate) relief: Option<ReliefKind>,
    /// Style of hidden parts of features; by default lines are dashed, outlines of areas cut, points faint
    #[arg(long, value_enum, value_name = "STYLE")]
    pub(crate) hidden: Option<HiddenKind>,
    /// Multiply heights over the median height of the terrain by F, 0.01 to 100; the straight picture keeps the true heights
    #[arg(long, value_name = "F", allow_negative_numbers = true, value_parser = parse_exaggeration)]
    pub(crate) exaggeration: Option<f64>,
    /// Draw dark edges and depth unsharp masking, of strengths in 0..=1 and 0..=10; 0.7,4 without a value
    #[arg(long, value_name = "EDGES[,UNSHARP]", num_args = 0..=1, require_equals = true, default_missing_value = "0.7,4", value_parser = parse_stylise)]
    pub(crate) stylise: Option<StylisationDoc>,
    /// Leave out the mark in the corner that says that the view is bent, and by how much; the record still says so
    #[arg(long)]
    pub(crate) no_mark: bool,
    /// Fill all holes of the terrain, also large ones; by default those of at most 3 % of it
    #[arg(long, conflicts_with = "keep_voids")]
    pub(crate) fill_voids: bool,
    #[command(flatten)]
    pub(crate) molecules: MoleculeArgs,
}

/// Shading of terrain.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub(crate) enum ReliefKind {
    /// Several directions of light blended, as in Swiss relief maps
    Swiss,
    /// One light
    Sun,
    /// No shading
    None,
}

/// Style of hidden parts.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub(crate) enum HiddenKind {
    /// As if nothing were in front
    Show,
    /// Faint
    Fade,
    /// Dashed and thinner
    Dash,
    /// Not drawn
    Cut,
}

impl From<ReliefKind> for Relief {
    fn from(kind: ReliefKind) -> Self {
        match kind {
            ReliefKind::Swiss => Self::Swiss,
            ReliefKind::Sun => Self::Sun,
            ReliefKind::None => Self::None,
        }
    }
}

impl From<HiddenKind> for Hidden {
    fn from(kind: HiddenKind) -> Self {
        match kind {
            HiddenKind::Show => Self::Show,
            HiddenKind::Fade => Self::Fade,
            HiddenKind::Dash => Self::Dash,
            HiddenKind::Cut => Self::Cut,
        }
    }
}

impl LookArgs {
    /// What is drawn in another way than usual.
    pub(crate) fn appearance(&self) -> Appearance {
        let [azimuth_deg, altitude_deg] = [0, 1].map(|i| self.light.map(|light| light[i]));
        let time = self.light_time.clone();
        let shadows = self.shadows || time.is_some();
        let AirArgs { sky, haze, .. } = self.air.clone();
        let furniture = self.air.furniture.wish();
        let stated = shadows || self.light.is_some() || sky.is_some() || haze.is_some();
        Appearance {
            light: stated.then_some(LightDoc { azimuth_deg, altitude_deg, time, shadows, sky, haze }),
            relief: self.relief.map(Into::into),
            stylisation: self.stylise,
            no_shadows: self.no_shadows,
            no_mark: self.no_mark,
            furniture,
            exaggeration: self.exaggeration,
        }
    }
}
