//! OpenStreetMap's PBF: blobs of packed blocks. Source: OpenStreetMap Wiki, "PBF Format"; the messages are those of
//! fileformat.proto and osmformat.proto, of which only what is used is named here.

use super::Tags;
use crate::budget::{self, Refusal};
use glam::DVec2;
use prost::Message;
use prost::bytes::Bytes;
use prost::encoding::{WireType, decode_key, decode_varint};
use rayon::prelude::*;
use std::io::Read;

/// Largest header of a blob and largest blob, packed or not, bytes.
const MAX_HEADER: usize = 64 << 10;
const MAX_BLOB: usize = 32 << 20;
/// Blocks that are unpacked at once.
const AT_ONCE: usize = 8;
/// What a file may require of its reader.
const FEATURES: [&str; 3] = ["OsmSchema-V0.6", "DenseNodes", "HistoricalInformation"];

/// Why a file gives no objects.
pub(super) enum Broken {
    /// It is sound, and of a kind that is not understood.
    Unknown(String),
    Memory(Refusal),
    Damaged(String),
}

impl From<Refusal> for Broken {
    fn from(refusal: Refusal) -> Self {
        Self::Memory(refusal)
    }
}

impl From<String> for Broken {
    fn from(why: String) -> Self {
        Self::Damaged(why)
    }
}

impl From<&str> for Broken {
    fn from(why: &str) -> Self {
        why.to_owned().into()
    }
}

#[derive(Clone, PartialEq, Message)]
struct BlobHeader {
    #[prost(string, required, tag = "1")]
    kind: String,
    #[prost(int32, required, tag = "3")]
    size: i32,
}

#[derive(Clone, PartialEq, Message)]
struct Blob {
    #[prost(bytes = "bytes", optional, tag = "1")]
    raw: Option<Bytes>,
    #[prost(int32, optional, tag = "2")]
    raw_size: Option<i32>,
    #[prost(bytes = "bytes", optional, tag = "3")]
    zlib: Option<Bytes>,
}

#[derive(Clone, PartialEq, Message)]
struct HeaderBlock {
    #[prost(string, repeated, tag = "4")]
    required: Vec<String>,
}

/// Objects of a file, up to some thousands.
#[derive(Clone, PartialEq, Message)]
pub(super) struct Block {
    #[prost(message, required, tag = "1")]
    strings: Strings,
    #[prost(message, repeated, tag = "2")]
    groups: Vec<Group>,
    #[prost(int32, optional, tag = "17", default = "100")]
    granularity: Option<i32>,
    #[prost(int64, optional, tag = "19")]
    lat_offset: Option<i64>,
    #[prost(int64, optional, tag = "20")]
    lon_offset: Option<i64>,
}

#[derive(Clone, PartialEq, Message)]
struct Strings {
    #[prost(bytes = "bytes", repeated, tag = "1")]
    s: Vec<Bytes>,
}

#[derive(Clone, PartialEq, Message)]
struct Group {
    #[prost(message, repeated, tag = "1")]
    nodes: Vec<Node>,
    #[prost(message, optional, tag = "2")]
    dense: Option<DenseNodes>,
    #[prost(message, repeated, tag = "3")]
    ways: Vec<Way>,
    #[prost(message, repeated, tag = "4")]
    relations: Vec<Relation>,
}

#[derive(Clone, PartialEq, Message)]
struct Node {
    #[prost(sint64, required, tag = "1")]
    id: i64,
    #[prost(sint64, required, tag = "8")]
    lat: i64,
    #[prost(sint64, required, tag = "9")]
    lon: i64,
}

/// Differences from node to node.
#[derive(Clone, PartialEq, Message)]
struct DenseNodes {
    #[prost(sint64, repeated, tag = "1")]
    id: Vec<i64>,
    #[prost(sint64, repeated, tag = "8")]
    lat: Vec<i64>,
    #[prost(sint64, repeated, tag = "9")]
    lon: Vec<i64>,
}

#[derive(Clone, PartialEq, Message)]
struct Way {
    #[prost(int64, required, tag = "1")]
    id: i64,
    #[prost(uint32, repeated, tag = "2")]
    keys: Vec<u32>,
    #[prost(uint32, repeated, tag = "3")]
    values: Vec<u32>,
    /// Differences from node to node.
    #[prost(sint64, repeated, tag = "8")]
    nodes: Vec<i64>,
}

#[derive(Clone, PartialEq, Message)]
struct Relation {
    #[prost(int64, required, tag = "1")]
    id: i64,
    #[prost(uint32, repeated, tag = "2")]
    keys: Vec<u32>,
    #[prost(uint32, repeated, tag = "3")]
    values: Vec<u32>,
    /// Differences from member to member.
    #[prost(sint64, repeated, tag = "9")]
    members: Vec<i64>,
    #[prost(int32, repeated, tag = "10")]
    kinds: Vec<i32>,
}

/// Kinds of members: nodes, ways and relations.
const KINDS: std::ops::RangeInclusive<i32> = 0..=2;
const WAY: i32 = 1;

impl Block {
    /// Number, longitude and latitude in degrees of all nodes.
    pub(super) fn nodes(&self) -> impl Iterator<Item = (i64, DVec2)> + '_ {
        let unit = 1e-9;
        let step = f64::from(self.granularity());
        let [x, y] = [self.lon_offset(), self.lat_offset()].map(|offset| offset as f64);
        let at = move |lon: i64, lat: i64| DVec2::new(x + step * lon as f64, y + step * lat as f64) * unit;
        self.groups.iter().flat_map(move |group| {
            let single = group.nodes.iter().map(move |n| (n.id, at(n.lon, n.lat)));
            let dense = group.dense.iter().flat_map(move |dense| {
                let ids = summed(&dense.id);
                ids.zip(summed(&dense.lon)).zip(summed(&dense.lat)).map(move |((id, lon), lat)| (id, at(lon, lat)))
            });
            single.chain(dense)
        })
    }

    /// Number, tags and nodes of all ways.
    pub(super) fn ways(&self) -> impl Iterator<Item = (i64, Tags, Vec<i64>)> + '_ {
        let ways = self.groups.iter().flat_map(|group| &group.ways);
        ways.map(|way| (way.id, self.tags(&way.keys, &way.values), summed(&way.nodes).collect()))
    }

    /// Number, tags and ways of all relations.
    pub(super) fn relations(&self) -> impl Iterator<Item = (i64, Tags, Vec<i64>)> + '_ {
        let relations = self.groups.iter().flat_map(|group| &group.relations);
        relations.map(|relation| {
            let members = summed(&relation.members).zip(&relation.kinds);
            let ways = members.filter(|(_, kind)| **kind == WAY).map(|(id, _)| id).collect();
            (relation.id, self.tags(&relation.keys, &relation.values), ways)
        })
    }

    /// Whether lists that belong together are equally long and members are of kinds that there are.
    fn agrees(&self) -> bool {
        self.groups.iter().all(|group| {
            let dense = group.dense.iter().all(|d| d.id.len() == d.lat.len() && d.id.len() == d.lon.len());
            let ways = group.ways.iter().all(|way| way.keys.len() == way.values.len());
            let relations = group.relations.iter().all(|relation| {
                let tags = relation.keys.len() == relation.values.len();
                tags && relation.members.len() == relation.kinds.len()
                    && relation.kinds.iter().all(|k| KINDS.contains(k))
            });
            dense && ways && relations
        })
    }

    fn tags(&self, keys: &[u32], values: &[u32]) -> Tags {
        let text = |i: &u32| Some(String::from_utf8_lossy(self.strings.s.get(*i as usize)?).into_owned());
        keys.iter().zip(values).filter_map(|(key, value)| Some((text(key)?, text(value)?))).collect()
    }
}

/// Sums of differences.
fn summed(differences: &[i64]) -> impl Iterator<Item = i64> + '_ {
    differences.iter().scan(0i64, |sum, d| {
        *sum = sum.wrapping_add(*d);
        Some(*sum)
    })
}

/// The blobs of objects of a file, still packed.
pub(super) struct Blobs<'f> {
    packed: Vec<&'f [u8]>,
    /// Why the file ends within a blob.
    pub(super) cut: Option<String>,
}

impl<'f> Blobs<'f> {
    /// Finds the blobs, and asks whether the file requires what is not understood.
    pub(super) fn of_file(file: &'f [u8]) -> Result<Self, Broken> {
        let (mut rest, mut blobs) = (file, Vec::new());
        while !rest.is_empty() {
            if let Some(why) = cut(rest).filter(|_| !blobs.is_empty()) {
                return Ok(Self { packed: blobs, cut: Some(why.into()) });
            }
            let length = rest.split_first_chunk().map(|(length, _)| u32::from_be_bytes(*length) as usize);
            let Some(length) = length.filter(|length| *length <= MAX_HEADER) else {
                return Err(format!("no blob at byte {}", file.len() - rest.len()).into());
            };
            let (head, after) = rest[4..].split_at_checked(length).ok_or("it ends within the header of a blob")?;
            let header = BlobHeader::decode(head).map_err(|e| e.to_string())?;
            let size = usize::try_from(header.size).ok().filter(|size| *size <= MAX_BLOB);
            let size = size.ok_or_else(|| format!("a blob of {} bytes, the limit is {MAX_BLOB}", header.size))?;
            let (blob, after) = after.split_at_checked(size).ok_or("it ends within a blob")?;
            match header.kind.as_str() {
                "OSMData" => blobs.push(blob),
                "OSMHeader" => {
                    let required = unpacked::<HeaderBlock>(blob)?.required;
                    if let Some(unknown) = required.iter().find(|f| !FEATURES.contains(&f.as_str())) {
                        return Err(Broken::Unknown(format!("it requires {unknown}")));
                    }
                }
                _ => {}
            }
            rest = after;
        }
        Ok(Self { packed: blobs, cut: None })
    }

    /// Calls `take` with what `find` finds in each block, in the order of the file.
    pub(super) fn each<T: Send>(
        &self,
        find: impl Fn(&Block) -> T + Sync,
        mut take: impl FnMut(T),
    ) -> Result<(), Broken> {
        for some in self.packed.chunks(AT_ONCE) {
            let found = some.par_iter().map(|blob| {
                let block: Block = unpacked(blob)?;
                if block.agrees() { Ok(find(&block)) } else { Err("its blocks contradict themselves".into()) }
            });
            found.collect::<Result<Vec<T>, Broken>>()?.into_iter().for_each(&mut take);
        }
        Ok(())
    }
}

/// Why the first blob of these bytes is not whole, where they end within it.
fn cut(bytes: &[u8]) -> Option<&'static str> {
    let Some((length, rest)) = bytes.split_first_chunk() else { return Some("it ends within the length of a blob") };
    let length = u32::from_be_bytes(*length) as usize;
    if length > MAX_HEADER {
        return None;
    }
    let Some((head, rest)) = rest.split_at_checked(length) else { return Some("it ends within the header of a blob") };
    let size = usize::try_from(BlobHeader::decode(head).ok()?.size).ok().filter(|size| *size <= MAX_BLOB)?;
    (size > rest.len()).then_some("it ends within a blob")
}

fn unpacked<M: Message + Default>(blob: &[u8]) -> Result<M, Broken> {
    let blob = Blob::decode(Bytes::copy_from_slice(blob)).map_err(|e| e.to_string())?;
    let bytes = match (blob.raw, blob.zlib) {
        (Some(raw), _) => raw,
        (None, Some(packed)) => {
            let size = usize::try_from(blob.raw_size.unwrap_or_default()).ok().filter(|size| *size <= MAX_BLOB);
            let size = size.ok_or_else(|| format!("a blob that unpacks to more than {MAX_BLOB} bytes"))?;
            let mut bytes = Vec::with_capacity(size);
            let stream = flate2::read::ZlibDecoder::new(&packed[..]);
            stream.take(MAX_BLOB as u64 + 1).read_to_end(&mut bytes).map_err(|e| e.to_string())?;
            if bytes.len() != size {
                return Err(format!("a blob says that it unpacks to {size} bytes and does not").into());
            }
            bytes.into()
        }
        (None, None) => return Err(Broken::Unknown("its blobs are neither plain nor packed by zlib".into())),
    };
    budget::ask("a block", decoded_bytes(&bytes))?;
    Ok(M::decode(bytes).map_err(|e| e.to_string())?)
}

/// Bytes that a block takes at most when it is decoded: of the numbers in it, and of its groups, objects and texts, each of which may be
/// written in two bytes.
fn decoded_bytes(block: &[u8]) -> u64 {
    // While a list grows it is held twice.
    8 * block.len() as u64 + 2 * parts(block, 2) * size_of::<Group>() as u64
}

/// Number of parts of a message that have a length, and of those in them, `levels` deep.
fn parts(message: &[u8], levels: u32) -> u64 {
    let (mut rest, mut count) = (message, 0);
    while let Ok((_, wire)) = decode_key(&mut rest) {
        let length = match wire {
            WireType::Varint if decode_varint(&mut rest).is_ok() => 0,
            WireType::ThirtyTwoBit => 4,
            WireType::SixtyFourBit => 8,
            WireType::LengthDelimited => decode_varint(&mut rest).unwrap_or(u64::MAX),
            _ => break,
        };
        let Some((part, after)) = usize::try_from(length).ok().and_then(|n| rest.split_at_checked(n)) else { break };
        if wire == WireType::LengthDelimited {
            count += 1 + if levels > 1 { parts(part, levels - 1) } else { 0 };
        }
        rest = after;
    }
    count
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Groups and nodes without content take two bytes in a file and over a hundred in memory.
    #[test]
    fn parts_are_counted_before_a_block_is_decoded() {
        let group = Group {
            nodes: vec![Node::default(); 5],
            dense: Some(DenseNodes { id: vec![300; 40], ..DenseNodes::default() }),
            ..Group::default()
        };
        let block =
            Block { groups: vec![group, Group::default()], lat_offset: Some(-1), ..Block::default() }.encode_to_vec();
        // The texts, the two groups, five nodes and the dense ones.
        assert_eq!(parts(&block, 2), 3 + 6);
        assert_eq!(parts(&block, 1), 3);
        assert_eq!(parts(&block[..block.len() - 3], 1), 3, "a part that is cut off ends the count");
        let empty = [0x12, 0].repeat(1 << 20);
        assert!(decoded_bytes(&empty) > (1 << 20) * size_of::<Group>() as u64);
    }
}
