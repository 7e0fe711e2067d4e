//! A tiny writer of DICOM for tests.

/// How elements are stored.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Syntax {
    Implicit,
    Explicit,
    BigEndian,
    Deflated,
    RunLengths,
    Jpeg,
    /// Named, but with pixels as they are.
    Named(&'static str),
}

impl Syntax {
    fn uid(self) -> String {
        let end = match self {
            Self::Implicit => "",
            Self::Explicit => ".1",
            Self::BigEndian => ".2",
            Self::Deflated => ".1.99",
            Self::RunLengths => ".5",
            Self::Jpeg => ".4.50",
            Self::Named(end) => end,
        };
        format!("1.2.840.10008.1.2{end}")
    }

    fn number(self, v: u32, size: usize) -> Vec<u8> {
        let mut bytes = v.to_le_bytes()[..size].to_vec();
        if self == Self::BigEndian {
            bytes.reverse();
        }
        bytes
    }

    /// An element; the value is of even length.
    pub(crate) fn element(self, tag: u32, kind: &[u8; 2], value: &[u8]) -> Vec<u8> {
        let mut value = value.to_vec();
        if value.len() % 2 == 1 {
            value.push(if kind == b"UI" || kind == b"OB" { 0 } else { b' ' });
        }
        let length = value.len() as u32;
        let mut out = [self.number(tag >> 16, 2), self.number(tag & 0xffff, 2)].concat();
        match (self, kind) {
            (Self::Implicit, _) => out.extend(self.number(length, 4)),
            (_, b"OB" | b"OW" | b"SQ" | b"UN") => {
                out.extend(kind);
                out.extend([0, 0]);
                out.extend(self.number(length, 4));
            }
            _ => {
                out.extend(kind);
                out.extend(self.number(length, 2));
            }
        }
        out.extend(value);
        out
    }

    pub(crate) fn text(self, tag: u32, kind: &[u8; 2], text: &str) -> Vec<u8> {
        self.element(tag, kind, text.as_bytes())
    }

    pub(crate) fn short(self, tag: u32, value: u16) -> Vec<u8> {
        self.element(tag, b"US", &self.number(u32::from(value), 2))
    }

    /// A sequence of items, with lengths, or with marks at their ends.
    pub(crate) fn sequence(self, tag: u32, items: &[Vec<u8>], open: bool) -> Vec<u8> {
        let mark = |element: u32, length: u32| {
            [self.number(0xfffe, 2), self.number(element, 2), self.number(length, 4)].concat()
        };
        let mut body = Vec::new();
        for item in items {
            body.extend(mark(0xe000, if open { u32::MAX } else { item.len() as u32 }));
            body.extend(item);
            if open {
                body.extend(mark(0xe00d, 0));
            }
        }
        if !open {
            return self.element(tag, b"SQ", &body);
        }
        let mut out = self.element(tag, b"SQ", &[]);
        let end = out.len() - 4;
        out[end..].fill(0xff);
        [out, body, mark(0xe0dd, 0)].concat()
    }

    /// The pixels of frames, compressed as the syntax says; samples little-endian.
    pub(crate) fn pixels(self, frames: &[Vec<u8>], sample: usize) -> Vec<u8> {
        let pieces: Vec<Vec<u8>> = match self {
            Self::RunLengths => frames.iter().map(|frame| run_lengths(frame, sample)).collect(),
            Self::Jpeg => frames.to_vec(),
            _ => {
                let swap =
                    |s: &[u8]| if self == Self::BigEndian { s.iter().rev().copied().collect() } else { s.to_vec() };
                let all: Vec<u8> = frames.concat().chunks(sample).flat_map(swap).collect();
                return self.element(0x7fe0_0010, b"OW", &all);
            }
        };
        let mut out = self.element(0x7fe0_0010, b"OB", &[]);
        let end = out.len() - 4;
        out[end..].fill(0xff);
        let item = |bytes: &[u8]| [&[0xfe, 0xff, 0x00, 0xe0], &(bytes.len() as u32).to_le_bytes()[..], bytes].concat();
        out.extend(item(&[]));
        for mut piece in pieces {
            if piece.len() % 2 == 1 {
                piece.push(0);
            }
            out.extend(item(&piece));
        }
        [out, vec![0xfe, 0xff, 0xdd, 0xe0, 0, 0, 0, 0]].concat()
    }

    /// A file of these elements.
    pub(crate) fn file(self, elements: &[Vec<u8>]) -> Vec<u8> {
        let meta = Self::Explicit.text(0x0002_0010, b"UI", &self.uid());
        let mut out = [vec![0; 128], b"DICM".to_vec()].concat();
        out.extend(Self::Explicit.element(0x0002_0000, b"UL", &(meta.len() as u32).to_le_bytes()));
        out.extend(meta);
        let body = elements.concat();
        if self == Self::Deflated {
            let mut encoder = flate2::write::DeflateEncoder::new(Vec::new(), flate2::Compression::default());
            std::io::Write::write_all(&mut encoder, &body).expect("memory");
            out.extend(encoder.finish().expect("memory"));
        } else {
            out.extend(body);
        }
        out
    }
}

/// A plane for each byte of a sample, the most significant first: runs of equal bytes, else literals.
fn run_lengths(frame: &[u8], sample: usize) -> Vec<u8> {
    let mut header = vec![sample as u32];
    let mut body = Vec::new();
    for byte in (0..sample).rev() {
        header.push(64 + body.len() as u32);
        let plane: Vec<u8> = frame.iter().skip(byte).step_by(sample).copied().collect();
        let mut rest = &plane[..];
        while let Some(&first) = rest.first() {
            let run = rest.iter().take_while(|b| **b == first).count().min(128);
            if run > 1 {
                body.extend([(257 - run) as u8, first]);
                rest = &rest[run..];
            } else {
                body.extend([0, first]);
                rest = &rest[1..];
            }
        }
        if body.len() % 2 == 1 {
            body.push(128);
        }
    }
    header.resize(16, 0);
    [header.iter().flat_map(|n| n.to_le_bytes()).collect(), body].concat()
}
