//! Blocks of OpenStreetMap's PBF: nodes, ways and relations as protocol buffers.
//!
//! Source: fileformat.proto and osmformat.proto of OSM-binary. A file is a row of blobs, each behind a header; a blob of data holds a
//! table of strings and groups of elements. Numbers that rise are written as differences.

use flate2::read::ZlibDecoder;
use std::collections::BTreeMap;
use std::io::Read;

pub(super) type Tags = BTreeMap<String, String>;

/// Largest header and largest block, bytes, as the format defines them.
const MAX_HEADER: usize = 64 << 10;
const MAX_BLOCK: usize = 32 << 20;
/// Type of a relation's member that is a way, and the largest type.
const WAY: u64 = 1;
const LAST_TYPE: u64 = 2;

/// Elements that a pass over a file asks for.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Kind {
    Node,
    Way,
    Relation,
}

#[derive(Debug, Clone, PartialEq)]
pub(super) enum Element {
    /// Id, longitude and latitude in degrees.
    Node(i64, f64, f64),
    /// Id, tags and the ids of its nodes.
    Way(i64, Tags, Vec<i64>),
    /// Id, tags and the ids of its members that are ways.
    Relation(i64, Tags, Vec<i64>),
}

/// Calls `take` with every element of a kind, in the order of the file.
///
/// # Errors
/// What is wrong with the file, in a few words.
pub(super) fn each(mut file: &[u8], kind: Kind, take: &mut dyn FnMut(Element)) -> Result<(), String> {
    while !file.is_empty() {
        let length = split(&mut file, 4)?.iter().fold(0, |n, byte| n << 8 | usize::from(*byte));
        if length > MAX_HEADER {
            return Err(format!("the header of a blob has {length} bytes, at most {MAX_HEADER} are allowed"));
        }
        let (mut name, mut size) = (&[][..], None);
        for field in Message(split(&mut file, length)?) {
            match field? {
                (1, Value::Bytes(text)) => name = text,
                (3, Value::Number(n)) => size = usize::try_from(n).ok(),
                _ => {}
            }
        }
        let blob = split(&mut file, size.ok_or("a blob without its size")?)?;
        if name == b"OSMData" {
            block(&unpacked(blob)?, kind, take)?;
        }
    }
    Ok(())
}

fn split<'b>(bytes: &mut &'b [u8], count: usize) -> Result<&'b [u8], String> {
    let (head, rest) = bytes.split_at_checked(count).ok_or("it ends within a blob")?;
    *bytes = rest;
    Ok(head)
}

/// Content of a blob.
fn unpacked(blob: &[u8]) -> Result<Vec<u8>, String> {
    for field in Message(blob) {
        match field? {
            (1, Value::Bytes(raw)) => return Ok(raw.to_vec()),
            (3, Value::Bytes(packed)) => {
                let mut out = Vec::new();
                let read = ZlibDecoder::new(packed).take(MAX_BLOCK as u64 + 1).read_to_end(&mut out);
                read.map_err(|e| format!("a block that cannot be unpacked: {e}"))?;
                return if out.len() > MAX_BLOCK { Err(format!("a block of over {MAX_BLOCK} bytes")) } else { Ok(out) };
            }
            (4..=7, Value::Bytes(_)) => return Err("a block is packed by another method than zlib".into()),
            _ => {}
        }
    }
    Err("a blob without content".into())
}

/// Strings and units of a block.
struct Context<'b> {
    strings: Vec<&'b [u8]>,
    /// Unit of coordinates, and longitude and latitude of their origin, 1e-9 degrees.
    unit: i64,
    origin: [i64; 2],
}

fn block(bytes: &[u8], kind: Kind, take: &mut dyn FnMut(Element)) -> Result<(), String> {
    let mut context = Context { strings: Vec::new(), unit: 100, origin: [0; 2] };
    let mut groups = Vec::new();
    for field in Message(bytes) {
        match field? {
            (1, Value::Bytes(table)) => {
                for string in Message(table) {
                    if let (1, Value::Bytes(text)) = string? {
                        context.strings.push(text);
                    }
                }
            }
            (2, Value::Bytes(group)) => groups.push(group),
            (17, Value::Number(n)) => context.unit = n as i64,
            (19, Value::Number(n)) => context.origin[1] = n as i64,
            (20, Value::Number(n)) => context.origin[0] = n as i64,
            _ => {}
        }
    }
    for field in groups.into_iter().flat_map(Message) {
        match (kind, field?) {
            (Kind::Node, (1, Value::Bytes(node))) => take(context.node(node)?),
            (Kind::Node, (2, Value::Bytes(nodes))) => context.dense(nodes, take)?,
            (Kind::Way, (3, Value::Bytes(way))) => take(context.way(way)?),
            (Kind::Relation, (4, Value::Bytes(relation))) => take(context.relation(relation)?),
            _ => {}
        }
    }
    Ok(())
}

/// Unsigned value of a number that is written with its sign in the last bit.
fn signed(n: u64) -> i64 {
    (n >> 1) as i64 ^ -((n & 1) as i64)
}

/// Values of a list of differences.
fn sums(differences: &[u64]) -> impl Iterator<Item = i64> + '_ {
    differences.iter().scan(0i64, |sum, n| {
        *sum = sum.wrapping_add(signed(*n));
        Some(*sum)
    })
}

impl Context<'_> {
    fn at(&self, id: i64, lon: i64, lat: i64) -> Element {
        let degrees = |n: i64, origin: i64| 1e-9 * origin.wrapping_add(self.unit.wrapping_mul(n)) as f64;
        Element::Node(id, degrees(lon, self.origin[0]), degrees(lat, self.origin[1]))
    }

    fn node(&self, bytes: &[u8]) -> Result<Element, String> {
        let [mut id, mut lon, mut lat] = [0; 3];
        for field in Message(bytes) {
            match field? {
                (1, Value::Number(n)) => id = signed(n),
                (8, Value::Number(n)) => lat = signed(n),
                (9, Value::Number(n)) => lon = signed(n),
                _ => {}
            }
        }
        Ok(self.at(id, lon, lat))
    }

    fn dense(&self, bytes: &[u8], take: &mut dyn FnMut(Element)) -> Result<(), String> {
        let [ids, lats, lons] = lists(bytes, [1, 8, 9])?;
        if ids.len() != lats.len() || ids.len() != lons.len() {
            return Err("its blocks contradict themselves: not as many positions as nodes".into());
        }
        sums(&ids).zip(sums(&lats)).zip(sums(&lons)).for_each(|((id, lat), lon)| take(self.at(id, lon, lat)));
        Ok(())
    }

    fn way(&self, bytes: &[u8]) -> Result<Element, String> {
        let [id, keys, values, nodes] = lists(bytes, [1, 2, 3, 8])?;
        Ok(Element::Way(last(&id), self.tags(&keys, &values)?, sums(&nodes).collect()))
    }

    fn relation(&self, bytes: &[u8]) -> Result<Element, String> {
        let [id, keys, values, members, types] = lists(bytes, [1, 2, 3, 9, 10])?;
        if members.len() != types.len() || types.iter().any(|t| *t > LAST_TYPE) {
            return Err("its blocks contradict themselves: members of unknown types".into());
        }
        let ways = sums(&members).zip(&types).filter(|(_, t)| **t == WAY).map(|(member, _)| member);
        Ok(Element::Relation(last(&id), self.tags(&keys, &values)?, ways.collect()))
    }

    /// Tags by the numbers of their strings; those that are not UTF-8 are left out.
    fn tags(&self, keys: &[u64], values: &[u64]) -> Result<Tags, String> {
        let string = |n: &u64| usize::try_from(*n).ok().and_then(|n| self.strings.get(n).copied());
        let mut tags = Tags::new();
        for (key, value) in keys.iter().zip(values) {
            let pair = string(key).zip(string(value)).ok_or("its blocks contradict themselves: a tag without text")?;
            if let (Ok(key), Ok(value)) = (std::str::from_utf8(pair.0), std::str::from_utf8(pair.1)) {
                tags.insert(key.to_owned(), value.to_owned());
            }
        }
        Ok(tags)
    }
}

/// Of a field that is written again the last value counts; 0 where it is missing.
fn last(values: &[u64]) -> i64 {
    values.last().map_or(0, |n| *n as i64)
}

/// Numbers in these fields of a message, packed or one by one.
fn lists<const N: usize>(bytes: &[u8], fields: [u64; N]) -> Result<[Vec<u64>; N], String> {
    let mut lists = [(); N].map(|()| Vec::new());
    for field in Message(bytes) {
        let (number, value) = field?;
        let Some(at) = fields.iter().position(|f| *f == number) else { continue };
        match value {
            Value::Number(n) => lists[at].push(n),
            Value::Bytes(mut packed) => {
                while !packed.is_empty() {
                    lists[at].push(varint(&mut packed)?);
                }
            }
        }
    }
    Ok(lists)
}

/// A value of a message; those of fixed width are skipped, for no field that is read has one.
enum Value<'b> {
    Number(u64),
    Bytes(&'b [u8]),
}

/// The fields of a message, by number.
struct Message<'b>(&'b [u8]);

impl<'b> Iterator for Message<'b> {
    type Item = Result<(u64, Value<'b>), String>;

    fn next(&mut self) -> Option<Self::Item> {
        while !self.0.is_empty() {
            match self.field() {
                Ok(None) => {}
                found => {
                    if found.is_err() {
                        self.0 = &[];
                    }
                    return found.transpose();
                }
            }
        }
        None
    }
}

impl<'b> Message<'b> {
    fn field(&mut self) -> Result<Option<(u64, Value<'b>)>, String> {
        let key = varint(&mut self.0)?;
        let value = match key & 7 {
            0 => Value::Number(varint(&mut self.0)?),
            2 => {
                let length = usize::try_from(varint(&mut self.0)?).map_err(|e| e.to_string())?;
                Value::Bytes(split(&mut self.0, length)?)
            }
            1 => return split(&mut self.0, 8).map(|_| None),
            5 => return split(&mut self.0, 4).map(|_| None),
            other => return Err(format!("a field of the unknown type {other}")),
        };
        Ok(Some((key >> 3, value)))
    }
}

/// A number of up to ten bytes, seven bits each, the lowest first.
fn varint(bytes: &mut &[u8]) -> Result<u64, String> {
    let mut value = 0;
    for k in 0..10 {
        let byte = split(bytes, 1)?[0];
        value |= u64::from(byte & 0x7f) << (7 * k);
        if byte < 0x80 {
            return Ok(value);
        }
    }
    Err("a number of more than ten bytes".into())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_read_as_the_encoding_defines_them() {
        let mut bytes = &[0x96, 0x01, 0x00, 0xff, 0xff, 0xff, 0xff, 0xff, 0xff, 0xff, 0xff, 0xff, 0x01][..];
        assert_eq!([varint(&mut bytes), varint(&mut bytes), varint(&mut bytes)], [Ok(150), Ok(0), Ok(u64::MAX)]);
        assert!(varint(&mut bytes).is_err() && varint(&mut &[0x80; 11][..]).is_err());
        assert_eq!([0, 1, 2, 3, u64::MAX].map(signed), [0, -1, 1, -2, i64::MIN]);
        assert_eq!(sums(&[4, 1, 2]).collect::<Vec<_>>(), [2, 1, 2]);
    }

    #[test]
    fn nodes_are_read_one_by_one_too_and_fields_of_fixed_width_are_skipped() {
        // Id -2, eight bytes of field 3, latitude 15, longitude -14, four bytes of field 4.
        let node = [0x08, 3, 0x19, 1, 2, 3, 4, 5, 6, 7, 8, 0x40, 30, 0x48, 27, 0x25, 1, 2, 3, 4];
        let context = Context { strings: Vec::new(), unit: 1_000_000_000, origin: [0, 1_000_000_000] };
        assert_eq!(context.node(&node), Ok(Element::Node(-2, -14.0, 16.0)));
        assert!(context.node(&node[..10]).is_err() && context.node(&[0x0b]).is_err());
    }
}
