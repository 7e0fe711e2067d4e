//! Progress and cancellation in one argument.

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

/// The work was cancelled; nothing was kept.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
#[error("cancelled")]
pub struct Cancelled;

type Report = dyn Fn(&str, f64) + Send + Sync;

/// Tells a listener how far work has come and asks it whether to go on. Cheap to clone.
#[derive(Clone, Default)]
pub struct Progress {
    report: Option<Arc<Report>>,
    cancelled: Arc<AtomicBool>,
}

impl std::fmt::Debug for Progress {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Progress").field("cancelled", &self.is_cancelled()).finish_non_exhaustive()
    }
}

impl Progress {
    /// Progress that nobody listens to.
    pub fn silent() -> Self {
        Self::default()
    }

    /// `report(stage, done)` is called with the name of the current work and the share done, 0..=1.
    pub fn new(report: impl Fn(&str, f64) + Send + Sync + 'static) -> Self {
        Self { report: Some(Arc::new(report)), cancelled: Arc::default() }
    }

    /// Progress that nobody listens to but that is cancelled together with this one: for a part of the work.
    pub fn unheard(&self) -> Self {
        Self { report: None, cancelled: Arc::clone(&self.cancelled) }
    }

    /// Flag to set from elsewhere (a signal handler, a button) to cancel.
    pub fn cancel_flag(&self) -> Arc<AtomicBool> {
        Arc::clone(&self.cancelled)
    }

    /// Whether the work should stop.
    pub fn is_cancelled(&self) -> bool {
        self.cancelled.load(Ordering::Relaxed)
    }

    /// Reports `done` (0..=1) of `stage`.
    ///
    /// # Errors
    /// [`Cancelled`] if the work should stop; return at once, leaving nothing half done.
    pub fn tick(&self, stage: &str, done: f64) -> Result<(), Cancelled> {
        if let Some(report) = &self.report {
            report(stage, done);
        }
        if self.is_cancelled() { Err(Cancelled) } else { Ok(()) }
    }
}
