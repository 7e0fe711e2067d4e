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

/// Reports progress to a listener, and carries cancellation and a limit of time. Cheap to clone.
#[derive(Clone, Default)]
pub struct Progress {
    report: Option<Arc<Report>>,
    cancelled: Arc<AtomicBool>,
    limit: Option<Duration>,
    span: Option<Span>,
}

/// A piece of work with a limit of time.
#[derive(Debug, Clone, Copy)]
struct Span {
    /// When all of the work began.
    began: Instant,
    /// Time for all of it.
    whole: Duration,
    /// When this piece should end.
    deadline: Instant,
}

impl Span {
    fn left(&self) -> Duration {
        self.deadline.saturating_duration_since(Instant::now())
    }
}

/// Least and largest share of the remaining time that is kept for the work after a piece.
const LEAST_REST: f64 = 0.15;
const MOST_REST: f64 = 0.75;

impl std::fmt::Debug for Progress {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Progress").field("cancelled", &self.is_cancelled()).finish_non_exhaustive()
    }
}

impl Progress {
    /// Progress without a listener.
    pub fn silent() -> Self {
        Self::default()
    }

    /// `report(stage, done)` is called with the name of the current work and the share done, 0..=1.
    pub fn new(report: impl Fn(&str, f64) + Send + Sync + 'static) -> Self {
        Self { report: Some(Arc::new(report)), ..Self::default() }
    }

    /// Progress without a listener that is cancelled together with this one: for a part of the work.
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
        let span = || {
            let (began, whole) = (Instant::now(), self.limit?);
            Some(Span { began, whole, deadline: began.checked_add(whole)? })
        };
        Self { span: self.span.or_else(span), ..self.clone() }
    }

    /// Whether a piece of work with a limit of time has begun.
    pub fn is_limited(&self) -> bool {
        self.span.is_some()
    }

    /// Remaining time; `None` without a limit.
    pub fn left(&self) -> Option<Duration> {
        self.span.map(|span| span.left())
    }

    /// Progress for a piece of the work that may take this share of the remaining time, 0..=1.
    pub fn part(&self, share: f64) -> Self {
        self.until(|span| Instant::now() + span.left().mul_f64(share.clamp(0.0, 1.0)))
    }

    /// Progress for a piece of the work that is followed by work of about `rest` times the time spent so far: between 0.15 and 0.75 of
    /// the remaining time is kept for that.
    pub fn before(&self, rest: f64) -> Self {
        self.until(|span| {
            let (left, wanted) = (span.left(), span.began.elapsed().mul_f64(rest.clamp(0.0, 1e6)));
            Instant::now() + left.saturating_sub(wanted.clamp(left.mul_f64(LEAST_REST), left.mul_f64(MOST_REST)))
        })
    }

    /// Progress for an indispensable piece of the work: it may take at least this share of the time for all of the work.
    pub fn at_least(&self, share: f64) -> Self {
        self.until(|span| span.deadline.max(Instant::now() + span.whole.mul_f64(share.clamp(0.0, 1.0))))
    }

    fn until(&self, deadline: impl Fn(&Span) -> Instant) -> Self {
        Self { span: self.span.map(|span| Span { deadline: deadline(&span), ..span }), ..self.clone() }
    }

    /// Flag to set from elsewhere (a signal handler, a button) to cancel.
    pub fn cancel_flag(&self) -> Arc<AtomicBool> {
        Arc::clone(&self.cancelled)
    }

    /// Whether the work should stop.
    pub fn is_cancelled(&self) -> bool {
        self.cancelled.load(Ordering::Relaxed)
    }

    /// Whether work that can end with an intermediate result should do so: it is cancelled, or its time is up.
    pub fn should_end(&self) -> bool {
        self.is_cancelled() || self.is_late()
    }

    /// Whether the time is up.
    pub fn is_late(&self) -> bool {
        self.span.is_some_and(|span| Instant::now() >= span.deadline)
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
        assert!(longer.is_limited() && !Progress::silent().begin().is_limited());
        longer.cancel_flag().store(true, Ordering::Relaxed);
        assert!(longer.should_end() && longer.tick("work", 0.5).is_err());
    }

    #[test]
    fn pieces_of_the_work_leave_time_for_the_others() {
        let seconds = |p: &Progress| p.left().unwrap().as_secs_f64();
        let work = Progress::silent().limited(Duration::from_secs(1000)).begin();
        // Some of the time is gone.
        std::thread::sleep(Duration::from_millis(2));
        assert!((seconds(&work.part(0.3)) - 300.0).abs() < 10.0);
        assert!((seconds(&work.before(0.0)) - 850.0).abs() < 10.0, "something is always left for the rest");
        assert!((seconds(&work.before(1e9)) - 250.0).abs() < 10.0, "and three quarters of the time at most");
        assert!((seconds(&work.part(0.5).part(0.5)) - 250.0).abs() < 10.0);
        let late = work.part(0.0);
        assert!(late.is_late() && !work.is_late());
        assert!((seconds(&late.at_least(0.1)) - 100.0).abs() < 10.0, "of all the time");
        assert!((seconds(&work.at_least(0.1)) - 1000.0).abs() < 10.0);
        let free = Progress::silent();
        assert!(
            free.part(0.5).left().is_none() && free.before(1.0).left().is_none() && free.at_least(1.0).left().is_none()
        );
    }
}
