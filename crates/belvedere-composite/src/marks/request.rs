//! What is to be written, how large it is, and where it may stand.

use crate::canvas::Fonts;
use crate::marks::occupied::{Occupied, Rect};
use belvedere_core::DVec2;
use belvedere_scene::{Color, NameAnchor, NameId, NamePlace};

/// A text to be placed.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct LabelRequest {
    pub(crate) text: String,
    /// A second line below, in smaller letters; possibly empty.
    pub(crate) second: String,
    /// The point it belongs to, pixels.
    pub(crate) at: DVec2,
    /// Reach of the marker: to the sides and below, and above, pixels.
    pub(crate) marker: [f64; 2],
    /// Height of the letters, pixels.
    pub(crate) size_px: f64,
    pub(crate) color: Color,
    /// Whether the text may be placed away from its point.
    pub(crate) leader: bool,
    /// Whether the text stands over its point, not beside it.
    pub(crate) over: bool,
    /// Baselines along which the text may run, best first.
    pub(crate) along: Vec<Baseline>,
    /// The line that it names and half its width with the casing, pixels: the text stays clear of it.
    pub(crate) line: (Vec<DVec2>, f64),
    /// Row of the highest ground above the columns around the point, where the point stands on the skyline.
    pub(crate) skyline: Option<f64>,
    /// 1 + index of the layer; 0 for texts of none.
    pub(crate) layer: u32,
    /// Number among the features of the layer that bear this text, and of the image of the feature.
    pub(crate) number: u32,
    pub(crate) image: u32,
    /// How much it counts among the texts of its layer; negative infinity where nothing says so.
    pub(crate) rank: f64,
    /// Whether its point is seen, or its style names hidden ones.
    pub(crate) seen: bool,
    /// The point of its line at `at`.
    pub(crate) anchor: Option<NameAnchor>,
}

/// How much a text of this rank counts: one without a rank less than any other.
pub(crate) fn rank_of(rank: Option<f64>) -> f64 {
    rank.filter(|rank| !rank.is_nan()).unwrap_or(f64::NEG_INFINITY)
}

/// Where a text may run along a line.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Baseline {
    /// Pixels, from left to right.
    pub(crate) points: Vec<DVec2>,
    /// Whether it lies above the line.
    pub(crate) upper: bool,
    /// Point of the line at the middle of the text.
    pub(crate) anchor: Option<NameAnchor>,
}

impl LabelRequest {
    /// A name beside a point.
    pub(crate) fn new(text: impl Into<String>, at: DVec2, size_px: f64, color: Color) -> Self {
        Self {
            text: text.into(),
            second: String::new(),
            at,
            marker: [0.0; 2],
            size_px,
            color,
            leader: false,
            over: false,
            along: Vec::new(),
            line: (Vec::new(), 0.0),
            skyline: None,
            layer: 0,
            number: 0,
            image: 0,
            rank: f64::NEG_INFINITY,
            seen: true,
            anchor: None,
        }
    }

    /// The same text, which stays clear of a line.
    /// * `half_px`: half the width of the line with its casing, pixels.
    pub(crate) fn clear_of(self, line: Vec<DVec2>, half_px: f64) -> Self {
        Self { line: (line, half_px), ..self }
    }

    /// Which text it is in all frames of a film.
    pub(crate) fn id(&self) -> NameId {
        NameId { layer: self.layer, text: self.text.clone(), number: self.number, image: self.image }
    }
}

/// Lines of text of a label, from above.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Lines {
    /// Text, height of the letters and width, pixels.
    pub(crate) lines: Vec<(String, f64, f64)>,
    /// Largest width, pixels.
    pub(crate) width: f64,
    /// From the baseline of the first line upwards, and downwards to the foot of the last, pixels.
    pub(crate) ascent: f64,
    pub(crate) descent: f64,
}

/// Height of the letters of a second line in those of the first.
const SECOND: f64 = 0.82;
/// From a baseline to the next in heights of the second line's letters.
const LEADING: f64 = 1.12;

impl Lines {
    pub(crate) fn of(request: &LabelRequest, fonts: &Fonts) -> Self {
        let first = fonts.text_size(request.size_px, &request.text);
        let mut lines = vec![(request.text.clone(), request.size_px, first.width)];
        let (mut width, mut descent) = (first.width, first.descent);
        if !request.second.is_empty() {
            let small = SECOND * request.size_px;
            let second = fonts.text_size(small, &request.second);
            lines.push((request.second.clone(), small, second.width));
            (width, descent) = (width.max(second.width), LEADING * small + second.descent);
        }
        Self { lines, width, ascent: first.ascent, descent }
    }

    /// Texts, heights of letters and left ends of baselines of a block whose first baseline begins at `at`.
    pub(crate) fn placed(&self, at: DVec2) -> impl Iterator<Item = (&str, f64, DVec2)> {
        let line = move |(i, (_, size, width)): (usize, &'_ (String, f64, f64))| {
            DVec2::new(at.x + 0.5 * (self.width - width), at.y + i as f64 * LEADING * size)
        };
        self.lines.iter().enumerate().map(move |(i, set)| (set.0.as_str(), set.1, line((i, set))))
    }
}

/// Where a text may stand.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Candidate {
    /// What it takes.
    pub(crate) boxes: Vec<Rect>,
    pub(crate) leader: Option<[DVec2; 2]>,
    /// Left end of the first baseline.
    pub(crate) baseline: DVec2,
    /// The baseline of a text along a curve, else empty.
    pub(crate) along: Vec<DVec2>,
    /// The same, relative to what is named.
    pub(crate) place: NamePlace,
}

/// The picture that texts are placed on.
pub(crate) struct Page<'a> {
    /// Pixels.
    pub(crate) size: DVec2,
    /// Pixels per unit of gaps, leaders and rims.
    pub(crate) density: f64,
    pub(crate) fonts: &'a Fonts,
    /// Where no text may stand.
    pub(crate) keep_clear: &'a [Rect],
    /// Where texts of other layers may not stand: what must be seen, by the numbers of the layers.
    pub(crate) must_see: Occupied,
}
