//! Places as users write them.
//!
//! `X,Y` or `X,Y,Z`. X and Y are scene coordinates, or longitude and latitude in degrees. With letters, in any order, they are always
//! degrees: `46.5N,11.3E`. Z is in metres over the datum of the data; `+20` is 20 m above the ground, as is `+0`.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use std::fmt;
use std::str::FromStr;

/// A place as it is written.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(try_from = "PlaceForm", into = "String")]
#[schemars(with = "PlaceForm")]
pub struct Place {
    /// Position on the map.
    pub position: PlacePosition,
    /// Height.
    pub height: PlaceHeight,
}

/// A position on the map as it is written.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum PlacePosition {
    /// Scene x and y, or longitude and latitude.
    Numbers([f64; 2]),
    /// Longitude and latitude, WGS84 degrees, told by letters.
    LonLat([f64; 2]),
}

/// A height as it is written.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum PlaceHeight {
    /// None: that of the ground.
    OnGround,
    /// Metres over the datum of the data.
    Metres(f64),
    /// Metres above the ground.
    AboveGround(f64),
}

impl Place {
    /// The place of two or three numbers.
    pub fn of(position: [f64; 2], height: Option<f64>) -> Self {
        let height = height.map_or(PlaceHeight::OnGround, PlaceHeight::Metres);
        Self { position: PlacePosition::Numbers(position), height }
    }

    /// Whether a height is written.
    pub fn has_height(&self) -> bool {
        self.height != PlaceHeight::OnGround
    }

    /// The two numbers as written; of letters longitude and latitude.
    pub fn numbers(&self) -> [f64; 2] {
        match self.position {
            PlacePosition::Numbers(p) | PlacePosition::LonLat(p) => p,
        }
    }
}

/// The message about a text that is no place.
const FORM: &str = "give X,Y or X,Y,Z: scene coordinates, lon,lat in degrees, or with letters as 46.5N,11.3E; Z in metres, or +20 for \
                    20 m above the ground";

impl FromStr for Place {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let parts: Vec<&str> = text.split(',').map(str::trim).collect();
        let (xy, z) = match parts[..] {
            [x, y] => ([x, y], None),
            [x, y, z] => ([x, y], Some(z)),
            _ => return Err(format!("it has {} parts between commas; {FORM}", parts.len())),
        };
        let height = match z {
            None => PlaceHeight::OnGround,
            Some(z) => {
                let height = number(z).ok_or_else(|| format!("\"{z}\" is not a height; {FORM}"))?;
                if z.starts_with('+') { PlaceHeight::AboveGround(height) } else { PlaceHeight::Metres(height) }
            }
        };
        let position = match xy.map(angle) {
            [None, None] => {
                let [x, y] = xy.map(|t| number(t).ok_or_else(|| format!("\"{t}\" is not a number; {FORM}")));
                PlacePosition::Numbers([x?, y?])
            }
            [Some(a), Some(b)] => {
                let (lat, lon) = match (a, b) {
                    (Angle::Lat(lat), Angle::Lon(lon)) | (Angle::Lon(lon), Angle::Lat(lat)) => (lat, lon),
                    _ => return Err(format!("one of N, S and one of E, W belong together; {FORM}")),
                };
                if !(lat.abs() <= 90.0 && lon.abs() <= 180.0) {
                    return Err("latitudes reach from 90S to 90N, longitudes from 180W to 180E".into());
                }
                PlacePosition::LonLat([lon, lat])
            }
            _ => return Err(format!("only one of the two has a letter; {FORM}")),
        };
        Ok(Self { position, height })
    }
}

fn number(text: &str) -> Option<f64> {
    text.parse().ok().filter(|v: &f64| v.is_finite())
}

enum Angle {
    Lat(f64),
    Lon(f64),
}

/// Degrees with a letter, such as `46.5N` or `11.3° e`.
fn angle(text: &str) -> Option<Angle> {
    let letter = text.chars().next_back()?.to_ascii_uppercase();
    let degrees = text[..text.len() - letter.len_utf8()].trim().trim_end_matches('°').trim_end();
    let value = number(degrees).filter(|v| *v >= 0.0)?;
    match letter {
        'N' => Some(Angle::Lat(value)),
        'S' => Some(Angle::Lat(-value)),
        'E' => Some(Angle::Lon(value)),
        'W' => Some(Angle::Lon(-value)),
        _ => None,
    }
}

impl fmt::Display for Place {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self.position {
            PlacePosition::Numbers([x, y]) => write!(f, "{x},{y}")?,
            PlacePosition::LonLat([lon, lat]) => {
                let side = |value: f64, [positive, negative]: [char; 2]| if value < 0.0 { negative } else { positive };
                write!(f, "{}{},{}{}", lat.abs(), side(lat, ['N', 'S']), lon.abs(), side(lon, ['E', 'W']))?;
            }
        }
        match self.height {
            PlaceHeight::OnGround => Ok(()),
            PlaceHeight::Metres(z) => write!(f, ",{z}"),
            PlaceHeight::AboveGround(z) => write!(f, ",+{z}"),
        }
    }
}

/// A place in a document: its text, or two or three numbers.
#[derive(Deserialize, JsonSchema)]
#[serde(untagged)]
pub(crate) enum PlaceForm {
    Text(String),
    Point([f64; 3]),
    Position([f64; 2]),
}

impl TryFrom<PlaceForm> for Place {
    type Error = String;

    fn try_from(form: PlaceForm) -> Result<Self, String> {
        match form {
            PlaceForm::Text(text) => text.parse(),
            PlaceForm::Point([x, y, z]) => Ok(Self::of([x, y], Some(z))),
            PlaceForm::Position(position) => Ok(Self::of(position, None)),
        }
    }
}

impl From<Place> for String {
    fn from(place: Place) -> Self {
        place.to_string()
    }
}

#[cfg(test)]
mod tests {
    use super::Place;

    #[test]
    fn a_place_is_written_as_it_is_read() {
        for text in ["1.5,-2", "1,2,3.25", "4,5,+20", "46.5N,11.25E,+0", "1S,2.5W,700"] {
            let place: Place = text.parse().expect("a place");
            assert_eq!(place.to_string(), text);
            let json = serde_json::to_string(&place).expect("JSON");
            assert_eq!(serde_json::from_str::<Place>(&json).expect("read"), place);
        }
        assert_eq!(serde_json::from_str::<Place>("[1, 2, 3]").expect("read"), Place::of([1.0, 2.0], Some(3.0)));
    }
}
