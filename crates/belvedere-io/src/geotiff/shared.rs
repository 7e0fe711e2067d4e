//! Chunks that lie at one place of the file, as sparse writers store empty ones: they are decoded once.

use super::layout::Layout;
use std::collections::{HashMap, HashSet};
use std::ops::Range;
use std::sync::{Arc, Mutex, PoisonError};

/// Place in the file, its bytes, and rows of the chunk.
type Key = (u64, u64, usize);

/// Decoded chunks to which several entries of the file point.
pub(super) struct Shared {
    /// Places named more than once.
    places: HashSet<u64>,
    decoded: Mutex<Known>,
}

#[derive(Default)]
struct Known {
    chunks: HashMap<Key, Arc<[u8]>>,
    bytes: u64,
}

impl Shared {
    /// Most bytes of decoded chunks that are kept.
    pub(super) const MOST_BYTES: u64 = 32 << 20;

    /// Those of a window of columns and rows.
    pub(super) fn of(layout: &Layout, cols: &Range<usize>, rows: &Range<usize>) -> Self {
        let [wide, high] = [layout.chunk_width, layout.chunk_height];
        let chunks = |r: &Range<usize>, n: usize| r.start / n..r.end.div_ceil(n);
        let mut seen = HashSet::new();
        let positions = layout.positions(chunks(cols, wide), chunks(rows, high));
        let places = positions.filter(|&at| at != 0 && !seen.insert(at)).collect();
        Self { places, decoded: Mutex::default() }
    }

    /// The samples of a chunk that was decoded.
    pub(super) fn get(&self, key: Key) -> Option<Arc<[u8]>> {
        if !self.places.contains(&key.0) {
            return None;
        }
        self.decoded.lock().unwrap_or_else(PoisonError::into_inner).chunks.get(&key).cloned()
    }

    /// Keeps the samples of a chunk, if others lie at the same place.
    pub(super) fn keep(&self, key: Key, samples: &[u8]) {
        if !self.places.contains(&key.0) {
            return;
        }
        let mut known = self.decoded.lock().unwrap_or_else(PoisonError::into_inner);
        let bytes = samples.len() as u64;
        if known.bytes.saturating_add(bytes) <= Self::MOST_BYTES && !known.chunks.contains_key(&key) {
            known.bytes += bytes;
            known.chunks.insert(key, samples.into());
        }
    }
}
