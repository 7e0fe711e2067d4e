//! Memory that the pictures of a session keep. A renderer's estimate of a picture includes its caches, so that they count once in a budget.

use belvedere_scene::Frame;
use std::sync::atomic::{AtomicU64, Ordering};

/// Bytes that the pictures of a session left in the process.
#[derive(Debug, Default)]
pub(crate) struct Kept(AtomicU64);

impl Kept {
    /// Bytes of those that the process holds that others hold.
    pub(crate) fn others(&self, held: u64) -> u64 {
        held.saturating_sub(self.0.load(Ordering::Relaxed))
    }

    /// Takes note of a picture that is drawn.
    ///
    /// * `before`, `after`: bytes that the process held when it was begun and when it was done.
    /// * `frame`: bytes of the picture itself, which whoever asked for it holds or drops.
    pub(crate) fn drawn(&self, [before, after]: [u64; 2], frame: u64) {
        let own = self.0.load(Ordering::Relaxed).min(before);
        self.0.store((own + after.saturating_sub(frame)).saturating_sub(before), Ordering::Relaxed);
    }
}

/// Bytes of a picture.
pub(crate) fn bytes_of(frame: &Frame) -> u64 {
    let Frame { color, depth, id, world, .. } = frame;
    let world = world.as_ref().map_or(0, |world| size_of_val(&world[..]));
    (size_of_val(&color[..]) + size_of_val(&depth[..]) + size_of_val(&id[..]) + world) as u64
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_pictures_leave_is_theirs_and_what_comes_later_is_not() {
        let kept = Kept::default();
        assert_eq!(kept.others(100), 100);
        // A cache of 30 and a frame of 5, which is dropped; the next picture adds 10 to the cache.
        kept.drawn([100, 135], 5);
        assert_eq!(kept.others(130), 100);
        kept.drawn([130, 145], 5);
        assert_eq!([kept.others(140), kept.others(240)], [100, 200], "100 that another session holds since");
        // A cache that shrinks.
        kept.drawn([240, 225], 5);
        assert_eq!(kept.others(220), 200);
        // Pictures whose caches were dropped meanwhile.
        kept.drawn([10, 12], 2);
        assert_eq!(kept.others(10), 0);
    }
}
