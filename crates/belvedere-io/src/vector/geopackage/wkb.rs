//! Well-known binary: points, straight lines, polygons and collections of them, in both byte orders, with heights and measures (OGC
//! 06-103r4, and the marks of PostGIS).

use super::odd::Odd;
use super::{Geometry, vertex};
use crate::vector::Vertex;

/// Deepest nesting of collections.
const MAX_DEPTH: usize = 32;
/// Marks of PostGIS: heights, measures, and the number of a system.
const HEIGHTS: u32 = 0x8000_0000;
const MEASURES: u32 = 0x4000_0000;
const SYSTEM: u32 = 0x2000_0000;

/// Adds the geometries of a value; those of a collection one by one.
///
/// # Errors
/// A predicate for values that are cut off, and for curves.
pub(super) fn read(bytes: &[u8], odd: &mut Odd, out: &mut Vec<Geometry>) -> Result<(), String> {
    Reader { bytes, odd }.geometry(MAX_DEPTH, out)
}

/// What follows, and counts of what is left out.
struct Reader<'b, 'o> {
    bytes: &'b [u8],
    odd: &'o mut Odd,
}

/// Byte order and numbers of a geometry.
#[derive(Clone, Copy)]
struct Layout {
    little: bool,
    has_height: bool,
    has_measure: bool,
}

impl Layout {
    fn numbers(self) -> usize {
        2 + usize::from(self.has_height) + usize::from(self.has_measure)
    }
}

fn damaged(what: &str) -> String {
    format!("its well-known binary is damaged ({what}); get the file again")
}

impl Reader<'_, '_> {
    fn bytes<const N: usize>(&mut self) -> Result<[u8; N], String> {
        let (bytes, rest) = self.bytes.split_first_chunk().ok_or_else(|| damaged("it is cut off"))?;
        self.bytes = rest;
        Ok(*bytes)
    }

    fn number(&mut self, little: bool) -> Result<u32, String> {
        let bytes = self.bytes()?;
        Ok(if little { u32::from_le_bytes(bytes) } else { u32::from_be_bytes(bytes) })
    }

    /// A count of parts of at least `least` bytes each.
    fn count(&mut self, layout: Layout, least: usize) -> Result<usize, String> {
        let count = self.number(layout.little)? as usize;
        if count > self.bytes.len() / least {
            return Err(damaged("it is cut off, or counts more than it holds"));
        }
        Ok(count)
    }

    /// The kind of a geometry, 1 to 7, and how its numbers are stored.
    fn head(&mut self) -> Result<(u32, Layout), String> {
        let little = match self.bytes::<1>()? {
            [0] => false,
            [1] => true,
            [_] => return Err(damaged("its byte order is neither 0 nor 1")),
        };
        let code = self.number(little)?;
        if code & SYSTEM != 0 {
            self.number(little)?;
        }
        let plain = code & !(HEIGHTS | MEASURES | SYSTEM);
        let has_height = code & HEIGHTS != 0 || matches!(plain / 1000, 1 | 3);
        let has_measure = code & MEASURES != 0 || matches!(plain / 1000, 2 | 3);
        match (plain / 1000, plain % 1000) {
            (0..=3, kind @ 1..=7) => Ok((kind, Layout { little, has_height, has_measure })),
            (_, kind) => Err(curve(kind).unwrap_or_else(|| damaged(&format!("it is of the kind {code}")))),
        }
    }

    fn geometry(&mut self, left: usize, out: &mut Vec<Geometry>) -> Result<(), String> {
        let left = left.checked_sub(1).ok_or_else(|| damaged("collections nest too deep"))?;
        let (kind, layout) = self.head()?;
        out.push(match kind {
            1 => Geometry::Points(self.point(layout)?.into_iter().collect()),
            2 => Geometry::Lines(self.line(layout)?.into_iter().collect()),
            3 => Geometry::Polygons(self.polygon(layout)?.into_iter().collect()),
            4 => Geometry::Points(self.parts(layout, 1, Self::point)?),
            5 => Geometry::Lines(self.parts(layout, 2, Self::line)?),
            6 => Geometry::Polygons(self.parts(layout, 3, Self::polygon)?),
            _ => {
                let count = self.count(layout, 5)?;
                return (0..count).try_for_each(|_| self.geometry(left, out));
            }
        });
        Ok(())
    }

    /// The parts of a geometry of several, each with a head of its own.
    fn parts<T>(
        &mut self,
        layout: Layout,
        wanted: u32,
        read: impl Fn(&mut Self, Layout) -> Result<Option<T>, String>,
    ) -> Result<Vec<T>, String> {
        let mut out = Vec::new();
        for _ in 0..self.count(layout, 5)? {
            let (kind, layout) = self.head()?;
            if kind != wanted {
                return Err(damaged(&format!("a part is of the kind {kind}, not {wanted}")));
            }
            out.extend(read(self, layout)?);
        }
        Ok(out)
    }

    /// Two or three numbers; the third is the height unless it is a measure.
    fn position(&mut self, layout: Layout) -> Result<[f64; 3], String> {
        let mut out = [f64::NAN; 4];
        for number in out.iter_mut().take(layout.numbers()) {
            let bytes = self.bytes()?;
            *number = if layout.little { f64::from_le_bytes(bytes) } else { f64::from_be_bytes(bytes) };
        }
        let [x, y, z, _] = out;
        Ok([x, y, if layout.has_height { z } else { f64::NAN }])
    }

    /// A point; an empty one is one of NaN.
    fn point(&mut self, layout: Layout) -> Result<Option<Vertex>, String> {
        let [x, y, z] = self.position(layout)?;
        let point = vertex(x, y, Some(z));
        self.odd.not_finite += usize::from(point.is_none() && !(x.is_nan() && y.is_nan()));
        Ok(point)
    }

    /// All positions of a line or ring; `None`, and counted, if one is not finite.
    fn positions(&mut self, layout: Layout) -> Result<Option<Vec<Vertex>>, String> {
        let count = self.count(layout, 8 * layout.numbers())?;
        let all: Vec<[f64; 3]> = (0..count).map(|_| self.position(layout)).collect::<Result<_, _>>()?;
        let all: Option<Vec<Vertex>> = all.into_iter().map(|[x, y, z]| vertex(x, y, Some(z))).collect();
        self.odd.not_finite += usize::from(all.is_none());
        Ok(all)
    }

    fn line(&mut self, layout: Layout) -> Result<Option<Vec<Vertex>>, String> {
        let line = self.positions(layout)?.filter(|line| !line.is_empty());
        self.odd.short_lines += usize::from(line.as_ref().is_some_and(|line| line.len() < 2));
        Ok(line.filter(|line| line.len() >= 2))
    }

    /// The rings of a polygon, outer first; `None` without an outer one.
    fn polygon(&mut self, layout: Layout) -> Result<Option<Vec<Vec<Vertex>>>, String> {
        let (mut rings, mut has_outer) = (Vec::new(), true);
        for k in 0..self.count(layout, 4)? {
            let ring = self.ring(layout)?;
            has_outer &= k > 0 || ring.is_some();
            rings.extend(ring);
        }
        Ok(Some(rings).filter(|rings| has_outer && !rings.is_empty()))
    }

    fn ring(&mut self, layout: Layout) -> Result<Option<Vec<Vertex>>, String> {
        let Some(mut ring) = self.positions(layout)?.filter(|ring| !ring.is_empty()) else { return Ok(None) };
        if ring.len() > 1 && ring.first().map(|v| v.xy) == ring.last().map(|v| v.xy) {
            ring.pop();
        }
        self.odd.short_rings += usize::from(ring.len() < 3);
        Ok(Some(ring).filter(|ring| ring.len() >= 3))
    }
}

/// The error of a kind of curve or surface, if it is one.
fn curve(kind: u32) -> Option<String> {
    const NAMES: [&str; 10] = [
        "CircularString",
        "CompoundCurve",
        "CurvePolygon",
        "MultiCurve",
        "MultiSurface",
        "Curve",
        "Surface",
        "PolyhedralSurface",
        "TIN",
        "Triangle",
    ];
    let name = NAMES.get(kind.checked_sub(8)? as usize)?;
    Some(format!(
        "its geometry is a {name}, which is not read; ogr2ogr -nlt CONVERT_TO_LINEAR makes straight ones of it"
    ))
}
