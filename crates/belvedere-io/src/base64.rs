//! Base64 (RFC 4648): whole texts as of data URIs, and units one after the other as VTK writes them.

/// The bytes of a whole text, padded or not.
pub(crate) fn decode(text: &str) -> Option<Vec<u8>> {
    let mut out = Vec::with_capacity(text.len() / 4 * 3);
    let (mut bits, mut held) = (0u32, 0);
    for c in text.trim_end_matches('=').bytes() {
        let value = match c {
            b'A'..=b'Z' => c - b'A',
            b'a'..=b'z' => c - b'a' + 26,
            b'0'..=b'9' => c - b'0' + 52,
            b'+' => 62,
            b'/' => 63,
            _ => return None,
        };
        bits = bits << 6 | u32::from(value);
        held += 6;
        if held >= 8 {
            held -= 8;
            out.push((bits >> held) as u8);
        }
    }
    Some(out)
}

/// Decodes bytes from text on demand: units one after the other, each padded by itself, white space anywhere.
pub(crate) struct Base64<'a> {
    text: &'a [u8],
    /// Decoded bytes not yet taken: at most 3.
    left: [u8; 3],
    count: usize,
}

impl<'a> Base64<'a> {
    pub(crate) fn new(text: &'a [u8]) -> Self {
        Self { text, left: [0; 3], count: 0 }
    }

    /// Most bytes that may still come.
    pub(crate) fn at_most(&self) -> usize {
        self.count + self.text.len() / 4 * 3 + 3
    }

    /// The next byte; `None` at the end of the text.
    fn next(&mut self) -> Result<Option<u8>, String> {
        if self.count == 0 && !self.quartet()? {
            return Ok(None);
        }
        let byte = self.left[0];
        self.left.rotate_left(1);
        self.count -= 1;
        Ok(Some(byte))
    }

    /// Exactly `n` bytes.
    pub(crate) fn take(&mut self, n: usize) -> Result<Vec<u8>, String> {
        let short = |at: usize| format!("its base64 data ends after {at} of {n} bytes; it is cut off");
        if n > self.at_most() {
            return Err(short(self.at_most()));
        }
        let mut out = Vec::with_capacity(n);
        while out.len() < n {
            match self.next()? {
                Some(byte) => out.push(byte),
                None => return Err(short(out.len())),
            }
        }
        Ok(out)
    }

    /// Decodes the next four characters; false at the end.
    fn quartet(&mut self) -> Result<bool, String> {
        let (mut bits, mut digits, mut padding) = (0u32, 0, 0);
        while digits + padding < 4 {
            let Some((&c, rest)) = self.text.split_first() else {
                return if digits + padding == 0 {
                    Ok(false)
                } else {
                    Err("its base64 data ends within four characters; it is cut off".into())
                };
            };
            self.text = rest;
            let digit = match c {
                b'A'..=b'Z' => c - b'A',
                b'a'..=b'z' => c - b'a' + 26,
                b'0'..=b'9' => c - b'0' + 52,
                b'+' => 62,
                b'/' => 63,
                b'=' if digits >= 2 => {
                    padding += 1;
                    continue;
                }
                _ if c.is_ascii_whitespace() => continue,
                _ => return Err(format!("its base64 data holds the byte {c}; it is damaged")),
            };
            if padding > 0 {
                return Err("its base64 data goes on within its padding; it is damaged".into());
            }
            bits |= u32::from(digit) << (18 - 6 * digits);
            digits += 1;
        }
        let [_, a, b, c] = bits.to_be_bytes();
        (self.left, self.count) = ([a, b, c], 3 - padding);
        Ok(true)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn units_follow_each_other() {
        let mut text = Base64::new(b"TWE= \n bi4=TWFu");
        assert_eq!(text.take(7).unwrap(), b"Man.Man");
        assert!(text.take(1).is_err());
        for bad in [&b"TWE"[..], b"T===", b"TW=u", b"TW?u"] {
            assert!(Base64::new(bad).take(3).is_err(), "{bad:?}");
        }
    }
}
