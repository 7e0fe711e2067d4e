//! Bytes of numbers that are not copied.

use glam::DVec3;
use std::ops::Deref;
use std::sync::Arc;

/// Bytes that their owner shares: numbers are little-endian, rows follow one another without gaps.
#[derive(Clone)]
pub struct SharedBytes(Arc<dyn AsRef<[u8]> + Send + Sync>);

impl<T: AsRef<[u8]> + Send + Sync + 'static> From<T> for SharedBytes {
    fn from(owner: T) -> Self {
        Self(Arc::new(owner))
    }
}

impl Deref for SharedBytes {
    type Target = [u8];

    fn deref(&self) -> &[u8] {
        (*self.0).as_ref()
    }
}

/// Numbers of their bytes.
pub(crate) fn f64s(bytes: &[u8]) -> impl Iterator<Item = f64> + '_ {
    bytes.as_chunks::<8>().0.iter().map(|b| f64::from_le_bytes(*b))
}

/// Positions of their bytes.
pub(crate) fn positions(bytes: &[u8]) -> impl Iterator<Item = DVec3> + '_ {
    bytes.as_chunks::<24>().0.iter().map(|b| {
        let mut numbers = f64s(b);
        DVec3::from_array(std::array::from_fn(|_| numbers.next().unwrap_or_default()))
    })
}
