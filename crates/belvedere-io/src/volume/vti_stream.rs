//! Blocks of VTK XML data: lengths, then bytes, compressed or not, as they are or in base64.

use super::ByteOrder;
use crate::base64::Base64;
use crate::{Fault, budget};
use flate2::{Decompress, FlushDecompress, Status};

/// Source of the bytes.
pub(super) enum Stream<'a> {
    Raw(&'a [u8]),
    Base64(Base64<'a>),
}

impl Stream<'_> {
    fn take(&mut self, n: usize) -> Result<Vec<u8>, String> {
        match self {
            Self::Base64(text) => text.take(n),
            Self::Raw(bytes) => {
                let have = bytes.len();
                let taken = bytes.split_at_checked(n);
                let (taken, rest) =
                    taken.ok_or_else(|| format!("its data ends {have} bytes into a part of {n}; it is cut off"))?;
                *bytes = rest;
                Ok(taken.to_vec())
            }
        }
    }

    /// Most bytes that may still be read.
    pub(super) fn at_most(&self) -> usize {
        match self {
            Self::Raw(bytes) => bytes.len(),
            Self::Base64(text) => text.at_most(),
        }
    }

    fn lengths(&mut self, n: usize, wide: bool, order: ByteOrder) -> Result<Vec<u64>, String> {
        let bytes = self.take(n * if wide { 8 } else { 4 })?;
        let big = order == ByteOrder::Big;
        let of = |b: &[u8]| b.iter().fold(0u64, |v, byte| v << 8 | u64::from(*byte));
        let each = bytes.chunks_exact(if wide { 8 } else { 4 }).map(|b| {
            let mut b = b.to_vec();
            if !big {
                b.reverse();
            }
            of(&b)
        });
        Ok(each.collect())
    }

    /// The `expected` bytes of an array.
    pub(super) fn array(
        &mut self,
        expected: usize,
        packed: bool,
        wide: bool,
        order: ByteOrder,
    ) -> Result<Vec<u8>, Fault> {
        if packed {
            return self.unpacked(expected, wide, order);
        }
        let declared = self.lengths(1, wide, order)?[0];
        if declared != expected as u64 {
            return Err(format!(
                "its array has {declared} bytes, its extent and type need {expected}; it is damaged, or its header_type is wrong"
            )
            .into());
        }
        Ok(self.take(expected)?)
    }

    /// Number of blocks, size of a block, size of the last if it is smaller, compressed sizes; then the blocks.
    fn unpacked(&mut self, expected: usize, wide: bool, order: ByteOrder) -> Result<Vec<u8>, Fault> {
        let head = self.lengths(3, wide, order)?;
        let [count, size, last] = [head[0], head[1], head[2]];
        let whole = if last == 0 { count } else { count.saturating_sub(1) };
        let total = whole.checked_mul(size).and_then(|n| n.checked_add(last));
        // Each block has a length that takes bytes of its own.
        if total != Some(expected as u64) || count > self.at_most() as u64 {
            return Err(format!(
                "its array is {count} blocks of {size} bytes and a last one of {last}, its extent and type need {expected}; it is damaged, or its header_type is wrong"
            )
            .into());
        }
        let sizes = self.lengths(count as usize, wide, order)?;
        let mut out = budget::room("the volume", expected)?;
        out.resize(expected, 0);
        let mut at = 0;
        for (i, packed) in sizes.iter().enumerate() {
            let packed = usize::try_from(*packed).ok().filter(|n| *n <= self.at_most());
            let packed =
                self.take(packed.ok_or_else(|| format!("its block {i} is longer than the file; it is damaged"))?)?;
            let length = if i as u64 + 1 == count && last != 0 { last } else { size } as usize;
            inflate(&packed, &mut out[at..at + length]).map_err(|e| format!("its block {i} of {count} {e}"))?;
            at += length;
        }
        Ok(out)
    }
}

fn inflate(packed: &[u8], out: &mut [u8]) -> Result<(), String> {
    let mut decoder = Decompress::new(true);
    match decoder.decompress(packed, out, FlushDecompress::Finish) {
        Ok(Status::StreamEnd) if decoder.total_out() == out.len() as u64 => Ok(()),
        Ok(_) => Err(format!("holds {} of {} bytes; it is damaged", decoder.total_out(), out.len())),
        Err(e) => Err(format!("is no valid zlib data ({e}); it is damaged")),
    }
}
