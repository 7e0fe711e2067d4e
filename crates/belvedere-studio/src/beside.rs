//! Background work.

/// Whether there are threads; without them, as on some web pages, background work runs at once in the caller.
pub const THREADS: bool = cfg!(any(not(target_family = "wasm"), target_feature = "atomics"));

/// Stack of threads that read and draw documents, bytes: deep enough for any document within the limits.
#[cfg(not(target_family = "wasm"))]
const STACK_BYTES: usize = 64 << 20;

/// Runs `work` in the background, or at once where there are no [`THREADS`].
///
/// # Errors
/// One sentence, if the system cannot start a thread.
#[cfg(not(target_family = "wasm"))]
pub fn beside(work: impl FnOnce() + Send + 'static) -> Result<(), String> {
    let started = std::thread::Builder::new().stack_size(STACK_BYTES).spawn(work);
    started.map(drop).map_err(|e| format!("no thread could be started: {e}"))
}

/// Runs `work` in the background, or at once where there are no [`THREADS`].
///
/// # Errors
/// Never.
#[cfg(target_family = "wasm")]
pub fn beside(work: impl FnOnce() + Send + 'static) -> Result<(), String> {
    // The web workers of a page belong to rayon.
    if THREADS {
        rayon::spawn(work)
    } else {
        work()
    }
    Ok(())
}
