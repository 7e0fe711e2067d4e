//! Mip pyramid of the ground in tiles that are computed on demand: averages of its nodes, the nodes, and levels between them with made detail.

use std::ops::Range;
use std::sync::OnceLock;
use std::sync::atomic::{AtomicUsize, Ordering};

/// Fixed-point steps of a tile, of the nodes of its own level.
pub(crate) const SPAN: u32 = SIDE as u32 * CELL as u32;

/// Stored bytes of a node of the ground.
pub(crate) type Node = [u8; 8];

/// Cells along a side of a tile, a power of two; one more node along each side, so that no cell lies in two tiles.
const SIDE: usize = 32;
pub(crate) const STRIDE: usize = SIDE + 1;
pub(crate) const NODES: usize = STRIDE * STRIDE;
pub(crate) type Tile = [Node; NODES];

/// Fixed-point steps of a cell.
pub(crate) const CELL: i32 = 256;

/// Bytes of tiles above which a frame starts without them, so that long flights over a large ground do not keep all of it.
const MOST_BYTES: usize = 192 << 20;

/// Bytes of tiles per pixel that a picture makes at most, about: one or two nodes per pixel, and tiles of which only a corner is seen.
const BYTES_PER_PIXEL: u64 = 64;
const BYTES_OF_CORNERS: u64 = 32 << 20;

/// Tiles along a side of a page: the places of tiles are made with the first tile among them.
const PAGE: usize = 8;
type Page = [OnceLock<Box<Tile>>; PAGE * PAGE];

#[derive(Debug)]
struct Level {
    nodes: [usize; 2],
    /// Tiles across and down.
    tiles: [usize; 2],
    /// Pages row by row.
    pages: Vec<OnceLock<Box<Page>>>,
}

impl Level {
    fn new(nodes: [usize; 2], tiles: [usize; 2]) -> Self {
        let pages = tiles.map(|n| n.div_ceil(PAGE)).iter().product();
        Self { nodes, tiles, pages: (0..pages).map(|_| OnceLock::new()).collect() }
    }

    /// The place of a tile; `None` off the ground.
    #[inline(always)]
    fn place(&self, [column, row]: [usize; 2]) -> Option<&OnceLock<Box<Tile>>> {
        if column >= self.tiles[0] || row >= self.tiles[1] {
            return None;
        }
        let across = self.tiles[0].div_ceil(PAGE);
        let page = self.pages.get(row / PAGE * across + column / PAGE)?;
        let page = page.get_or_init(|| Box::new(std::array::from_fn(|_| OnceLock::new())));
        page.get(row % PAGE * PAGE + column % PAGE)
    }
}

/// Nodes and tiles across and down of a level.
/// * `finer`: levels below that of the nodes of the ground.
fn level_size(nodes: [usize; 2], k: usize, finer: u32) -> ([usize; 2], [usize; 2]) {
    let nodes = nodes.map(|n| (n << finer).div_ceil(1 << k));
    (nodes, nodes.map(|n| (n + 1).div_ceil(SIDE)))
}

/// Bytes that the tiles of a ground take at most: all of them, or the limit and the tiles of one more picture; with their
/// places.
pub(crate) fn most_bytes(nodes: [usize; 2], finer: u32, pixels: u64) -> u64 {
    let levels = 1 + finer as usize + nodes[0].max(nodes[1]).next_power_of_two().trailing_zeros() as usize;
    let tiles: usize = (0..levels).map(|k| level_size(nodes, k, finer).1.iter().product::<usize>()).sum();
    let all = tiles as u64 * size_of::<Tile>() as u64;
    let made = all.min(pixels.saturating_mul(BYTES_PER_PIXEL).saturating_add(MOST_BYTES as u64 + BYTES_OF_CORNERS));
    // A page takes an eighth of a tile.
    made + made / 8
}

/// Levels of halved detail, each with a border of one repeated node, so that no position needs clamping.
#[derive(Debug)]
pub(crate) struct Tiles {
    levels: Vec<Level>,
    /// Number of the level of the nodes of the ground.
    finer: u32,
    bytes: AtomicUsize,
}

/// The nodes around a point, west and east in a row, and the point's offsets east and south in 1/256.
pub(crate) struct FourNodes<'a> {
    pub(crate) north: &'a [Node; 2],
    pub(crate) south: &'a [Node; 2],
    pub(crate) east_share: u32,
    pub(crate) south_share: u32,
}

impl Tiles {
    /// Levels without tiles.
    /// * `top`: averages above the level of the nodes; `finer`: levels below it.
    pub(crate) fn new(nodes: [usize; 2], top: usize, finer: u32) -> Self {
        let level = |k: usize| {
            let (nodes, tiles) = level_size(nodes, k, finer);
            Level::new(nodes, tiles)
        };
        Self { levels: (0..=top + finer as usize).map(level).collect(), finer, bytes: AtomicUsize::new(0) }
    }

    /// Number of the level of the nodes of the ground.
    #[inline(always)]
    pub(crate) fn finer(&self) -> u32 {
        self.finer
    }

    /// Number of the coarsest level.
    #[inline(always)]
    pub(crate) fn top(&self) -> usize {
        self.levels.len() - 1
    }

    /// Columns and rows that the nodes of a tile repeat.
    pub(crate) fn repeated(&self, k: usize, tile: [usize; 2]) -> [RepeatedNodes; 2] {
        [0, 1].map(|axis| RepeatedNodes { from: tile[axis] * SIDE, nodes: self.levels[k].nodes[axis] })
    }

    /// Bytes of the tiles made so far.
    #[cfg(test)]
    pub(crate) fn bytes(&self) -> usize {
        self.bytes.load(Ordering::Relaxed)
    }

    /// Whether the tiles exceed the limit of memory, so that the next frame starts without them.
    pub(crate) fn is_full(&self) -> bool {
        self.bytes.load(Ordering::Relaxed) > MOST_BYTES
    }

    /// Nodes around a point; `None` off the ground.
    /// * `at`: column and row of the ground, [`CELL`] steps to a cell;
    /// * `make`: makes a tile from the number of its level and its column and row.
    #[inline(always)]
    pub(crate) fn around(
        &self,
        k: usize,
        at: [i32; 2],
        make: impl FnOnce(usize, [usize; 2]) -> Box<Tile>,
    ) -> Option<FourNodes<'_>> {
        let (x, y) = (level_position(at[0], k as u32, self.finer), level_position(at[1], k as u32, self.finer));
        let tile = self.tile([k as u32, x / SPAN, y / SPAN], make)?;
        let first = first_of(x, y) as usize;
        Some(FourNodes {
            north: tile[first..].first_chunk()?,
            south: tile[first + STRIDE..].first_chunk()?,
            east_share: x & 255,
            south_share: y & 255,
        })
    }

    /// A tile by its level, column and row; `None` off the ground.
    #[inline(always)]
    pub(crate) fn tile(
        &self,
        [k, column, row]: [u32; 3],
        make: impl FnOnce(usize, [usize; 2]) -> Box<Tile>,
    ) -> Option<&Tile> {
        let (k, column, row) = (k as usize, column as usize, row as usize);
        let place = self.levels.get(k)?.place([column, row])?;
        Some(match place.get() {
            Some(tile) => tile,
            None => self.made(place, || make(k, [column, row])),
        })
    }

    /// Drops the tiles that may not be kept.
    /// * `keep`: decides by the first and last columns and rows of the ground that affect a tile.
    pub(crate) fn retain(&mut self, keep: impl Fn([[usize; 2]; 2]) -> bool) {
        let finer = self.finer as usize;
        for (k, level) in self.levels.iter_mut().enumerate() {
            let across = level.tiles[0].div_ceil(PAGE);
            for (n, page) in level.pages.iter_mut().enumerate() {
                for (i, tile) in page.get_mut().into_iter().flat_map(|page| page.iter_mut()).enumerate() {
                    let at = [n % across * PAGE + i % PAGE, n / across * PAGE + i / PAGE];
                    let reach = at.map(|i| {
                        // A tile depends on three nodes of the next level and a border of one on either side; between the nodes, on two
                        // on either side.
                        let [from, to] = [(i * SIDE).saturating_sub(8) << k, ((i + 1) * SIDE + 8) << k];
                        [(from >> finer).saturating_sub(4), (to >> finer) + 4]
                    });
                    if tile.get().is_some() && !keep(reach) {
                        tile.take();
                        *self.bytes.get_mut() -= size_of::<Tile>();
                    }
                }
            }
        }
    }

    #[cold]
    #[inline(never)]
    fn made<'a>(&self, place: &'a OnceLock<Box<Tile>>, make: impl FnOnce() -> Box<Tile>) -> &'a Tile {
        place.get_or_init(|| {
            self.bytes.fetch_add(size_of::<Tile>(), Ordering::Relaxed);
            make()
        })
    }
}

/// Position along an axis of level `k`, [`CELL`] steps from node to node.
/// * `at`: position on the ground, `CELL` steps from node to node; `finer`: see [`Tiles::finer`].
#[inline(always)]
pub(crate) fn level_position(at: i32, k: u32, finer: u32) -> u32 {
    // Node i of level k lies at (i + 0.5) 2^(k - finer) - 0.5 of the ground, and is number i + 1 with the rim.
    ((at.wrapping_add(CELL / 2) << (finer & 31) >> (k & 31)) + CELL / 2) as u32
}

/// Index of the north-western node around a point of a level, in its tile.
#[inline(always)]
pub(crate) fn first_of(x: u32, y: u32) -> u32 {
    (y / CELL as u32) % SIDE as u32 * STRIDE as u32 + (x / CELL as u32) % SIDE as u32
}

/// The nodes around a point of a tile: north-west, north-east, south-west, south-east; both words of each.
#[inline(always)]
pub(crate) fn around(tile: &Tile, first: usize) -> Option<[[u32; 2]; 4]> {
    let ([a, b], [c, d]) = (tile[first..].first_chunk()?, tile[first + STRIDE..].first_chunk()?);
    Some([words(*a), words(*b), words(*c), words(*d)])
}

#[inline(always)]
fn words([a, b, c, d, e, f, g, h]: Node) -> [u32; 2] {
    [u32::from_le_bytes([a, b, c, d]), u32::from_le_bytes([e, f, g, h])]
}

/// Nodes in a line, `count` of them from `first` on; those beyond the ends of the ground repeat the last node there.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Line {
    first: isize,
    pub(crate) count: usize,
    /// Number of the last node of the ground.
    last: usize,
}

impl Line {
    pub(crate) fn iter(self) -> impl Iterator<Item = usize> {
        (self.first..self.first + self.count as isize).map(move |i| (i.max(0) as usize).min(self.last))
    }

    /// The first node on the ground, and the range of the line's nodes that lie on the ground.
    pub(crate) fn inside(self) -> (usize, Range<usize>) {
        let from = (-self.first).max(0) as usize;
        let to = (self.last as isize + 1 - self.first).clamp(from as isize, self.count as isize);
        ((self.first + from as isize) as usize, from..to as usize)
    }

    /// Copies the values of the end nodes to the nodes beyond the ground.
    #[inline(always)]
    pub(crate) fn repeat(self, values: &mut [f32]) {
        let (_, Range { start, end }) = self.inside();
        if start < end {
            let (first, last) = (values[start], values[end - 1]);
            values[..start].fill(first);
            values[end..].fill(last);
        }
    }
}

/// The nodes of a tile along an axis; those beyond the ground repeat the last one.
#[derive(Debug, Clone, Copy)]
pub(crate) struct RepeatedNodes {
    from: usize,
    nodes: usize,
}

impl Line {
    /// Number of the first node, which may lie before the ground.
    pub(crate) fn first(self) -> isize {
        self.first
    }

    /// The nodes of the level `by` levels coarser from which this line is interpolated, two before the first and after the last.
    /// * `last`: number of the last node there.
    pub(crate) fn around(self, by: u32, last: usize) -> Self {
        let [from, to] = [self.first, self.first + self.count as isize - 1].map(|i| i >> by);
        Self { first: from - 2, count: (to - from) as usize + 5, last }
    }
}

impl RepeatedNodes {
    pub(crate) fn all(self) -> Line {
        Line { first: self.from as isize - 1, count: STRIDE, last: self.nodes - 1 }
    }

    /// The nodes of the next coarser level over them, and one more at either end; beyond the ground the last one is repeated.
    pub(crate) fn parents(self) -> Line {
        Line { first: (self.from / 2) as isize - 2, count: SIDE / 2 + 3, last: self.nodes.div_ceil(2) - 1 }
    }

    /// Index of the parent over a node.
    pub(crate) fn parent_of(self, node: usize) -> usize {
        node / 2 + 2 - self.from / 2
    }
}

/// A tile of nodes row by row.
pub(crate) fn boxed(nodes: Vec<Node>) -> Box<Tile> {
    nodes.into_boxed_slice().try_into().unwrap_or_else(|_| Box::new([Node::default(); NODES]))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lines_repeat_the_ends_of_the_ground() {
        for (from, nodes) in [(0, 5), (0, 200), (32, 33), (64, 70), (32, 32), (0, 1)] {
            for line in [RepeatedNodes { from, nodes }.all(), RepeatedNodes { from, nodes }.parents()] {
                let (first, inside) = line.inside();
                let mut values = vec![-1.0; line.count];
                inside.clone().for_each(|i| values[i] = (first + i - inside.start) as f32);
                line.repeat(&mut values);
                let want: Vec<f32> = line.iter().map(|i| i as f32).collect();
                assert_eq!(values, want, "{from} of {nodes}");
            }
        }
    }

    #[test]
    fn tiles_take_no_more_than_is_said() {
        for (nodes, finer) in [([70usize, 70], 0), ([300, 129], 0), ([1, 2], 3), ([1025, 40], 0), ([40, 33], 2)] {
            let top = nodes[0].max(nodes[1]).next_power_of_two().trailing_zeros() as usize;
            let tiles = Tiles::new(nodes, top, finer);
            let steps = |n: usize| (0..n << finer).map(move |i| (i as i32 * CELL) >> finer);
            for k in 0..=tiles.top() {
                for at in steps(nodes[0]).flat_map(|c| steps(nodes[1]).map(move |r| [c, r])) {
                    assert!(tiles.around(k, at, |_, _| boxed(Vec::new())).is_some());
                }
            }
            let bytes = tiles.bytes.load(Ordering::Relaxed) as u64;
            let most = most_bytes(nodes, finer, u64::MAX);
            assert!(bytes <= most && 2 * bytes > most, "{nodes:?}: {bytes} of {most}");
        }
        assert!(most_bytes([40_000, 40_000], 0, 1 << 20) < 350 << 20, "not all of a huge ground");
    }
}
