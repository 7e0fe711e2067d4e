//! Progress and cancellation in one argument.

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Duration;
use web_time::Instant;

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
    limit: Option<Duration>,
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

    /// The same with a limit of time for each piece of work that can end with the best it has: see [`Progress::begin`].
    pub fn limited(self, limit: Duration) -> Self {
        Self { limit: Some(limit), ..self }
    }

    /// The same with this limit where none is stated.
    pub fn limited_unless_stated(self, limit: Duration) -> Self {
        Self { limit: self.limit.or(Some(limit)), ..self }
    }

    /// The same for a piece of work that begins now, to which the limit of time applies from here on; inside such a piece nothing
    /// changes.
    pub fn begin(&self) -> Self {
        let deadline = || self.limit.and_then(|limit| Instant::now().checked_add(limit));
        Self { deadline: self.deadline.or_else(deadline), ..self.clone() }
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_limit_applies_from_the_beginning_of_a_piece_of_work() {
        let progress = Progress::silent().limited(Duration::ZERO);
        assert!(!progress.should_end());
        let work = progress.begin();
        assert!(work.is_late() && work.should_end() && !work.is_cancelled());
        assert!(work.tick("work", 0.5).is_ok(), "time that is up is no reason to lose everything");
        let longer = Progress::silent().limited(Duration::from_secs(3600)).begin();
        assert!(!longer.begin().should_end());
        longer.cancel_flag().store(true, Ordering::Relaxed);
        assert!(longer.should_end() && longer.tick("work", 0.5).is_err());
    }
}
