//! Depths of surfaces where marks read them: of the whole picture, or of its parts that are needed.

use crate::skyline::Skyline;
use std::ops::Range;
use std::sync::atomic::{AtomicU32, Ordering};

/// Side of a tile, pixels.
const TILE: usize = 8;

/// Depths of the surfaces at the pixel centres; infinite in the sky.
#[derive(Debug, Clone, Copy)]
pub enum Depths<'a> {
    /// All of them, row by row.
    Whole(&'a [f32]),
    /// Those of some tiles.
    Tiles(&'a DepthTiles),
    /// None yet: what is read is noted.
    Wanted(&'a DepthTiles),
}

/// Depths of a picture by tiles, those that marks read alone.
#[derive(Debug)]
pub struct DepthTiles {
    /// Tiles across.
    across: usize,
    width: usize,
    height: usize,
    /// Of each tile: 0 where nothing reads it, 1 where something does, 2 + its number once it has a place.
    slots: Vec<AtomicU32>,
    depth: Vec<f32>,
    /// Where the sky begins, if marks read it.
    pub skyline: Skyline,
}

impl DepthTiles {
    /// Bytes per pixel of a picture of whose depths nothing is read.
    pub const BYTES_PER_TILE: u64 = 4;

    /// Tiles of a picture of this size, pixels, none of them wanted.
    pub fn new([width, height]: [usize; 2]) -> Self {
        let across = width.div_ceil(TILE);
        let slots = (0..across * height.div_ceil(TILE)).map(|_| AtomicU32::new(0)).collect();
        Self { across, width, height, slots, depth: Vec::new(), skyline: Skyline::default() }
    }

    fn slot(&self, x: usize, y: usize) -> &AtomicU32 {
        &self.slots[y / TILE * self.across + x / TILE]
    }

    /// Notes that a pixel is read.
    pub(crate) fn want(&self, x: usize, y: usize) {
        let slot = self.slot(x, y);
        if slot.load(Ordering::Relaxed) == 0 {
            slot.store(1, Ordering::Relaxed);
        }
    }

    /// Depth of a pixel; infinite in a tile that nothing was known to read.
    pub(crate) fn at(&self, x: usize, y: usize) -> f32 {
        match self.slot(x, y).load(Ordering::Relaxed).checked_sub(2) {
            Some(number) => self.depth[number as usize * TILE * TILE + y % TILE * TILE + x % TILE],
            None => f32::INFINITY,
        }
    }

    /// Gives every wanted tile its place.
    pub fn make_room(&mut self) {
        let wanted = self.slots.iter_mut().map(AtomicU32::get_mut).filter(|slot| **slot == 1);
        let mut count = 0;
        for slot in wanted {
            *slot = 2 + count;
            count += 1;
        }
        self.depth = vec![f32::INFINITY; count as usize * TILE * TILE];
    }

    /// Whether any pixel of some rows is wanted.
    pub fn are_wanted_in(&self, rows: Range<usize>) -> bool {
        self.wanted_columns(rows).is_some()
    }

    /// The columns from the first to the last that are wanted in some rows.
    pub fn wanted_columns(&self, rows: Range<usize>) -> Option<Range<usize>> {
        let tiles = rows.start / TILE..rows.end.min(self.height).div_ceil(TILE);
        let is_wanted = |column: &usize| {
            tiles.clone().any(|row| self.slots[row * self.across + column].load(Ordering::Relaxed) > 0)
        };
        let first = (0..self.across).find(is_wanted)?;
        let last = (0..self.across).rfind(is_wanted)?;
        Some(first * TILE..((last + 1) * TILE).min(self.width))
    }

    /// Fills the wanted tiles from the depths of some rows.
    /// * `row`: number of the row; `depth`: of all its columns.
    pub fn fill(&mut self, row: usize, depth: &[f32]) {
        let slots = &mut self.slots[row / TILE * self.across..][..self.across];
        for (column, (slot, depth)) in slots.iter_mut().zip(depth.chunks(TILE)).enumerate() {
            debug_assert!(column * TILE < self.width);
            if let Some(number) = slot.get_mut().checked_sub(2) {
                let from = number as usize * TILE * TILE + row % TILE * TILE;
                self.depth[from..from + depth.len()].copy_from_slice(depth);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn tiles_hold_what_is_read_of_them_and_nothing_else() {
        let (width, height) = (37, 21);
        let all: Vec<f32> = (0..width * height).map(|i| i as f32).collect();
        let mut tiles = DepthTiles::new([width, height]);
        let read = [[0, 0], [36, 20], [9, 15], [10, 8]];
        read.iter().for_each(|[x, y]| tiles.want(*x, *y));
        tiles.make_room();
        assert_eq!(tiles.depth.len(), 3 * TILE * TILE, "two pixels share a tile");
        assert_eq!(tiles.wanted_columns(8..16), Some(8..16));
        assert_eq!(tiles.wanted_columns(16..21), Some(32..37));
        assert!(tiles.are_wanted_in(0..3));
        all.chunks(width).enumerate().for_each(|(row, depth)| tiles.fill(row, depth));
        for [x, y] in read {
            assert_eq!(tiles.at(x, y), all[y * width + x]);
        }
        assert_eq!(tiles.at(20, 3), f32::INFINITY);
    }
}
