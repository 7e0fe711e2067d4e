//! Marks as shapes on the picture, for files of vectors: the same stretches, symbols and names that are drawn on pixels.

use crate::canvas::CanvasShape;
use crate::marks::symbol;
use belvedere_core::{DVec2, polygon};
use belvedere_scene::{Color, Symbol};

/// A colour and its opacity.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Paint {
    /// The colour.
    pub color: Color,
    /// Opacity with that of the colour, 0..=1.
    pub opacity: f32,
}

/// How a shape is painted.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Role {
    /// Below everything: behind surfaces.
    Hidden,
    /// A rim below every fill of its layer.
    Casing,
    /// What is seen.
    Fill,
}

/// A stretch of a line that is all visible or all hidden.
#[derive(Debug, Clone, PartialEq)]
pub struct LineShape {
    /// Number of the line in its group; the stretches of a line stand in their order.
    pub number: usize,
    /// Vertices about a pixel apart, pixels.
    pub points: Vec<DVec2>,
    /// Length of what lies inside the picture as measures count it, scene units: in plan where there is ground.
    pub length: f64,
    /// Whether it is visible.
    pub visible: bool,
    /// Whether the style draws it.
    pub drawn: bool,
    /// Paint: fill, or hidden.
    pub role: Role,
    /// Width, pixels.
    pub width: f64,
    /// Width with the rim, pixels.
    pub casing: Option<f64>,
    /// Lengths of dashes and gaps, pixels.
    pub dash: Option<[f64; 2]>,
}

/// A symbol of a point.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SymbolShape {
    /// The symbol.
    pub symbol: Symbol,
    /// Its point, pixels.
    pub at: DVec2,
    /// Half its size, pixels.
    pub half: f64,
    /// Width of a rim around it, which belongs to the symbol, pixels.
    pub grow: f64,
    /// Paint.
    pub role: Role,
}

/// Lines and symbols that are painted alike.
#[derive(Debug, Clone, PartialEq)]
pub struct LayerShapes {
    /// 1 + index of the layer in the scene; 0 for marks of no layer.
    pub id: u32,
    /// Paint of hidden parts.
    pub hidden: Paint,
    /// Paint of rims.
    pub casing: Paint,
    /// Paint of visible parts.
    pub fill: Paint,
    /// Stretches of lines.
    pub lines: Vec<LineShape>,
    /// Symbols.
    pub symbols: Vec<SymbolShape>,
}

/// The marks of a picture as shapes, in the order of drawing.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Shapes {
    /// Marks of no layer below all layers, such as the grid.
    pub under: Vec<LayerShapes>,
    /// Marks of the layers, lines before points, and those of no layer above them; the marks of a layer follow each other.
    pub layers: Vec<LayerShapes>,
    /// Names and their leaders.
    pub names: Vec<CanvasShape>,
}

/// Rings of a symbol of half size `half` around its point, pixels, y down, holes oriented against their outer ring; curves in steps of at most
/// 5 degrees.
pub fn outline(symbol: Symbol, half: f64) -> Vec<Vec<DVec2>> {
    symbol::rings(symbol).iter().map(|ring| ring.iter().map(|corner| half * *corner).collect()).collect()
}

/// A polyline with as few vertices as lie within `tolerance` of it (Douglas and Peucker); its ends stay.
///
/// * `tolerance`: pixels, >= 0.
pub fn simplified(points: &[DVec2], tolerance: f64) -> Vec<DVec2> {
    let Some(last) = points.len().checked_sub(1) else { return Vec::new() };
    let mut kept = vec![false; points.len()];
    (kept[0], kept[last]) = (true, true);
    let mut open = vec![(0, last)];
    while let Some((from, to)) = open.pop() {
        let (a, b) = (points[from], points[to]);
        let farthest = (from + 1..to)
            .map(|i| (i, polygon::to_segment(points[i], a, b).length()))
            .max_by(|x, y| x.1.total_cmp(&y.1));
        if let Some((middle, _)) = farthest.filter(|(_, off)| *off > tolerance) {
            kept[middle] = true;
            open.extend([(from, middle), (middle, to)]);
        }
    }
    points.iter().zip(kept).filter(|(_, kept)| *kept).map(|(p, _)| *p).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn simplified_lines_stay_within_the_tolerance() {
        let wave: Vec<DVec2> = (0..=4000)
            .map(|i| DVec2::new(0.3 * f64::from(i), 60.0 * (0.01 * f64::from(i)).sin() + (0.7 * f64::from(i)).sin()))
            .collect();
        for tolerance in [0.05, 0.5, 5.0] {
            let few = simplified(&wave, tolerance);
            assert_eq!((few.first(), few.last()), (wave.first(), wave.last()));
            let off = |p: &DVec2| {
                few.windows(2).map(|w| polygon::to_segment(*p, w[0], w[1]).length()).fold(f64::INFINITY, f64::min)
            };
            let worst = wave.iter().step_by(7).map(off).fold(0.0, f64::max);
            assert!(worst <= tolerance + 1e-12 && few.len() < wave.len(), "{worst} with {} vertices", few.len());
        }
        assert_eq!(simplified(&wave[..1], 1.0), wave[..1]);
        assert!(simplified(&[], 1.0).is_empty());
    }

    #[test]
    fn the_outline_of_a_symbol_is_where_its_distance_is_0() {
        for (_, symbol) in Symbol::NAMED {
            let rings = outline(symbol, 10.0);
            assert!(!rings.is_empty() && rings.iter().all(|ring| ring.len() >= 3));
            for (a, b) in rings.iter().flat_map(|ring| ring.iter().zip(ring.iter().cycle().skip(1))) {
                for t in [0.0, 0.5] {
                    let d = symbol::distance(symbol, a.lerp(*b, t).as_vec2(), 10.0);
                    assert!(d.abs() < 0.02, "{symbol:?}: {d} at {}", a.lerp(*b, t));
                }
            }
        }
    }
}
