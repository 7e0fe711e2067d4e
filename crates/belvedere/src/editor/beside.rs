//! Work beside the window.

/// Whether there are threads; without them, as on a web page of its own, everything is done in turn.
pub const THREADS: bool = cfg!(any(not(target_family = "wasm"), target_feature = "atomics"));

/// Stack of threads that read and draw documents: deep enough for any that passes the limits.
#[cfg(not(target_family = "wasm"))]
const STACK_BYTES: usize = 64 << 20;

/// Does something beside the caller, or at once where there are no [`THREADS`].
///
/// # Errors
/// One sentence, if the system starts no thread.
#[cfg(not(target_family = "wasm"))]
pub fn beside(work: impl FnOnce() + Send + 'static) -> Result<(), String> {
    let started = std::thread::Builder::new().stack_size(STACK_BYTES).spawn(work);
    started.map(drop).map_err(|e| format!("no thread could be started: {e}"))
}

/// Does something beside the caller, or at once where there are no [`THREADS`].
///
/// # Errors
/// None.
#[cfg(target_family = "wasm")]
pub fn beside(work: impl FnOnce() + Send + 'static) -> Result<(), String> {
    // Workers of a page belong to rayon.
    if THREADS {
        rayon::spawn(work)
    } else {
        work()
    }
    Ok(())
}
