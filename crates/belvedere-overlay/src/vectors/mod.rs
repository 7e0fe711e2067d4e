//! Pictures as vectors: lines, areas, points, names and legends as shapes by layer, over the raster of the surfaces.

mod area;
mod pdf;
mod pdf_letters;
mod svg;

use crate::sheet::Sheet;
pub use area::AreaShape;
pub use area::areas;
use belvedere_composite::canvas::{Canvas, CanvasShape};
use belvedere_composite::marks::{LayerShapes, Shapes};
pub use pdf::write as pdf;
pub use svg::write as svg;

/// Most distance of simplified lines from the whole ones on paper, millimetres.
const SIMPLE_MM: f64 = 0.05;
/// The same on the picture, pixels: shapes lie on the raster within 0.1 pixels.
const SIMPLE_PX: f64 = 0.08;

/// What of a picture becomes vectors.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub enum VectorContent {
    /// Nothing: a picture of pixels.
    #[default]
    Nothing,
    /// Marks, over the raster of the surfaces.
    OverRaster,
    /// Marks alone; areas are filled.
    Alone,
}

/// Shapes of one kind that belong to no layer.
#[derive(Debug, Clone, PartialEq)]
pub struct Furniture {
    /// Name of the kind: `legend`, `inset`, `mark`.
    pub name: &'static str,
    /// The shapes, in the order of drawing.
    pub shapes: Vec<CanvasShape>,
}

/// Where furniture goes: onto the picture, or into a list.
pub struct Furnish<'a> {
    /// The picture.
    pub pixels: &'a mut [[u8; 3]],
    /// Size of the picture, pixels.
    pub size: [usize; 2],
    /// The list; `None`: onto the picture.
    pub record: Option<&'a mut Vec<Furniture>>,
}

impl Furnish<'_> {
    /// Draws one kind of furniture on a canvas, or records it.
    pub fn draw(&mut self, name: &'static str, draw: impl FnOnce(Canvas<'_>)) {
        let Some(record) = &mut self.record else { return draw(Canvas::new(self.pixels, self.size[0])) };
        let mut shapes = Vec::new();
        draw(Canvas::recording(&mut shapes, self.size));
        record.push(Furniture { name, shapes });
    }
}

/// The vectors of a picture, in its pixels.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct VectorPicture {
    /// Lines, symbols and names.
    pub marks: Shapes,
    /// Areas, cut to what is seen of them.
    pub areas: Vec<AreaShape>,
    /// Legends, inset and mark.
    pub furniture: Vec<Furniture>,
    /// Ids of the scene's layers.
    pub layers: Vec<String>,
    /// Whether the raster of the surfaces lies below.
    pub over_raster: bool,
}

/// A part of a picture between its surfaces and its names.
pub enum Piece<'a> {
    /// Fills of the areas of a layer, by its index.
    Fills(usize, Vec<&'a AreaShape>),
    /// Marks of no layer below all lines.
    Grid(&'a [LayerShapes]),
    /// Outlines, lines or symbols of a layer, by its index.
    Marks(usize, &'a [LayerShapes]),
    /// Marks of no layer over all others.
    Overlay(&'a [LayerShapes]),
}

impl VectorPicture {
    /// What is drawn, in the order of pictures of pixels, where areas are a part of the ground: all fills lie below all lines.
    pub fn pieces(&self) -> Vec<Piece<'_>> {
        let areas = |layer: usize| self.areas.iter().filter(|area| area.layer == layer).collect::<Vec<_>>();
        let fills = (0..self.layers.len()).map(|layer| (layer, areas(layer))).filter(|(_, areas)| !areas.is_empty());
        let marks = self.marks.layers.chunk_by(|a, b| a.id == b.id).map(|sheets| match sheets[0].id as usize {
            0 => Piece::Overlay(sheets),
            id => Piece::Marks(id - 1, sheets),
        });
        let fills = fills.map(|(layer, areas)| Piece::Fills(layer, areas));
        fills.chain([Piece::Grid(&self.marks.under)]).chain(marks).collect()
    }

    /// Whether a layer has outlines, lines or symbols.
    pub fn has_marks(&self, layer: usize) -> bool {
        self.marks.layers.iter().any(|sheet| sheet.id as usize == layer + 1)
    }
}

/// Whether there is nothing to draw.
pub fn is_blank(sheets: &[LayerShapes]) -> bool {
    sheets.iter().all(|sheet| sheet.lines.is_empty() && sheet.symbols.is_empty())
}

/// What a file of vectors says beside its shapes.
pub struct Page<'a> {
    /// Size of the picture, pixels.
    pub size: [usize; 2],
    /// Its place on paper.
    pub sheet: Option<Sheet>,
    /// Title, possibly empty.
    pub title: &'a str,
    /// Program, and the note of bent pictures.
    pub description: &'a str,
    /// The surfaces as PNG, not interlaced.
    pub raster: Option<&'a [u8]>,
}

/// Largest distance of simplified shapes from whole ones, pixels.
///
/// * `dpi`: pixels per inch.
pub fn tolerance_px(dpi: f64) -> f64 {
    (SIMPLE_MM / 25.4 * dpi).min(SIMPLE_PX)
}
