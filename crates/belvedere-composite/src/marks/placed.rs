//! Marks of layers that are of one importance: those of context, or those that must be seen.

use crate::marks::MarkBuilder;
use crate::marks::occupied::Occupied;
use crate::marks::point::PointMarks;
use crate::marks::request::LabelRequest;
use crate::marks::ribbon::StrokeLayer;
use crate::marks::symbols::PointGroup;

/// Side of the squares of what lines take, units.
const SQUARE: f64 = 16.0;

/// Marks of the layers.
#[derive(Default)]
pub(super) struct Placed {
    pub(super) sheets: Vec<StrokeLayer>,
    pub(super) symbols: Vec<PointGroup>,
    pub(super) requests: Vec<LabelRequest>,
}

impl Placed {
    /// What its visible lines take, each with the number of its layer.
    pub(super) fn lines(&self, density: f64) -> Occupied {
        let mut taken = Occupied::new(SQUARE * density);
        for sheet in &self.sheets {
            sheet.visible_boxes().for_each(|rect| taken.take(rect, sheet.id() as usize));
        }
        taken
    }

    /// Lines, with what its visible symbols take.
    pub(super) fn with_symbols(&self, mut lines: Occupied) -> Occupied {
        for group in &self.symbols {
            let seen = group.images.iter().filter(|image| image.seen);
            seen.for_each(|image| lines.take(image.rect(), group.id as usize));
        }
        lines
    }

    /// Symbols. Names go into `requests`, drawings into `points`.
    pub(super) fn drawn(
        mut self,
        builder: &MarkBuilder<'_>,
        points: &mut PointMarks,
        requests: &mut Vec<LabelRequest>,
    ) -> Vec<StrokeLayer> {
        let sheets = builder.drawn_points(self.symbols, points);
        requests.append(&mut self.requests);
        requests.append(&mut points.requests);
        sheets
    }
}
