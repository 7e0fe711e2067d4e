//! Places of tiles as numbers: by zoom, then along a Z-order curve, so that what lies below a tile stands together.

/// Deepest zoom that is read.
pub(super) const MOST_ZOOM: u8 = 24;
/// Bits of a place within its zoom.
const BITS: u32 = 56;

/// The number of a tile: 8 bits of zoom, then the bits of column and row by turns.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(super) struct Key(u64);

impl Key {
    /// `None` for tiles that the zoom does not have.
    ///
    /// * `zoom`: 0 to [`MOST_ZOOM`].
    /// * `column`, `row`: counted from the north-west.
    pub(super) fn new(zoom: u8, column: u64, row: u64) -> Option<Self> {
        let side = 1u64 << zoom.min(MOST_ZOOM);
        let is_there = zoom <= MOST_ZOOM && column < side && row < side;
        is_there.then(|| Self(u64::from(zoom) << BITS | spread(column) | spread(row) << 1))
    }

    pub(super) fn zoom(self) -> u8 {
        (self.0 >> BITS) as u8
    }

    /// Column and row.
    pub(super) fn place(self) -> [u64; 2] {
        [gathered(self.0), gathered(self.0 >> 1)]
    }

    /// The tile that holds it, `steps` zooms above.
    pub(super) fn above(self, steps: u8) -> Option<Self> {
        let zoom = self.zoom().checked_sub(steps)?;
        let [column, row] = self.place().map(|n| n >> steps);
        Self::new(zoom, column, row)
    }

    /// The four tiles below it: north-west, north-east, south-west, south-east.
    pub(super) fn below(self) -> [Option<Self>; 4] {
        let [column, row] = self.place().map(|n| 2 * n);
        [[0, 0], [1, 0], [0, 1], [1, 1]].map(|[c, r]| Self::new(self.zoom() + 1, column + c, row + r))
    }

    /// First number and the one behind the last of the tiles that lie in it, `steps` zooms below; both of a zoom that is read.
    pub(super) fn range_below(self, steps: u8) -> [Self; 2] {
        let place = self.0 & ((1 << BITS) - 1);
        let zoom = u64::from(self.zoom() + steps) << BITS;
        let [first, end] = [place, place + 1].map(|n| n << (2 * u32::from(steps)));
        [Self(zoom + first), Self(zoom + end)]
    }
}

/// Bit k of a number at bit 2 k.
fn spread(number: u64) -> u64 {
    (0..u32::from(MOST_ZOOM)).fold(0, |out, k| out | (number >> k & 1) << (2 * k))
}

/// Bits 0, 2, 4 ... of a number.
fn gathered(number: u64) -> u64 {
    (0..u32::from(MOST_ZOOM)).fold(0, |out, k| out | (number >> (2 * k) & 1) << k)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn tiles_below_one_are_a_range_and_places_come_back() {
        let tile = Key::new(3, 5, 6).expect("there");
        assert_eq!((tile.zoom(), tile.place()), (3, [5, 6]));
        assert_eq!((Key::new(3, 8, 0), Key::new(MOST_ZOOM + 1, 0, 0)), (None, None));
        assert_eq!(tile.above(1).map(|t| (t.zoom(), t.place())), Some((2, [2, 3])));
        assert_eq!(tile.above(4), None);
        let [first, end] = tile.range_below(2);
        let below: Vec<Key> = (0..32 * 32).filter_map(|k| Key::new(5, k % 32, k / 32)).collect();
        let inside = |key: &Key| key.above(2) == Some(tile);
        assert!(below.iter().all(|key| inside(key) == (first <= *key && *key < end)));
        assert!(tile.below().into_iter().flatten().all(|key| key.above(1) == Some(tile)));
        let last = Key::new(MOST_ZOOM, (1 << MOST_ZOOM) - 1, 7).expect("there");
        assert_eq!(last.place(), [(1 << MOST_ZOOM) - 1, 7]);
    }
}
