//! What is straightened, and from which side it is seen.

#[cfg(feature = "clap")]
use super::value;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use std::str::FromStr;

/// A line along which space is straightened, and how it is seen; the camera is chosen for it.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[cfg_attr(feature = "clap", derive(clap::Args))]
#[serde(default)]
pub struct Straighten {
    /// Straighten what lies around a line, such as a vessel, and cut it open along the line: a file (CSV `x,y,z`, OBJ, JSON), a line layer,
    /// or X,Y,Z:X,Y,Z, two points of a volume between which the centreline is traced
    #[cfg_attr(feature = "clap", arg(long, value_name = "LINE", allow_hyphen_values = true))]
    pub straighten: Option<StraightenedLine>,
    /// Largest distance from the line that is shown; by default four times the clearance of a traced centreline, else a tenth of its length
    #[cfg_attr(feature = "clap", arg(long, value_name = "R", requires = "straighten", value_parser = value::number))]
    pub radius: Option<f64>,
    /// Side from which the line is seen, degrees about it; 0 by default, where what was above stays above as far as it can
    #[cfg_attr(feature = "clap", arg(long, value_name = "DEG", requires = "straighten", allow_hyphen_values = true, value_parser = value::number))]
    pub side: Option<f64>,
    /// Look at it from outside instead of cutting it open
    #[cfg_attr(feature = "clap", arg(long, requires = "straighten"))]
    pub uncut: bool,
}

impl Straighten {
    /// Names of the options.
    pub const OPTIONS: [&'static str; 4] = ["straighten", "radius", "side", "uncut"];
}

/// A line that is straightened.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(untagged)]
pub enum StraightenedLine {
    /// The centreline between two points of a volume, scene coordinates.
    Between([[f64; 3]; 2]),
    /// A line layer or a file.
    Named(String),
}

impl FromStr for StraightenedLine {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let point = |text: &str| {
            let numbers: Option<Vec<f64>> = text.split(',').map(|n| n.trim().parse().ok()).collect();
            numbers.and_then(|n| <[f64; 3]>::try_from(n).ok()).filter(|p| p.iter().all(|c| c.is_finite()))
        };
        if let Some((from, to)) = text.split_once(':')
            && let (Some(from), Some(to)) = (point(from), point(to))
        {
            return Ok(Self::Between([from, to]));
        }
        match text.trim() {
            "" => Err("give a file, a line layer, or two points as X,Y,Z:X,Y,Z".into()),
            name => Ok(Self::Named(name.to_owned())),
        }
    }
}
