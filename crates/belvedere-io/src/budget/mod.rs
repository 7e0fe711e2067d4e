//! One budget of memory for all that a process reads, holds, solves and draws.
//!
//! An application sets it ([`set`]); else it is [`of_machine`]. Work asks for its peak before it begins ([`ask`]). What is held already
//! counts where the application tells it ([`count_by`]); elsewhere each request is weighed alone.

mod machine;

pub use machine::{Pages, address_space_left, of_machine, pages};

use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::{Mutex, OnceLock, PoisonError, TryLockError};

/// Requests from this size on are tried before they are granted, bytes.
const TRIED: u64 = 16 << 20;

/// The budget that was set, bytes; 0 = none was.
static SET: AtomicU64 = AtomicU64::new(0);
static METER: OnceLock<fn() -> u64> = OnceLock::new();
static IN_WORK: Mutex<Vec<PathBuf>> = Mutex::new(Vec::new());

/// Why work is not begun: it needs more memory than there is.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("{0}")]
pub struct Refusal(String);

impl From<Refusal> for std::io::Error {
    fn from(refusal: Refusal) -> Self {
        Self::new(std::io::ErrorKind::OutOfMemory, refusal)
    }
}

/// Sets the budget of the process, bytes, but no more than its limit of address space leaves; 0 = that of the machine.
pub fn set(bytes: u64) {
    SET.store(bytes.min(address_space_left()), Ordering::Relaxed);
}

/// The budget of the process, bytes.
pub fn bytes() -> u64 {
    static MACHINE: OnceLock<u64> = OnceLock::new();
    match SET.load(Ordering::Relaxed) {
        0 => *MACHINE.get_or_init(of_machine),
        bytes => bytes,
    }
}

/// Makes `meter` tell how many bytes the process holds. The first call counts.
pub fn count_by(meter: fn() -> u64) {
    let _ = METER.set(meter);
}

/// Bytes that the process holds; 0 if nothing counts them.
pub fn held() -> u64 {
    METER.get().map_or(0, |meter| meter())
}

/// Makes the memory that the process owns count; `false` where the system does not tell it.
pub fn count_own() -> bool {
    let tells = pages().is_some();
    if tells {
        count_by(|| pages().map_or(0, |pages| pages.held));
    }
    tells
}

/// Bytes of the budget that are free, and that the limit of address space allows.
pub fn left() -> u64 {
    left_beside(bytes(), held())
}

/// Bytes of a budget that some work may hold in all, and that the limit of address space allows.
///
/// * `others`: bytes held beside it; the rest of what the process holds is the work's own, such as a cache of its last picture.
pub fn left_beside(budget: u64, others: u64) -> u64 {
    let own = held().saturating_sub(others);
    budget.saturating_sub(others).min(address_space_left().saturating_add(own))
}

/// Asks for the peak of some work.
///
/// * `what`: subject of the sentence, such as `the raster`.
/// * `peak`: bytes beside those that are held.
///
/// # Errors
/// A [`Refusal`], if the budget has not so much left.
pub fn ask(what: &str, peak: u64) -> Result<(), Refusal> {
    ask_of(bytes(), what, peak)
}

/// As [`ask`], of another budget.
pub(crate) fn ask_of(budget: u64, what: &str, peak: u64) -> Result<(), Refusal> {
    let held = held();
    if held.saturating_add(peak) <= budget {
        return if is_given(peak) { Ok(()) } else { Err(not_given(what, peak)) };
    }
    let mib = |b: u64| b.div_ceil(1 << 20);
    let beside = if held > 0 { format!(" beside {} MiB in use", mib(held)) } else { String::new() };
    Err(Refusal(format!(
        "{what} needs {} MiB{beside}, more than {} MiB; allow more memory, or use a smaller level, window or file",
        mib(peak),
        budget >> 20
    )))
}

/// Room for `count` values, empty.
///
/// * `what`: as in [`ask`].
///
/// # Errors
/// A [`Refusal`], if the budget or the machine has not so much left.
pub fn room<T>(what: &str, count: usize) -> Result<Vec<T>, Refusal> {
    let peak = (count as u64).saturating_mul(size_of::<T>() as u64);
    ask(what, peak)?;
    let mut out = Vec::new();
    match out.try_reserve_exact(count) {
        Ok(()) => Ok(out),
        Err(_) => Err(not_given(what, peak)),
    }
}

/// The refusal of more than the system gives.
fn not_given(what: &str, peak: u64) -> Refusal {
    Refusal(format!("{what} needs {} MiB, which the system does not give; allow more memory", peak.div_ceil(1 << 20)))
}

/// The refusal of an entry of an archive that has more than `most` bytes.
pub(crate) fn too_large(entry: &str, archive: &str, most: u64, unpacked: &str) -> Refusal {
    let mib = most >> 20;
    Refusal(format!(
        "{entry} in the archive{archive} has more than {mib} MiB{unpacked}; allow more memory, or take a part of it"
    ))
}

/// Whether the system gives so much at once. A limit of address space (`ulimit -v`) counts what was reserved and is not used, too, so that
/// less is left than the budget says.
fn is_given(bytes: u64) -> bool {
    if bytes < TRIED || cfg!(target_family = "wasm") {
        return true;
    }
    let mut room: Vec<u8> = Vec::new();
    let given = usize::try_from(bytes).is_ok_and(|bytes| room.try_reserve_exact(bytes).is_ok());
    // Else the compiler leaves the request out.
    std::hint::black_box(&room);
    given
}

/// The file in work, until it is dropped.
#[derive(Debug)]
pub(crate) struct InWork(PathBuf);

/// Marks a file as the one in work, for the message of a budget that does not suffice.
pub(crate) fn work_on(path: &Path) -> InWork {
    IN_WORK.lock().unwrap_or_else(PoisonError::into_inner).push(path.to_owned());
    InWork(path.to_owned())
}

impl Drop for InWork {
    fn drop(&mut self) {
        let mut files = IN_WORK.lock().unwrap_or_else(PoisonError::into_inner);
        // Files are read side by side, too, and end in any order.
        if let Some(at) = files.iter().rposition(|file| *file == self.0) {
            files.remove(at);
        }
    }
}

/// Gives the file in work to `say`; `None` if there is none, or if it is just being changed. Allocates nothing.
pub fn file_in_work(say: impl FnOnce(Option<&Path>)) {
    match IN_WORK.try_lock() {
        Ok(files) => say(files.last().map(PathBuf::as_path)),
        Err(TryLockError::Poisoned(files)) => say(files.into_inner().last().map(PathBuf::as_path)),
        Err(TryLockError::WouldBlock) => say(None),
    }
}

#[cfg(test)]
mod tests;
