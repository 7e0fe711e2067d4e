//! Work beside the interpreter: on a pool of this process, with progress, cancellation by Ctrl-C, and panics as exceptions.

use crate::errors::{exception, raised};
use belvedere::BelvedereError;
use belvedere::scene::Progress;
use pyo3::prelude::*;
use rayon::{ThreadPool, ThreadPoolBuilder};
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::atomic::Ordering;
use std::sync::mpsc::{Receiver, RecvTimeoutError, channel};
use std::sync::{Arc, Mutex, PoisonError};
use std::time::{Duration, Instant};

/// Time between two looks at signals and progress.
const EVERY: Duration = Duration::from_millis(20);
/// Time that cancelled work has to end by itself; then it is left to end beside the interpreter.
const GRACE: Duration = Duration::from_millis(700);
/// Stack of threads: deep enough for any document that passes the limits.
const STACK_BYTES: usize = 64 << 20;
/// Pools that are kept for other numbers of threads.
const KEPT: usize = 4;

/// What a call says about how its work is done.
#[derive(Default)]
pub(crate) struct Ask {
    /// Threads; 0 = one for each core, or `RAYON_NUM_THREADS`.
    pub(crate) threads: usize,
    /// Limit of time for solving, seconds.
    pub(crate) time_limit_s: Option<f64>,
    /// Called with the name of the current work and the share done, 0..=1.
    pub(crate) progress: Option<Py<PyAny>>,
}

/// How a call is done, from Python: `(threads, time_limit_s, progress)`.
impl<'py> FromPyObject<'_, 'py> for Ask {
    type Error = PyErr;

    fn extract(object: Borrowed<'_, 'py, PyAny>) -> PyResult<Self> {
        let (threads, time_limit_s, progress) = object.extract()?;
        Ok(Self { threads, time_limit_s, progress })
    }
}

/// Number of the process, number of threads, and their pool.
type Kept = (u32, usize, Arc<ThreadPool>);

static POOLS: Mutex<Vec<Kept>> = Mutex::new(Vec::new());

/// The pool of this process with so many threads. Threads do not survive a fork, so that a forked process has pools of its own.
fn pool(threads: usize) -> PyResult<Arc<ThreadPool>> {
    let process = std::process::id();
    let mut pools = POOLS.lock().unwrap_or_else(PoisonError::into_inner);
    // A pool of the parent would wait for threads that this process does not have.
    pools.extract_if(.., |(owner, ..)| *owner != process).for_each(std::mem::forget);
    if let Some((.., pool)) = pools.iter().find(|(_, count, _)| *count == threads) {
        return Ok(pool.clone());
    }
    let builder = ThreadPoolBuilder::new().num_threads(threads).stack_size(STACK_BYTES);
    let made = builder.build().map_err(|e| {
        exception("InputError", &format!("threads={threads}: the threads could not be started ({e}); ask for fewer"))
    })?;
    let made = Arc::new(made);
    if pools.len() >= KEPT {
        pools.remove(0);
    }
    pools.push((process, threads, made.clone()));
    Ok(made)
}

/// Runs `work` on the pool while the interpreter is free for other threads; signals and progress are looked at in between.
pub(crate) fn run<T: Send + 'static>(
    py: Python<'_>,
    ask: &Ask,
    work: impl FnOnce(Progress) -> Result<T, BelvedereError> + Send + 'static,
) -> PyResult<T> {
    let said = Arc::new(Mutex::new(None::<(String, f64)>));
    let mut progress = Progress::silent();
    if ask.progress.is_some() {
        let said = said.clone();
        progress = Progress::new(move |stage, done| {
            *said.lock().unwrap_or_else(PoisonError::into_inner) = Some((stage.to_owned(), done));
        });
    }
    if let Some(limit) = ask.time_limit_s {
        let limit = Duration::try_from_secs_f64(limit).map_err(|_| {
            exception("InputError", &format!("time_limit_s={limit} is not a time; give seconds of at least 0"))
        })?;
        progress = progress.limited(limit);
    }
    let cancel = progress.cancel_flag();
    let (sender, mut receiver) = channel();
    let pool = pool(ask.threads)?;
    pool.spawn(move || {
        let done = catch_unwind(AssertUnwindSafe(|| work(progress)));
        // Nobody listens to work that was left behind.
        let _ = sender.send(done.unwrap_or_else(|panic| Err(broken(&*panic))));
    });
    let tell = |share: Option<(String, f64)>| match (&ask.progress, share) {
        (Some(listener), Some((stage, done))) => listener.call1(py, (stage, done)).map(|_| ()),
        _ => Ok(()),
    };
    loop {
        let next = &mut receiver;
        match py.detach(move || next.recv_timeout(EVERY)) {
            Ok(done) => {
                let last = said.lock().unwrap_or_else(PoisonError::into_inner).take();
                let done = done.map_err(|e| raised(&e))?;
                tell(last)?;
                return Ok(done);
            }
            Err(RecvTimeoutError::Timeout) => {}
            Err(RecvTimeoutError::Disconnected) => {
                return Err(exception("InternalError", "the work ended without a result"));
            }
        }
        let now = said.lock().unwrap_or_else(PoisonError::into_inner).take();
        if let Err(stop) = py.check_signals().and_then(|()| tell(now)) {
            cancel.store(true, Ordering::SeqCst);
            let rest = &mut receiver;
            if !py.detach(move || ended(rest)) {
                forget(&pool);
            }
            return Err(stop);
        }
    }
}

/// Waits until cancelled work has ended, but not for long; returns whether it has.
fn ended<T>(receiver: &mut Receiver<T>) -> bool {
    let until = Instant::now() + GRACE;
    while let Err(RecvTimeoutError::Timeout) = receiver.recv_timeout(EVERY) {
        if Instant::now() >= until {
            return false;
        }
    }
    true
}

/// Leaves a pool to the work that does not end, so that later calls do not wait for it.
fn forget(left: &Arc<ThreadPool>) {
    POOLS.lock().unwrap_or_else(PoisonError::into_inner).retain(|(.., pool)| !Arc::ptr_eq(pool, left));
}

fn broken(panic: &(dyn std::any::Any + Send)) -> BelvedereError {
    let text = panic.downcast_ref::<String>().map(String::as_str).or(panic.downcast_ref::<&str>().copied());
    BelvedereError::Internal { what: text.unwrap_or("no message").lines().next().unwrap_or_default().to_owned() }
}
