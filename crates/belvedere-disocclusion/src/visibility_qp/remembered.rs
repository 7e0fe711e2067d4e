//! Cache of traced lines of sight, for points that hardly move.

use super::problem::LinesOfSight;
use belvedere_core::DVec2;
use std::collections::HashMap;
use std::sync::{Arc, Mutex, PoisonError};

/// Lines are traced at heights that are multiples of this and shifted to the ones between, metres.
const STEP_M: f64 = 0.04;

/// A line as it was traced: number of its step of height, and its vertices.
type Traced = (i64, Arc<[(DVec2, f64)]>);

/// Cache of lines of sight that take long to trace. Between judgements and solutions of one picture points move by centimetres, and
/// their lines with them: fully at the point, not at all at the eye. Answers do not depend on the lines that were traced before.
pub(crate) struct RememberedLines<S> {
    sight: S,
    /// The last line of each point.
    known: Mutex<HashMap<[u64; 2], Traced>>,
}

impl<S: LinesOfSight> RememberedLines<S> {
    /// * `sight`: traces lines that depend smoothly on the heights of their points.
    pub(crate) fn new(sight: S) -> Self {
        Self { sight, known: Mutex::default() }
    }

    fn traced(&self, grid: DVec2, step: i64) -> Arc<[(DVec2, f64)]> {
        let key = [grid.x.to_bits(), grid.y.to_bits()];
        let known = || self.known.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some((at, line)) = known().get(&key)
            && *at == step
        {
            return Arc::clone(line);
        }
        let mut line = Vec::new();
        self.sight.trace(grid, step as f64 * STEP_M, &mut line);
        let line: Arc<[(DVec2, f64)]> = line.into();
        known().insert(key, (step, Arc::clone(&line)));
        line
    }
}

impl<S: LinesOfSight> LinesOfSight for RememberedLines<S> {
    fn trace(&self, grid: DVec2, z: f64, out: &mut Vec<(DVec2, f64)>) {
        let step = (z / STEP_M).round();
        let line = self.traced(grid, step as i64);
        let shift = z - step * STEP_M;
        let total: f64 = line.windows(2).map(|p| p[0].0.distance(p[1].0)).sum();
        let mut way = 0.0;
        for (k, &(at, height)) in line.iter().enumerate() {
            way += if k > 0 { line[k - 1].0.distance(at) } else { 0.0 };
            let left = if total > 0.0 { 1.0 - way / total } else { 1.0 };
            out.push((at, height + left * shift));
        }
    }

    fn straight(&self) -> Option<(DVec2, f64)> {
        self.sight.straight()
    }
}

#[cfg(test)]
mod tests;
