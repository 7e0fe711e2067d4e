//! One budget of memory for all that a process reads, holds, solves and draws.
//!
//! An application sets it ([`set`]); else it is [`of_machine`]. Work asks for its peak before it begins ([`ask`]). What is held already
//! counts where the application tells it ([`count_by`]); elsewhere each request is weighed alone.

mod machine;

pub use machine::of_machine;

use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::{Mutex, OnceLock, PoisonError, TryLockError};

/// Words of every refusal; what can be done follows.
const REMEDY: &str = "allow more memory";

/// The budget that was set, bytes; 0 = none was.
static SET: AtomicU64 = AtomicU64::new(0);
static METER: OnceLock<fn() -> u64> = OnceLock::new();
static IN_WORK: Mutex<Vec<PathBuf>> = Mutex::new(Vec::new());

/// Sets the budget of the process, bytes, but no more than its limit of address space leaves; 0 = that of the machine.
pub fn set(bytes: u64) {
    SET.store(bytes.min(machine::address_space_left()), Ordering::Relaxed);
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

/// Bytes of the budget that are free.
pub fn left() -> u64 {
    bytes().saturating_sub(held())
}

/// Asks for the peak of some work.
///
/// * `what`: subject of the sentence, such as `the raster`.
/// * `peak`: bytes beside those that are held.
///
/// # Errors
/// A sentence, if the budget has not so much left.
pub fn ask(what: &str, peak: u64) -> Result<(), String> {
    ask_of(bytes(), what, peak)
}

/// As [`ask`], of another budget.
pub(crate) fn ask_of(budget: u64, what: &str, peak: u64) -> Result<(), String> {
    let held = held();
    if held.saturating_add(peak) <= budget {
        return Ok(());
    }
    let mib = |b: u64| b.div_ceil(1 << 20);
    let beside = if held > 0 { format!(" beside {} MiB in use", mib(held)) } else { String::new() };
    Err(format!(
        "{what} needs {} MiB{beside}, more than {} MiB; {REMEDY}, or use a smaller level, window or file",
        mib(peak),
        budget >> 20
    ))
}

/// Whether a sentence is a refusal for want of memory.
pub fn is_refusal(reason: &str) -> bool {
    reason.contains(REMEDY)
}

/// Room for `count` values, empty.
///
/// * `what`: as in [`ask`].
///
/// # Errors
/// A sentence, if the budget or the machine has not so much left.
pub fn room<T>(what: &str, count: usize) -> Result<Vec<T>, String> {
    let peak = (count as u64).saturating_mul(size_of::<T>() as u64);
    ask(what, peak)?;
    let mut out = Vec::new();
    match out.try_reserve_exact(count) {
        Ok(()) => Ok(out),
        Err(_) => {
            Err(format!("{what} needs {} MiB, which this machine does not give; {REMEDY}", peak.div_ceil(1 << 20)))
        }
    }
}

/// The file in work, until it is dropped.
#[derive(Debug)]
pub(crate) struct InWork(());

/// Marks a file as the one in work, for the message of a budget that does not suffice.
pub(crate) fn work_on(path: &Path) -> InWork {
    IN_WORK.lock().unwrap_or_else(PoisonError::into_inner).push(path.to_owned());
    InWork(())
}

impl Drop for InWork {
    fn drop(&mut self) {
        IN_WORK.lock().unwrap_or_else(PoisonError::into_inner).pop();
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
mod tests {
    use super::*;

    #[test]
    fn what_just_fits_is_allowed() {
        assert_eq!(ask_of(3 << 20, "the raster", 3 << 20), Ok(()));
        let text = ask_of(3 << 20, "the raster", (3 << 20) + 1).unwrap_err();
        assert!(text.contains("the raster needs 4 MiB") && text.contains("more than 3 MiB"), "{text}");
        assert!(is_refusal(&text), "{text}");
    }

    #[test]
    fn room_beyond_the_machine_is_an_error() {
        assert!(room::<u64>("the raster", usize::MAX).is_err_and(|e| is_refusal(&e)));
        assert!(room::<u64>("the raster", 100).is_ok_and(|room| room.capacity() >= 100));
    }

    #[test]
    fn the_last_file_is_in_work() {
        let _first = work_on(Path::new("budget_a"));
        {
            let _second = work_on(Path::new("budget_b"));
            assert!(bytes() > 0);
        }
        assert!(IN_WORK.lock().expect("free").iter().any(|p| p == Path::new("budget_a")));
    }
}
