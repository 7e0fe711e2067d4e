//! Pictures made beside the window: the newest wish counts, and a picture at rest gives way to a new one.

use super::beside::{THREADS, beside};
use super::live::{Judged, LiveSession, Order, Pace, Shown};
use belvedere_scene::Progress;
use std::sync::atomic::Ordering;
use std::sync::mpsc::{self, Receiver, Sender};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError, TryLockError};

/// What a painter has to say.
#[derive(Debug)]
pub enum Answer {
    /// A picture.
    Shown(Box<Shown>),
    /// What the last picture shows of what must be seen.
    Judged(Box<Judged>),
    /// Why there is none, one sentence; what was shown before stays.
    Failed(String),
}

/// Called from where the painter works when there is an answer, or something to ask for.
type Wake = Box<dyn Fn() + Send + Sync>;

/// Draws the newest order: beside the window, or where there are no threads, when [`Painter::answer`] is asked.
pub struct Painter {
    desk: Arc<Desk>,
    outbox: Sender<Answer>,
    answers: Receiver<Answer>,
    /// Without threads: whether the last picture is still to be shown, before anything else is done.
    waits: bool,
}

/// Where orders are laid down, and whoever works at them.
struct Desk {
    state: Mutex<State>,
    /// Held by the one who works.
    session: Mutex<LiveSession>,
    wake: Wake,
}

#[derive(Debug, Default)]
struct State {
    order: Option<Order>,
    /// The picture that was drawn last and is not judged yet.
    to_judge: Option<Order>,
    /// Cancels the work in hand, if that may give way.
    yielding: Option<Progress>,
    /// Whether somebody works.
    at_work: bool,
}

impl Painter {
    /// A painter without an order.
    ///
    /// * `wake`: called when it is worth asking for an answer, from any thread.
    pub fn new(wake: impl Fn() + Send + Sync + 'static) -> Self {
        let (outbox, answers) = mpsc::channel();
        let desk = Desk { state: Mutex::default(), session: Mutex::default(), wake: Box::new(wake) };
        Self { desk: Arc::new(desk), outbox, answers, waits: false }
    }

    /// The next picture; one that was ordered before and is not begun is forgotten, one at rest that is begun is broken off.
    pub fn order(&mut self, order: Order) {
        let mut state = self.desk.state();
        state.give_way();
        state.order = Some(order);
        let begins = THREADS && !std::mem::replace(&mut state.at_work, true);
        drop(state);
        if !THREADS {
            (self.desk.wake)();
        } else if begins {
            let (desk, outbox) = (self.desk.clone(), self.outbox.clone());
            if let Err(reason) = beside(move || desk.work(&outbox)) {
                self.desk.state().at_work = false;
                let _ = self.outbox.send(Answer::Failed(reason));
            }
        }
    }

    /// The next answer, if there is one.
    pub fn answer(&mut self) -> Option<Answer> {
        if THREADS { self.answers.try_recv().ok() } else { self.answer_in_turn() }
    }

    /// Draws what was ordered, if anything was; what a picture shows is judged when it is on the screen.
    fn answer_in_turn(&mut self) -> Option<Answer> {
        if std::mem::take(&mut self.waits) {
            if self.desk.state().to_judge.is_some() {
                (self.desk.wake)();
            }
            return None;
        }
        let (task, progress) = self.desk.next()?;
        self.waits = matches!(task, Task::Show(_));
        self.desk.perform(task, &progress)
    }

    /// The next answer within a time: for tests and scripts.
    #[cfg(not(target_family = "wasm"))]
    pub fn answer_within(&mut self, time: std::time::Duration) -> Option<Answer> {
        self.answers.recv_timeout(time).ok()
    }
}

impl Drop for Painter {
    fn drop(&mut self) {
        let mut state = self.desk.state();
        state.give_way();
        (state.order, state.to_judge) = (None, None);
    }
}

impl State {
    fn give_way(&mut self) {
        self.to_judge = None;
        if let Some(progress) = self.yielding.take() {
            progress.cancel_flag().store(true, Ordering::Relaxed);
        }
    }
}

/// One thing to do.
enum Task {
    Show(Order),
    Judge(Order),
}

impl Desk {
    /// Does everything that there is to do.
    fn work(&self, outbox: &Sender<Answer>) {
        while let Some((task, progress)) = self.next() {
            if let Some(answer) = self.perform(task, &progress) {
                // Whoever does not listen any more has withdrawn the orders, too.
                let _ = outbox.send(answer);
                (self.wake)();
            }
        }
    }

    fn next(&self) -> Option<(Task, Progress)> {
        let mut state = self.state();
        let progress = Progress::silent();
        let order = state.order.take();
        let rests = order.as_ref().is_none_or(|order| order.pace == Pace::Resting);
        let task = order.map(Task::Show).or_else(|| state.to_judge.take().map(Task::Judge));
        state.yielding = (rests && task.is_some()).then(|| progress.clone());
        state.at_work = task.is_some();
        task.map(|task| (task, progress))
    }

    fn perform(&self, task: Task, progress: &Progress) -> Option<Answer> {
        // A picture that panicked is made anew.
        let mut session = self.session.lock().unwrap_or_else(PoisonError::into_inner);
        match task {
            Task::Show(order) => {
                let answer = guarded(|| session.show(&order, progress));
                let mut state = self.state();
                if session.has_time_to_judge(order.pace) && !progress.is_cancelled() {
                    state.to_judge = Some(order);
                }
                answer
            }
            Task::Judge(order) => judge(&mut session, &order, progress),
        }
    }

    /// Never held for long. The page of a browser may not sleep, only try again.
    fn state(&self) -> MutexGuard<'_, State> {
        loop {
            match self.state.try_lock() {
                Ok(state) => return state,
                Err(TryLockError::Poisoned(state)) => return state.into_inner(),
                Err(TryLockError::WouldBlock) => std::thread::yield_now(),
            }
        }
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
fn judge(session: &mut LiveSession, order: &Order, progress: &Progress) -> Option<Answer> {
    session.judge(order, progress).ok().flatten().map(|judged| Answer::Judged(Box::new(judged)))
}
