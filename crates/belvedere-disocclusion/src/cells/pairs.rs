//! Hash table with a value for each pair of regions.

/// Hash table from unordered pairs of different numbers to a value; open addressing, a power of two in size.
pub(super) struct Pairs<T> {
    slots: Vec<(u64, T)>,
    used: usize,
    /// Slot that was found last: neighbouring nodes mostly need the same one.
    last: usize,
}

const FREE: u64 = u64::MAX;

impl<T: Copy + Default> Pairs<T> {
    pub(super) fn new() -> Self {
        Self { slots: vec![(FREE, T::default()); 1 << 10], used: 0, last: 0 }
    }

    /// The value of a pair, at first `T::default()`.
    #[inline]
    pub(super) fn entry(&mut self, a: u32, b: u32) -> &mut T {
        let key = u64::from(a.min(b)) << 32 | u64::from(a.max(b));
        if self.slots[self.last].0 != key {
            self.last = self.find(key);
        }
        &mut self.slots[self.last].1
    }

    fn find(&mut self, key: u64) -> usize {
        if 2 * self.used >= self.slots.len() {
            self.grow();
        }
        let i = self.slot(key);
        if self.slots[i].0 == FREE {
            self.slots[i].0 = key;
            self.used += 1;
        }
        i
    }

    fn slot(&self, key: u64) -> usize {
        let mask = self.slots.len() - 1;
        // Fibonacci hashing.
        let mut i = (key.wrapping_mul(0x9E37_79B9_7F4A_7C15) >> 32) as usize & mask;
        while self.slots[i].0 != key && self.slots[i].0 != FREE {
            i = (i + 1) & mask;
        }
        i
    }

    fn grow(&mut self) {
        let wider = vec![(FREE, T::default()); 2 * self.slots.len()];
        for entry in std::mem::replace(&mut self.slots, wider) {
            if entry.0 != FREE {
                let i = self.slot(entry.0);
                self.slots[i] = entry;
            }
        }
    }

    /// All pairs, the smaller number first, in no particular order.
    pub(super) fn iter(&self) -> impl Iterator<Item = ([u32; 2], T)> {
        self.slots.iter().filter(|s| s.0 != FREE).map(|&(key, value)| ([(key >> 32) as u32, key as u32], value))
    }
}
