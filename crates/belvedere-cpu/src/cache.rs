//! Cache between frames: values that are costly to compute and depend on the ground, not on the view.

use belvedere_scene::Heightfield;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError, Weak};

/// Values by the ground that they were computed from and a key of all other inputs; keeps the [`ENTRIES`] used last.
#[derive(Debug)]
pub(crate) struct GroundCache<K, V>(Mutex<Vec<Entry<K, V>>>);

/// Entries of a cache.
const ENTRIES: usize = 6;

#[derive(Debug)]
struct Entry<K, V> {
    /// A weak reference: a dropped ground frees its heights, but its address is not used again while the entry lives.
    ground: Weak<Heightfield>,
    key: K,
    value: V,
}

impl<K: PartialEq, V> Entry<K, V> {
    fn is_for(&self, ground: &Arc<Heightfield>, key: &K) -> bool {
        self.ground.as_ptr() == Arc::as_ptr(ground) && self.key == *key
    }
}

impl<K, V> Default for GroundCache<K, V> {
    fn default() -> Self {
        Self(Mutex::default())
    }
}

impl<K: PartialEq, V: Clone> GroundCache<K, V> {
    /// The value for `ground` and `key`, computed by `make` if it is not cached; `make` must depend on nothing else.
    pub(crate) fn get(&self, ground: &Arc<Heightfield>, key: K, make: impl FnOnce() -> V) -> V {
        if let Some(found) = self.find(ground, &key) {
            return found;
        }
        // Computed without the lock: `make` runs in parallel, and its threads may draw another frame meanwhile.
        let value = make();
        self.put(ground, key, value.clone());
        value
    }

    /// The value for `ground` and `key`, from now on the one used last.
    fn find(&self, ground: &Arc<Heightfield>, key: &K) -> Option<V> {
        let mut entries = lock(&self.0);
        let found = entries.iter().position(|e| e.is_for(ground, key))?;
        entries[found..].rotate_left(1);
        entries.last().map(|e| e.value.clone())
    }

    /// Removes the value for `ground` and `key`.
    pub(crate) fn take(&self, ground: &Arc<Heightfield>, key: &K) -> Option<V> {
        let mut entries = lock(&self.0);
        let found = entries.iter().position(|e| e.is_for(ground, key))?;
        Some(entries.remove(found).value)
    }

    /// Stores a value; replaces that of the same ground and key.
    pub(crate) fn put(&self, ground: &Arc<Heightfield>, key: K, value: V) {
        let mut entries = lock(&self.0);
        entries.retain(|e| e.ground.strong_count() > 0 && !e.is_for(ground, &key));
        if entries.len() >= ENTRIES {
            entries.remove(0);
        }
        entries.push(Entry { ground: Arc::downgrade(ground), key, value });
    }
}

/// Locks a mutex, poisoned or not: entries are written whole, so a panic leaves none half-written.
pub(crate) fn lock<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}

#[cfg(test)]
mod tests {
    use super::*;
    use belvedere_core::DVec2;

    fn ground() -> Arc<Heightfield> {
        Heightfield::measured(DVec2::ZERO, DVec2::ONE, 2, 2, vec![0.0; 4]).unwrap().into()
    }

    #[test]
    fn values_are_found_by_ground_and_key_alone() {
        let (cache, a, b) = (GroundCache::default(), ground(), ground());
        assert_eq!(a, b, "equal grounds are not the same ground");
        assert_eq!([cache.get(&a, 1, || 'p'), cache.get(&b, 1, || 'q'), cache.get(&a, 2, || 'r')], ['p', 'q', 'r']);
        let again = [cache.get(&a.clone(), 1, || 'x'), cache.get(&b, 1, || 'x'), cache.get(&a, 2, || 'x')];
        assert_eq!(again, ['p', 'q', 'r'], "kept");
        cache.put(&a, 1, 's');
        assert_eq!([cache.take(&a, &1), cache.take(&a, &1), cache.take(&b, &1)], [Some('s'), None, Some('q')]);
        assert_eq!(GroundCache::default().get(&a, 2, || 'y'), 'y', "caches share nothing");
    }

    #[test]
    fn the_value_not_used_for_longest_goes_first_and_those_of_freed_grounds_before() {
        let (cache, a) = (GroundCache::default(), ground());
        (0..ENTRIES).for_each(|key| assert_eq!(cache.get(&a, key, || key), key));
        assert_eq!(cache.get(&a, 0, || 99), 0);
        cache.get(&a, ENTRIES, || ENTRIES);
        assert_eq!([cache.take(&a, &0), cache.take(&a, &1), cache.take(&a, &2)], [Some(0), None, Some(2)]);
        for _ in 0..100 {
            assert_eq!(cache.get(&ground(), 3, || 77), 77, "an address used before is another ground");
        }
        assert_eq!(cache.take(&a, &3), Some(3), "freed grounds leave room");
    }
}
