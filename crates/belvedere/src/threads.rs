//! The worker threads of the process.

use rayon::ThreadPoolBuilder;

/// Starts the worker threads that loaders, solvers and renderers share: one for each core, or as many as the system gives. Without this call
/// they start when they are first needed, and a system that refuses one of them ends the work with an error.
///
/// Returns their number; 1 means that the calling thread works alone. Where they run already it changes nothing.
pub fn start() -> usize {
    let mut count = std::thread::available_parallelism().map_or(1, usize::from);
    // A failed start of the shared threads cannot be repeated, so that of others is tried first.
    while count > 0 && ThreadPoolBuilder::new().num_threads(count).build().is_err() {
        count /= 2;
    }
    let builder = ThreadPoolBuilder::new().num_threads(count.max(1));
    let builder = if count > 0 { builder } else { builder.use_current_thread() };
    // An error says that they run already.
    let _ = builder.build_global();
    rayon::current_num_threads()
}
