//! Draws pictures in the background: the newest order counts, and a picture at rest is cancelled by a new order.

use super::beside::{THREADS, beside};
use belvedere::BelvedereError;
use belvedere::live::{Judged, LiveSession, Order, Pace, Shown};
use belvedere::scene::Progress;
use belvedere::scene_file::Document;
use std::sync::atomic::Ordering;
use std::sync::mpsc::{self, Receiver, Sender};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError, TryLockError};

/// An answer of a painter.
#[derive(Debug)]
pub enum Answer {
    /// A picture.
    Shown(Box<Shown>),
    /// Visibility of the required features in the last picture.
    Judged(Box<Judged>),
    /// Why there is no picture of the document, one sentence; the last picture stays.
    Failed(Arc<Document>, String),
}

/// Called from the painter's thread when there is an answer, or when `Painter::answer` should be called.
type Wake = Box<dyn Fn() + Send + Sync>;

/// Draws the newest order in the background, or, where there are no threads, within [`Painter::answer`].
pub struct Painter {
    desk: Arc<Desk>,
    outbox: Sender<Answer>,
    answers: Receiver<Answer>,
    /// Without threads: the last picture has not been shown yet, and nothing else is done before.
    waits: bool,
}

/// Orders, shared by the painter and its thread.
struct Desk {
    state: Mutex<State>,
    /// Locked by the working thread.
    session: Mutex<LiveSession>,
    wake: Wake,
}

#[derive(Debug, Default)]
struct State {
    order: Option<Order>,
    /// Order of the last picture, if it is to be judged.
    to_judge: Option<Order>,
    /// Cancels the current task, if a new order may cancel it.
    yielding: Option<Progress>,
    /// Whether a thread is working.
    at_work: bool,
    /// Pixels of the picture per point of the screen; 0: not told.
    density: f64,
    /// What the work is at, and its share done, 0..=1.
    at: Option<(String, f64)>,
}

impl Painter {
    /// A painter without an order.
    ///
    /// * `wake`: called from any thread when there may be an answer.
    pub fn new(wake: impl Fn() + Send + Sync + 'static) -> Self {
        let (outbox, answers) = mpsc::channel();
        let desk = Desk { state: Mutex::default(), session: Mutex::default(), wake: Box::new(wake) };
        Self { desk: Arc::new(desk), outbox, answers, waits: false }
    }

    /// Orders the next picture; an earlier order that has not begun is dropped, a picture at rest that has begun is cancelled.
    pub fn order(&mut self, order: Order) {
        let mut state = self.desk.state();
        state.give_way();
        let document = order.document.clone();
        state.order = Some(order);
        let begins = THREADS && !std::mem::replace(&mut state.at_work, true);
        drop(state);
        if !THREADS {
            (self.desk.wake)();
        } else if begins {
            let (desk, outbox) = (self.desk.clone(), self.outbox.clone());
            if let Err(reason) = beside(move || desk.work(&outbox)) {
                self.desk.state().at_work = false;
                let _ = self.outbox.send(Answer::Failed(document, reason));
            }
        }
    }

    /// Lets the pictures that are ordered from now on have lines, marks and names that many times as large.
    ///
    /// * `density`: pixels of the picture per point of the screen, more than 0.
    pub fn set_density(&mut self, density: f64) {
        self.desk.state().density = density;
    }

    /// Gives up the picture at rest that is being drawn or waits, and its judgement; there is no answer.
    pub fn cancel(&mut self) {
        let mut state = self.desk.state();
        state.give_way();
        state.order = None;
    }

    /// What the work is at, in words, and its share done, 0..=1; `None` while nothing tells.
    pub fn progress(&self) -> Option<(String, f64)> {
        self.desk.state().at.clone()
    }

    /// The next answer, if it has arrived.
    pub fn answer(&mut self) -> Option<Answer> {
        if THREADS { self.answers.try_recv().ok() } else { self.answer_in_turn() }
    }

    /// Draws the order, if there is one; the picture is judged after it has been shown.
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

    /// The next answer within a time limit, for tests and scripts.
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
    /// Performs tasks until there are none.
    fn work(self: &Arc<Self>, outbox: &Sender<Answer>) {
        while let Some((task, progress)) = self.next() {
            if let Some(answer) = self.perform(task, &progress) {
                // A receiver that was dropped has withdrawn its orders, too.
                let _ = outbox.send(answer);
                (self.wake)();
            }
        }
    }

    fn next(self: &Arc<Self>) -> Option<(Task, Progress)> {
        let mut state = self.state();
        let desk = Arc::downgrade(self);
        let progress = Progress::new(move |stage, share| {
            if let Some(desk) = desk.upgrade() {
                desk.state().at = Some((stage.to_owned(), share));
            }
        });
        state.at = None;
        let order = state.order.take();
        let rests = order.as_ref().is_none_or(|order| order.pace == Pace::Resting);
        let task = order.map(Task::Show).or_else(|| state.to_judge.take().map(Task::Judge));
        state.yielding = (rests && task.is_some()).then(|| progress.clone());
        state.at_work = task.is_some();
        task.map(|task| (task, progress))
    }

    fn perform(&self, task: Task, progress: &Progress) -> Option<Answer> {
        // After a panic the session is used again for the next picture.
        let mut session = self.session.lock().unwrap_or_else(PoisonError::into_inner);
        match task {
            Task::Show(order) => {
                session.set_density(self.state().density);
                let answer = guarded(&order.document, || session.show(&order, progress));
                let mut state = self.state();
                // Without threads a judgement would hold the next picture of a motion up.
                let in_background = THREADS || order.pace == Pace::Resting;
                if in_background && session.has_time_to_judge(order.pace) && !progress.is_cancelled() {
                    state.to_judge = Some(order);
                }
                answer
            }
            Task::Judge(order) => judge(&mut session, &order, progress),
        }
    }

    /// Locks the state, which is held for short times only. The main thread of a browser may not block, so it spins.
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

/// A picture, or the reason why there is none; `None` if it was cancelled. A panic is a reason too, so that the window lives on.
fn guarded(document: &Arc<Document>, show: impl FnOnce() -> Result<Shown, BelvedereError>) -> Option<Answer> {
    let failed = |reason| Some(Answer::Failed(document.clone(), reason));
    match std::panic::catch_unwind(std::panic::AssertUnwindSafe(show)) {
        Ok(Ok(shown)) => Some(Answer::Shown(Box::new(shown))),
        Ok(Err(e)) if e.is_cancelled() => None,
        Ok(Err(e)) => failed(e.to_string()),
        Err(_) => failed("internal error while drawing; please report this with the scene".into()),
    }
}

/// Judges the last picture; an error gives no answer, since the picture stands for itself.
fn judge(session: &mut LiveSession, order: &Order, progress: &Progress) -> Option<Answer> {
    session.judge(order, progress).ok().flatten().map(|judged| Answer::Judged(Box::new(judged)))
}
