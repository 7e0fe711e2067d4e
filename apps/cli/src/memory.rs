//! Counts what the program holds, and ends it in one line where memory passes the budget or the machine refuses.
//!
//! Loaders, solvers and renderers ask before they begin (`belvedere::io::budget`). This is the last door, for what no estimate foresaw and for
//! libraries that cannot report a failed allocation: without it the process would abort, or be killed by the system.

// The trait of allocators is unsafe. Every method hands its arguments on to the allocator of the system unchanged.
#![allow(unsafe_code)]

use belvedere::io::budget;
use std::alloc::{GlobalAlloc, Layout, System};
use std::cell::Cell;
use std::io::Write;
use std::path::PathBuf;
use std::sync::OnceLock;
use std::sync::atomic::{AtomicBool, AtomicI64, Ordering};

/// Bytes that a thread takes or frees before it tells the others.
const STEP: i64 = 64 << 10;
/// What the program itself, its stacks and gaps between allocations take, bytes.
const OWN: u64 = 16 << 20;

static HELD: AtomicI64 = AtomicI64::new(0);
static MOST: AtomicI64 = AtomicI64::new(i64::MAX);
static ENDING: AtomicBool = AtomicBool::new(false);
/// The working folder, below which files are named from there.
static FOLDER: OnceLock<PathBuf> = OnceLock::new();

thread_local! {
    /// Bytes taken or freed by this thread that [`HELD`] does not know of.
    static UNTOLD: Cell<i64> = const { Cell::new(0) };
}

/// The allocator of the system, counted.
struct Counted;

#[global_allocator]
static ALLOCATOR: Counted = Counted;

/// Sets the budget of the process, bytes; `None` = that of the machine.
pub(crate) fn begin(most: Option<u64>) {
    budget::set(most.unwrap_or(0));
    budget::count_by(held);
    if let Ok(folder) = std::env::current_dir() {
        let _ = FOLDER.set(folder);
    }
    let bytes = budget::bytes();
    MOST.store(i64::try_from(bytes.saturating_sub(OWN).max(bytes / 2)).unwrap_or(i64::MAX), Ordering::Relaxed);
}

/// Bytes that the program holds, but for [`STEP`] bytes of each thread.
fn held() -> u64 {
    u64::try_from(HELD.load(Ordering::Relaxed)).unwrap_or(0).saturating_add(OWN)
}

/// Counts `bytes` more, or less if negative; whether they are within the budget.
fn count(bytes: i64) -> bool {
    let told = UNTOLD.try_with(|untold| {
        let sum = untold.get() + bytes;
        let tell = sum.abs() >= STEP;
        untold.set(if tell { 0 } else { sum });
        if tell { sum } else { 0 }
    });
    // A thread that ends has no cell any more.
    let told = told.unwrap_or(bytes);
    if told == 0 {
        return true;
    }
    let now = HELD.fetch_add(told, Ordering::Relaxed) + told;
    told < 0 || now <= MOST.load(Ordering::Relaxed) || ENDING.load(Ordering::Relaxed)
}

fn size(bytes: usize) -> i64 {
    i64::try_from(bytes).unwrap_or(i64::MAX / 4)
}

/// Ends the process, unless another thread does: then this one goes on, for it may hold what that one waits for.
fn over(bytes: usize) {
    if !ENDING.swap(true, Ordering::SeqCst) {
        end(bytes, false);
    }
}

/// Says in one line what failed, and ends the process with 2.
#[cold]
fn end(bytes: usize, refused: bool) -> ! {
    let mib = |b: u64| b.div_ceil(1 << 20);
    let mut err = std::io::stderr().lock();
    let _ = write!(err, "belvedere: ");
    budget::file_in_work(|file| {
        let inside =
            |file| FOLDER.get().and_then(|folder| std::path::Path::strip_prefix(file, folder).ok()).unwrap_or(file);
        if let Some(name) = file.and_then(|file| inside(file).to_str()) {
            for c in name.chars().map(|c| if c.is_control() { '?' } else { c }) {
                let _ = write!(err, "{c}");
            }
            let _ = write!(err, ": ");
        }
    });
    // What failed is counted already.
    let used = held().saturating_sub(bytes as u64);
    let (more, used, most) = (mib(bytes as u64), mib(used), budget::bytes() >> 20);
    let _ = write!(err, "{more} MiB are needed beside {used} MiB in use, ");
    let _ = if refused {
        write!(err, "and the machine does not give them; close other programs")
    } else {
        write!(err, "the budget of memory is {most} MiB; allow more memory (--max-mem)")
    };
    let _ = writeln!(err, ", or use a smaller file, --size or --samples");
    std::process::exit(2)
}

// SAFETY: every method calls the same method of `System` with the same arguments, and returns what it returned; counting neither touches
// the memory nor allocates, and `end` does not return.
unsafe impl GlobalAlloc for Counted {
    unsafe fn alloc(&self, layout: Layout) -> *mut u8 {
        if !count(size(layout.size())) {
            over(layout.size());
        }
        // SAFETY: the caller's promises are those of `System`.
        checked(unsafe { System.alloc(layout) }, layout.size())
    }

    unsafe fn alloc_zeroed(&self, layout: Layout) -> *mut u8 {
        if !count(size(layout.size())) {
            over(layout.size());
        }
        // SAFETY: as in `alloc`.
        checked(unsafe { System.alloc_zeroed(layout) }, layout.size())
    }

    unsafe fn realloc(&self, block: *mut u8, layout: Layout, new_size: usize) -> *mut u8 {
        // Both blocks may exist for a moment.
        if !count(size(new_size) - size(layout.size())) {
            over(new_size.saturating_sub(layout.size()));
        }
        // SAFETY: as in `alloc`; `block` came from `System`.
        checked(unsafe { System.realloc(block, layout, new_size) }, new_size)
    }

    unsafe fn dealloc(&self, block: *mut u8, layout: Layout) {
        count(-size(layout.size()));
        // SAFETY: `block` came from `System` with this layout.
        unsafe { System.dealloc(block, layout) }
    }
}

/// The block, unless the system gave none.
fn checked(block: *mut u8, bytes: usize) -> *mut u8 {
    if block.is_null() {
        if !ENDING.swap(true, Ordering::SeqCst) {
            end(bytes, true);
        }
        // Another thread ends the process.
        loop {
            std::thread::park();
        }
    }
    block
}
