//! Trajectories of molecular dynamics: the places of all atoms, one frame after the other.
//!
//! They name no elements and no bonds: a structure of the same atoms in the same order says what they are. Errors
//! count frames and atoms from 1.

mod compressed;
mod dcd;
#[cfg(test)]
pub(crate) mod testing;
mod xtc;

/// Format of a trajectory.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Kind {
    /// Compressed coordinates of GROMACS.
    Xtc,
    /// Binary trajectory of CHARMM, NAMD and X-PLOR.
    Dcd,
}

/// The format that the first bytes tell; 12 of them are enough.
pub(super) fn kind_of(bytes: &[u8]) -> Option<Kind> {
    if xtc::is_xtc(bytes) {
        Some(Kind::Xtc)
    } else if dcd::is_dcd(bytes) {
        Some(Kind::Dcd)
    } else {
        None
    }
}

/// Frames that are read: `first`, and from there on each `every`th.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Wanted {
    /// Frame that is read first, from 0.
    pub first: usize,
    /// Frames from one that is read to the next; 0 counts as 1.
    pub every: usize,
    /// Frames that are read at most; with 0 the file is only counted.
    pub most: usize,
}

impl Wanted {
    /// All frames of a file.
    pub const ALL: Self = Self { first: 0, every: 1, most: usize::MAX };

    /// Whether a frame, from 0, is read.
    fn has(&self, frame: usize) -> bool {
        let every = self.every.max(1);
        frame.checked_sub(self.first).is_some_and(|after| after % every == 0 && after / every < self.most)
    }
}

/// Places of the atoms of a system over time.
#[derive(Clone, Debug, PartialEq)]
pub struct Trajectory {
    /// Name of the format: `XTC` or `DCD`.
    pub format: &'static str,
    /// Atoms of each frame.
    pub atoms: usize,
    /// Whole frames of the file, whether read or not.
    pub frames_in_file: usize,
    /// Places of the atoms in the frames that were wanted, in angstrom; all are finite.
    pub frames: Vec<Vec<[f32; 3]>>,
    /// Time from one frame of the file to the next in picoseconds; `None` if the file does not say or it varies.
    pub step_ps: Option<f64>,
    /// Whether the file ends within a frame. The whole frames before it count.
    pub cut_off: bool,
}

/// Reads the wanted frames of a trajectory; others are skipped without decoding.
///
/// # Errors
/// One sentence if the bytes are of no known format, damaged, without a whole frame or without the first wanted one, or
/// if a coordinate is not finite.
pub(super) fn read(bytes: &[u8], wanted: &Wanted) -> Result<Trajectory, String> {
    let read = match kind_of(bytes) {
        Some(Kind::Xtc) => xtc::read(bytes, wanted)?,
        Some(Kind::Dcd) => dcd::read(bytes, wanted)?,
        None => {
            let shown: Vec<String> = bytes.iter().take(8).map(|byte| format!("{byte:02x}")).collect();
            return Err(format!(
                "its {} bytes begin with [{}], which is neither XTC nor DCD; give a trajectory in one of these formats",
                bytes.len(),
                shown.join(" ")
            ));
        }
    };
    if wanted.first >= read.frames_in_file {
        let (first, last) = (wanted.first.saturating_add(1), read.frames_in_file);
        return Err(format!(
            "frame {first} is wanted first and the file ends with frame {last}; begin at an earlier one"
        ));
    }
    Ok(read)
}

/// The first `N` bytes from a place on.
fn bytes_at<const N: usize>(bytes: &[u8], at: usize) -> Option<[u8; N]> {
    bytes.get(at..)?.first_chunk().copied()
}

/// A time in picoseconds, rounded to as few decimals as its error allows; `None` if it is not above 0.
fn plain_ps(ps: f64, error: f64) -> Option<f64> {
    let rounded = (0..12).map(|decimals| {
        let unit = 10.0_f64.powi(decimals);
        (ps * unit).round() / unit
    });
    let plain = rounded.into_iter().find(|rounded| (rounded - ps).abs() <= error).unwrap_or(ps);
    (plain.is_finite() && plain > 0.0).then_some(plain)
}

#[cfg(test)]
mod tests;
