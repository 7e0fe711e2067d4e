//! Rows of a picture whose representations are drawn one by one: the same rows of every representation, mixed.

use crate::cache::lock;
use crate::frame::threads_of;
use crate::rows::{self, Caches, Work, on};
use crate::surfaces::Scratch;
use belvedere_composite::layers::{Levels, sum_of_stats};
use belvedere_scene::{Frame, FrameStats, PictureRows, PixelGrid, RenderError, RenderJob};
use rayon::ThreadPool;
use std::ops::Range;
use std::sync::Mutex;

/// Prepares a picture, with all representations that are drawn one by one if it has any, and lets `work` draw it.
pub(crate) fn draw(
    caches: Caches<'_>,
    job: &RenderJob<'_>,
    scratch: &mut Scratch,
    work: Work<'_>,
) -> Result<(), RenderError> {
    let Some(levels) = Levels::of(job) else { return rows::draw(caches, job, scratch, work) };
    rows::check(job)?;
    with((caches, job), (&levels, threads_of(job).as_ref()), &[], work)
}

/// Prepares the representations after those that are `ready`.
fn with(
    (caches, job): (Caches<'_>, &RenderJob<'_>),
    (levels, pool): (&Levels<'_>, Option<&ThreadPool>),
    ready: &[&dyn PictureRows],
    work: Work<'_>,
) -> Result<(), RenderError> {
    if ready.len() == levels.count() {
        let keep_world = job.options.aux.world;
        return work(&LevelRows { levels, ready, pool, keep_world, frames: Mutex::default() });
    }
    let options = levels.options(job.options, ready.len());
    let alone = RenderJob { options: &options, ..*job };
    rows::draw(caches, &alone, &mut Scratch::default(), &mut |rows| {
        let ready: Vec<&dyn PictureRows> = ready.iter().copied().chain([rows]).collect();
        with((caches, job), (levels, pool), &ready, work)
    })
}

struct LevelRows<'a> {
    levels: &'a Levels<'a>,
    ready: &'a [&'a dyn PictureRows],
    pool: Option<&'a ThreadPool>,
    keep_world: bool,
    /// Memory of the rows drawn last, of each representation.
    frames: Mutex<Vec<Frame>>,
}

impl PictureRows for LevelRows<'_> {
    fn size(&self) -> [usize; 2] {
        self.ready[0].size()
    }

    fn stats(&self) -> FrameStats {
        let pixels = self.size().iter().product();
        let stats: Vec<FrameStats> = self.ready.iter().map(|level| level.stats()).collect();
        sum_of_stats(stats.iter().map(|stats| (pixels, stats)))
    }

    fn look(&self, grid: &PixelGrid, points: bool) -> Result<Frame, RenderError> {
        // Weights follow from world points.
        let frames = self.ready.iter().map(|level| level.look(grid, true)).collect::<Result<Vec<_>, _>>()?;
        let (levels, frames) = (self.levels, &frames);
        Ok(on(self.pool, || levels.composite(frames, points)))
    }

    fn draw(&self, rows: Range<usize>, frame: &mut Frame) -> Result<(), RenderError> {
        let mut frames = std::mem::take(&mut *lock(&self.frames));
        frames.resize_with(self.ready.len(), Frame::default);
        for (level, frame) in self.ready.iter().zip(&mut frames) {
            level.draw(rows.clone(), frame)?;
        }
        let (levels, drawn, keep_world) = (self.levels, &frames, self.keep_world);
        *frame = on(self.pool, || levels.composite(drawn, keep_world));
        frame.stats = FrameStats::default();
        *lock(&self.frames) = frames;
        Ok(())
    }
}
