//! Features of a FlatGeobuf: geometries and properties.

use super::buffer::Table;
use crate::vector::collected::Collected;
use crate::vector::{Geometry, Vertex, shorten, vertex};
use std::collections::BTreeMap;

/// Deepest nesting of geometries.
const MAX_DEPTH: usize = 16;

/// A column of properties.
pub(super) struct Column {
    name: String,
    kind: u8,
}

impl Column {
    /// The columns in a field of a header or feature.
    pub(super) fn of(table: &Table<'_>, field: usize) -> Vec<Self> {
        let column = |column: Table<'_>| Self {
            name: column.text(0).map(|name| shorten(&name)).unwrap_or_default(),
            kind: column.bytes(1).map_or(0, |[kind]| kind),
        };
        table.tables(field).map(column).collect()
    }
}

/// The features of a file, and counts of what is left out.
pub(super) struct Features<'c> {
    /// Kind of all geometries; 0 = each states its own.
    kind: u8,
    columns: &'c [Column],
    pub(super) found: Collected,
    pub(super) curves: usize,
    pub(super) odd: usize,
}

/// Why a geometry is left out.
enum Odd {
    Curve,
    NotFinite,
    Damaged,
}

impl<'c> Features<'c> {
    pub(super) fn new(kind: u8, columns: &'c [Column]) -> Self {
        Self { kind, columns, found: Collected::default(), curves: 0, odd: 0 }
    }

    /// Reads all features; why not all could be read, if some were not.
    ///
    /// * `count`: their number; 0 = not known.
    pub(super) fn read(&mut self, mut bytes: &[u8], count: u64) -> Option<String> {
        let mut number = 0u64;
        let of = if count > 0 { format!(" of {count}") } else { String::new() };
        while !bytes.is_empty() {
            let cut = || Some(format!("is cut off after {number}{of} features"));
            let Some((size, rest)) = bytes.split_first_chunk::<4>() else { return cut() };
            let Some((feature, rest)) = rest.split_at_checked(u32::from_le_bytes(*size) as usize) else { return cut() };
            if self.feature(feature).is_none() {
                return Some(format!("is damaged in feature {}{of}", number + 1));
            }
            number += 1;
            bytes = rest;
        }
        (number < count).then(|| format!("is cut off after {number}{of} features"))
    }

    /// Adds a feature; `None` if it is damaged.
    fn feature(&mut self, bytes: &[u8]) -> Option<()> {
        let table = Table::root(bytes)?;
        let own = Column::of(&table, 2);
        let columns = if own.is_empty() { self.columns } else { &own };
        let properties = properties(table.list(1, 1).unwrap_or_default(), columns)?;
        let Some(geometry) = table.table(0) else {
            self.found.without_geometry += 1;
            return Some(());
        };
        let mut shapes = Vec::new();
        // No geometry has more positions or parts than it has room for, however they are repeated.
        let mut reader = Reader { left: bytes.len() / 4, found: &mut self.found };
        match reader.geometry(&geometry, self.kind, MAX_DEPTH, &mut shapes) {
            Ok(()) => shapes.into_iter().for_each(|shape| self.found.add(shape, properties.clone())),
            Err(Odd::Curve) => self.curves += 1,
            Err(Odd::NotFinite) => self.odd += 1,
            Err(Odd::Damaged) => return None,
        }
        Some(())
    }
}

/// Reads one geometry with its parts.
struct Reader<'f> {
    left: usize,
    found: &'f mut Collected,
}

impl Reader<'_> {
    fn spend(&mut self, count: usize) -> Result<(), Odd> {
        self.left = self.left.checked_sub(count).ok_or(Odd::Damaged)?;
        Ok(())
    }

    /// * `kind`: that of its layer or of its place in another geometry, where it states none.
    fn geometry(&mut self, table: &Table<'_>, kind: u8, depth: usize, out: &mut Vec<Geometry>) -> Result<(), Odd> {
        self.spend(1)?;
        let depth = depth.checked_sub(1).ok_or(Odd::Damaged)?;
        let own = table.bytes(6).map_or(0, |[kind]| kind);
        out.push(match if own == 0 { kind } else { own } {
            1 | 4 => Geometry::Points(self.positions(table)?),
            2 => {
                let line = self.positions(table)?;
                Geometry::Lines(self.found.line(line).into_iter().collect())
            }
            5 => {
                let lines = self.parts(table)?;
                Geometry::Lines(lines.into_iter().filter_map(|line| self.found.line(line)).collect())
            }
            3 => Geometry::Polygons(self.polygon(table)?.into_iter().collect()),
            6 => {
                let mut polygons = Vec::new();
                for part in table.tables(7) {
                    self.spend(1)?;
                    polygons.extend(self.polygon(&part)?);
                }
                Geometry::Polygons(polygons)
            }
            7 => {
                let mut parts = table.tables(7);
                return parts.try_for_each(|part| self.geometry(&part, 0, depth, out));
            }
            8..=17 => return Err(Odd::Curve),
            _ => return Err(Odd::Damaged),
        });
        Ok(())
    }

    fn positions(&mut self, table: &Table<'_>) -> Result<Vec<Vertex>, Odd> {
        let numbers = |field: usize| -> Vec<f64> {
            let bytes = table.list(field, 8).unwrap_or_default();
            bytes.as_chunks::<8>().0.iter().map(|b| f64::from_le_bytes(*b)).collect()
        };
        let (xy, z) = (numbers(1), numbers(2));
        self.spend(xy.len() / 2)?;
        let pairs = xy.as_chunks::<2>().0.iter().enumerate();
        let all = pairs.map(|(k, [x, y])| vertex(*x, *y, z.get(k).copied()));
        // An empty point is one of NaN.
        if let [x, y] = xy.as_slice()
            && x.is_nan()
            && y.is_nan()
        {
            return Ok(Vec::new());
        }
        all.collect::<Option<_>>().ok_or(Odd::NotFinite)
    }

    /// The positions of a geometry, divided where its parts end.
    fn parts(&mut self, table: &Table<'_>) -> Result<Vec<Vec<Vertex>>, Odd> {
        let mut positions = self.positions(table)?;
        let ends = table.list(0, 4).unwrap_or_default();
        let mut parts = Vec::new();
        let mut start = 0;
        self.spend(ends.len() / 4)?;
        for end in ends.as_chunks::<4>().0 {
            let end = u32::from_le_bytes(*end) as usize;
            let part = end.checked_sub(start).filter(|part| *part <= positions.len()).ok_or(Odd::Damaged)?;
            let rest = positions.split_off(part);
            parts.push(std::mem::replace(&mut positions, rest));
            start = end;
        }
        // One part needs no ends.
        parts.extend((ends.is_empty() && !positions.is_empty()).then_some(positions));
        Ok(parts)
    }

    fn polygon(&mut self, table: &Table<'_>) -> Result<Option<Vec<Vec<Vertex>>>, Odd> {
        let mut rings = Vec::new();
        for (k, ring) in self.parts(table)?.into_iter().enumerate() {
            match self.found.ring(ring) {
                Some(ring) => rings.push(ring),
                // Without an outer ring its holes mean nothing.
                None if k == 0 => return Ok(None),
                None => {}
            }
        }
        Ok(Some(rings).filter(|rings| !rings.is_empty()))
    }
}

/// The values of a feature as text; `None` if they are damaged. Binary values are left out.
fn properties(mut bytes: &[u8], columns: &[Column]) -> Option<BTreeMap<String, String>> {
    let mut out = BTreeMap::new();
    while !bytes.is_empty() {
        let (column, rest) = bytes.split_first_chunk()?;
        let column = columns.get(usize::from(u16::from_le_bytes(*column)))?;
        let (value, rest) = value(rest, column.kind)?;
        out.extend(value.map(|value| (column.name.clone(), value)));
        bytes = rest;
    }
    Some(out)
}

/// A value and the bytes behind it.
fn value(bytes: &[u8], kind: u8) -> Option<(Option<String>, &[u8])> {
    fn number<const N: usize, T: ToString>(bytes: &[u8], of: fn([u8; N]) -> T) -> Option<(Option<String>, &[u8])> {
        let (number, rest) = bytes.split_first_chunk()?;
        Some((Some(of(*number).to_string()), rest))
    }
    match kind {
        0 => number(bytes, i8::from_le_bytes),
        1 => number(bytes, u8::from_le_bytes),
        2 => number(bytes, |[b]: [u8; 1]| b != 0),
        3 => number(bytes, i16::from_le_bytes),
        4 => number(bytes, u16::from_le_bytes),
        5 => number(bytes, i32::from_le_bytes),
        6 => number(bytes, u32::from_le_bytes),
        7 => number(bytes, i64::from_le_bytes),
        8 => number(bytes, u64::from_le_bytes),
        9 => number(bytes, f32::from_le_bytes),
        10 => number(bytes, f64::from_le_bytes),
        11..=14 => {
            let (size, rest) = bytes.split_first_chunk()?;
            let (text, rest) = rest.split_at_checked(u32::from_le_bytes(*size) as usize)?;
            let text = (kind != 14).then(|| shorten(&String::from_utf8_lossy(text)));
            Some((text, rest))
        }
        _ => None,
    }
}
