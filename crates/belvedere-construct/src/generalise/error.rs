//! Errors of the generalisation of a city.

use belvedere_core::plain::number;
use belvedere_scene::Cancelled;

/// A generalisation that is not possible.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum GeneraliseError {
    /// Cancelled through [`belvedere_scene::Progress`].
    #[error(transparent)]
    Cancelled(#[from] Cancelled),
    /// No building has an area.
    #[error("none of the {buildings} buildings has an outline with an area; load a file with building footprints")]
    NoBuildings {
        /// Buildings of the city.
        buildings: usize,
    },
    /// Coordinates that are not metres, or are damaged.
    #[error("the city is {width:.6} by {height:.6} units wide, 10 to 1000000 m are possible; {}", extent_hint(*width, *height))]
    Extent {
        /// Width, units of the coordinates.
        width: f64,
        /// Height, units of the coordinates.
        height: f64,
    },
    /// A setting out of its range.
    #[error("{name} is {}, it must be {}", number(*value), range_words(*least, *most))]
    Setting {
        /// Name.
        name: &'static str,
        /// The value.
        value: f64,
        /// Least value.
        least: f64,
        /// Largest value.
        most: f64,
    },
}

fn range_words(least: f64, most: f64) -> String {
    if most > 1e15 { format!("at least {}", number(least)) } else { format!("in {}..={}", number(least), number(most)) }
}

fn extent_hint(width: f64, height: f64) -> &'static str {
    if width.max(height) < 10.0 {
        "project it from degrees to metres first"
    } else {
        "look for buildings far away from the others"
    }
}
