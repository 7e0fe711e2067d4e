//! Values of square blocks of a grid, of blocks of four of them, and so on.

use belvedere_core::DVec2;
use rayon::prelude::*;

/// Values of square blocks of cells, such as bounds of the ground in them, level by level.
///
/// Blocks of level 0 are `side` cells wide, those of each further level twice as wide, and the last level is one block.
#[derive(Debug, Clone)]
pub struct Pyramid<T> {
    levels: Vec<Level<T>>,
}

#[derive(Debug, Clone)]
struct Level<T> {
    size: [usize; 2],
    /// Cells along a side of a block, and its inverse.
    side: f64,
    per_cell: f64,
    blocks: Vec<T>,
}

impl<T: Copy + Send + Sync> Pyramid<T> {
    /// * `cells`: of the grid, columns and rows;
    /// * `leaf`: the value of a block (column, row) of level 0;
    /// * `parent`: the value of a block of a higher level from the up to four it is made of.
    pub fn new(
        cells: [usize; 2],
        side: usize,
        leaf: impl Fn([usize; 2]) -> T + Sync,
        parent: impl Fn(usize, [usize; 2], &[T]) -> T + Sync,
    ) -> Self {
        let mut out = Self { levels: Vec::new() };
        let mut width = side;
        loop {
            let size = cells.map(|n| n.div_ceil(width).max(1));
            let value = |i: usize| {
                let block = [i % size[0], i / size[0]];
                match out.levels.last() {
                    None => leaf(block),
                    Some(finer) => finer.parent_of(block, |children| parent(out.levels.len(), block, children)),
                }
            };
            let blocks = (0..size[0] * size[1]).into_par_iter().with_min_len(8).map(value).collect();
            out.levels.push(Level { size, side: width as f64, per_cell: 1.0 / width as f64, blocks });
            if size == [1, 1] {
                return out;
            }
            width *= 2;
        }
    }

    /// Sets all values anew, on one thread.
    pub fn renew(&mut self, leaf: impl Fn([usize; 2]) -> T, parent: impl Fn(&[T]) -> T) {
        for level in 0..self.levels.len() {
            let (finer, coarser) = self.levels.split_at_mut(level);
            let Level { size, blocks, .. } = &mut coarser[0];
            for (i, value) in blocks.iter_mut().enumerate() {
                let block = [i % size[0], i / size[0]];
                *value = finer.last().map_or_else(|| leaf(block), |finer| finer.parent_of(block, &parent));
            }
        }
    }

    /// Number of levels, at least 1.
    pub fn levels(&self) -> usize {
        self.levels.len()
    }

    /// Blocks of a level, columns and rows.
    pub fn size(&self, level: usize) -> [usize; 2] {
        self.levels[level].size
    }

    /// Cells along a side of a block of a level.
    pub fn side(&self, level: usize) -> f64 {
        self.levels[level].side
    }

    /// The value of a block (column, row).
    #[inline]
    pub fn block(&self, level: usize, [col, row]: [usize; 2]) -> &T {
        let level = &self.levels[level];
        &level.blocks[row * level.size[0] + col]
    }

    /// The finest level whose blocks are at least `width` cells wide; the last if none is.
    #[inline]
    pub fn level_of(&self, width: f64) -> usize {
        self.levels.iter().position(|l| l.side >= width).unwrap_or(self.levels.len() - 1)
    }

    /// The block of a level that holds a point in grid coordinates, or the nearest one.
    #[inline]
    pub fn block_at(&self, level: usize, at: DVec2) -> [usize; 2] {
        let Level { size, per_cell, .. } = self.levels[level];
        let index = |x: f64, n: usize| ((x * per_cell).max(0.0) as usize).min(n - 1);
        [index(at.x, size[0]), index(at.y, size[1])]
    }

    /// Combines the values of a rectangle of blocks of a level, `last` included.
    #[inline]
    pub fn fold<A>(&self, level: usize, first: [usize; 2], last: [usize; 2], init: A, add: impl Fn(A, &T) -> A) -> A {
        let Level { size, blocks, .. } = &self.levels[level];
        let mut sum = init;
        for row in first[1]..=last[1] {
            sum = blocks[row * size[0] + first[0]..=row * size[0] + last[0]].iter().fold(sum, &add);
        }
        sum
    }
}

impl<T: Copy> Level<T> {
    fn parent_of(&self, [col, row]: [usize; 2], parent: impl FnOnce(&[T]) -> T) -> T {
        let first = self.blocks[2 * row * self.size[0] + 2 * col];
        let (mut children, mut count) = ([first; 4], 0);
        for (y, x) in [(2 * row, 2 * col), (2 * row, 2 * col + 1), (2 * row + 1, 2 * col), (2 * row + 1, 2 * col + 1)] {
            if x < self.size[0] && y < self.size[1] {
                children[count] = self.blocks[y * self.size[0] + x];
                count += 1;
            }
        }
        parent(&children[..count])
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_block_holds_what_its_cells_hold() {
        for (cells, side) in [([37, 21], 1), ([64, 64], 8), ([5, 90], 2), ([1, 1], 1)] {
            let value = |x: usize, y: usize| (x * 7919 + y * 104_729) % 1009;
            let most = |side: usize, [col, row]: [usize; 2]| {
                let columns = |y: usize| (col * side..((col + 1) * side).min(cells[0])).map(move |x| value(x, y));
                (row * side..((row + 1) * side).min(cells[1])).flat_map(columns).max().unwrap()
            };
            let largest = |children: &[usize]| *children.iter().max().unwrap();
            let mut pyramid = Pyramid::new(cells, side, |b| most(side, b), |_, _, children| largest(children));
            for renewed in [false, true] {
                for level in 0..pyramid.levels() {
                    let width = side << level;
                    assert_eq!(pyramid.size(level), cells.map(|n| n.div_ceil(width)));
                    assert_eq!((pyramid.side(level), pyramid.level_of(width as f64)), (width as f64, level));
                    let [cols, rows] = pyramid.size(level);
                    for block in (0..cols * rows).map(|i| [i % cols, i / cols]) {
                        assert_eq!(*pyramid.block(level, block), most(width, block), "{cells:?}, {level}, {renewed}");
                    }
                    let all = pyramid.fold(level, [0, 0], [cols - 1, rows - 1], 0, |a: usize, b| a.max(*b));
                    assert_eq!(all, most(1 << 10, [0, 0]));
                }
                assert_eq!(pyramid.size(pyramid.levels() - 1), [1, 1]);
                pyramid.renew(|b| most(side, b), largest);
            }
        }
    }
}
