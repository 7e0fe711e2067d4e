//! Names of one frame of a film, as they were placed before it is drawn.

use serde::{Deserialize, Serialize};

/// Which text a name is: the same in all frames of a film.
#[derive(Debug, Clone, PartialEq, Eq, Hash, Serialize, Deserialize)]
pub struct NameId {
    /// 1 + index of its layer; 0 for texts of no layer.
    pub layer: u32,
    /// The text.
    pub text: String,
    /// Number among the features of the layer that bear this text.
    pub number: u32,
    /// Number of the image of the feature: rays that part may show it several times.
    pub image: u32,
}

/// Side of a name on its point or line.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Serialize, Deserialize)]
pub enum NameSide {
    /// Centred on its point.
    Over,
    /// Above its point.
    Above {
        /// Number of the length of its leader, from 0 on: the shortest.
        leader: u32,
        /// Number of the share of the text that stands to the left of the point.
        shift: u32,
    },
    /// Above its point in a row of the picture.
    Row {
        /// Number of the row from the upper rim of the picture on.
        row: u32,
        /// As of [`NameSide::Above`].
        shift: u32,
    },
    /// Right of its point.
    Right,
    /// Left of its point.
    Left,
    /// Below its point.
    Below,
    /// Level, beside its line.
    Beside {
        /// Whether it stands on the upper side.
        upper: bool,
    },
    /// Along its line.
    Along {
        /// Whether it runs on the upper side.
        upper: bool,
    },
}

/// Point of a line that a name belongs to.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Serialize, Deserialize)]
pub struct NameAnchor {
    /// Index of the line in its layer.
    pub feature: u32,
    /// Distance along the line, thousandths of a scene unit.
    pub along: i64,
}

/// Where a name stands, told relative to what it names.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Serialize, Deserialize)]
pub struct NamePlace {
    /// Side of the point or line.
    pub side: NameSide,
    /// Point of the line; `None` for names of points and areas.
    pub anchor: Option<NameAnchor>,
}

/// A name of a frame of a film and its place.
#[derive(Debug, Clone, PartialEq, Eq, Hash, Serialize, Deserialize)]
pub struct PlacedName {
    /// Which name.
    pub id: NameId,
    /// Where it stands.
    pub place: NamePlace,
}
