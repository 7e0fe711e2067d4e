//! Terrain disocclusion on a thread of its own while pictures are drawn: a picture waits for its ground only if that would lag too far.

use super::super::metrics::{Hides, Judge};
use super::super::visibility_qp::ViewSight;
use super::super::{Field, ReferencePoint};
use super::{TerrainMemory, TerrainSolver, in_picture};
use crate::DisocclusionError;
use belvedere_core::{TerrainDisocclusion, View};
use belvedere_scene::{Cancelled, Progress, Scene};
use std::sync::Arc;
use std::sync::atomic::Ordering;
use std::sync::mpsc::{Receiver, Sender, channel};
use std::thread::JoinHandle;

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

    /// The same on one thread alone, for pictures that do not wait for their ground ([`LiveTerrain::newest`]): work of the solver among that
    /// of a picture would delay it by as long as it takes.
    pub fn apart(solver: TerrainSolver, scene: Arc<Scene>) -> Self {
        Self::started(solver, scene, true)
    }

    fn started(solver: TerrainSolver, scene: Arc<Scene>, apart: bool) -> Self {
        let (orders, inbox) = channel();
        let (outbox, answers) = channel();
        let progress = Progress::silent();
        let guard = solver.settings().guard;
        let own = progress.clone();
        let worker = std::thread::spawn(move || {
            let pool = apart.then(|| rayon::ThreadPoolBuilder::new().num_threads(1).build().ok()).flatten();
            match pool {
                Some(pool) => pool.install(|| work(&solver, &scene, inbox, outbox, &own)),
                None => work(&solver, &scene, inbox, outbox, &own),
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
        let verdicts = Judge::faceted(field, ground.stage.grid(), &sight).judge(&points, self.guard);
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

/// Solves for the newest view until the inbox is closed.
fn work(solver: &TerrainSolver, scene: &Scene, inbox: Receiver<Order>, outbox: Sender<Answer>, progress: &Progress) {
    let mut memory = TerrainMemory::default();
    let mut points: Arc<[ReferencePoint]> = Arc::new([]);
    while let Ok(mut order) = inbox.recv() {
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
