//! Small files that state, or expand to, far more than they hold: whoever believes them runs out of memory.

mod blast;
mod packed;
mod stated;

pub use blast::{Blast, Budget, Fate, blast};

/// A small file that asks for much.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Bomb {
    /// Name of the file, whose ending says its format.
    pub name: String,
    /// Its content.
    pub bytes: Vec<u8>,
}

impl Bomb {
    fn new(name: impl Into<String>, bytes: impl Into<Vec<u8>>) -> Self {
        Self { name: name.into(), bytes: bytes.into() }
    }
}

/// Files of every format, the same in every run. Those of `largest` MiB or less when expanded; such as only state their size are always
/// among them.
pub fn bombs(largest: usize) -> Vec<Bomb> {
    let mut all = stated::all();
    all.extend(packed::all(largest << 20));
    all
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::collections::BTreeSet;

    #[test]
    fn they_are_small_and_each_has_its_own_name() {
        let all = bombs(64);
        let names: BTreeSet<_> = all.iter().map(|bomb| &bomb.name).collect();
        assert_eq!(names.len(), all.len());
        assert!(all.len() > 50, "{} files", all.len());
        let large = all.iter().find(|bomb| bomb.bytes.len() > 4 << 20);
        assert!(large.is_none(), "{}", large.map_or("", |bomb| &bomb.name));
    }
}
