//! LZW as TIFF has it: codes of 9 to 12 bits, most significant bit first, widths switched one code early.
//!
//! Source: TIFF 6.0, section 13. Every string of the table has just been written to the output, one byte after the
//! previous string, so that the table holds places in the output instead of strings.

const CLEAR: usize = 256;
const END: usize = 257;
const FIRST: usize = 258;
const MAX_CODES: usize = 4096;
/// Short strings are copied by a move of this many bytes, which needs no loop.
const SHORT: usize = 16;

/// Place and length of the string of each code from [`FIRST`] on; kept from call to call.
#[derive(Default)]
pub(super) struct Lzw {
    table: Vec<[u32; 2]>,
}

impl Lzw {
    /// Fills `out` from `raw`; returns the number of bytes written.
    pub(super) fn decode(&mut self, raw: &[u8], out: &mut [u8]) -> Result<usize, &'static str> {
        if u32::try_from(out.len()).is_err() {
            return Err("a strip or tile of 4 GiB or more");
        }
        self.table.resize(MAX_CODES, [0; 2]);
        let mut bytes = raw.iter();
        let (mut buffer, mut filled, mut width) = (0u64, 0u32, 9u32);
        let (mut next, mut previous, mut at) = (FIRST, None::<(usize, usize)>, 0usize);
        while at < out.len() {
            while filled < width {
                let Some(&byte) = bytes.next() else { return Ok(at) };
                buffer = buffer << 8 | u64::from(byte);
                filled += 8;
            }
            filled -= width;
            let code = (buffer >> filled) as usize & ((1 << width) - 1);
            if code == CLEAR {
                (width, next, previous) = (9, FIRST, None);
                continue;
            }
            if code == END {
                break;
            }
            let length = match previous {
                _ if code < CLEAR => {
                    out[at] = code as u8;
                    1
                }
                Some(_) if code < next => {
                    let [from, length] = self.table[code];
                    copy(out, from as usize, at, length as usize)
                }
                // The string that is only being defined: the previous one and its first byte again.
                Some((from, length)) if code == next && next < MAX_CODES => {
                    let copied = copy(out, from, at, length);
                    let first = out[at];
                    match out.get_mut(at + copied) {
                        Some(last) if copied == length => {
                            *last = first;
                            copied + 1
                        }
                        _ => copied,
                    }
                }
                _ => return Err("a code without a string"),
            };
            if let Some((from, length)) = previous
                && next < MAX_CODES
            {
                self.table[next] = [from as u32, length as u32 + 1];
                next += 1;
                if next == (1 << width) - 1 && width < 12 {
                    width += 1;
                }
            }
            previous = Some((at, length));
            at += length;
        }
        Ok(at)
    }
}

/// Copies `length` bytes from `from` to `to`, as many as there is room for; returns how many.
fn copy(out: &mut [u8], from: usize, to: usize, length: usize) -> usize {
    if length <= SHORT
        && to + SHORT <= out.len()
        && let Some(&bytes) = out[from..].first_chunk::<SHORT>()
    {
        out[to..to + SHORT].copy_from_slice(&bytes);
        return length;
    }
    let length = length.min(out.len() - to);
    out.copy_within(from..from + length, to);
    length
}

#[cfg(test)]
mod tests {
    use super::*;
    use belvedere_testkit::Random;

    fn encode(bytes: &[u8]) -> Vec<u8> {
        weezl::encode::Encoder::with_tiff_size_switch(weezl::BitOrder::Msb, 8).encode(bytes).unwrap()
    }

    #[test]
    fn what_another_encoder_wrote() {
        let mut random = Random::new(3);
        for colors in [1, 2, 5, 256] {
            for len in [0, 1, 2, 15, 16, 17, 40, 1000, 70_000] {
                let bytes: Vec<u8> = (0..len).map(|_| random.below(colors) as u8).collect();
                let mut out = vec![0; len];
                assert_eq!(Lzw::default().decode(&encode(&bytes), &mut out), Ok(len));
                assert!(out == bytes, "{colors} {len}");
                let mut part = vec![0; len / 2];
                assert_eq!(Lzw::default().decode(&encode(&bytes), &mut part), Ok(len / 2), "stops when full");
                assert!(part[..] == bytes[..len / 2]);
            }
        }
    }

    #[test]
    fn rubbish_is_survived() {
        let mut random = Random::new(4);
        let mut lzw = Lzw::default();
        for _ in 0..20_000 {
            let start = if random.below(2) == 0 { vec![0x80, 0] } else { Vec::new() };
            let mut bytes: Vec<u8> =
                start.into_iter().chain((0..random.below(60)).map(|_| random.below(256) as u8)).collect();
            if random.below(2) == 0 {
                bytes = encode(&bytes.repeat(3));
                let at = random.below(bytes.len());
                bytes[at] ^= 1 << random.below(8);
            }
            let mut out = vec![0; random.below(300)];
            let room = out.len();
            assert!(lzw.decode(&bytes, &mut out).is_ok_and(|n| n <= room) || room > 0);
        }
    }
}
