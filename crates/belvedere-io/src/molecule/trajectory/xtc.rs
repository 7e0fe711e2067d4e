//! XTC: frames of big-endian words, each with a head that states its length.
//!
//! Format: GROMACS, magic number 1995, and 2023 where the length has 64 bits. Up to nine atoms are plain numbers, more
//! are compressed. Lengths are in nanometres.

use super::compressed::Block;
use super::{Trajectory, Wanted, bytes_at, plain_ps};

/// Magic number of frames whose compressed length has 32 bits.
const SHORT: i32 = 1995;

/// Magic number of frames whose compressed length has 64 bits.
const LONG: i32 = 2023;

/// Atoms that are not compressed.
const PLAIN: usize = 9;

/// Bytes of the head that all frames have.
const HEAD: usize = 56;

/// Angstrom in a nanometre.
const ANGSTROM: f64 = 10.0;

/// Whether the first bytes are of such a file.
pub(super) fn is_xtc(bytes: &[u8]) -> bool {
    matches!(word(bytes, 0), Some(SHORT | LONG))
}

pub(super) fn read(bytes: &[u8], wanted: &Wanted) -> Result<Trajectory, String> {
    let mut out =
        Trajectory { format: "XTC", atoms: 0, frames_in_file: 0, frames: Vec::new(), step_ps: None, cut_off: false };
    let mut times = Vec::new();
    let mut rest = bytes;
    while !rest.is_empty() {
        let number = times.len() + 1;
        let named = |e: String| format!("frame {number}: {e}");
        let frame = match next(rest).map_err(named)? {
            Next::Whole(frame) => frame,
            Next::Cut { .. } if number > 1 => {
                out.cut_off = true;
                break;
            }
            Next::Cut { needed } => {
                let left = rest.len();
                return Err(format!(
                    "the file has {left} bytes and its first frame needs {needed}; it is cut off or damaged, copy it again"
                ));
            }
        };
        if number == 1 {
            out.atoms = frame.atoms;
        } else if frame.atoms != out.atoms {
            let (now, before) = (frame.atoms, out.atoms);
            return Err(format!(
                "frame {number} has {now} atoms and the frames before have {before}; write a trajectory of the same atoms"
            ));
        }
        if wanted.has(number - 1) {
            out.frames.push(frame.places().map_err(named)?);
        }
        times.push(frame.time_ps);
        rest = frame.after;
    }
    out.frames_in_file = times.len();
    out.step_ps = even_step(&times);
    Ok(out)
}

/// What comes next in a file.
enum Next<'b> {
    Whole(Frame<'b>),
    /// The bytes end before the frame does, which needs so many at least.
    Cut {
        needed: u64,
    },
}

/// A frame that is there in full.
struct Frame<'b> {
    atoms: usize,
    time_ps: f32,
    coordinates: Coordinates<'b>,
    /// Bytes behind it.
    after: &'b [u8],
}

enum Coordinates<'b> {
    /// Numbers of 4 bytes.
    Plain(&'b [u8]),
    Compressed(Block<'b>),
}

/// The frame at the start of the bytes; an error where its head contradicts itself.
fn next(bytes: &[u8]) -> Result<Next<'_>, String> {
    let Some(magic) = word(bytes, 0) else { return Ok(Next::Cut { needed: HEAD as u64 }) };
    if !matches!(magic, SHORT | LONG) {
        return Err(format!(
            "it begins with {magic} where {SHORT} or {LONG} is needed; the file is damaged, copy it again"
        ));
    }
    let (Some(stated), Some(time), Some(again)) = (word(bytes, 4), bytes_at(bytes, 12), word(bytes, 52)) else {
        return Ok(Next::Cut { needed: HEAD as u64 });
    };
    if stated != again {
        return Err(format!("it states {stated} atoms, then {again}; the file is damaged, copy it again"));
    }
    let Some(atoms) = usize::try_from(stated).ok().filter(|atoms| *atoms > 0) else {
        return Err(format!("it states {stated} atoms where 1 or more are needed; the file is damaged, copy it again"));
    };
    let time_ps = f32::from_be_bytes(time);
    let whole = |coordinates, after| Next::Whole(Frame { atoms, time_ps, coordinates, after });
    if atoms <= PLAIN {
        let length = 12 * atoms;
        let Some((numbers, after)) = bytes.get(HEAD..).and_then(|rest| rest.split_at_checked(length)) else {
            return Ok(Next::Cut { needed: (HEAD + length) as u64 });
        };
        return Ok(whole(Coordinates::Plain(numbers), after));
    }
    // Precision, least and most numbers, the index of the small base, then the length.
    let start = HEAD + 32 + if magic == LONG { 8 } else { 4 };
    let length = match magic {
        LONG => bytes_at(bytes, HEAD + 32).map(u64::from_be_bytes),
        _ => bytes_at(bytes, HEAD + 32).map(|length| u64::from(u32::from_be_bytes(length))),
    };
    let (Some(length), Some(precision)) = (length, bytes_at(bytes, HEAD)) else {
        return Ok(Next::Cut { needed: start as u64 });
    };
    let triple = |at| Some([word(bytes, at)?, word(bytes, at + 4)?, word(bytes, at + 8)?]);
    let (Some(least), Some(most), Some(small)) = (triple(HEAD + 4), triple(HEAD + 16), word(bytes, HEAD + 28)) else {
        return Ok(Next::Cut { needed: start as u64 });
    };
    let needed = (start as u64).saturating_add(length.saturating_add(length.wrapping_neg() % 4));
    let parts = || {
        let (frame, after) = bytes.split_at_checked(usize::try_from(needed).ok()?)?;
        Some((frame.get(start..)?.get(..usize::try_from(length).ok()?)?, after))
    };
    let Some((packed, after)) = parts() else { return Ok(Next::Cut { needed }) };
    let block = Block { atoms, precision: f32::from_be_bytes(precision), least, most, small, bytes: packed };
    Ok(whole(Coordinates::Compressed(block), after))
}

impl Frame<'_> {
    /// Places in angstrom.
    fn places(&self) -> Result<Vec<[f32; 3]>, String> {
        match &self.coordinates {
            Coordinates::Compressed(block) => block.places(ANGSTROM),
            Coordinates::Plain(numbers) => {
                let atoms = numbers.as_chunks::<12>().0.iter().enumerate();
                atoms.map(|(i, atom)| plain_place(atom).map_err(|e| format!("atom {}: {e}", i + 1))).collect()
            }
        }
    }
}

/// The place of an atom that is not compressed.
fn plain_place(numbers: &[u8; 12]) -> Result<[f32; 3], String> {
    let mut place = [0.0; 3];
    for (value, number) in place.iter_mut().zip(numbers.as_chunks::<4>().0) {
        let nanometres = f32::from_be_bytes(*number);
        *value = (f64::from(nanometres) * ANGSTROM) as f32;
        if !value.is_finite() {
            return Err(format!(
                "a coordinate is {nanometres:e} nm, which is not finite in angstrom; the file is damaged or the simulation failed, \
                 leave the frame out"
            ));
        }
    }
    Ok(place)
}

/// The time between frames if it is the same between all.
fn even_step(times_ps: &[f32]) -> Option<f64> {
    let (first, last) = (f64::from(*times_ps.first()?), f64::from(*times_ps.last()?));
    if times_ps.len() < 2 {
        return None;
    }
    let steps = (times_ps.len() - 1) as f64;
    let step = (last - first) / steps;
    // Late times are rounded to single precision.
    let error = f64::from(f32::EPSILON) * first.abs().max(last.abs());
    let is_even =
        |(i, time): (usize, &f32)| (f64::from(*time) - (first + i as f64 * step)).abs() <= 1e-3 * step + 2.0 * error;
    if times_ps.iter().enumerate().all(is_even) { plain_ps(step, error / steps) } else { None }
}

fn word(bytes: &[u8], at: usize) -> Option<i32> {
    bytes_at(bytes, at).map(i32::from_be_bytes)
}
