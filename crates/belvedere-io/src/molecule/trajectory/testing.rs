//! Writers of small trajectories for tests.

use super::compressed::{BASES, JOINED};

/// What a DCD file holds besides coordinates.
#[derive(Clone, Copy, Default)]
pub(crate) struct Layout {
    /// Whether the highest byte of a number is first.
    pub(crate) big: bool,
    /// Whether X-PLOR wrote it rather than CHARMM; it has no unit cell and no fourth dimension.
    pub(crate) xplor: bool,
    /// Whether each frame begins with a unit cell.
    pub(crate) cell: bool,
    /// Whether each frame ends with a fourth dimension.
    pub(crate) fourth: bool,
    /// The first atoms are fixed: later frames leave so many out.
    pub(crate) fixed: usize,
}

/// A little-endian DCD file with a unit cell. Places are in angstrom.
pub(crate) fn write_dcd(frames: &[Vec<[f32; 3]>], step_ps: f64) -> Vec<u8> {
    write_dcd_as(frames, step_ps, Layout { cell: true, ..Layout::default() })
}

/// A DCD file of a layout. Places are in angstrom.
pub(crate) fn write_dcd_as(frames: &[Vec<[f32; 3]>], step_ps: f64, layout: Layout) -> Vec<u8> {
    let mut out = Vec::new();
    let swap = |bytes: &mut [u8]| {
        if layout.big {
            bytes.reverse()
        }
    };
    let word = |value: u32| {
        let mut bytes = value.to_le_bytes();
        swap(&mut bytes);
        bytes
    };
    let double = |value: f64| {
        let mut bytes = value.to_le_bytes();
        swap(&mut bytes);
        bytes
    };
    let mut record = |body: &[u8]| {
        out.extend(word(body.len() as u32));
        out.extend(body);
        out.extend(word(body.len() as u32));
    };
    let atoms = frames.first().map_or(0, Vec::len);
    // Ten steps of the simulation between frames.
    let delta = step_ps / 10.0 / 0.048_888_21;
    let mut numbers = [0; 20].map(word);
    numbers[0] = word(frames.len() as u32);
    numbers[2] = word(10);
    numbers[8] = word(layout.fixed as u32);
    if layout.xplor {
        let bytes = double(delta);
        numbers[9].copy_from_slice(&bytes[..4]);
        numbers[10].copy_from_slice(&bytes[4..]);
    } else {
        numbers[9] = word((delta as f32).to_bits());
        numbers[10] = word(u32::from(layout.cell));
        numbers[11] = word(u32::from(layout.fourth));
        numbers[19] = word(24);
    }
    record(&[b"CORD".as_slice(), numbers.as_flattened()].concat());
    record(&[word(1).as_slice(), &[b' '; 80]].concat());
    record(&word(atoms as u32));
    if layout.fixed > 0 {
        let free: Vec<_> = (layout.fixed + 1..=atoms).map(|atom| word(atom as u32)).collect();
        record(free.as_flattened());
    }
    for (i, frame) in frames.iter().enumerate() {
        if layout.cell {
            record([80.0, 90.0, 80.0, 90.0, 90.0, 80.0].map(double).as_flattened());
        }
        let moved = &frame[if i == 0 { 0 } else { layout.fixed }..];
        for axis in 0..3 {
            let values: Vec<_> = moved.iter().map(|place| word(place[axis].to_bits())).collect();
            record(values.as_flattened());
        }
        if layout.fourth {
            record(&vec![0; 4 * moved.len()]);
        }
    }
    out
}

/// An XTC file: uncompressed up to nine atoms, otherwise rounded to a hundredth of an angstrom, with three successive
/// atoms as a run where they are close enough. Places are in angstrom.
pub(crate) fn write_xtc(frames: &[Vec<[f32; 3]>], step_ps: f64) -> Vec<u8> {
    write_xtc_as(frames, step_ps, 1995)
}

/// An XTC file with magic number 1995 or 2023.
pub(crate) fn write_xtc_as(frames: &[Vec<[f32; 3]>], step_ps: f64, magic: i32) -> Vec<u8> {
    let mut out = Vec::new();
    for (i, frame) in frames.iter().enumerate() {
        let atoms = frame.len() as u32;
        let side = |on: bool| if on { 8.0_f32 } else { 0.0 };
        out.extend(magic.to_be_bytes());
        out.extend(atoms.to_be_bytes());
        out.extend((10 * i as u32).to_be_bytes());
        out.extend(((i as f64 * step_ps) as f32).to_be_bytes());
        out.extend((0..9).flat_map(|k| side(k % 4 == 0).to_be_bytes()));
        out.extend(atoms.to_be_bytes());
        if atoms <= 9 {
            out.extend(frame.as_flattened().iter().flat_map(|value| (value / 10.0).to_be_bytes()));
            continue;
        }
        let places: Vec<[i64; 3]> =
            frame.iter().map(|place| place.map(|v| (f64::from(v) * 100.0).round() as i64)).collect();
        let bound = |axis: usize, largest: bool| {
            let values = places.iter().map(|place| place[axis]);
            if largest { values.max() } else { values.min() }.unwrap_or(0)
        };
        let (least, most) = ([0, 1, 2].map(|axis| bound(axis, false)), [0, 1, 2].map(|axis| bound(axis, true)));
        let widest = places.chunks_exact(3).flat_map(|three| [minus(three[0], three[1]), minus(three[2], three[0])]);
        let widest = widest.flatten().map(i64::abs).max().unwrap_or(0);
        let small = BASES.iter().position(|base| i64::from(base / 2) > widest);
        out.extend(1000.0_f32.to_be_bytes());
        out.extend([least, most].as_flattened().iter().flat_map(|v| (*v as i32).to_be_bytes()));
        out.extend((small.unwrap_or(9) as u32).to_be_bytes());
        let mut bits = packed(&places, least, most, small);
        match magic {
            2023 => out.extend((bits.len() as u64).to_be_bytes()),
            _ => out.extend((bits.len() as u32).to_be_bytes()),
        }
        bits.resize(bits.len().next_multiple_of(4), 0);
        out.extend(bits);
    }
    out
}

/// Places as bits; `small`: index of the base of a run of three.
fn packed(places: &[[i64; 3]], least: [i64; 3], most: [i64; 3], small: Option<usize>) -> Vec<u8> {
    let mut bits = Bits::default();
    let extents = minus(most, least).map(|v| v as u64 + 1);
    let bits_of = |value: u128| 128 - value.leading_zeros();
    let whole = |bits: &mut Bits, place: [i64; 3]| {
        let above = minus(place, least).map(|v| v as u64);
        if extents.iter().any(|extent| *extent > JOINED) {
            above.iter().zip(extents).for_each(|(v, extent)| bits.put((*v).into(), bits_of(extent.into())));
        } else {
            bits.joined(above, extents, bits_of(extents.iter().map(|extent| u128::from(*extent)).product()));
        }
    };
    let (mut threes, mut singles) = (places.chunks_exact(3), places);
    if let Some(small) = small {
        let half = i64::from(BASES[small] / 2);
        for (i, three) in threes.by_ref().enumerate() {
            whole(&mut bits, three[1]);
            // The first says that two neighbours follow and the base stays, the others that nothing changes.
            if i == 0 {
                bits.put(0b10_0111, 6)
            } else {
                bits.put(0, 1)
            }
            for difference in [minus(three[0], three[1]), minus(three[2], three[0])] {
                bits.joined(difference.map(|v| (v + half) as u64), [BASES[small].into(); 3], small as u32);
            }
        }
        singles = threes.remainder();
    }
    for place in singles {
        whole(&mut bits, *place);
        bits.put(0b10_0001, 6);
    }
    bits.bytes
}

fn minus(a: [i64; 3], b: [i64; 3]) -> [i64; 3] {
    [a[0] - b[0], a[1] - b[1], a[2] - b[2]]
}

#[derive(Default)]
struct Bits {
    bytes: Vec<u8>,
    count: usize,
}

impl Bits {
    /// The highest bit first.
    fn put(&mut self, value: u128, count: u32) {
        for bit in (0..count).rev() {
            if self.count.is_multiple_of(8) {
                self.bytes.push(0);
            }
            self.bytes[self.count / 8] |= ((value >> bit & 1) as u8) << (7 - self.count % 8);
            self.count += 1;
        }
    }

    /// As one number, its lowest byte first.
    fn joined(&mut self, [x, y, z]: [u64; 3], extents: [u64; 3], count: u32) {
        let mut value =
            (u128::from(x) * u128::from(extents[1]) + u128::from(y)) * u128::from(extents[2]) + u128::from(z);
        for _ in 0..count / 8 {
            self.put(value & 255, 8);
            value >>= 8;
        }
        self.put(value, count % 8);
    }
}
