//! The samples of a level: tiles as they are stored, else made of those below them, else cut out of one above.

use super::encoding::Encoding;
use super::key::Key;
use super::picture::Picture;
use super::{Pyramid, Tile};
use crate::{Fault, IoError, Raster, Samples, budget};
use belvedere_scene::Progress;
use rayon::prelude::*;
use std::sync::{Arc, PoisonError};

/// Heights of a tile, metres, row by row from the north; `None` where it is all void.
type Heights = Option<Arc<[f32]>>;

impl Pyramid {
    /// Reads a level.
    ///
    /// # Errors
    /// [`IoError::Format`] beyond the limits, and if no tile can be read; [`IoError::Cancelled`].
    pub(crate) fn read(&self, level: usize, progress: &Progress) -> Result<Raster, IoError> {
        let bad = |e: Fault| IoError::format(&self.path, e);
        let info = self.info(level);
        let (width, count) = (info.width, self.samples(level));
        // Samples, heights, and a row of tiles.
        let peak =
            (count as u64).saturating_mul(9).saturating_add((width as u64).saturating_mul(16 * self.side as u64));
        self.limits.check(peak).map_err(|e| bad(e.into()))?;
        let mut samples: Vec<f32> = budget::room("the raster", count).map_err(|e| bad(e.into()))?;
        samples.resize(count, f32::NAN);
        let [cols, rows] = self.part(level);
        let side = self.side as u64;
        let zoom = self.zoom - level as u8;
        let tile_cols = cols.start / side..cols.end.div_ceil(side);
        for tile_row in rows.start / side..rows.end.div_ceil(side) {
            progress
                .tick("reading terrain", (tile_row * side).saturating_sub(rows.start) as f64 / info.height as f64)?;
            let read = |column| match Key::new(zoom, column, tile_row) {
                Some(key) => self.tile(key, progress).map(|heights| (column * side, heights)),
                None => Ok((column * side, None)),
            };
            let tiles: Vec<(u64, Heights)> =
                tile_cols.clone().into_par_iter().map(read).collect::<Result<_, Fault>>().map_err(bad)?;
            let top = tile_row * side;
            for row in rows.start.max(top)..rows.end.min(top + side) {
                let line = &mut samples[(row - rows.start) as usize * width..][..width];
                for (left, heights) in &tiles {
                    let Some(heights) = heights else { continue };
                    let (start, end) = (cols.start.max(*left), cols.end.min(left + side));
                    let from = &heights[((row - top) * side) as usize..][..side as usize];
                    line[(start - cols.start) as usize..(end - cols.start) as usize]
                        .copy_from_slice(&from[(start - left) as usize..(end - left) as usize]);
                }
            }
        }
        progress.tick("reading terrain", 1.0)?;
        Ok(Raster { info, samples: Samples::F32(samples), mask: None })
    }

    /// The best that there is of a tile.
    fn tile(&self, key: Key, progress: &Progress) -> Result<Heights, Fault> {
        if progress.is_cancelled() {
            return Ok(None);
        }
        if let Some(heights) = self.find(key).map(|tile| self.stored(tile)).transpose()?.flatten() {
            return Ok(Some(heights));
        }
        if self.is_refined(key) { self.halved(key, progress) } else { self.cut_of_above(key) }
    }

    /// The heights of a tile that is stored; `None` if it cannot be read, which is kept.
    fn stored(&self, tile: &Tile) -> Result<Heights, Fault> {
        let read = self.store.read(tile, &self.limits).and_then(|(bytes, file)| {
            let picture = Picture::of(&bytes, &self.limits)?;
            match picture.side == self.side {
                true => Ok((picture, file)),
                false => Err(format!("has {} samples along a side, others have {}", picture.side, self.side).into()),
            }
        });
        let mut kept = self.read.lock().unwrap_or_else(PoisonError::into_inner);
        match read {
            Ok((picture, file)) => {
                kept.files.extend(file.map(|file| (tile.key, file)));
                drop(kept);
                Ok(Some(heights(self.encoding, &picture)))
            }
            Err(e) if e.is_of_memory() => Err(e),
            Err(e) => {
                kept.damaged.insert(tile.key, e.to_string());
                Ok(None)
            }
        }
    }

    /// A tile of the means of four samples each of those below it.
    fn halved(&self, key: Key, progress: &Progress) -> Result<Heights, Fault> {
        let side = self.side;
        let mut out = vec![f32::NAN; side * side];
        for (quarter, below) in key.below().into_iter().enumerate() {
            let Some(heights) = below.map(|below| self.tile(below, progress)).transpose()?.flatten() else { continue };
            let (left, top) = (quarter % 2 * side / 2, quarter / 2 * side / 2);
            for row in 0..side / 2 {
                for col in 0..side / 2 {
                    let four = [0, 1, side, side + 1].map(|k| heights[2 * row * side + 2 * col + k]);
                    let (sum, known) =
                        four.iter().filter(|h| h.is_finite()).fold((0.0, 0.0), |(sum, n), h| (sum + h, n + 1.0));
                    // Without a known sample 0 / 0.
                    out[(top + row) * side + left + col] = sum / known;
                }
            }
        }
        Ok(Some(out.into()))
    }

    /// The part of the nearest tile above, between whose samples heights are bilinear.
    fn cut_of_above(&self, key: Key) -> Result<Heights, Fault> {
        for steps in 1..=key.zoom() {
            let Some(above) = key.above(steps) else { return Ok(None) };
            let Some(heights) = self.kept_above(above)? else { continue };
            let side = self.side;
            let [left, top] = key.place().map(|n| n % (1 << steps));
            let at = |n: u64, k: usize| {
                let at = ((n * side as u64) as f64 + k as f64 + 0.5) / (1u64 << steps) as f64 - 0.5;
                let at = at.clamp(0.0, side as f64 - 1.0);
                let first = (at.floor() as usize).min(side - 2);
                (first, (at - first as f64) as f32)
            };
            let height = |i: usize| {
                let ((c, u), (r, v)) = (at(left, i % side), at(top, i / side));
                let four = [0, 1, side, side + 1].map(|k| heights[r * side + c + k]);
                let weights = [(1.0 - u) * (1.0 - v), u * (1.0 - v), (1.0 - u) * v, u * v];
                // A void counts only where it has a weight.
                four.iter().zip(weights).filter(|(_, w)| *w > 0.0).map(|(h, w)| h * w).sum()
            };
            return Ok(Some((0..side * side).map(height).collect()));
        }
        Ok(None)
    }

    /// A stored tile that may stand in for many.
    fn kept_above(&self, key: Key) -> Result<Heights, Fault> {
        let Some(tile) = self.find(key) else { return Ok(None) };
        let kept = || self.read.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some((last, heights)) = &kept().above
            && *last == key
        {
            return Ok(Some(heights.clone()));
        }
        let heights = self.stored(tile)?;
        if let Some(heights) = &heights {
            kept().above = Some((key, heights.clone()));
        }
        Ok(heights)
    }
}

fn heights(encoding: Encoding, picture: &Picture) -> Arc<[f32]> {
    picture.pixels.iter().map(|pixel| encoding.height(*pixel)).collect()
}
