//! Progress and cancellation in one argument.

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Instant;

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
    deadline: Option<Instant>,
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
        Self { report: Some(Arc::new(report)), ..Self::default() }
    }

    /// Progress that nobody listens to but that is cancelled together with this one: for a part of the work.
    pub fn unheard(&self) -> Self {
        Self { report: None, ..self.clone() }
    }

    /// The same with a moment at which the work should end with the best it has; an earlier one of this progress stays.
    pub fn until(&self, deadline: Instant) -> Self {
        Self { deadline: Some(self.deadline.map_or(deadline, |d| d.min(deadline))), ..self.clone() }
    }

    /// Flag to set from elsewhere (a signal handler, a button) to cancel.
    pub fn cancel_flag(&self) -> Arc<AtomicBool> {
        Arc::clone(&self.cancelled)
    }

    /// Whether the work should stop.
    pub fn is_cancelled(&self) -> bool {
        self.cancelled.load(Ordering::Relaxed)
    }

    /// Whether work that can end with something less good should do so: it is cancelled, or its time is up.
    pub fn should_end(&self) -> bool {
        self.is_cancelled() || self.is_late()
    }

    /// Whether the time is up.
    pub fn is_late(&self) -> bool {
        self.deadline.is_some_and(|deadline| Instant::now() >= deadline)
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
