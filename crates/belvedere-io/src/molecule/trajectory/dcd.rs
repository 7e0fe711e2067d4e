//! DCD: records of Fortran, each between two markers of its length.
//!
//! Format: CHARMM, NAMD and X-PLOR, of either byte order, with markers of 32 bits. A frame is a record of x, one of y
//! and one of z, with the unit cell before and a fourth dimension behind them where the head says so. Fixed atoms are
//! in the first frame only. Lengths are in angstrom.

use super::{Trajectory, Wanted, bytes_at, plain_ps};

/// Bytes of the record of the head.
const HEAD: u32 = 84;

/// What begins the head of coordinates, and of velocities.
const TITLES: [[u8; 4]; 2] = [*b"CORD", *b"VELD"];

/// The unit of time of CHARMM in picoseconds.
const AKMA_PS: f64 = 0.048_888_21;

/// Whether the first bytes are of such a file.
pub(super) fn is_dcd(bytes: &[u8]) -> bool {
    Order::of(bytes).is_some() || has_long_markers(bytes)
}

/// Whether the markers have 64 bits, as some compilers write them.
fn has_long_markers(bytes: &[u8]) -> bool {
    let marker = bytes_at(bytes, 0);
    let is_long = marker.is_some_and(|m| [u64::from_le_bytes(m), u64::from_be_bytes(m)].contains(&u64::from(HEAD)));
    is_long && bytes_at(bytes, 8).is_some_and(|title| TITLES.contains(&title))
}

pub(super) fn read(bytes: &[u8], wanted: &Wanted) -> Result<Trajectory, String> {
    let (head, mut rest) = Head::read(bytes)?;
    let mut out = Trajectory {
        format: "DCD",
        atoms: head.atoms,
        frames_in_file: 0,
        frames: Vec::new(),
        step_ps: head.step_ps,
        cut_off: false,
    };
    // Places of the fixed atoms.
    let mut first = Vec::new();
    while !rest.is_empty() {
        let number = out.frames_in_file + 1;
        let (frame, after) = match head.frame(rest, number == 1) {
            Ok(next) => next,
            Err(Lack::Cut { .. }) if number > 1 => {
                out.cut_off = true;
                break;
            }
            Err(Lack::Cut { needed }) => {
                let left = rest.len();
                return Err(format!(
                    "{left} bytes follow its head where a record of its first frame needs {needed}; it is cut off or damaged, copy it again"
                ));
            }
            Err(Lack::Damaged(what)) => return Err(format!("frame {number}: {what}")),
        };
        let is_wanted = wanted.has(number - 1);
        let is_base = number == 1 && !head.free.is_empty();
        if is_wanted || is_base {
            let places = head.places(&frame, &first).map_err(|e| format!("frame {number}: {e}"))?;
            if is_base {
                first.clone_from(&places);
            }
            if is_wanted {
                out.frames.push(places);
            }
        }
        out.frames_in_file = number;
        rest = after;
    }
    if out.frames_in_file == 0 {
        return Err(
            "no frame follows its head; it is cut off or the simulation wrote none, give one with frames".into()
        );
    }
    Ok(out)
}

/// What the records before the first frame say.
struct Head {
    order: Order,
    atoms: usize,
    /// The atoms that move, from 0; empty where all do.
    free: Vec<usize>,
    has_cell: bool,
    has_fourth: bool,
    step_ps: Option<f64>,
}

impl Head {
    /// The head, and the bytes behind it.
    fn read(bytes: &[u8]) -> Result<(Self, &[u8]), String> {
        if has_long_markers(bytes) {
            let remedy = "convert it, or write it with a program built for markers of 32 bits";
            return Err(format!("its records have markers of 64 bits and such of 32 bits are needed; {remedy}"));
        }
        let Some(order) = Order::of(bytes) else {
            return Err(format!("it does not begin with a record of {HEAD} bytes; it is damaged or no DCD file"));
        };
        let (numbers, rest) = order.record(bytes).map_err(|lack| lack.of("the head"))?;
        if numbers.starts_with(&TITLES[1]) {
            return Err(
                "it holds velocities where coordinates are needed; give the trajectory of the coordinates".into()
            );
        }
        let number = |i: usize| order.number(numbers, 4 + 4 * i).unwrap_or(0);
        let (title, rest) = order.title(rest).map_err(|lack| lack.of("the title"))?;
        let (count, rest) = order.record(rest).map_err(|lack| lack.of("the number of atoms"))?;
        let stated = order.number(count, 0).unwrap_or(0);
        let Some(atoms) = usize::try_from(stated).ok().filter(|atoms| *atoms > 0) else {
            return Err(format!(
                "it states {stated} atoms where 1 or more are needed; the file is damaged, copy it again"
            ));
        };
        // The version of CHARMM, and 0 from X-PLOR, which knows neither unit cell nor fourth dimension.
        let is_charmm = number(19) != 0;
        let step = if is_charmm {
            bytes_at(numbers, 40).map(|bits| f64::from(f32::from_bits(order.word(bits))))
        } else {
            bytes_at(numbers, 40).map(|bits| order.double(bits))
        };
        let mut head = Self {
            order,
            atoms,
            free: Vec::new(),
            has_cell: is_charmm && number(10) != 0,
            has_fourth: is_charmm && number(11) != 0,
            // LAMMPS states its step in the units of the simulation, which are not stated.
            step_ps: step
                .filter(|_| !title.windows(6).any(|name| name == b"LAMMPS"))
                .and_then(|s| step_ps(s, number(2))),
        };
        let rest = head.read_fixed(number(8), rest)?;
        Ok((head, rest))
    }

    /// Reads which atoms are free if some are fixed; the bytes behind.
    fn read_fixed<'b>(&mut self, fixed: i32, rest: &'b [u8]) -> Result<&'b [u8], String> {
        if fixed == 0 {
            return Ok(rest);
        }
        let atoms = self.atoms;
        let Some(count) = usize::try_from(fixed).ok().and_then(|fixed| atoms.checked_sub(fixed)).filter(|n| *n > 0)
        else {
            return Err(format!(
                "{fixed} of {atoms} atoms are stated to be fixed where fewer than all are needed; the file is damaged, copy it again"
            ));
        };
        let (list, rest) = self.order.record(rest).map_err(|lack| lack.of("the list of free atoms"))?;
        if list.len() as u64 != 4 * count as u64 {
            let bytes = list.len();
            return Err(format!(
                "the list of {count} free atoms has {bytes} bytes where four for each are needed; the file is damaged, copy it again"
            ));
        }
        for number in list.as_chunks().0 {
            let number = self.order.word(*number) as i32;
            let Some(atom) = usize::try_from(number).ok().filter(|atom| (1..=atoms).contains(atom)) else {
                return Err(format!(
                    "atom {number} is in the list of free atoms and there are {atoms} atoms; the file is damaged, copy it again"
                ));
            };
            self.free.push(atom - 1);
        }
        Ok(rest)
    }

    /// The x, y and z at the start of the bytes, and the bytes behind the frame.
    fn frame<'b>(&self, bytes: &'b [u8], is_first: bool) -> Result<([&'b [u8]; 3], &'b [u8]), Lack> {
        let mut rest = bytes;
        if self.has_cell {
            (_, rest) = self.order.record(rest)?;
        }
        let count = if is_first || self.free.is_empty() { self.atoms } else { self.free.len() };
        let mut axes = [&bytes[..0]; 3];
        for (axis, name) in axes.iter_mut().zip(["x", "y", "z"]) {
            // Before the length is believed, which may be beyond the end.
            if let Some(length) = self.order.number(rest, 0).map(|length| length as u32)
                && u64::from(length) != 4 * count as u64
            {
                return Err(Lack::Damaged(format!(
                    "the record of {name} of {count} atoms has {length} bytes where four for each are needed; the file is damaged or \
                     in double precision, write it anew"
                )));
            }
            (*axis, rest) = self.order.record(rest)?;
        }
        if self.has_fourth {
            (_, rest) = self.order.record(rest)?;
        }
        Ok((axes, rest))
    }

    /// Places of all atoms. `first`: those of the first frame; empty for itself and where no atoms are fixed.
    fn places(&self, axes: &[&[u8]; 3], first: &[[f32; 3]]) -> Result<Vec<[f32; 3]>, String> {
        let [x, y, z] = axes.map(|axis| axis.as_chunks::<4>().0);
        let value = |bits: &[u8; 4]| f32::from_bits(self.order.word(*bits));
        let read = x.iter().zip(y).zip(z).map(|((x, y), z)| [value(x), value(y), value(z)]);
        let mut places = first.to_vec();
        if first.is_empty() {
            places.reserve_exact(x.len());
            places.extend(read);
        } else {
            for (atom, place) in self.free.iter().zip(read) {
                if let Some(moved) = places.get_mut(*atom) {
                    *moved = place;
                }
            }
        }
        if let Some(atom) = places.iter().position(|place| !place.iter().all(|value| value.is_finite())) {
            let [x, y, z] = places.get(atom).copied().unwrap_or_default();
            return Err(format!(
                "atom {} is at ({x}, {y}, {z}), which is not finite; the file is damaged or the simulation failed, leave the frame out",
                atom + 1
            ));
        }
        Ok(places)
    }
}

/// The time between frames: a step of the simulation in units of CHARMM, and steps from one frame to the next.
fn step_ps(step: f64, every: i32) -> Option<f64> {
    // Programs that convert files write 1 where they do not know it; it would be 49 fs.
    if step == 1.0 || every <= 0 {
        return None;
    }
    let between = step * AKMA_PS * f64::from(every);
    // The unit has seven digits.
    plain_ps(between, 1e-6 * between)
}

/// Why a record cannot be read.
enum Lack {
    /// The bytes end before the record does, which needs so many.
    Cut {
        needed: u64,
    },
    Damaged(String),
}

impl Lack {
    /// The error for a record without which there are no frames.
    fn of(self, what: &str) -> String {
        match self {
            Self::Cut { needed } => {
                format!(
                    "the record of {what} needs {needed} bytes and the file has fewer; it is cut off or damaged, copy it again"
                )
            }
            Self::Damaged(why) => format!("{what}: {why}"),
        }
    }
}

/// Order of the bytes of a number.
#[derive(Clone, Copy)]
enum Order {
    Little,
    Big,
}

impl Order {
    /// By the first record.
    fn of(bytes: &[u8]) -> Option<Self> {
        let order = match bytes_at(bytes, 0)? {
            marker if u32::from_le_bytes(marker) == HEAD => Self::Little,
            marker if u32::from_be_bytes(marker) == HEAD => Self::Big,
            _ => return None,
        };
        TITLES.contains(&bytes_at(bytes, 4)?).then_some(order)
    }

    fn word(self, bytes: [u8; 4]) -> u32 {
        match self {
            Self::Little => u32::from_le_bytes(bytes),
            Self::Big => u32::from_be_bytes(bytes),
        }
    }

    fn double(self, bytes: [u8; 8]) -> f64 {
        match self {
            Self::Little => f64::from_le_bytes(bytes),
            Self::Big => f64::from_be_bytes(bytes),
        }
    }

    fn number(self, bytes: &[u8], at: usize) -> Option<i32> {
        bytes_at(bytes, at).map(|bytes| self.word(bytes) as i32)
    }

    /// The record of the title. MDAnalysis once wrote markers that do not fit it; the number of its lines does.
    fn title(self, bytes: &[u8]) -> Result<(&[u8], &[u8]), Lack> {
        let by_lines = || {
            let lines = usize::try_from(self.number(bytes, 4)?).ok()?;
            let (record, rest) = bytes.get(4..)?.split_at_checked(lines.checked_mul(80)?.checked_add(4)?)?;
            let (marker, rest) = rest.split_first_chunk::<4>()?;
            bytes.starts_with(marker).then_some((record, rest))
        };
        self.record(bytes).or_else(|lack| by_lines().ok_or(lack))
    }

    /// The record at the start of the bytes without its markers, and the bytes behind it.
    fn record(self, bytes: &[u8]) -> Result<(&[u8], &[u8]), Lack> {
        let length = bytes_at(bytes, 0).map(|marker| self.word(marker)).ok_or(Lack::Cut { needed: 8 })?;
        let parts = || {
            let (record, rest) = bytes.get(4..)?.split_at_checked(usize::try_from(length).ok()?)?;
            let (marker, rest) = rest.split_first_chunk()?;
            Some((record, self.word(*marker), rest))
        };
        match parts() {
            None => Err(Lack::Cut { needed: u64::from(length) + 8 }),
            Some((record, again, rest)) if again == length => Ok((record, rest)),
            Some((_, again, _)) => Err(Lack::Damaged(format!(
                "a record states {length} bytes before it and {again} behind it; the file is damaged, copy it again"
            ))),
        }
    }
}
