//! Areas in plan: from cities to the geometry library and back, grown, shrunk, closed and simplified.

use super::crossings;
use belvedere_core::DVec2;
use belvedere_scene::city::Polygon;
use geo::algorithm::buffer::{BufferStyle, LineCap, LineJoin};
use geo::algorithm::orient::{Direction, Orient};
use geo::{
    Area as _, BooleanOps, Buffer, ConvexHull, Coord, LineString, MinimumRotatedRect, MultiPolygon, Simplify,
    Validation,
};
use rayon::prelude::*;

/// Several polygons, none overlapping another.
pub(super) type Land = MultiPolygon<f64>;

/// Angle between vertices of round outlines, radians.
const ROUND: f64 = 0.5;
/// Outlines that are put together at a time: small unions cost less than one large one.
const AT_ONCE: usize = 64;
/// Pieces smaller than this are rounding, m^2.
const SPECK_M2: f64 = 1e-3;

fn ring(points: &[DVec2]) -> Option<LineString<f64>> {
    (points.len() >= 3 && points.iter().all(|p| p.is_finite()))
        .then(|| LineString::from(points.iter().map(|p| (p.x, p.y)).collect::<Vec<_>>()))
}

/// Crossings of the rings of a polygon up to which they are repaired: what repair costs grows with the crossings, which may be as many
/// as pairs of edges.
pub(super) const MOST_CROSSINGS: usize = 1000;

/// Whether the rings of a polygon cross themselves or each other so often that [`land_of`] takes its convex hull. Polygons of one outline,
/// such as streets, may cross each other.
pub(super) fn is_tangled(polygon: &Polygon) -> bool {
    crossings::exceed(polygon, MOST_CROSSINGS)
}

fn hull(polygon: &Polygon) -> Land {
    let points = polygon.outer.iter().filter(|p| p.is_finite());
    let points: LineString<f64> = points.map(|p| (p.x, p.y)).collect::<Vec<_>>().into();
    one(points.convex_hull())
}

/// The land of an outline; rings that cross themselves or each other are repaired, or replaced by their convex hull where they are tangled
/// ([`is_tangled`]); rings that are not finite are left out.
pub(super) fn land_of(polygons: &[Polygon]) -> Land {
    let parts: Vec<Land> = polygons
        .iter()
        .filter_map(|p| {
            if is_tangled(p) {
                return Some(hull(p));
            }
            let holes = p.holes.iter().filter_map(|h| ring(h)).collect();
            let polygon = geo::Polygon::new(ring(&p.outer)?, holes);
            // The rule of odd and even crossings needs no orientation of rings.
            Some(if polygon.is_valid() { polygon.orient(Direction::Default).into() } else { polygon.union(&nothing()) })
        })
        .collect();
    without_specks(if parts.len() == 1 {
        parts.into_iter().next().unwrap_or_else(nothing)
    } else {
        geo::unary_union(&parts)
    })
}

/// The polygons of a city, rings oriented as it wants them.
pub(super) fn polygons_of(land: &Land) -> Vec<Polygon> {
    let turned = |ring: &LineString<f64>, left: bool| {
        let mut points: Vec<DVec2> = ring.coords().map(|c| DVec2::new(c.x, c.y)).collect();
        points.pop();
        let twice: f64 = points.iter().zip(points.iter().cycle().skip(1)).map(|(a, b)| a.x * b.y - b.x * a.y).sum();
        if (twice > 0.0) != left {
            points.reverse();
        }
        points
    };
    let polygon = |p: &geo::Polygon<f64>| Polygon {
        outer: turned(p.exterior(), true),
        holes: p.interiors().iter().map(|h| turned(h, false)).collect(),
    };
    land.iter().map(polygon).filter(|p| p.outer.len() >= 3).collect()
}

/// Everything within `by` metres of the land; corners are rounded.
pub(super) fn grown(land: &Land, by: f64) -> Land {
    land.buffer_with_style(BufferStyle::new(by).line_join(LineJoin::Round(ROUND)))
}

/// Everything within `by` metres of the land; corners stay corners.
pub(super) fn widened(land: &Land, by: f64) -> Land {
    land.buffer_with_style(BufferStyle::new(by).line_join(LineJoin::Miter(1.0)))
}

/// The land further than `by` metres inside; corners stay corners.
pub(super) fn shrunk(land: &Land, by: f64) -> Land {
    if by <= 0.0 {
        return land.clone();
    }
    without_specks(land.buffer_with_style(BufferStyle::new(-by).line_join(LineJoin::Miter(1.0))))
}

/// The land with gaps up to `2 by` metres wide filled.
pub(super) fn closed(land: &Land, by: f64) -> Land {
    let shrink = BufferStyle::new(-by).line_join(LineJoin::Round(ROUND));
    without_specks(grown(land, by).buffer_with_style(shrink))
}

/// The land within `half_width` metres of a line.
pub(super) fn along(line: &LineString<f64>, half_width: f64) -> Land {
    let style = BufferStyle::new(half_width).line_join(LineJoin::Round(ROUND)).line_cap(LineCap::Round(ROUND));
    line.buffer_with_style(style)
}

/// Everything that lies in one of `parts`, which should lie near their neighbours in the list.
pub(super) fn union(mut parts: Vec<Land>) -> Land {
    while parts.len() > 1 {
        parts = parts.par_chunks(AT_ONCE).map(geo::unary_union).collect();
    }
    parts.pop().unwrap_or_else(|| MultiPolygon(Vec::new()))
}

/// `parts` in an order in which neighbours in the list are neighbours in the plane.
pub(super) fn by_place(mut parts: Vec<Land>) -> Vec<Land> {
    const BITS: u32 = 10;
    let corner = |land: &Land| land.iter().next().and_then(|p| p.exterior().coords().next().copied());
    let corners: Vec<Coord<f64>> = parts.iter().filter_map(corner).collect();
    let low = corners.iter().fold(DVec2::MAX, |low, c| low.min(DVec2::new(c.x, c.y)));
    let high = corners.iter().fold(DVec2::MIN, |high, c| high.max(DVec2::new(c.x, c.y)));
    let scale = f64::from((1u32 << BITS) - 1) / (high - low).max_element().max(1e-9);
    let interleave = |at: Coord<f64>| {
        let cell = ((DVec2::new(at.x, at.y) - low) * scale).as_uvec2();
        (0..BITS).fold(0u32, |key, bit| key | (cell.x >> bit & 1) << (2 * bit) | (cell.y >> bit & 1) << (2 * bit + 1))
    };
    parts.sort_by_cached_key(|land| corner(land).map_or(0, interleave));
    parts
}

/// Land without the pieces that rounding leaves.
pub(super) fn without_specks(mut land: Land) -> Land {
    land.0.retain(|p| p.unsigned_area() > SPECK_M2);
    land
}

/// The land with its holes filled.
pub(super) fn filled(land: Land) -> Land {
    let whole: Vec<geo::Polygon<f64>> =
        land.into_iter().map(|p| geo::Polygon::new(p.into_inner().0, Vec::new())).collect();
    geo::unary_union(&whole)
}

/// The land with those holes filled that are smaller than `below` m^2, but for those with something of `kept` in them.
pub(super) fn filled_below(land: &Land, kept: &Land, below: f64) -> Land {
    let stays = |hole: &LineString<f64>| {
        let hole = geo::Polygon::new(hole.clone(), Vec::new());
        hole.unsigned_area() >= below || (!kept.0.is_empty() && !common(&one(hole), kept).0.is_empty())
    };
    let of = |p: &geo::Polygon<f64>| {
        let holes = p.interiors().iter().filter(|h| stays(h)).cloned().collect();
        geo::Polygon::new(p.exterior().clone(), holes)
    };
    MultiPolygon(land.iter().map(of).collect())
}

/// The least rectangle round an outline of more than four corners, if the outline fills at least `share` of it.
pub(super) fn rectangle_round(polygon: &geo::Polygon<f64>, share: f64) -> Option<geo::Polygon<f64>> {
    if polygon.exterior().0.len() <= 5 && polygon.interiors().is_empty() {
        return Some(polygon.clone());
    }
    // Unions and buffers need the outer ring counter-clockwise.
    let rectangle = polygon.minimum_rotated_rect()?.orient(Direction::Default);
    (polygon.unsigned_area() >= share * rectangle.unsigned_area()).then_some(rectangle)
}

/// One polygon as land.
pub(super) fn one(polygon: geo::Polygon<f64>) -> Land {
    MultiPolygon(vec![polygon])
}

/// The land with outlines of fewer vertices, none moved by more than `by` metres; what then would cross itself is put in order.
pub(super) fn simplified(land: &Land, by: f64) -> Land {
    let simple = |polygon: &geo::Polygon<f64>| {
        let size = polygon.unsigned_area();
        let kept = |land: &Land| (0.7 * size..1.4 * size).contains(&area(land));
        let mut tolerance = by;
        while tolerance > 0.05 {
            let simple = polygon.simplify(tolerance);
            let simple = if simple.is_valid() { one(simple) } else { without_specks(simple.union(&nothing())) };
            if kept(&simple) {
                return simple;
            }
            tolerance *= 0.5;
        }
        one(polygon.clone())
    };
    MultiPolygon(land.iter().flat_map(simple).collect())
}

fn nothing() -> Land {
    MultiPolygon(Vec::new())
}

/// The land with outlines that touch themselves, or each other within a polygon, grown together there.
pub(super) fn parted(land: Land) -> Land {
    const TOUCH_M: f64 = 0.02;
    let key = |c: &Coord<f64>| [c.x, c.y].map(|v| (v * 200.0).round() as i64);
    let touches = |p: &geo::Polygon<f64>| {
        let rings = std::iter::once(p.exterior()).chain(p.interiors());
        let mut keys: Vec<_> = rings.flat_map(|r| r.0.iter().skip(1)).map(key).collect();
        let corners = keys.len();
        keys.sort_unstable();
        keys.dedup();
        keys.len() < corners
    };
    let of = |p: geo::Polygon<f64>| {
        if !touches(&p) {
            return one(p);
        }
        let wide = simplified(&grown(&one(p), 5.0 * TOUCH_M), 2.0 * TOUCH_M);
        MultiPolygon(wide.into_iter().map(|p| p.simplify(TOUCH_M)).collect())
    };
    MultiPolygon(land.into_iter().flat_map(of).collect())
}

/// The part of `land` that lies in `other`.
pub(super) fn common(land: &Land, other: &Land) -> Land {
    without_specks(land.intersection(other))
}

/// Area, m^2.
pub(super) fn area(land: &Land) -> f64 {
    land.unsigned_area()
}

/// Triangles of the land as prisms: roofs and walls.
pub(super) fn triangles(land: &Land) -> usize {
    let of = |p: &geo::Polygon<f64>| {
        let rings = std::iter::once(p.exterior()).chain(p.interiors());
        let corners: usize = rings.map(|r| r.0.len().saturating_sub(1)).sum();
        3 * corners + 2 * p.interiors().len() - 2
    };
    land.iter().filter(|p| p.exterior().0.len() > 3).map(of).sum()
}
