//! A band of image rows: nearness and primitive of every sample.

use crate::screen::SUB;
use std::ops::Range;

pub(crate) use belvedere_scene::ROWS as BAND;

/// Samples of padding at the end of a row, which wide writes may touch.
pub(crate) const SLACK: usize = 8;

/// No surface.
pub(crate) const SKY: u32 = u32::MAX;

/// Sample positions inside a pixel, in 1/256 pixel. The first is the centre; the rest carry colour coverage.
pub(crate) fn sample_offsets(samples: u32) -> Vec<[i32; 2]> {
    let centre = [SUB / 2, SUB / 2];
    // Rotated grids: no two samples share a row or a column. Steps of 1/16 pixel from the centre.
    let pattern: &[[i32; 2]] = match samples {
        4 => &[[-2, -6], [6, -2], [-6, 2], [2, 6]],
        16 => &[
            [1, 1],
            [-1, -3],
            [-3, 2],
            [4, -1],
            [-5, -2],
            [2, 5],
            [5, 3],
            [3, -5],
            [-2, 6],
            [0, -7],
            [-4, -6],
            [-6, 4],
            [-8, 0],
            [7, -4],
            [6, 7],
            [-7, -8],
        ],
        _ => &[],
    };
    let step = SUB / 16;
    std::iter::once(centre).chain(pattern.iter().map(|[x, y]| [centre[0] + step * x, centre[1] + step * y])).collect()
}

/// Nearness and primitive of every sample of the rows `y0..y1`.
///
/// The nearer surface wins; of equally near ones the one with the smaller number, so the order of drawing does not matter.
#[derive(Debug, Default)]
pub(crate) struct Band {
    pub(crate) y0: i32,
    pub(crate) y1: i32,
    pub(crate) width: i32,
    pub(crate) offsets: Vec<[i32; 2]>,
    /// Columns of which the samples are wanted, where not all are.
    pub(crate) only: Option<[i32; 2]>,
    /// Smallest and largest offset of samples along x and y, fixed-point steps.
    reach: [[i32; 2]; 2],
    /// Nearness (larger = nearer), one plane per sample.
    pub(crate) q: Vec<f32>,
    pub(crate) prim: Vec<u32>,
    /// Distance of rows in samples: a multiple of the lane width, larger than the width of the picture.
    pub(crate) stride: usize,
    tiles: Tiles,
    /// Fragments inside a triangle, for tests of coverage.
    #[cfg(test)]
    pub(crate) hits: Vec<u32>,
}

impl Band {
    #[cfg(test)]
    pub(crate) fn new(y0: i32, y1: i32, width: i32, offsets: Vec<[i32; 2]>) -> Self {
        let mut band = Self::default();
        band.clear(y0, y1, width, &offsets);
        band
    }

    /// Resets the band to sky for other rows; its memory is reused.
    pub(crate) fn clear(&mut self, y0: i32, y1: i32, width: i32, offsets: &[[i32; 2]]) {
        let alike = (self.y1 - self.y0, self.width, self.offsets.as_slice()) == (y1 - y0, width, offsets);
        (self.y0, self.y1, self.width, self.only) = (y0, y1, width, None);
        if alike {
            return self.clear_drawn();
        }
        self.offsets.clear();
        self.offsets.extend_from_slice(offsets);
        self.reach = [0, 1].map(|axis| {
            let along = offsets.iter().map(|o: &[i32; 2]| o[axis]);
            [along.clone().min().unwrap_or(0), along.max().unwrap_or(0)]
        });
        self.stride = (width.max(0) as usize).next_multiple_of(SLACK) + SLACK;
        let n = offsets.len() * (y1 - y0).max(0) as usize * self.stride;
        self.q.clear();
        self.q.resize(n, f32::NEG_INFINITY);
        self.prim.clear();
        self.prim.resize(n, SKY);
        self.tiles.clear(self.stride);
        #[cfg(test)]
        {
            self.hits = vec![0; n];
        }
    }

    /// Resets the columns that were drawn to.
    fn clear_drawn(&mut self) {
        let rows = self.q.chunks_mut(self.stride.max(1)).zip(self.prim.chunks_mut(self.stride.max(1)));
        for (q, prim) in rows {
            for Part { columns, drawn } in parts(&self.tiles.drawn, self.stride) {
                if drawn {
                    q[columns.clone()].fill(f32::NEG_INFINITY);
                    prim[columns].fill(SKY);
                }
            }
        }
        self.tiles.clear(self.stride);
        #[cfg(test)]
        self.hits.fill(0);
    }

    /// Parts of the columns from left to right, by whether a surface was drawn there.
    pub(crate) fn parts(&self) -> impl Iterator<Item = Part> {
        parts(&self.tiles.drawn, self.width.max(0) as usize)
    }

    /// Index of a sample.
    #[inline(always)]
    pub(crate) fn index(&self, sample: usize, x: i32, y: i32) -> usize {
        let rows = (self.y1 - self.y0) as usize;
        (sample * rows + (y - self.y0) as usize) * self.stride + x as usize
    }

    /// Whether no sample of the band lies in a box of fixed-point positions.
    #[inline(always)]
    pub(crate) fn misses(&self, x: [i32; 2], y: [i32; 2]) -> bool {
        let [[left, right], [top, bottom]] = self.reach;
        let (xa, xb) = ((x[0] - right + SUB - 1) >> 8, (x[1] - left) >> 8);
        let (ya, yb) = ((y[0] - bottom + SUB - 1) >> 8, (y[1] - top) >> 8);
        (xa > xb) | (ya > yb) | (xb < 0) | (xa >= self.width) | (yb < self.y0) | (ya >= self.y1)
    }

    /// Whether the samples in these columns of the image hide everything whose nearness is at most `q`.
    pub(crate) fn hides(&mut self, x: [i32; 2], q: f32) -> bool {
        let (from, to) = ((x[0] >> 8).max(0) as usize / TILE, (x[1] >> 8).clamp(0, self.width - 1) as usize / TILE);
        (from..=to).all(|tile| {
            if self.tiles.stale[tile] {
                let columns = tile * TILE..((tile + 1) * TILE).min(self.width as usize);
                // Column by column, so that the loop is vectorised.
                let mut least = [f32::INFINITY; TILE];
                for row in self.q.chunks(self.stride) {
                    for (least, q) in least.iter_mut().zip(&row[columns.clone()]) {
                        *least = if *q < *least { *q } else { *least };
                    }
                }
                self.tiles.least[tile] = least.into_iter().fold(f32::INFINITY, |a, b| if b < a { b } else { a });
                self.tiles.stale[tile] = false;
            }
            self.tiles.least[tile] > q
        })
    }

    /// Repeats the samples apart from the centre (or the centre, if there are no others) for several exposures, each starting from what
    /// was drawn so far.
    /// * `offsets`: offsets of all samples of all exposures; the existing ones come first.
    pub(crate) fn expose(&mut self, offsets: Vec<[i32; 2]>) {
        let plane = (self.y1 - self.y0).max(0) as usize * self.stride;
        let own = self.offsets.len();
        for s in own..offsets.len() {
            let from = if own == 1 { 0 } else { 1 + (s - 1) % (own - 1) };
            self.q.extend_from_within(from * plane..(from + 1) * plane);
            self.prim.extend_from_within(from * plane..(from + 1) * plane);
        }
        #[cfg(test)]
        self.hits.resize(self.q.len(), 0);
        self.offsets = offsets;
    }

    /// Marks columns as drawn to. Columns that are not marked are neither coloured nor cleared.
    pub(crate) fn drew(&mut self, x: [i32; 2]) {
        let (from, to) = ((x[0] >> 8).max(0) as usize / TILE, (x[1] >> 8).clamp(0, self.width - 1) as usize / TILE);
        for tiles in [&mut self.tiles.stale, &mut self.tiles.drawn] {
            if let Some(tiles) = tiles.get_mut(from..=to) {
                tiles.fill(true);
            }
        }
    }

    #[inline(always)]
    pub(crate) fn write(&mut self, i: usize, q: f32, prim: u32) {
        #[cfg(test)]
        {
            self.hits[i] += 1;
        }
        if q > self.q[i] || (q == self.q[i] && prim < self.prim[i]) {
            self.q[i] = q;
            self.prim[i] = prim;
        }
    }
}

/// Width of a tile, pixels; each tile keeps its least nearness.
const TILE: usize = 32;

/// Least nearness of all samples per tile: a surface that is farther is hidden there.
#[derive(Debug, Default)]
struct Tiles {
    least: Vec<f32>,
    stale: Vec<bool>,
    /// Whether a surface was drawn in the tile since the band was cleared.
    drawn: Vec<bool>,
}

/// Adjacent columns in all of which a surface was drawn, or in none.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Part {
    pub(crate) columns: Range<usize>,
    pub(crate) drawn: bool,
}

/// The first `width` columns, adjacent tiles of one kind joined.
fn parts(drawn: &[bool], width: usize) -> impl Iterator<Item = Part> {
    let mut from = 0;
    drawn.chunk_by(|a, b| a == b).map_while(move |tiles| {
        let columns = from..(from + tiles.len() * TILE).min(width);
        from = columns.end;
        (!columns.is_empty()).then(|| Part { columns, drawn: tiles[0] })
    })
}

impl Tiles {
    fn clear(&mut self, width: usize) {
        self.least.clear();
        self.least.resize(width.div_ceil(TILE), f32::NEG_INFINITY);
        for flags in [&mut self.stale, &mut self.drawn] {
            flags.clear();
            flags.resize(width.div_ceil(TILE), false);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_band_that_was_drawn_in_is_cleared_like_a_new_one() {
        let offsets = sample_offsets(4);
        let mut band = Band::new(0, 16, 203, offsets.clone());
        assert!(band.parts().eq([Part { columns: 0..203, drawn: false }]));
        for (from, to) in [(40, 95), (200, 202)] {
            for (s, y) in (0..offsets.len()).flat_map(|s| (0..16).map(move |y| (s, y))) {
                (from..=to).for_each(|x| band.write(band.index(s, x, y), 1.0, 7));
            }
            band.drew([from * 256 + 3, to * 256 + 255]);
        }
        let part = |columns, drawn| Part { columns, drawn };
        assert!(band.parts().eq([part(0..32, false), part(32..96, true), part(96..192, false), part(192..203, true)]));
        band.clear(32, 48, 203, &offsets);
        let new = Band::new(32, 48, 203, offsets);
        assert!(band.q == new.q && band.prim == new.prim && band.hits == new.hits && band.parts().eq(new.parts()));
    }
}
