//! Pictures made beside the window: the newest wish counts, and a picture at rest gives way to a new one.

use super::live::{Judged, LiveSession, Order, Pace, Shown};
use belvedere_scene::Progress;
#[cfg(not(target_family = "wasm"))]
use std::sync::{Arc, Condvar, Mutex};

/// What a painter has to say.
#[derive(Debug)]
pub enum Answer {
    /// A picture.
    Shown(Box<Shown>),
    /// What the last picture at rest shows of what must be seen.
    Judged(Box<Judged>),
    /// Why there is none, one sentence; what was shown before stays.
    Failed(String),
}

/// Called from the thread of the painter when there is an answer.
type Wake = Box<dyn Fn() + Send>;

/// Draws the newest order, on a thread of its own; where there are no threads, when [`Painter::answer`] is asked.
pub struct Painter {
    #[cfg(not(target_family = "wasm"))]
    desk: Arc<Desk>,
    #[cfg(not(target_family = "wasm"))]
    worker: Option<std::thread::JoinHandle<()>>,
    #[cfg(not(target_family = "wasm"))]
    answers: std::sync::mpsc::Receiver<Answer>,
    #[cfg(target_family = "wasm")]
    wake: Wake,
    #[cfg(target_family = "wasm")]
    session: LiveSession,
    #[cfg(target_family = "wasm")]
    order: Option<Order>,
    #[cfg(target_family = "wasm")]
    to_judge: Option<Order>,
    /// Whether the last answer is still to be shown.
    #[cfg(target_family = "wasm")]
    waits: bool,
}

/// Stack of the thread: deep enough for any document that passes the limits.
#[cfg(not(target_family = "wasm"))]
const STACK_BYTES: usize = 64 << 20;

/// Where orders are laid down.
#[cfg(not(target_family = "wasm"))]
#[derive(Debug, Default)]
struct Desk {
    state: Mutex<State>,
    news: Condvar,
}

#[cfg(not(target_family = "wasm"))]
#[derive(Debug, Default)]
struct State {
    order: Option<Order>,
    /// Cancels the work in hand, if that may give way.
    yielding: Option<Progress>,
    ended: bool,
}

#[cfg(not(target_family = "wasm"))]
impl Desk {
    fn state(&self) -> std::sync::MutexGuard<'_, State> {
        // A painter that panicked left nothing half done in here.
        self.state.lock().unwrap_or_else(std::sync::PoisonError::into_inner)
    }

    /// Waits for an order; `None` at the end. Work on it may be cancelled through what comes with it, if it is a picture at rest.
    fn next(&self) -> Option<(Order, Progress)> {
        let mut state = self.state();
        loop {
            if state.ended {
                return None;
            }
            if let Some(order) = state.order.take() {
                let progress = Progress::silent();
                state.yielding = (order.pace == Pace::Resting).then(|| progress.clone());
                return Some((order, progress));
            }
            state = self.news.wait(state).unwrap_or_else(std::sync::PoisonError::into_inner);
        }
    }
}

#[cfg(not(target_family = "wasm"))]
impl Painter {
    /// Starts the thread.
    pub fn new(wake: Wake) -> Self {
        let desk = Arc::new(Desk::default());
        let (outbox, answers) = std::sync::mpsc::channel();
        let own = desk.clone();
        let work = move || {
            let mut session = LiveSession::default();
            while let Some((order, progress)) = own.next() {
                let say = |answer: Answer| {
                    let heard = outbox.send(answer).is_ok();
                    wake();
                    heard
                };
                let shown = match guarded(|| session.show(&order, &progress)) {
                    Some(answer) => say(answer),
                    None => true,
                };
                let judges = order.pace == Pace::Resting && !progress.is_cancelled();
                let judged = if judges { judge(&session, &order, &progress) } else { None };
                if !shown || judged.is_some_and(|answer| !say(answer)) {
                    return;
                }
            }
        };
        // Without a thread every order is answered by silence; a system that starts none has worse to tell.
        let worker = std::thread::Builder::new().stack_size(STACK_BYTES).spawn(work).ok();
        Self { desk, worker, answers }
    }

    /// The next picture; one that was ordered before and is not begun is forgotten, one at rest that is begun is broken off.
    pub fn order(&mut self, order: Order) {
        let mut state = self.desk.state();
        if let Some(progress) = state.yielding.take() {
            progress.cancel_flag().store(true, std::sync::atomic::Ordering::Relaxed);
        }
        state.order = Some(order);
        drop(state);
        self.desk.news.notify_one();
    }

    /// The next answer, if there is one.
    pub fn answer(&mut self) -> Option<Answer> {
        self.answers.try_recv().ok()
    }

    /// The next answer within a time: for tests and scripts.
    pub fn answer_within(&mut self, time: std::time::Duration) -> Option<Answer> {
        self.answers.recv_timeout(time).ok()
    }
}

#[cfg(not(target_family = "wasm"))]
impl Drop for Painter {
    fn drop(&mut self) {
        let mut state = self.desk.state();
        state.ended = true;
        if let Some(progress) = state.yielding.take() {
            progress.cancel_flag().store(true, std::sync::atomic::Ordering::Relaxed);
        }
        drop(state);
        self.desk.news.notify_one();
        if let Some(worker) = self.worker.take() {
            let _ = worker.join();
        }
    }
}

#[cfg(target_family = "wasm")]
impl Painter {
    /// A painter without a thread.
    pub fn new(wake: Wake) -> Self {
        Self { wake, session: LiveSession::default(), order: None, to_judge: None, waits: false }
    }

    /// The next picture; one that was ordered before is forgotten.
    pub fn order(&mut self, order: Order) {
        self.to_judge = None;
        self.order = Some(order);
        (self.wake)();
    }

    /// Draws what was ordered, if anything was; what a picture shows is judged when it is on the screen.
    pub fn answer(&mut self) -> Option<Answer> {
        let progress = Progress::silent();
        if let Some(order) = self.order.take() {
            self.waits = true;
            self.to_judge = (order.pace == Pace::Resting).then(|| order.clone());
            return guarded(|| self.session.show(&order, &progress));
        }
        if std::mem::take(&mut self.waits) {
            if self.to_judge.is_some() {
                (self.wake)();
            }
            return None;
        }
        let order = self.to_judge.take()?;
        judge(&self.session, &order, &progress)
    }
}

/// A picture or the reason why there is none; nothing if it was broken off. A panic is a reason, too: the window lives on.
fn guarded(show: impl FnOnce() -> Result<Shown, crate::BelvedereError>) -> Option<Answer> {
    match std::panic::catch_unwind(std::panic::AssertUnwindSafe(show)) {
        Ok(Ok(shown)) => Some(Answer::Shown(Box::new(shown))),
        Ok(Err(e)) if e.is_cancelled() => None,
        Ok(Err(e)) => Some(Answer::Failed(e.to_string())),
        Err(_) => Some(Answer::Failed("internal error while drawing; please report this with the scene".into())),
    }
}

/// What cannot be judged is not: the picture stands for itself.
fn judge(session: &LiveSession, order: &Order, progress: &Progress) -> Option<Answer> {
    session.judge(order, progress).ok().flatten().map(|judged| Answer::Judged(Box::new(judged)))
}
