//! Geometries as well-known text: points, straight lines, polygons and collections of them, with heights and measures, and the number of a
//! system before them, as PostGIS writes it.

use super::collected::Collected;
use super::{Geometry, Vertex, vertex};

/// Deepest nesting of collections.
const MAX_DEPTH: usize = 32;

/// Geometries of a text, and the number of their system.
#[derive(Default)]
pub(super) struct Shapes {
    pub(super) geometries: Vec<Geometry>,
    pub(super) srid: Option<u32>,
}

/// The geometries of a text; `None` if it cannot be read.
///
/// * `found`: counts lines and rings that are too short.
pub(super) fn read(text: &str, found: &mut Collected) -> Option<Shapes> {
    let mut shapes = Shapes::default();
    let mut rest = text.trim();
    if let Some((head, tail)) = rest.split_once(';') {
        let (key, number) = head.split_once('=')?;
        shapes.srid = number.trim().parse().ok().filter(|_| key.trim().eq_ignore_ascii_case("SRID"));
        shapes.srid?;
        rest = tail;
    }
    let mut reader = Reader { rest, found };
    reader.geometry(MAX_DEPTH, &mut shapes.geometries)?;
    reader.rest.trim().is_empty().then_some(shapes)
}

/// The text that follows.
struct Reader<'t, 'f> {
    rest: &'t str,
    found: &'f mut Collected,
}

impl<'t> Reader<'t, '_> {
    fn word(&mut self) -> &'t str {
        let rest = self.rest.trim_start();
        let (word, rest) = rest.split_at(rest.find(|c: char| !c.is_ascii_alphabetic()).unwrap_or(rest.len()));
        self.rest = rest;
        word
    }

    /// Takes a sign, if it is the next.
    fn sign(&mut self, sign: char) -> bool {
        let after = self.rest.trim_start().strip_prefix(sign);
        self.rest = after.unwrap_or(self.rest);
        after.is_some()
    }

    /// A list in parentheses; empty for the word EMPTY.
    fn list<T>(&mut self, mut item: impl FnMut(&mut Self) -> Option<T>) -> Option<Vec<T>> {
        let mut out = Vec::new();
        if !self.sign('(') {
            return self.word().eq_ignore_ascii_case("EMPTY").then_some(out);
        }
        loop {
            out.push(item(self)?);
            if !self.sign(',') {
                break;
            }
        }
        self.sign(')').then_some(out)
    }

    fn geometry(&mut self, left: usize, out: &mut Vec<Geometry>) -> Option<()> {
        let left = left.checked_sub(1)?;
        let kind = self.word().to_ascii_uppercase();
        let before = self.rest;
        let marks = ["ZM", "Z", "M"];
        let has = |mark: &str| kind.len() > mark.len() + 3 && kind.ends_with(mark);
        // The mark stands alone or at the end of the word.
        let mark = match marks.iter().find(|mark| has(mark)) {
            Some(mark) => *mark,
            None => {
                let word = self.word();
                let mark = marks.iter().find(|mark| word.eq_ignore_ascii_case(mark)).copied();
                self.rest = if mark.is_some() { self.rest } else { before };
                mark.unwrap_or("")
            }
        };
        let kind = kind.strip_suffix(mark).filter(|_| has(mark)).unwrap_or(&kind);
        let has_height = mark != "M";
        out.push(match kind {
            "POINT" => Geometry::Points(self.list(|r| r.position(has_height))?),
            "MULTIPOINT" => Geometry::Points(self.list(|r| r.point(has_height))?),
            "LINESTRING" => Geometry::Lines(self.line(has_height)?.into_iter().collect()),
            "MULTILINESTRING" => Geometry::Lines(self.list(|r| r.line(has_height))?.into_iter().flatten().collect()),
            "POLYGON" => Geometry::Polygons(self.polygon(has_height)?.into_iter().collect()),
            "MULTIPOLYGON" => Geometry::Polygons(self.list(|r| r.polygon(has_height))?.into_iter().flatten().collect()),
            "GEOMETRYCOLLECTION" => return self.list(|r| r.geometry(left, out)).map(drop),
            _ => return None,
        });
        Some(())
    }

    /// A point of several, with or without parentheses of its own.
    fn point(&mut self, has_height: bool) -> Option<Vertex> {
        let is_open = self.sign('(');
        let point = self.position(has_height)?;
        (!is_open || self.sign(')')).then_some(point)
    }

    fn position(&mut self, has_height: bool) -> Option<Vertex> {
        let end = self.rest.find([',', ')']).unwrap_or(self.rest.len());
        let (numbers, rest) = self.rest.split_at(end);
        self.rest = rest;
        let numbers: Option<Vec<f64>> = numbers.split_whitespace().map(|number| number.parse().ok()).collect();
        match numbers?.as_slice() {
            [x, y, rest @ ..] if rest.len() <= 2 => vertex(*x, *y, rest.first().copied().filter(|_| has_height)),
            _ => None,
        }
    }

    /// A line, if it is one.
    fn line(&mut self, has_height: bool) -> Option<Option<Vec<Vertex>>> {
        let line = self.list(|r| r.position(has_height))?;
        Some(if line.is_empty() { None } else { self.found.line(line) })
    }

    /// A polygon, if it has an outer ring.
    fn polygon(&mut self, has_height: bool) -> Option<Option<Vec<Vec<Vertex>>>> {
        let rings = self.list(|r| r.list(|r| r.position(has_height)))?;
        let rings: Vec<Option<Vec<Vertex>>> = rings.into_iter().map(|ring| self.found.ring(ring)).collect();
        let has_outer = rings.first().is_some_and(Option::is_some);
        Some(has_outer.then(|| rings.into_iter().flatten().collect()))
    }
}
