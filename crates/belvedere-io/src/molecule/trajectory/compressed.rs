//! Compressed coordinates of XTC: whole numbers within a box, and runs of small differences.
//!
//! Coordinates are rounded to whole numbers. An atom is three of them above the least of the frame, joined into one
//! number of as many bits as the largest takes. A run of neighbours may follow, as differences in a smaller base: the
//! first to that atom, each further one to the neighbour before. The first neighbour stands before the atom itself,
//! because the atoms of water are nearest to its oxygen. The base may change by one third of a bit for each axis after
//! each run.

/// Bases of differences; three numbers of one take as many bits as its index. Those up to index 8 are not in use.
#[rustfmt::skip]
pub(super) const BASES: [u32; 73] = [
    0, 0, 0, 0, 0, 0, 0, 0, 0,
    8, 10, 12, 16, 20, 25, 32, 40, 50, 64, 80, 101, 128, 161, 203, 256, 322, 406, 512, 645, 812, 1024, 1290, 1625, 2048,
    2580, 3250, 4096, 5060, 6501, 8192, 10321, 13003, 16384, 20642, 26007, 32768, 41285, 52015, 65536, 82570, 104_031,
    131_072, 165_140, 208_063, 262_144, 330_280, 416_127, 524_287, 660_561, 832_255, 1_048_576, 1_321_122, 1_664_510,
    2_097_152, 2_642_245, 3_329_021, 4_194_304, 5_284_491, 6_658_042, 8_388_607, 10_568_983, 13_316_085, 16_777_216,
];

/// Largest extent whose numbers are joined; beyond it each has bits of its own.
pub(super) const JOINED: u64 = 0xff_ffff;

/// Bits that an atom takes at least: one for its place and one that tells whether the run changes.
const LEAST_BITS: u64 = 2;

/// The coordinates of a frame.
pub(super) struct Block<'b> {
    pub(super) atoms: usize,
    /// Whole numbers in a unit of length.
    pub(super) precision: f32,
    pub(super) least: [i32; 3],
    pub(super) most: [i32; 3],
    /// Index of the first base of differences.
    pub(super) small: i32,
    pub(super) bytes: &'b [u8],
}

impl Block<'_> {
    /// Places of the atoms, times a factor; all are finite.
    pub(super) fn places(&self, factor: f64) -> Result<Vec<[f32; 3]>, String> {
        if !(self.precision > 0.0 && self.precision.is_finite()) {
            let precision = self.precision;
            return Err(format!(
                "its precision is {precision} where a number above 0 is needed; the file is damaged, copy it again"
            ));
        }
        let (atoms, bits) = (self.atoms, 8 * self.bytes.len() as u64);
        if (atoms as u64).saturating_mul(LEAST_BITS) > bits {
            let bytes = self.bytes.len();
            return Err(format!(
                "{atoms} atoms are stated in {bytes} bytes, which hold {} at most; the file is damaged, copy it again",
                bits / LEAST_BITS
            ));
        }
        let whole = Whole::new(self.least, self.most)?;
        let mut out =
            Places { block: self, scale: factor / f64::from(self.precision), places: Vec::with_capacity(atoms) };
        let mut bits = Bits { bytes: self.bytes, at: 0 };
        let mut base = usize::try_from(self.small).unwrap_or(usize::MAX);
        let mut neighbours = 0;
        while out.places.len() < atoms {
            let ended = || {
                let bytes = self.bytes.len();
                format!("its {bytes} bytes end before the last of {atoms} atoms; the file is damaged, copy it again")
            };
            let anchor = whole.next(&mut bits).ok_or_else(ended)?;
            // A run is as long as the one before unless it is stated.
            let mut change = 1;
            if bits.take(1).ok_or_else(ended)? == 1 {
                let code = bits.take(5).ok_or_else(ended)?;
                (neighbours, change) = (code / 3, code % 3);
            }
            if neighbours > 0 {
                let small = Small::new(base)?;
                let mut before = small.next(anchor, &mut bits).ok_or_else(ended)?;
                out.push(before)?;
                out.push(anchor)?;
                for _ in 1..neighbours {
                    before = small.next(before, &mut bits).ok_or_else(ended)?;
                    out.push(before)?;
                }
            } else {
                out.push(anchor)?;
            }
            base = match change {
                0 => base.saturating_sub(1),
                1 => base,
                _ => base.saturating_add(1),
            };
        }
        Ok(out.places)
    }
}

/// Places that are read so far.
struct Places<'b> {
    block: &'b Block<'b>,
    scale: f64,
    places: Vec<[f32; 3]>,
}

impl Places<'_> {
    fn push(&mut self, numbers: [i64; 3]) -> Result<(), String> {
        let (atoms, atom) = (self.block.atoms, self.places.len() + 1);
        if atom > atoms {
            return Err(format!("a run goes on after the last of {atoms} atoms; the file is damaged, copy it again"));
        }
        for (number, (least, most)) in numbers.iter().zip(self.block.least.iter().zip(&self.block.most)) {
            if *number < i64::from(*least) || *number > i64::from(*most) {
                return Err(format!(
                    "atom {atom} has the number {number} where the frame states {least} to {most}; the file is damaged, copy it again"
                ));
            }
        }
        let place = numbers.map(|number| (number as f64 * self.scale) as f32);
        if !place.iter().all(|value| value.is_finite()) {
            let precision = self.block.precision;
            return Err(format!(
                "atom {atom} is not at a finite place with the stated precision of {precision:e}; the file is damaged, copy it again"
            ));
        }
        self.places.push(place);
        Ok(())
    }
}

/// Coding of the atoms that are no neighbours.
struct Whole {
    least: [i64; 3],
    coding: Coding,
}

enum Coding {
    /// One number of so many bits, with the extents as mixed base.
    Joined { bits: u32, y: u64, z: u64 },
    /// Three numbers of so many bits.
    Apart { bits: [u32; 3] },
}

impl Whole {
    fn new(least: [i32; 3], most: [i32; 3]) -> Result<Self, String> {
        let mut extents = [0; 3];
        for (extent, (least, most)) in extents.iter_mut().zip(least.iter().zip(&most)) {
            *extent = match u64::try_from(i64::from(*most) - i64::from(*least)) {
                Ok(difference) if difference < u64::from(u32::MAX) => difference + 1,
                _ => {
                    return Err(format!(
                        "its coordinates go from {least} to {most}, which is no extent; the file is damaged, copy it again"
                    ));
                }
            };
        }
        let [x, y, z] = extents;
        let coding = if extents.iter().any(|extent| *extent > JOINED) {
            Coding::Apart { bits: extents.map(|extent| 64 - extent.leading_zeros()) }
        } else {
            let product = u128::from(x) * u128::from(y) * u128::from(z);
            Coding::Joined { bits: 128 - product.leading_zeros(), y, z }
        };
        Ok(Self { least: least.map(i64::from), coding })
    }

    /// `None` at the end of the bits.
    fn next(&self, bits: &mut Bits) -> Option<[i64; 3]> {
        let above = match &self.coding {
            Coding::Joined { bits: count, y, z } => bits.joined(*count, *y, *z)?,
            Coding::Apart { bits: [x, y, z] } => [bits.take(*x)?, bits.take(*y)?, bits.take(*z)?],
        };
        let mut out = self.least;
        out.iter_mut().zip(above).for_each(|(number, above)| *number += above as i64);
        Some(out)
    }
}

/// Coding of neighbours.
struct Small {
    bits: u32,
    base: u64,
}

impl Small {
    fn new(index: usize) -> Result<Self, String> {
        match BASES.get(index) {
            Some(base) if *base > 0 => Ok(Self { bits: index as u32, base: u64::from(*base) }),
            _ => {
                let largest = BASES.len() - 1;
                let text = "the index of a base of differences is";
                Err(format!("{text} {index} where 9 to {largest} is needed; the file is damaged, copy it again"))
            }
        }
    }

    /// The neighbour of an atom; `None` at the end of the bits.
    fn next(&self, of: [i64; 3], bits: &mut Bits) -> Option<[i64; 3]> {
        let above = bits.joined(self.bits, self.base, self.base)?;
        let half = (self.base / 2) as i64;
        let mut out = of;
        out.iter_mut().zip(above).for_each(|(number, above)| *number += above as i64 - half);
        Some(out)
    }
}

/// Bits from the highest of each byte to the lowest.
struct Bits<'b> {
    bytes: &'b [u8],
    /// Bits that are read.
    at: u64,
}

impl Bits<'_> {
    /// A number of up to 56 bits, the highest first; `None` where fewer are left.
    fn take(&mut self, count: u32) -> Option<u64> {
        let end = self.at + u64::from(count);
        if end > 8 * self.bytes.len() as u64 {
            return None;
        }
        let rest = self.bytes.get((self.at / 8) as usize..)?;
        let window = if let Some(window) = rest.first_chunk() {
            u64::from_be_bytes(*window)
        } else {
            rest.iter().rev().fold(0, |window, byte| (window >> 8) | (u64::from(*byte) << 56))
        };
        let number = (window << (self.at % 8)).checked_shr(64 - count).unwrap_or(0);
        self.at = end;
        Some(number)
    }

    /// A number of up to 56 bits as bytes of which the lowest is first; the last one may have fewer bits.
    fn low_first(&mut self, count: u32) -> Option<u64> {
        let number = self.take(count)?;
        let odd = count % 8;
        let whole = count - odd;
        let bytes = (number >> odd).swap_bytes().checked_shr(64 - whole).unwrap_or(0);
        Some(bytes | ((number & ((1 << odd) - 1)) << whole))
    }

    /// Three numbers that are joined as one of up to 72 bits: (x times the extent of y plus y) times that of z plus z.
    fn joined(&mut self, count: u32, y: u64, z: u64) -> Option<[u64; 3]> {
        let low = self.low_first(count.min(56))?;
        if count <= 56 {
            let rest = low % (y * z);
            return Some([low / (y * z), rest / z, rest % z]);
        }
        let number = u128::from(low) | (u128::from(self.low_first(count - 56)?) << 56);
        let (y, z) = (u128::from(y), u128::from(z));
        let rest = number % (y * z);
        Some([number / (y * z), rest / z, rest % z].map(|number| number as u64))
    }
}
