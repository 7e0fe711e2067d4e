//! Loops compiled for the vector instructions of the machine.
//!
//! The program is built for the oldest processors; a kernel is compiled for newer ones as well, and the best version is chosen at
//! run time. Only instructions differ: no operation is contracted or reordered, so all versions give the same
//! bits.

pub(crate) use belvedere_composite::color::nearest;
use pulp::{Arch, Simd, WithSimd};
use std::sync::LazyLock;

static ARCH: LazyLock<Arch> = LazyLock::new(Arch::new);

/// Values that are computed together.
pub(crate) const LANES: usize = 32;
pub(crate) type Lanes = [f32; LANES];
pub(crate) type IntLanes = [i32; LANES];

/// A computation that is compiled for several processors. [`Kernel::run`] and its hot callees must be `#[inline(always)]`.
pub(crate) trait Kernel {
    type Output;
    fn run(self) -> Self::Output;
}

struct With<K>(K);

impl<K: Kernel> WithSimd for With<K> {
    type Output = K::Output;

    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) -> K::Output {
        self.0.run()
    }
}

/// Runs the version for this processor.
#[inline]
pub(crate) fn run<K: Kernel>(kernel: K) -> K::Output {
    ARCH.dispatch(With(kernel))
}
