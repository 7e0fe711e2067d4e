//! Geometries of GeoPackage: a header of its own (OGC 12-128r19, 2.1.3), then well-known binary, which the crate `wkb` reads.

use super::{Geometry, vertex};
use crate::vector::Vertex;
use belvedere_core::{Warning, WarningKind};
use geo_traits::{
    CoordTrait, Dimensions, GeometryCollectionTrait, GeometryTrait, GeometryType, LineStringTrait,
    MultiLineStringTrait, MultiPointTrait, MultiPolygonTrait, PointTrait, PolygonTrait,
};

/// Numbers of oddities among the features of a table.
#[derive(Debug, Default)]
pub(super) struct Odd {
    pub(super) without_geometry: usize,
    other_system: usize,
    short_lines: usize,
    short_rings: usize,
    not_finite: usize,
}

impl Odd {
    /// One sentence for each kind of oddity that occurred.
    pub(super) fn warnings(&self, table: &str) -> impl Iterator<Item = Warning> {
        use WarningKind::{Ignored, Repaired};
        let of = |kind: WarningKind, count: usize, what: &str| {
            Warning::counted(kind, count, what).map(|w| w.placed(format_args!("table \"{table}\"")))
        };
        [
            of(Ignored, self.without_geometry, "features without geometry were dropped"),
            of(
                Repaired,
                self.other_system,
                "features name another coordinate system than their table; that of the table was taken",
            ),
            of(Ignored, self.not_finite, "points, lines and rings with positions that are not finite were dropped"),
            of(Ignored, self.short_lines, "lines of fewer than 2 points were dropped"),
            of(Ignored, self.short_rings, "polygon rings of fewer than 3 points were dropped"),
        ]
        .into_iter()
        .flatten()
    }
}

/// The geometries of a value, several of a collection, none of an empty one.
///
/// * `srs_id`: system of its table.
pub(super) fn geometries(blob: &[u8], srs_id: i64, odd: &mut Odd) -> Result<Vec<Geometry>, String> {
    let header = Header::of(blob)?;
    odd.other_system += usize::from(i64::from(header.srs_id) != srs_id);
    let mut out = Vec::new();
    if !header.empty {
        straight(header.wkb)?;
        let wkb = wkb::reader::read_wkb(header.wkb)
            .map_err(|e| format!("its well-known binary is damaged ({e}); get the file again"))?;
        gather(&wkb, odd, &mut out);
    }
    out.retain(|geometry| geometry.vertices().next().is_some());
    odd.without_geometry += usize::from(out.is_empty());
    Ok(out)
}

/// The header before the well-known binary.
struct Header<'b> {
    srs_id: i32,
    empty: bool,
    wkb: &'b [u8],
}

impl<'b> Header<'b> {
    fn of(blob: &'b [u8]) -> Result<Self, String> {
        let short = || format!("its geometry of {} bytes is cut off; get the file again", blob.len());
        let head: &[u8; 8] = blob.first_chunk().ok_or_else(short)?;
        let [b'G', b'P', _, flags, srs_id @ ..] = head else {
            let [a, b, ..] = head;
            return Err(format!(
                "its geometry begins with the bytes {a:02x} {b:02x}, not with \"GP\"; export the file again"
            ));
        };
        if flags & 0x20 != 0 {
            return Err("its geometry is of an extended type that is not read; export it as a standard one".into());
        }
        let srs_id = if flags & 1 == 1 { i32::from_le_bytes(*srs_id) } else { i32::from_be_bytes(*srs_id) };
        let envelope = match flags >> 1 & 7 {
            0 => 0,
            1 => 32,
            2 | 3 => 48,
            4 => 64,
            code => return Err(format!("its envelope is of kind {code}, the last is 4; export the file again")),
        };
        let wkb = blob.get(8 + envelope..).ok_or_else(short)?;
        Ok(Self { srs_id, empty: flags & 0x10 != 0, wkb })
    }
}

/// Refuses kinds other than points, straight lines and polygons, by name.
fn straight(wkb: &[u8]) -> Result<(), String> {
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
    let Some(&[order, rest @ ..]) = wkb.first_chunk::<5>() else { return Ok(()) };
    let code = if order == 0 { u32::from_be_bytes(rest) } else { u32::from_le_bytes(rest) };
    match usize::try_from(code % 1000).ok().and_then(|kind| kind.checked_sub(8)).and_then(|k| NAMES.get(k)) {
        Some(name) => Err(format!(
            "its geometry is a {name}, which is not read; ogr2ogr -nlt CONVERT_TO_LINEAR makes straight ones of it"
        )),
        None => Ok(()),
    }
}

fn gather<'a>(g: &'a wkb::reader::Wkb<'a>, odd: &mut Odd, out: &mut Vec<Geometry>) {
    out.push(match g.as_type() {
        GeometryType::Point(p) => Geometry::Points(points([p], odd)),
        GeometryType::MultiPoint(m) => Geometry::Points(points(m.points(), odd)),
        GeometryType::LineString(l) => Geometry::Lines(lines([l], odd)),
        GeometryType::MultiLineString(m) => Geometry::Lines(lines(m.line_strings(), odd)),
        GeometryType::Polygon(p) => Geometry::Polygons(polygon(p, odd).into_iter().collect()),
        GeometryType::MultiPolygon(m) => Geometry::Polygons(m.polygons().filter_map(|p| polygon(p, odd)).collect()),
        // The crate bounds their nesting.
        GeometryType::GeometryCollection(c) => return c.geometries().for_each(|g| gather(g, odd, out)),
        // Kinds that well-known binary lacks.
        GeometryType::Rect(_) | GeometryType::Triangle(_) | GeometryType::Line(_) => return,
    });
}

/// A position; its third number is the height unless it is a measure; `None` if it is not finite.
fn position(c: &impl CoordTrait<T = f64>) -> Option<Vertex> {
    let z = matches!(c.dim(), Dimensions::Xyz | Dimensions::Xyzm).then(|| c.nth(2)).flatten();
    vertex(c.x(), c.y(), z)
}

fn points<P: PointTrait<T = f64>>(points: impl IntoIterator<Item = P>, odd: &mut Odd) -> Vec<Vertex> {
    let mut out = Vec::new();
    // An empty point is one of NaN.
    for c in points.into_iter().filter_map(|p| p.coord().map(|c| (position(&c), c.x().is_nan() && c.y().is_nan()))) {
        match c {
            (Some(p), _) => out.push(p),
            (None, empty) => odd.not_finite += usize::from(!empty),
        }
    }
    out
}

/// All positions of a line or ring; `None`, and counted, if one is not finite.
fn positions(line: &impl LineStringTrait<T = f64>, odd: &mut Odd) -> Option<Vec<Vertex>> {
    let all = line.coords().map(|c| position(&c)).collect();
    odd.not_finite += usize::from(Option::is_none(&all));
    all
}

fn lines<L: LineStringTrait<T = f64>>(lines: impl IntoIterator<Item = L>, odd: &mut Odd) -> Vec<Vec<Vertex>> {
    let mut out = Vec::new();
    for line in lines.into_iter().filter(|l| l.num_coords() > 0) {
        match positions(&line, odd) {
            Some(line) if line.len() >= 2 => out.push(line),
            Some(_) => odd.short_lines += 1,
            None => {}
        }
    }
    out
}

/// The rings of a polygon, outer first; `None` without an outer one.
fn polygon<P: PolygonTrait<T = f64>>(polygon: P, odd: &mut Odd) -> Option<Vec<Vec<Vertex>>> {
    let mut rings = vec![ring(&polygon.exterior()?, odd)?];
    for hole in polygon.interiors() {
        rings.extend(ring(&hole, odd));
    }
    Some(rings)
}

fn ring(line: &impl LineStringTrait<T = f64>, odd: &mut Odd) -> Option<Vec<Vertex>> {
    if line.num_coords() == 0 {
        return None;
    }
    let mut ring = positions(line, odd)?;
    if ring.len() > 1 && ring.first().map(|v| v.xy) == ring.last().map(|v| v.xy) {
        ring.pop();
    }
    odd.short_rings += usize::from(ring.len() < 3);
    (ring.len() >= 3).then_some(ring)
}
