//! The worker threads of the process.

use rayon::ThreadPoolBuilder;
use std::sync::Arc;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::time::{Duration, Instant};

/// Address space that a thread may take, bytes: its stack, and the share of the heap that the system's library reserves for it.
const SPACE_BYTES: u64 = 66 << 20;
/// Longest time that threads which were tried have to end.
const END_WITHIN: Duration = Duration::from_secs(1);

/// Starts the worker threads that loaders, solvers and renderers share: one for each core, or as many as the system gives. Without this call
/// they start when they are first needed, and a system that refuses one of them ends the work with an error.
///
/// Returns their number; 1 means that the calling thread works alone. Where they run already it changes nothing.
pub fn start() -> usize {
    let wanted = std::env::var("RAYON_NUM_THREADS").ok().and_then(|n| n.parse().ok()).filter(|n| *n > 0);
    let mut count = wanted.unwrap_or_else(|| {
        // Where address space is limited (`ulimit -v`) most of it is left to the work.
        let fit = usize::try_from(belvedere_io::budget::address_space_left() / 4 / SPACE_BYTES).unwrap_or(usize::MAX);
        std::thread::available_parallelism().map_or(1, usize::from).min(fit.max(1))
    });
    // A failed start of the shared threads cannot be repeated, so that of others is tried first.
    while count > 0 && !can_start(count) {
        count /= 2;
    }
    let builder = ThreadPoolBuilder::new().num_threads(count.max(1));
    let builder = if count > 0 { builder } else { builder.use_current_thread() };
    // An error says that they run already.
    let _ = builder.build_global();
    rayon::current_num_threads()
}

/// Starts as many threads, and waits until they have ended again.
fn can_start(count: usize) -> bool {
    let running = Arc::new(AtomicUsize::new(0));
    let [begun, ended] = [running.clone(), running.clone()];
    let builder = ThreadPoolBuilder::new()
        .num_threads(count)
        .start_handler(move |_| {
            begun.fetch_add(1, Ordering::SeqCst);
        })
        .exit_handler(move |_| {
            ended.fetch_sub(1, Ordering::SeqCst);
        });
    let can = builder.build().is_ok();
    let began = Instant::now();
    while running.load(Ordering::SeqCst) > 0 && began.elapsed() < END_WITHIN {
        std::thread::sleep(Duration::from_micros(200));
    }
    can
}
