//! Terrain disocclusion on a thread of its own while pictures are drawn: a picture waits for its ground only if that would lag too far.

use super::super::metrics::{Hides, Judge};
use super::super::visibility_qp::ViewSight;
use super::super::{Field, ReferencePoint};
use super::{TerrainMemory, TerrainSolver, in_picture};
use crate::DisocclusionError;
use belvedere_core::{TerrainDisocclusion, View};
use belvedere_scene::{Cancelled, Instant, Progress, Scene};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{Receiver, Sender, channel};
use std::sync::{Arc, Mutex, OnceLock, PoisonError};
use std::thread::JoinHandle;
use std::time::Duration;

/// Terrain disocclusion while pictures are drawn. A thread of its own solves for the newest view that was requested; every picture
/// gets the newest ground that is solved, and the number of points that this ground hides.
///
/// Which ground a picture gets depends on how fast the machine is: films are solved frame by frame instead ([`TerrainSolver`]).
#[derive(Debug)]
pub struct LiveTerrain {
    orders: Option<Sender<Order>>,
    answers: Receiver<Answer>,
    worker: Option<JoinHandle<()>>,
    progress: Progress,
    guard: f64,
    frame: u64,
    ground: Option<Ground>,
}

/// Ground for a picture.
#[derive(Debug, Clone)]
pub struct LiveFrame {
    /// The displacement.
    pub stage: TerrainDisocclusion,
    /// Number of pictures since the view was requested for which it was solved, 0..=[`LiveTerrain::LAG`].
    pub lag: u64,
    /// Reference points in the picture, farther from the eye than three times the guard.
    pub points: usize,
    /// Number of these points that this ground hides from this eye.
    pub hidden: usize,
    /// Largest height by which the ground rises over a line of sight, scene units; 0 if nothing is hidden.
    pub hidden_worst_m: f64,
}

#[derive(Debug)]
struct Order {
    frame: u64,
    view: View,
}

/// Rest after each piece of work of a solver apart, as a multiple of the time that the piece took: it works a third of the time, and leaves
/// the rest to the pictures.
const REST: u32 = 2;
/// Longest rest, and time between two looks at whether the work is still wanted.
const LONGEST_REST: Duration = Duration::from_secs(1);
const NAP: Duration = Duration::from_millis(5);

type Answer = Result<Ground, DisocclusionError>;

#[derive(Debug)]
struct Ground {
    frame: u64,
    stage: TerrainDisocclusion,
    field: Arc<Field>,
    points: Arc<[ReferencePoint]>,
}

impl LiveTerrain {
    /// Largest lag, pictures: a picture waits rather than show ground that was solved for an earlier view than that.
    pub const LAG: u64 = 3;

    /// Starts the thread.
    ///
    /// * `solver`: with a time step between two pictures, if the ground is to move smoothly.
    pub fn new(solver: TerrainSolver, scene: Arc<Scene>) -> Self {
        Self::started(solver, scene, false)
    }

    /// The same on one thread alone that works a third of the time, for pictures that do not wait for their ground
    /// ([`LiveTerrain::newest`]): work of the solver among that of a picture would delay it by as long as it takes.
    pub fn apart(solver: TerrainSolver, scene: Arc<Scene>) -> Self {
        Self::started(solver, scene, true)
    }

    fn started(solver: TerrainSolver, scene: Arc<Scene>, apart: bool) -> Self {
        let (orders, inbox) = channel();
        let (outbox, answers) = channel();
        let (rests, progress) = match apart.then(Rests::new) {
            Some((rests, progress)) => (Some(rests), progress),
            None => (None, Progress::silent()),
        };
        let guard = solver.settings().guard;
        let own = progress.clone();
        let worker = std::thread::spawn(move || {
            let pool = apart.then(|| rayon::ThreadPoolBuilder::new().num_threads(1).build().ok()).flatten();
            match pool {
                Some(pool) => pool.install(|| work(&solver, &scene, inbox, outbox, (&own, rests.as_deref()))),
                None => work(&solver, &scene, inbox, outbox, (&own, rests.as_deref())),
            }
        });
        Self { orders: Some(orders), answers, worker: Some(worker), progress, guard, frame: 0, ground: None }
    }

    /// Ground for the next picture, and whether it shows what it should from the eye of `base`.
    ///
    /// # Errors
    /// Those of [`TerrainSolver::solve`], for this view or an earlier one; the next view may be requested all the same.
    pub fn frame(&mut self, base: &View) -> Result<LiveFrame, DisocclusionError> {
        self.ask(base);
        while let Ok(answer) = self.answers.try_recv() {
            self.take(answer)?;
        }
        loop {
            match &self.ground {
                Some(ground) if self.frame - ground.frame <= Self::LAG => return Ok(self.judged(ground, base)),
                _ => match self.answers.recv() {
                    Ok(answer) => self.take(answer)?,
                    Err(_) => return Err(Cancelled.into()),
                },
            }
        }
    }

    /// Requests ground for the view and returns the newest that is solved, for whatever view, without waiting. `None` before the
    /// first is solved.
    ///
    /// # Errors
    /// As [`LiveTerrain::frame`].
    pub fn newest(&mut self, base: &View) -> Result<Option<TerrainDisocclusion>, DisocclusionError> {
        self.ask(base);
        while let Ok(answer) = self.answers.try_recv() {
            self.take(answer)?;
        }
        Ok(self.ground.as_ref().map(|ground| ground.stage.clone()))
    }

    fn ask(&mut self, base: &View) {
        self.frame += 1;
        let order = Order { frame: self.frame, view: base.clone() };
        // If the thread has ended, waiting for its answer reports that.
        if let Some(orders) = &self.orders {
            let _ = orders.send(order);
        }
    }

    fn take(&mut self, answer: Answer) -> Result<(), DisocclusionError> {
        self.ground = Some(answer?);
        Ok(())
    }

    fn judged(&self, ground: &Ground, base: &View) -> LiveFrame {
        let field = &*ground.field;
        let eye = base.pinhole().eye.truncate();
        let nearest = 3.0 * self.guard * field.spacing().max_element();
        let shown = |p: &&ReferencePoint| {
            let at = field.scene_from_grid(p.grid);
            at.distance(eye) > nearest && in_picture::holds(base, at.extend(p.ground + p.lift))
        };
        let points: Vec<ReferencePoint> = ground.points.iter().filter(shown).copied().collect();
        let sight = ViewSight::new(base, field);
        let verdicts = Judge::new(field, ground.stage.grid(), &sight).judge(&points, self.guard);
        let hidden: Vec<f64> = verdicts.into_iter().filter_map(|v| v.hides().map(Hides::over)).collect();
        LiveFrame {
            stage: ground.stage.clone(),
            lag: self.frame - ground.frame,
            points: points.len(),
            hidden: hidden.len(),
            hidden_worst_m: hidden.into_iter().filter(|over| over.is_finite()).fold(0.0, f64::max),
        }
    }
}

impl Drop for LiveTerrain {
    fn drop(&mut self) {
        self.progress.cancel_flag().store(true, Ordering::Relaxed);
        self.orders = None;
        if let Some(worker) = self.worker.take() {
            // A panic over there has been printed there.
            let _ = worker.join();
        }
    }
}

/// Rests of a thread that works a third of the time.
#[derive(Debug)]
struct Rests {
    /// When the work began or went on.
    woke: Mutex<Instant>,
    cancelled: OnceLock<Arc<AtomicBool>>,
}

impl Rests {
    /// Progress at whose reports the thread rests.
    fn new() -> (Arc<Self>, Progress) {
        let rests = Arc::new(Self { woke: Mutex::new(Instant::now()), cancelled: OnceLock::new() });
        let own = rests.clone();
        let progress = Progress::new(move |_, _| own.rest());
        let _ = rests.cancelled.set(progress.cancel_flag());
        (rests, progress)
    }

    /// Begins a work.
    fn begin(&self) {
        *self.woke.lock().unwrap_or_else(PoisonError::into_inner) = Instant::now();
    }

    fn rest(&self) {
        let mut woke = self.woke.lock().unwrap_or_else(PoisonError::into_inner);
        let (began, rest) = (Instant::now(), (REST * woke.elapsed()).min(LONGEST_REST));
        let is_wanted = || !self.cancelled.get().is_some_and(|flag| flag.load(Ordering::Relaxed));
        while is_wanted() && began.elapsed() < rest {
            std::thread::sleep(NAP.min(rest.saturating_sub(began.elapsed())));
        }
        *woke = Instant::now();
    }
}

/// Solves for the newest view until the inbox is closed.
fn work(
    solver: &TerrainSolver,
    scene: &Scene,
    inbox: Receiver<Order>,
    outbox: Sender<Answer>,
    (progress, rests): (&Progress, Option<&Rests>),
) {
    let mut memory = TerrainMemory::default();
    let mut points: Arc<[ReferencePoint]> = Arc::new([]);
    while let Ok(mut order) = inbox.recv() {
        if let Some(rests) = rests {
            rests.begin();
        }
        while let Ok(newer) = inbox.try_recv() {
            order = newer;
        }
        let Order { frame, view } = order;
        let ground = solver.advance(scene, &view, &mut memory, progress).map(|(stage, field)| {
            if points.is_empty() {
                points = memory.points().into();
            }
            Ground { frame, stage, field, points: points.clone() }
        });
        if outbox.send(ground).is_err() {
            return;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_thread_apart_rests_twice_as_long_as_it_works_and_not_once_it_is_cancelled() {
        let (rests, progress) = Rests::new();
        let work = || std::thread::sleep(Duration::from_millis(15));
        rests.begin();
        for _ in 0..3 {
            work();
            let began = Instant::now();
            assert!(progress.tick("work", 0.5).is_ok());
            assert!(began.elapsed() >= Duration::from_millis(30), "{:?}", began.elapsed());
        }
        // Cancelled while it rests for a second.
        let Some(long_ago) = Instant::now().checked_sub(Duration::from_secs(60)) else { return };
        *rests.woke.lock().expect("lock") = long_ago;
        let flag = progress.cancel_flag();
        let canceller = std::thread::spawn(move || flag.store(true, Ordering::Relaxed));
        let began = Instant::now();
        assert!(progress.tick("work", 0.5).is_err());
        assert!(began.elapsed() < LONGEST_REST, "a cancelled work rests");
        canceller.join().expect("thread");
    }
}
